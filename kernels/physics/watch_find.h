// Which candidates may touch, or come to an impact, within the next substeps? Every vertex is taken
// to go straight on as it does now, u a substep, from shares 0 to 2 middle of it. In the middle of
// that time two features are measured; before and after they come nearer by no more than a corner
// of one moves against one of the other. What is listed here is looked at, and nothing else, as
// long as no vertex strays from its way (watch_stray.h).
#pragma once

#include "atomic.h"
#include "pair_close.h"

typedef struct cloth_watch_find_args {
  cloth_contact_scene scene;
  const cloth_real *x0, *x1; // [vertices x 3] m, the way of every vertex: x0 + share (x1 - x0)
  cloth_real middle, span; // of x1 - x0: the middle of the time, and half of it and a substep more
  cloth_real reach;        // m
  const uint64_t *pair;    // [n]
  uint64_t *watch;         // [capacity], appended
  uint32_t capacity;
  uint32_t *count; // [1] counts up, also past the capacity
} cloth_watch_find_args;

CLOTH_FN int cloth_watch_needs(const cloth_watch_find_args *a, cloth_contact_geometry *g)
{
  cloth_v3 o = cloth_v3_load(a->x0, g->vertex[0]), u[4], lo = cloth_v3_make(0, 0, 0), hi = lo;
  cloth_real at[12];
  for (int k = 0; k < 4; k++) {
    cloth_v3 x = cloth_v3_load(a->x0, g->vertex[k]);
    u[k] = cloth_v3_sub(cloth_v3_load(a->x1, g->vertex[k]), x);
    x = cloth_v3_add_scaled(cloth_v3_sub(x, o), a->middle, cloth_v3_sub(u[k], u[0]));
    cloth_v3_store(at, k, x);
    lo = cloth_v3_min(lo, x), hi = cloth_v3_max(hi, x);
    g->vertex[k] = k;
  }
  cloth_contact_measure(at, g);
  cloth_real size = hi.x - lo.x + (hi.y - lo.y) + (hi.z - lo.z);
  cloth_real rounding = cloth_pair_rounding(size, a->scene.thickness); // the least not looked at
  return cloth_pair_moves(u, g->type, (g->distance - a->reach - rounding) / a->span);
}

CLOTH_FN void cloth_watch_find(int i, const cloth_watch_find_args *a)
{
  cloth_contact_geometry g;
  if (cloth_contact_on_seam(&a->scene, cloth_pair_unpack(a->scene.format, a->pair[i]))) return;
  cloth_pair_vertices(&a->scene, a->pair[i], &g);
  if (!cloth_watch_needs(a, &g)) return;
  uint32_t at = cloth_atomic_next(a->count);
  if (at < a->capacity) a->watch[at] = a->pair[i];
}
