// x += dx, chunk by chunk, with the largest correction of the chunk.
#pragma once

#include "chunk.h"

typedef struct cloth_correct_args {
  int first, count;     // owned vertices
  const cloth_real *dx; // [vertices x 3] m
  cloth_real *x;        // [vertices x 3] m
  cloth_real *largest;  // [chunks] m, written; NaN if any is
} cloth_correct_args;

/// Vertex v; the size of its correction [m].
CLOTH_FN cloth_real cloth_correct_vertex(int v, const cloth_correct_args *a)
{
  cloth_v3 d = cloth_v3_load(a->dx, v);
  cloth_v3_store(a->x, v, cloth_v3_add(cloth_v3_load(a->x, v), d));
  return cloth_v3_length(d);
}

CLOTH_FN void cloth_correct(int i, const cloth_correct_args *a)
{
  cloth_real largest = 0;
  int begin = a->first + i * CLOTH_CHUNK, end = cloth_chunk_end(a->first, a->count, i);
  for (int v = begin; v < end; v++) largest = cloth_larger(largest, cloth_correct_vertex(v, a));
  a->largest[a->first / CLOTH_CHUNK + i] = largest;
}
