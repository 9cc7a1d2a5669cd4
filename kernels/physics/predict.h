// Where vertex i goes if nothing but inertia and gravity acts: x* = x + h v + h^2 g, the point that
// backward Euler pulls towards (Baraff and Witkin 1998), and the first guess of the solve.
// (Guessing the acceleration of the last substep too would save iterations but multiplies what the
// last solve left in the soft modes, step after step, until it shows.)
#pragma once

#include "real.h"

typedef struct cloth_predict_args {
  const cloth_real *x_t0;      // [n x 3] m
  const cloth_real *v;         // [n x 3] m/s
  const cloth_real *mass_drag; // [n] 1/s, damping against the scene frame; NULL: none
  cloth_real gravity[3];       // m/s^2
  cloth_real h;                // s
  cloth_real *x_pred;          // [n x 3] m, written
  cloth_real *x;               // [n x 3] m, written
} cloth_predict_args;

CLOTH_FN void cloth_predict(int i, const cloth_predict_args *a)
{
  cloth_real keep = a->mass_drag ? 1 / (1 + a->h * a->mass_drag[i]) : 1; // implicit
  cloth_v3 g = cloth_v3_make(a->gravity[0], a->gravity[1], a->gravity[2]);
  cloth_v3 u = cloth_v3_scale(a->h * keep, cloth_v3_add_scaled(cloth_v3_load(a->v, i), a->h, g));
  cloth_v3 x = cloth_v3_add(cloth_v3_load(a->x_t0, i), u);
  cloth_v3_store(a->x_pred, i, x);
  cloth_v3_store(a->x, i, x);
}
