// The coarse matrix P' A P: the slices of an aggregate's chunks, added in order. Element i is
// aggregate first + i: three columns (the matrix is symmetric: a row of it is a column).
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_sum_args {
  int chunks, aggregates;
  int first;               // aggregate of element 0
  const cloth_real *slice; // [chunks x 3 x 3 aggregates] N/m
  cloth_real *matrix;      // [n x n] N/m, n = 3 aggregates, written
} cloth_coarse_sum_args;

/// Numbers [first, last) of the 3 n of element i's columns.
CLOTH_FN void cloth_coarse_sum_range(int i, const cloth_coarse_sum_args *a, int first, int last)
{
  int size = 9 * a->aggregates;
  i += a->first;
  cloth_real *column = a->matrix + (int64_t)i * size;
  int begin = cloth_aggregate_begin(i, a->chunks, a->aggregates);
  int end = cloth_aggregate_begin(i + 1, a->chunks, a->aggregates);
  for (int k = first; k < last; k++) column[k] = 0;
  for (int c = begin; c < end; c++)
    for (int k = first; k < last; k++) column[k] += a->slice[(int64_t)c * size + k];
}

CLOTH_FN void cloth_coarse_sum(int i, const cloth_coarse_sum_args *a)
{
  cloth_coarse_sum_range(i, a, 0, 9 * a->aggregates);
}
