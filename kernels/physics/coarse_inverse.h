// Row i of the inverse of the coarse matrix, once a substep, by two triangular solves. An iteration
// then needs a product with a small dense matrix, which has no chain of dependent steps.
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_inverse_args {
  int aggregates;
  const cloth_real *factor; // [n x n] coarse_factor.h, n = 3 aggregates
  const cloth_real *usable; // [1]
  cloth_real *inverse;      // [n x n], written
} cloth_coarse_inverse_args;

CLOTH_FN void cloth_coarse_inverse(int i, const cloth_coarse_inverse_args *a)
{
  int n = 3 * a->aggregates;
  cloth_real *y = a->inverse + (int64_t)i * n;
  if (!(*a->usable > 0)) return;
  for (int k = 0; k < n; k++) y[k] = k == i ? 1 : 0;
  for (int j = i; j < n; j++) { // L y = e
    const cloth_real *col = a->factor + (int64_t)j * n;
    cloth_real f = y[j] * col[j];
    y[j] = f;
    for (int r = j + 1; r < n; r++) y[r] -= f * col[r];
  }
  for (int j = n - 1; j >= 0; j--) { // L' x = y
    const cloth_real *col = a->factor + (int64_t)j * n;
    cloth_real f = y[j] * col[j];
    y[j] = f;
    for (int r = 0; r < j; r++) y[r] -= f * col[r];
  }
}
