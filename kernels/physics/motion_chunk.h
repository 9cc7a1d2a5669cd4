// How a chunk of vertices moves in the step: the range of their displacements, with and without
// gravity.
#pragma once

#include "box.h"
#include "chunk.h"

typedef struct cloth_motion_chunk_args {
  int count;                // vertices
  const cloth_real *x_t0;   // [count x 3] m
  const cloth_real *x;      // [count x 3] m, coasting
  const cloth_real *x_pred; // [count x 3] m, falling
  cloth_real *motion;       // [chunks x 6] m, written
} cloth_motion_chunk_args;

CLOTH_FN void cloth_motion_chunk(int i, const cloth_motion_chunk_args *a)
{
  cloth_box range;
  int begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i);
  for (int v = begin; v < end; v++) {
    cloth_v3 d = cloth_v3_sub(cloth_v3_load(a->x, v), cloth_v3_load(a->x_t0, v));
    cloth_v3 fall = cloth_v3_sub(cloth_v3_load(a->x_pred, v), cloth_v3_load(a->x_t0, v));
    range.lo = v > begin ? cloth_v3_min(range.lo, d) : d;
    range.hi = v > begin ? cloth_v3_max(range.hi, d) : d;
    range.lo = cloth_v3_min(range.lo, fall), range.hi = cloth_v3_max(range.hi, fall);
  }
  cloth_box_store(a->motion, i, range);
}
