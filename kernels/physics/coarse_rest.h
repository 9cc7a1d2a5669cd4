// P' r: the sums of r over the chunks of aggregate i, lanes as in coarse_solve.h.
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_rest_args {
  int chunks, aggregates;
  const cloth_real *partial; // [chunks x CLOTH_PCG_PARTIALS] sums of r over chunks
  const cloth_real *done;    // [1] above 0: nothing is left to do; NULL: always
  cloth_real *rest;          // [3 aggregates] N, written
} cloth_coarse_rest_args;

/// What lane l adds up of component k: chunks l, l + LANES, ... of the aggregate.
CLOTH_FN cloth_real cloth_coarse_rest_lane(const cloth_coarse_rest_args *a, int i, int k, int lane)
{
  int begin = cloth_aggregate_begin(i, a->chunks, a->aggregates);
  int end = cloth_aggregate_begin(i + 1, a->chunks, a->aggregates);
  cloth_real sum = 0;
  for (int c = begin + lane; c < end; c += CLOTH_COARSE_LANES)
    sum += a->partial[CLOTH_PCG_PARTIALS * c + 2 + k];
  return sum;
}

CLOTH_FN void cloth_coarse_rest(int i, const cloth_coarse_rest_args *a)
{
  if (a->done && *a->done > 0) return;
  int used = cloth_aggregate_begin(i + 1, a->chunks, a->aggregates) -
             cloth_aggregate_begin(i, a->chunks, a->aggregates);
  if (used > CLOTH_COARSE_LANES) used = CLOTH_COARSE_LANES;
  for (int k = 0; k < 3; k++) {
    cloth_real lane[CLOTH_COARSE_LANES];
    for (int l = 0; l < used; l++) lane[l] = cloth_coarse_rest_lane(a, i, k, l);
    a->rest[3 * i + k] = cloth_lanes_sum_of(lane, used, CLOTH_COARSE_LANES);
  }
}
