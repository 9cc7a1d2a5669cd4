// Vertex i, if impacts have moved it from where the solve had put it, is held in the next one.
#pragma once

#include "real.h"

typedef struct cloth_impact_pin_args {
  const cloth_real *x_solved; // [vertices x 3] m
  const cloth_real *x;        // [vertices x 3] m
  cloth_real *free;           // [vertices] 0: held rigidly; set so where they differ
} cloth_impact_pin_args;

CLOTH_FN void cloth_impact_pin(int i, const cloth_impact_pin_args *a)
{
  cloth_v3 way = cloth_v3_sub(cloth_v3_load(a->x, i), cloth_v3_load(a->x_solved, i));
  if (!(way.x == 0 && way.y == 0 && way.z == 0)) a->free[i] = 0;
}
