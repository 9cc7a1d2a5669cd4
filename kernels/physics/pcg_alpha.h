// The length of the step along p. One element.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_alpha_args {
  int chunks;                // of all parts
  const cloth_real *partial; // [chunks x CLOTH_PCG_PARTIALS] field 0: p'q
  cloth_real *scalar;        // [CLOTH_PCG_SCALARS]
} cloth_pcg_alpha_args;

/// The scalars from p'q.
CLOTH_FN void cloth_pcg_alpha_set(cloth_real *s, cloth_real pq)
{
  s[CLOTH_PCG_ALPHA] = 0;
  if (pq > 0) {
    s[CLOTH_PCG_ALPHA] = s[CLOTH_PCG_RZ] / pq;
    s[CLOTH_PCG_ITERATIONS] += 1;
  } else {
    s[CLOTH_PCG_DONE] = 1; // p is zero, or the matrix is not positive definite along it
  }
}

CLOTH_FN void cloth_pcg_alpha(int i, const cloth_pcg_alpha_args *a)
{
  (void)i;
  if (a->scalar[CLOTH_PCG_DONE] > 0) return;
  cloth_pcg_alpha_set(a->scalar, cloth_partial_sum(a->partial, a->chunks, 0, 0));
}
