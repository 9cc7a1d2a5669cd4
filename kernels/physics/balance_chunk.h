// What is left of the forces on a chunk after a solve: the sum of its residual.
#pragma once

#include "pcg.h"

typedef struct cloth_balance_chunk_args {
  int first, count;    // owned vertices
  const cloth_real *r; // [vertices x 3] N, b - A dx
  cloth_real *partial; // [chunks x CLOTH_PCG_PARTIALS] fields 2 to 4 written
} cloth_balance_chunk_args;

CLOTH_FN void cloth_balance_chunk(int i, const cloth_balance_chunk_args *a)
{
  cloth_real sum[3][CLOTH_CHUNK];
  int begin = a->first + i * CLOTH_CHUNK, end = cloth_chunk_end(a->first, a->count, i);
  for (int lane = 0; lane < CLOTH_CHUNK; lane++) {
    cloth_v3 r = begin + lane < end ? cloth_v3_load(a->r, begin + lane) : cloth_v3_make(0, 0, 0);
    sum[0][lane] = r.x, sum[1][lane] = r.y, sum[2][lane] = r.z;
  }
  cloth_real *field = a->partial + CLOTH_PCG_PARTIALS * (begin / CLOTH_CHUNK) + 2;
  for (int k = 0; k < 3; k++) field[k] = cloth_chunk_sum(sum[k]);
}
