// q = A x of chunk i: mesh blocks, then contacts; and the partial x'q.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_product_args {
  cloth_block_rows rows;            // of this part
  int first, count;                 // owned vertices
  const uint32_t *contact_first;    // [rows + 1]; NULL: no contacts
  const uint32_t *contact_entry;    // [entries] 4 contact + corner
  const cloth_real *contact_weight; // [contacts x 4]
  const cloth_real *contact_q;      // [contacts x 3] contact_product.h
  const cloth_real *x;              // [vertices x 3]
  cloth_real *q;                    // [vertices x 3], written
  cloth_real *partial;              // [chunks x CLOTH_PCG_PARTIALS], field 0 written
} cloth_pcg_product_args;

CLOTH_FN void cloth_pcg_product(int i, const cloth_pcg_product_args *a)
{
  cloth_real y[CLOTH_ROW_GROUP * 3], sum = 0;
  int begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i);
  for (int row = begin; row < end; row += CLOTH_ROW_GROUP) {
    cloth_block_product(&a->rows, row / CLOTH_ROW_GROUP, a->x, y);
    for (int l = 0; l < CLOTH_ROW_GROUP && row + l < end; l++) {
      cloth_v3 q = cloth_v3_load(y, l);
      if (a->contact_first)
        for (uint32_t n = a->contact_first[row + l]; n < a->contact_first[row + l + 1]; n++) {
          uint32_t e = a->contact_entry[n];
          q = cloth_v3_add_scaled(q, a->contact_weight[e],
                                  cloth_v3_load(a->contact_q, (int)(e / 4)));
        }
      cloth_v3_store(a->q, a->first + row + l, q);
      sum += cloth_v3_dot(cloth_v3_load(a->x, a->first + row + l), q);
    }
  }
  a->partial[CLOTH_PCG_PARTIALS * (a->first / CLOTH_CHUNK + i)] = sum;
}
