// Range of the deformation gradient of the list's triangle i over start, first guess (or solution)
// and free flight of the substep.
#pragma once

#include "flat_patch.h"

typedef struct cloth_flat_triangle_args {
  const int *which;         // [n] triangles; NULL: all
  const int *triangle;      // [triangles x 3]
  const cloth_real *rest;   // [n x 4] 1/m, inverse of the edges 1-0, 2-0 at rest
  const cloth_real *x_t0;   // [vertices x 3] m
  const cloth_real *x;      // [vertices x 3] m
  const cloth_real *x_pred; // [vertices x 3] m
  cloth_real *range;        // [n x CLOTH_FLAT_RANGE], written
} cloth_flat_triangle_args;

CLOTH_FN void cloth_flat_gradient(const cloth_real *x, const int *v, const cloth_real *rest,
                                  cloth_real *f)
{
  cloth_v3 o = cloth_v3_load(x, v[0]);
  cloth_v3 e1 = cloth_v3_sub(cloth_v3_load(x, v[1]), o);
  cloth_v3 e2 = cloth_v3_sub(cloth_v3_load(x, v[2]), o);
  cloth_v3_store(f, 0, cloth_v3_add_scaled(cloth_v3_scale(rest[0], e1), rest[2], e2));
  cloth_v3_store(f, 1, cloth_v3_add_scaled(cloth_v3_scale(rest[1], e1), rest[3], e2));
}

CLOTH_FN void cloth_flat_triangle(int i, const cloth_flat_triangle_args *a)
{
  const int *v = a->triangle + 3 * (a->which ? a->which[i] : i);
  cloth_real f[18], rest[4], range[CLOTH_FLAT_RANGE];
  cloth_load4(a->rest + 4 * i, rest);
  cloth_flat_gradient(a->x_t0, v, rest, f);
  cloth_flat_gradient(a->x, v, rest, f + 6);
  cloth_flat_gradient(a->x_pred, v, rest, f + 12);
  for (int k = 0; k < 6; k++) {
    cloth_real lo = f[6 + k] < f[k] ? f[6 + k] : f[k], hi = f[6 + k] > f[k] ? f[6 + k] : f[k];
    range[k] = f[12 + k] < lo ? f[12 + k] : lo;
    range[6 + k] = f[12 + k] > hi ? f[12 + k] : hi;
  }
  cloth_flat_range_store(a->range + CLOTH_FLAT_RANGE * i, range);
}
