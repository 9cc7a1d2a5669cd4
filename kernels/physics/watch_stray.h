// Count vertices that are not where pairs are watched for: farther than `slack` from their straight
// way at the start or the end of the substep, or on a way of the substep, to x or in free flight,
// that is farther than slack / 2 from its share of it.
#pragma once

#include "atomic.h"
#include "real.h"

typedef struct cloth_watch_stray_args {
  int first;                 // vertex of element 0
  int cloth_vertices;        // vertices from here on belong to bodies
  const cloth_real *x0, *x1; // [vertices x 3] m, the way: x0 + share (x1 - x0)
  cloth_real begin, end;     // shares at the start and the end of the substep
  const cloth_real *x_t0;    // [vertices x 3] m
  const cloth_real *x;       // [vertices x 3] m
  const cloth_real *x_pred;  // [cloth vertices x 3] m
  cloth_real slack;          // m
  uint32_t *strayed;         // [1] counts up
} cloth_watch_stray_args;

CLOTH_FN int cloth_watch_within(cloth_v3 d, cloth_real bound)
{
  return cloth_v3_dot(d, d) <= bound * bound; // not NaN
}

CLOTH_FN void cloth_watch_stray(int i, const cloth_watch_stray_args *a)
{
  int v = a->first + i;
  cloth_v3 x0 = cloth_v3_load(a->x0, v), u = cloth_v3_sub(cloth_v3_load(a->x1, v), x0);
  cloth_v3 x_t0 = cloth_v3_load(a->x_t0, v), x = cloth_v3_load(a->x, v);
  cloth_v3 begin = cloth_v3_add_scaled(cloth_v3_sub(x_t0, x0), -a->begin, u);
  cloth_v3 end = cloth_v3_add_scaled(cloth_v3_sub(x, x0), -a->end, u);
  cloth_real half = a->slack / 2, h = a->end - a->begin;
  int stays = cloth_watch_within(begin, a->slack) && cloth_watch_within(end, a->slack) &&
              cloth_watch_within(cloth_v3_add_scaled(cloth_v3_sub(x, x_t0), -h, u), half);
  if (stays && v < a->cloth_vertices) {
    cloth_v3 flight = cloth_v3_sub(cloth_v3_load(a->x_pred, v), x_t0);
    stays = cloth_watch_within(cloth_v3_add_scaled(flight, -h, u), half);
  }
  if (!stays) cloth_atomic_next(a->strayed);
}
