// Largest of a chunk of numbers; NaN if any is.
#pragma once

#include "chunk.h"

typedef struct cloth_reduce_max_args {
  int count;
  const cloth_real *value; // [count]
  cloth_real *largest;     // [chunks], written
} cloth_reduce_max_args;

CLOTH_FN void cloth_reduce_max(int i, const cloth_reduce_max_args *a)
{
  int begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i);
  cloth_real largest = a->value[begin];
  for (int k = begin + 1; k < end; k++)
    if (!(a->value[k] <= largest) && largest == largest) largest = a->value[k];
  a->largest[i] = largest;
}
