// How far held vertex number i is taken from where it would coast to [m].
#pragma once

#include "real.h"

typedef struct cloth_hold_jump_args {
  const int *vertex;      // [n]
  const cloth_real *x_t0; // [vertices x 3] m
  const cloth_real *v;    // [vertices x 3] m/s
  cloth_real h;           // s
  cloth_real *aim;        // [n x 3] m, where the hold wants it; becomes the jump
} cloth_hold_jump_args;

CLOTH_FN void cloth_hold_jump(int i, const cloth_hold_jump_args *a)
{
  int v = a->vertex[i];
  cloth_v3 coast = cloth_v3_scale(a->h, cloth_v3_load(a->v, v));
  cloth_v3 path = cloth_v3_sub(cloth_v3_load(a->aim, i), cloth_v3_load(a->x_t0, v));
  cloth_v3_store(a->aim, i, cloth_v3_sub(path, coast));
}
