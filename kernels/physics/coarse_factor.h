// Cholesky factor of the coarse matrix, in place, once a substep. One element: the matrix is small
// (up to 288 rows).
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_factor_args {
  int aggregates;
  cloth_real *factor; // [n x n] column by column, n = 3 aggregates; the matrix, then its lower
                      // factor with the diagonal inverted, and above the diagonal its transpose
  cloth_real *usable; // [1] 1: the factor exists, written
} cloth_coarse_factor_args;

CLOTH_FN void cloth_coarse_factor(int i, const cloth_coarse_factor_args *a)
{
  (void)i;
  int n = 3 * a->aggregates;
  *a->usable = 0;
  for (int j = 0; j < n; j++) {
    cloth_real *col = a->factor + (int64_t)j * n, pivot = col[j];
    if (!(pivot > 0)) { // an aggregate that is held altogether has empty rows: leave it out
      for (int r = j; r < n; r++)
        if (!(col[r] == 0)) return; // lost to rounding: no coarse level in this substep
      for (int k = j + 1; k < n; k++) a->factor[(int64_t)k * n + j] = 0;
      continue;
    }
    cloth_real s = 1 / cloth_sqrt(pivot);
    for (int r = j + 1; r < n; r++) col[r] *= s;
    col[j] = s;
    for (int k = j + 1; k < n; k++) {
      cloth_real *to = a->factor + (int64_t)k * n, f = col[k];
      to[j] = f;
      if (f == 0) continue;
      for (int r = k; r < n; r++) to[r] -= f * col[r];
    }
  }
  *a->usable = 1;
}
