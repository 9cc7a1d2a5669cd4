// Quadratic bending over one inner edge: E = k/2 |L|^2 with L = sum_a c_a x_a, c constant.
//
// While the cloth does not stretch, |L| is the bending of the edge: c_a is d theta / d (height of
// corner a) at rest, so that k is the same as in bend.h and both agree for small angles. The matrix
// k c_a c_b I is constant, there is no angle that could jump, and the cost is that of four springs.
// Only for cloth that is flat at rest. Damping is viscous: k damping (L - L_t0); unlike that of
// bend.h it also brakes the turning of a bent edge as a whole.
//
// Source: M. Bergou, M. Wardetzky, D. Harmon, D. Zorin, E. Grinspun, A Quadratic Bending Model for
// Inextensible Surfaces, 2006, equations (4) and (5) with their cotangents as heights.
#pragma once

#include "bend.h"

typedef struct cloth_bend_quadratic_args {
  const int *hinge;            // [n x 4]            v0 v1 the shared edge, v2 v3, local ids
  const cloth_real *stiffness; // [n]            N m  per rad, as in bend.h
  const cloth_real *weight;    // [n x 4]        1/m  c, adds up to zero
  const cloth_real *damping;   // [n]            1    damping time over step length
  const cloth_real *x;         // [vertices x 3] m    positions
  const cloth_real *x_t0;      // [vertices x 3] m    positions at the start of the step
  const cloth_real *free;      // [vertices]    1    0: held rigidly; NULL: none is
  cloth_real *force;           // [n x 12]       N    on v0 v1 v2 v3                          (out)
  cloth_real *factor;          // [n]            N m  tangent block K_ab = factor c_a c_b I   (out)
} cloth_bend_quadratic_args;

CLOTH_FN cloth_v3 cloth_bend_quadratic_sum(const cloth_real *x, const int *v, const cloth_real *c)
{
  // differences to v0: the weights add up to zero, and positions may be large
  cloth_v3 x0 = cloth_v3_load(x, v[0]), sum = cloth_v3_make(0, 0, 0);
  for (int k = 1; k < 4; k++)
    sum = cloth_v3_add_scaled(sum, c[k], cloth_v3_sub(cloth_v3_load(x, v[k]), x0));
  return sum;
}

CLOTH_FN void cloth_bend_quadratic(int i, const cloth_bend_quadratic_args *a)
{
  const int *v = a->hinge + 4 * i;
  const cloth_real *c = a->weight + 4 * i;
  cloth_real k = cloth_bend_clamp(a->free, v) * a->stiffness[i], d = a->damping[i];
  cloth_v3 l = cloth_bend_quadratic_sum(a->x, v, c);
  cloth_v3 change = cloth_v3_sub(l, cloth_bend_quadratic_sum(a->x_t0, v, c));
  cloth_v3 moment = cloth_v3_add_scaled(l, d, change);
  for (int n = 0; n < 4; n++)
    cloth_v3_store(a->force, 4 * i + n, cloth_v3_scale(-k * c[n], moment));
  a->factor[i] = k * (1 + d);
}
