// Where vertex i goes if nothing but inertia and gravity acts: x* = x + h v + h^2 g, the point that
// backward Euler pulls towards (Baraff and Witkin 1998). The solve starts from x + h v + s h^2 g,
// where s in [0, 1] is how much of free fall the cloth as a whole did in the last substep: free
// fall starts at its answer, and cloth that lies does not start inside the table. (From x* the
// first residual is that of a free fall: one per cent of it is more than the friction of a towel
// and shakes one that hangs. Guessing the acceleration of each vertex would save iterations but
// multiplies what the last solve left in the soft modes, step after step, until it shows.)
#pragma once

#include "real.h"

typedef struct cloth_predict_args {
  int first;                   // vertex of element 0
  const cloth_real *x_t0;      // [n x 3] m
  const cloth_real *v;         // [n x 3] m/s
  const cloth_real *mass_drag; // [n] 1/s, damping against the scene frame; NULL: none
  cloth_real gravity[3];       // m/s^2
  cloth_real acceleration[3];  // m/s^2, of the first guess
  cloth_real h;                // s
  cloth_real *x_pred;          // [n x 3] m, written
  cloth_real *x;               // [n x 3] m, where the solve starts, written
} cloth_predict_args;

CLOTH_FN void cloth_predict(int i, const cloth_predict_args *a)
{
  int k = a->first + i;
  cloth_real keep = a->mass_drag ? 1 / (1 + a->h * a->mass_drag[k]) : 1; // implicit
  cloth_v3 v = cloth_v3_load(a->v, k), x = cloth_v3_load(a->x_t0, k);
  cloth_v3 g = cloth_v3_make(a->gravity[0], a->gravity[1], a->gravity[2]);
  cloth_v3 guess = cloth_v3_make(a->acceleration[0], a->acceleration[1], a->acceleration[2]);
  cloth_v3_store(a->x_pred, k,
                 cloth_v3_add_scaled(x, a->h * keep, cloth_v3_add_scaled(v, a->h, g)));
  cloth_v3_store(a->x, k, cloth_v3_add_scaled(x, a->h * keep, cloth_v3_add_scaled(v, a->h, guess)));
}
