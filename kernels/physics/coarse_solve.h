// The coarse correction: c = (P' A P)^-1 P' r by two triangular solves. One element.
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_solve_args {
  int chunks, aggregates;
  const cloth_real *partial;       // [chunks x CLOTH_PCG_PARTIALS] sums of r over chunks
  const cloth_real *lower, *upper; // [n x n] coarse_factor.h
  const cloth_real *usable;        // [1]
  cloth_real *rest;                // [n] work
  cloth_real *coarse;              // [n] m, written
  cloth_real *scalar;              // [CLOTH_PCG_SCALARS], RZ_COARSE written
} cloth_coarse_solve_args;

CLOTH_FN void cloth_coarse_solve(int i, const cloth_coarse_solve_args *a)
{
  (void)i;
  int n = 3 * a->aggregates;
  cloth_real *y = a->rest, *c = a->coarse, rz = 0;
  a->scalar[CLOTH_PCG_RZ_COARSE] = 0;
  for (int k = 0; k < n; k++) y[k] = c[k] = 0;
  if (!(*a->usable > 0)) return;
  for (int k = 0; k < a->chunks; k++) {
    int to = 3 * cloth_aggregate_of(k * CLOTH_CHUNK, a->chunks, a->aggregates);
    for (int d = 0; d < 3; d++) y[to + d] += a->partial[CLOTH_PCG_PARTIALS * k + 2 + d];
  }
  for (int j = 0; j < n; j++) {
    const cloth_real *col = a->lower + (int64_t)j * n;
    cloth_real f = y[j] * col[j];
    y[j] = f;
    for (int r = j + 1; r < n; r++) y[r] -= f * col[r];
  }
  for (int j = n - 1; j >= 0; j--) {
    const cloth_real *col = a->upper + (int64_t)j * n;
    cloth_real f = y[j] * col[j];
    c[j] = f;
    for (int r = 0; r < j; r++) y[r] -= f * col[r];
  }
  // r'z of this level, from the sums again: y was overwritten
  for (int k = 0; k < a->chunks; k++) {
    int at = 3 * cloth_aggregate_of(k * CLOTH_CHUNK, a->chunks, a->aggregates);
    for (int d = 0; d < 3; d++) rz += a->partial[CLOTH_PCG_PARTIALS * k + 2 + d] * c[at + d];
  }
  a->scalar[CLOTH_PCG_RZ_COARSE] = rz;
}
