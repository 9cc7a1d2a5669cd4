// Where held vertex number i is, and the residual of its row: what the force of a hold is made of.
// Gathered, so that the host reads no more than it needs.
#pragma once

#include "real.h"

typedef struct cloth_hold_measure_args {
  const int *vertex;   // [n]
  const cloth_real *x; // [vertices x 3] m
  const cloth_real *r; // [vertices x 3] N, of the owned rows
  cloth_real *out;     // [n x 6] m, N; written
} cloth_hold_measure_args;

CLOTH_FN void cloth_hold_measure(int i, const cloth_hold_measure_args *a)
{
  int v = a->vertex[i];
  cloth_v3_store(a->out, 2 * i, cloth_v3_load(a->x, v));
  cloth_v3_store(a->out, 2 * i + 1, cloth_v3_load(a->r, v));
}
