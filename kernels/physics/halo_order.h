// Chunk i of a part into the order of the product: those of groups that nobody else reads first.
// (The matrix is symmetric: they are those that read nothing of others.)
#pragma once

#include "real.h"

typedef struct cloth_halo_order_args {
  int chunks;            // of the part
  const uint32_t *place; // [chunks + 1] scanned: outer chunks before; the last: all
  uint32_t *order;       // [chunks], written
  uint32_t *outer;       // [1] outer chunks, written
} cloth_halo_order_args;

CLOTH_FN void cloth_halo_order(int i, const cloth_halo_order_args *a)
{
  uint32_t before = a->place[i], all = a->place[a->chunks];
  int outer = a->place[i + 1] > before;
  uint32_t at = outer ? (uint32_t)a->chunks - all + before : (uint32_t)i - before;
  a->order[at] = (uint32_t)i;
  if (i == 0) *a->outer = all;
}
