// How far cloth that nothing holds moves as a whole by what is left of all forces after a solve.
// Element k is a direction.
#pragma once

#include "pcg.h"

typedef struct cloth_balance_mean_args {
  int chunks;                // of all parts
  cloth_real give;           // m/N: step^2 over the mass of all cloth
  const cloth_real *partial; // [chunks x CLOTH_PCG_PARTIALS] balance_chunk.h
  cloth_real *mean;          // [3] m, written
} cloth_balance_mean_args;

CLOTH_FN void cloth_balance_mean(int k, const cloth_balance_mean_args *a)
{
  a->mean[k] = a->give * cloth_partial_sum(a->partial, a->chunks, 0, 2 + k);
}
