// Vertex i goes only as far as its impacts allow.
#pragma once

#include "impact.h"

typedef struct cloth_impact_hold_back_args {
  int first;              // vertex of element 0
  const cloth_real *x_t0; // [vertices x 3] m
  const cloth_real *free; // [vertices] 0: held rigidly, stays on its way
  uint32_t *allowed;      // [vertices] of CLOTH_WHOLE; reset to the whole way
  cloth_real *x;          // [vertices x 3] m
} cloth_impact_hold_back_args;

CLOTH_FN void cloth_impact_hold_back(int i, const cloth_impact_hold_back_args *a)
{
  int v = a->first + i;
  uint32_t allowed = a->allowed[v];
  a->allowed[v] = CLOTH_WHOLE;
  if (allowed >= CLOTH_WHOLE || !(a->free[v] > 0)) return;
  cloth_v3 x_t0 = cloth_v3_load(a->x_t0, v);
  cloth_real share = (cloth_real)allowed / (cloth_real)CLOTH_WHOLE;
  cloth_v3_store(a->x, v,
                 cloth_v3_add_scaled(x_t0, share, cloth_v3_sub(cloth_v3_load(a->x, v), x_t0)));
}
