// Who reads anything of chunk i of a part.
#pragma once

#include "chunk.h"

typedef struct cloth_halo_chunk_args {
  int count;              // rows of the part
  const uint32_t *reader; // [rows] bit j: part j reads it
  uint32_t *chunk_reader; // [chunks], written
} cloth_halo_chunk_args;

CLOTH_FN void cloth_halo_chunk(int i, const cloth_halo_chunk_args *a)
{
  uint32_t readers = 0;
  for (int row = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i); row < end; row++)
    readers |= a->reader[row];
  a->chunk_reader[i] = readers;
}
