// Row i of the coarse correction c = (P' A P)^-1 P' r.
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_solve_args {
  int aggregates;
  const cloth_real *inverse; // [n x n], n = 3 aggregates: coarse_inverse.h
  const cloth_real *usable;  // [1]
  const cloth_real *rest;    // [n] N
  const cloth_real *done;    // [1] above 0: nothing is left to do; NULL: always
  cloth_real *coarse;        // [n] m, written
} cloth_coarse_solve_args;

/// What lane l of a row adds up: columns l, l + LANES, ...
CLOTH_FN cloth_real cloth_coarse_lane(const cloth_coarse_solve_args *a, int i, int lane)
{
  int n = 3 * a->aggregates;
  const cloth_real *row = a->inverse + (int64_t)i * n;
  cloth_real sum = 0;
  for (int k = lane; k < n; k += CLOTH_COARSE_LANES) sum += row[k] * a->rest[k];
  return sum;
}

CLOTH_FN void cloth_coarse_solve(int i, const cloth_coarse_solve_args *a)
{
  if (a->done && *a->done > 0) return;
  int n = 3 * a->aggregates;
  const cloth_real *row = a->inverse + (int64_t)i * n;
  cloth_real lane[CLOTH_COARSE_LANES];
  for (int l = 0; l < CLOTH_COARSE_LANES; l++) lane[l] = 0;
  int whole = n - n % CLOTH_COARSE_LANES;
  for (int k = 0; k < whole; k += CLOTH_COARSE_LANES)
    for (int l = 0; l < CLOTH_COARSE_LANES; l++) lane[l] += row[k + l] * a->rest[k + l];
  for (int l = 0; l < n - whole; l++) lane[l] += row[whole + l] * a->rest[whole + l];
  cloth_real sum = cloth_lanes_sum(lane, CLOTH_COARSE_LANES);
  a->coarse[i] = *a->usable > 0 ? sum : 0;
}
