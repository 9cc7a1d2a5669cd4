// Held vertex number i goes to its target; a rigid hold is exact, a compliant one is a spring.
#pragma once

#include "real.h"

typedef struct cloth_hold_args {
  const int *vertex;      // [n]
  const cloth_real *aim;  // [n x 3] m, where the hold wants vertex[i] at the end of the substep
  const cloth_real *free; // [vertices] 0: held rigidly, 1: not
  cloth_real *target;     // [vertices x 3] m, written
  cloth_real *x;          // [vertices x 3] m, written for rigid holds
} cloth_hold_args;

CLOTH_FN void cloth_hold(int i, const cloth_hold_args *a)
{
  int v = a->vertex[i];
  cloth_v3 aim = cloth_v3_load(a->aim, i);
  cloth_v3_store(a->target, v, aim);
  if (!(a->free[v] > 0)) cloth_v3_store(a->x, v, aim);
}
