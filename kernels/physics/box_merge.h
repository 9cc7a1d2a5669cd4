// The box around a chunk of boxes.
#pragma once

#include "box.h"
#include "chunk.h"

typedef struct cloth_box_merge_args {
  int count;             // boxes
  const cloth_real *box; // [count x 6] m
  cloth_real *out;       // [chunks of them x 6] m, written
} cloth_box_merge_args;

CLOTH_FN void cloth_box_merge(int i, const cloth_box_merge_args *a)
{
  int k = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i);
  cloth_box b = cloth_box_load(a->box, k);
  for (k++; k < end; k++) b = cloth_box_union(b, cloth_box_load(a->box, k));
  cloth_box_store(a->out, i, b);
}
