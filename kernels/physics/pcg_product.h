// q = A x of chunk i: mesh blocks, then contacts; and the partial x'q.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_product_args {
  cloth_block_rows rows;         // of this part
  int first, count;              // owned vertices
  const uint32_t *contact_first; // [2 rows + 1] contact_row.h; NULL: no contacts
  const cloth_real *contact_q;   // [entries x 3] by row: contact_product.h
  const cloth_real *x;           // [vertices x 3]
  cloth_real *q;                 // [vertices x 3], written
  cloth_real *partial;           // [chunks x CLOTH_PCG_PARTIALS], field 0 written
  const cloth_real *done;        // [1] above 0: nothing is left to do; NULL: always multiply
} cloth_pcg_product_args;

/// Row `row` of q is stored. Returns its share of x'q.
CLOTH_FN cloth_real cloth_pcg_product_set(int row, const cloth_pcg_product_args *a, cloth_v3 q)
{
  cloth_v3_store(a->q, a->first + row, q);
  return cloth_v3_dot(cloth_v3_load(a->x, a->first + row), q);
}

/// Row `row` of q from its mesh part: contacts are added, q is stored. Returns its share of x'q.
CLOTH_FN cloth_real cloth_pcg_product_row(int row, const cloth_pcg_product_args *a, cloth_v3 q)
{
  uint32_t begin = a->contact_first ? a->contact_first[2 * row + 1] : 0;
  uint32_t end = a->contact_first ? a->contact_first[2 * row + 2] : 0;
  CLOTH_UNROLL_MORE
  for (uint32_t n = begin; n < end; n++) q = cloth_v3_add(q, cloth_v3_load(a->contact_q, (int)n));
  return cloth_pcg_product_set(row, a, q);
}

CLOTH_FN void cloth_pcg_product(int i, const cloth_pcg_product_args *a)
{
  if (a->done && *a->done > 0) return;
  cloth_real y[CLOTH_ROW_GROUP * 3], sum[CLOTH_CHUNK];
  int begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i);
  for (int row = begin; row < begin + CLOTH_CHUNK; row += CLOTH_ROW_GROUP) {
    if (row < end) cloth_block_product(&a->rows, row / CLOTH_ROW_GROUP, a->x, y);
    for (int l = 0; l < CLOTH_ROW_GROUP; l++)
      sum[row - begin + l] =
          row + l < end ? cloth_pcg_product_row(row + l, a, cloth_v3_load(y, l)) : 0;
  }
  a->partial[CLOTH_PCG_PARTIALS * (a->first / CLOTH_CHUNK + i)] = cloth_chunk_sum(sum);
}
