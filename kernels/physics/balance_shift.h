// Vertex i goes along with the cloth as a whole.
#pragma once

#include "real.h"

typedef struct cloth_balance_shift_args {
  const cloth_real *mean; // [3] m
  cloth_real *x;          // [vertices x 3] m
} cloth_balance_shift_args;

CLOTH_FN void cloth_balance_shift(int i, const cloth_balance_shift_args *a)
{
  cloth_v3_store(a->x, i, cloth_v3_add(cloth_v3_load(a->x, i), cloth_v3_load(a->mean, 0)));
}
