// Vertex i at the start of a substep of BDF2 with variable steps (Hairer, Norsett, Wanner 1993,
// III.5): with w = h / h_last, a = (1 + w)^2 / (1 + 2 w), b = w^2 / (1 + 2 w), gamma = h (1 + w) /
// (1 + 2 w),
//   x_1 = (a x_0 - b x_last) + gamma v_1,   v_1 = (a v_0 - b v_last) + gamma M^-1 f(x_1, v_1),
// which is backward Euler of the step gamma from (a x_0 - b x_last, a v_0 - b v_last).
#pragma once

#include "real.h"

typedef struct cloth_bdf2_start_args {
  const cloth_real *x, *v;           // [n x 3] m, m/s, now
  const cloth_real *x_last, *v_last; // [n x 3] at the start of the substep before
  cloth_real b, w;                   // see above
  cloth_real *x_from, *v_from;       // [n x 3] written
  cloth_real *v_ahead; // [n x 3] m/s, written: v + w (v - v_last), for the error estimate
} cloth_bdf2_start_args;

CLOTH_FN void cloth_bdf2_start(int i, const cloth_bdf2_start_args *a)
{
  cloth_v3 x = cloth_v3_load(a->x, i), v = cloth_v3_load(a->v, i),
           v_last = cloth_v3_load(a->v_last, i);
  // x + b (x - x_last), as a - b = 1: in float the sum of two large numbers would lose digits
  cloth_v3 way = cloth_v3_sub(x, cloth_v3_load(a->x_last, i)), change = cloth_v3_sub(v, v_last);
  cloth_v3_store(a->x_from, i, cloth_v3_add_scaled(x, a->b, way));
  cloth_v3_store(a->v_from, i, cloth_v3_add_scaled(v, a->b, change));
  cloth_v3_store(a->v_ahead, i, cloth_v3_add_scaled(v, a->w, change));
}
