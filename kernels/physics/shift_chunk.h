// The farthest that a vertex of a chunk is from where the solve had put it.
#pragma once

#include "chunk.h"

typedef struct cloth_shift_chunk_args {
  int count;                  // vertices
  const cloth_real *x_solved; // [vertices x 3] m
  const cloth_real *x;        // [vertices x 3] m
  cloth_real *largest;        // [chunks] m, written; NaN if any is
} cloth_shift_chunk_args;

CLOTH_FN void cloth_shift_chunk(int i, const cloth_shift_chunk_args *a)
{
  cloth_real largest = 0;
  int begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i);
  for (int v = begin; v < end; v++)
    largest = cloth_larger(largest, cloth_v3_length(cloth_v3_sub(cloth_v3_load(a->x, v),
                                                                 cloth_v3_load(a->x_solved, v))));
  a->largest[i] = largest;
}
