// Cholesky factor of the coarse matrix, once a substep. One element: the matrix is small (up to 384
// rows).
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_factor_args {
  int chunks, aggregates;
  const cloth_real *slice; // [chunks x 3 x 3 aggregates] N/m
  cloth_real *lower;  // [n x n] column by column, n = 3 aggregates, written; its diagonal inverted
  cloth_real *upper;  // [n x n] the transpose, column by column, written
  cloth_real *usable; // [1] 1: the factor exists, written
} cloth_coarse_factor_args;

CLOTH_FN void cloth_coarse_sum(const cloth_coarse_factor_args *a)
{
  int n = 3 * a->aggregates;
  for (int k = 0; k < n * n; k++) a->lower[k] = 0;
  for (int c = 0; c < a->chunks; c++) { // the matrix is symmetric: a row of it is a column
    cloth_real *column =
        a->lower + (int64_t)3 * cloth_aggregate_of(c * CLOTH_CHUNK, a->chunks, a->aggregates) * n;
    const cloth_real *slice = a->slice + (int64_t)c * 3 * n;
    for (int k = 0; k < 3 * n; k++) column[k] += slice[k];
  }
}

CLOTH_FN void cloth_coarse_factor(int i, const cloth_coarse_factor_args *a)
{
  (void)i;
  int n = 3 * a->aggregates;
  cloth_coarse_sum(a);
  *a->usable = 0;
  for (int j = 0; j < n; j++) {
    cloth_real *col = a->lower + (int64_t)j * n, pivot = col[j];
    if (!(pivot > 0)) { // an aggregate that is held altogether has empty rows: leave it out
      for (int r = 0; r < n; r++)
        if (col[r] != 0) return; // lost to rounding: no coarse level in this substep
      continue;
    }
    cloth_real s = 1 / cloth_sqrt(pivot);
    for (int r = j + 1; r < n; r++) col[r] *= s;
    col[j] = s;
    for (int k = j + 1; k < n; k++) {
      cloth_real *to = a->lower + (int64_t)k * n, f = col[k];
      if (f == 0) continue;
      for (int r = k; r < n; r++) to[r] -= f * col[r];
    }
  }
  for (int j = 0; j < n; j++)
    for (int r = 0; r < n; r++)
      a->upper[(int64_t)r * n + j] = r >= j ? a->lower[(int64_t)j * n + r] : 0;
  *a->usable = 1;
}
