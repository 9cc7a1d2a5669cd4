// Does anybody read anything of the group (pcg.h) that chunk i of a part is in? A group that is not
// whole counts as read: in the order of halo_order.h it comes last, so that every other one begins
// where a block of a GPU does.
#pragma once

#include "real.h"

typedef struct cloth_halo_group_args {
  int chunks, group;            // of the part, of a group
  const uint32_t *chunk_reader; // [chunks] halo_chunk.h
  uint32_t *place;              // [chunks + 1] 1: somebody, written; scanned afterwards
} cloth_halo_group_args;

CLOTH_FN void cloth_halo_group(int i, const cloth_halo_group_args *a)
{
  int begin = i / a->group * a->group, end = begin + a->group;
  uint32_t outer = end > a->chunks;
  for (int c = begin; c < end && !outer; c++) outer = a->chunk_reader[c] != 0;
  a->place[i] = outer;
}
