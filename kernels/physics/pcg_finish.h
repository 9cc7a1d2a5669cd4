// What the host asks after a solve, side by side: one read instead of three. One element.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_finish_args {
  int chunks;                // of all parts
  const cloth_real *partial; // [chunks x CLOTH_PCG_PARTIALS] fields of pcg_residual.h
  const cloth_real *largest; // [chunks] m, correct.h
  cloth_real *scalar;        // [CLOTH_PCG_SCALARS], RESIDUAL, RESIDUAL_LENGTH and LARGEST written
} cloth_pcg_finish_args;

CLOTH_FN void cloth_pcg_finish(int i, const cloth_pcg_finish_args *a)
{
  (void)i;
  cloth_real largest = 0, length_sq = 0;
  for (int c = 0; c < a->chunks; c++) {
    largest = cloth_larger(largest, a->largest[c]);
    length_sq = cloth_larger(length_sq, a->partial[CLOTH_PCG_PARTIALS * c + 1]);
  }
  a->scalar[CLOTH_PCG_LARGEST] = largest;
  a->scalar[CLOTH_PCG_RESIDUAL_LENGTH] = cloth_sqrt(length_sq);
  a->scalar[CLOTH_PCG_RESIDUAL] = cloth_partial_sum(a->partial, a->chunks, 0, 0);
}
