// Would candidate i pass through on the straight way from the start to the end of the substep? If
// so, its vertices may go only part of the way.
#pragma once

#include "contact_find.h"
#include "toi.h"

#define CLOTH_IMPACT_SHARE                                                                         \
  (cloth_real)0.1 // a pair that starts closer keeps this much of its distance

enum { CLOTH_WHOLE = 1 << 20 }; // the whole way, in fixed point: a minimum of integers has no order

typedef struct cloth_impact_find_args {
  cloth_contact_scene scene;
  int first, last;      // vertices of this part
  int stop;             // 1: whatever is involved stays where it was
  cloth_real gap;       // m, distance that counts as an impact
  const uint64_t *pair; // [n]
  uint32_t *allowed;    // [cloth vertices] of CLOTH_WHOLE, lowered
  uint32_t *count;      // [1] impacts of which this part owns the first cloth vertex; counts up
  uint32_t *any;        // [1] impacts seen by this part; counts up
} cloth_impact_find_args;

CLOTH_FN void cloth_impact_find(int i, const cloth_impact_find_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_contact_geometry g;
  cloth_pair_vertices(s, a->pair[i], &g);
  if (!cloth_pair_near(s, &g, a->gap) || cloth_contact_ignored(s, &g)) return;

  cloth_v3 p[4], q[4]; // as stored: toi.h accounts for their rounding
  for (int k = 0; k < 4; k++) {
    p[k] = cloth_v3_load(s->x_t0, g.vertex[k]);
    q[k] = cloth_v3_load(s->x, g.vertex[k]);
  }
  cloth_real toi;
  int hit = g.type == CLOTH_VERTEX_FACE
                ? cloth_toi_vertex_face(p, q, a->gap, CLOTH_IMPACT_SHARE, &toi)
                : cloth_toi_edge_edge(p, q, a->gap, CLOTH_IMPACT_SHARE, &toi);
  if (!hit) return;

  cloth_real share = a->stop || !(toi > (cloth_real)0.05) ? 0 : toi * (cloth_real)0.8;
  uint32_t allowed = (uint32_t)(share * (cloth_real)CLOTH_WHOLE);
  int owner = -1;
  for (int k = 0; k < 4; k++) {
    int v = g.vertex[k];
    if (v >= s->cloth_vertices) continue;
    if (owner < 0) owner = v;
    cloth_atomic_min(a->allowed + v, allowed);
  }
  cloth_atomic_add(a->any, 1);
  if (owner >= a->first && owner < a->last) cloth_atomic_add(a->count, 1);
}
