// How far held vertex number i is taken from where it would coast to [m]. A rigid hold takes it to
// where it aims. A compliant one may be stretched for ever, and pulls no more than before then:
// only what it moves against the vertex counts, and of that what the spring alone would make of it.
#pragma once

#include "real.h"

typedef struct cloth_hold_jump_args {
  const int *vertex;           // [n]
  const cloth_real *x_t0;      // [vertices x 3] m
  const cloth_real *v;         // [vertices x 3] m/s
  const cloth_real *mass;      // [vertices] kg
  const cloth_real *stiffness; // [vertices] N/m, compliant holds; 0: rigid; NULL: all are
  cloth_real h;                // s
  cloth_real *aim; // [n x 3] m: where a rigid hold wants it, how far a compliant one goes; becomes
                   // the jump
} cloth_hold_jump_args;

CLOTH_FN void cloth_hold_jump(int i, const cloth_hold_jump_args *a)
{
  int v = a->vertex[i];
  cloth_real k = a->stiffness ? a->stiffness[v] * a->h * a->h : 0;
  cloth_v3 coast = cloth_v3_scale(a->h, cloth_v3_load(a->v, v)), path = cloth_v3_load(a->aim, i);
  if (!(k > 0)) path = cloth_v3_sub(path, cloth_v3_load(a->x_t0, v));
  cloth_real share = k > 0 ? k / (a->mass[v] + k) : 1;
  cloth_v3_store(a->aim, i, cloth_v3_scale(share, cloth_v3_sub(path, coast)));
}
