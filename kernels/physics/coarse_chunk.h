// The rows of chunk i summed into the coarse matrix P' A P: three rows, three columns per
// aggregate. Held rows and columns are left out.
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_chunk_args {
  cloth_block_rows rows; // of this part
  int first, count;      // owned vertices
  int cloth_vertices, chunks, aggregates;
  const cloth_real *free;            // [cloth vertices]
  const uint32_t *contact_first;     // [rows + 1]; NULL: no contacts
  const uint32_t *contact_entry;     // [entries] 4 contact + corner
  const int *contact_vertex;         // [contacts x 4]
  const cloth_real *contact_weight;  // [contacts x 4]
  const cloth_real *contact_tangent; // [contacts x 6] N/m
  cloth_real *slice;                 // [chunks x 3 x 3 aggregates] N/m, written
} cloth_coarse_chunk_args;

CLOTH_FN void cloth_coarse_contacts(const cloth_coarse_chunk_args *a, int row, cloth_real *slice)
{
  int width = 3 * a->aggregates;
  for (uint32_t n = a->contact_first[row]; n < a->contact_first[row + 1]; n++) {
    int e = (int)a->contact_entry[n], c = e / 4;
    cloth_sym3 t = cloth_sym3_load(a->contact_tangent, c);
    for (int k = 0; k < 4; k++) {
      int v = a->contact_vertex[4 * c + k];
      if (v >= a->cloth_vertices || !(a->free[v] > 0)) continue;
      cloth_real w = a->contact_weight[e] * a->contact_weight[4 * c + k];
      cloth_real *at = slice + 3 * cloth_aggregate_of(v, a->chunks, a->aggregates);
      at[0] += w * t.xx, at[1] += w * t.xy, at[2] += w * t.zx;
      at += width, at[0] += w * t.xy, at[1] += w * t.yy, at[2] += w * t.yz;
      at += width, at[0] += w * t.zx, at[1] += w * t.yz, at[2] += w * t.zz;
    }
  }
}

CLOTH_FN void cloth_coarse_chunk(int i, const cloth_coarse_chunk_args *a)
{
  int width = 3 * a->aggregates, end = cloth_chunk_end(0, a->count, i);
  cloth_real *slice = a->slice + (int64_t)(a->first / CLOTH_CHUNK + i) * 3 * width;
  for (int k = 0; k < 3 * width; k++) slice[k] = 0;
  for (int row = i * CLOTH_CHUNK; row < end; row++) {
    if (!(a->free[a->first + row] > 0)) continue;
    int group = row / CLOTH_ROW_GROUP, lane = row % CLOTH_ROW_GROUP;
    for (int s = a->rows.first[group]; s < a->rows.first[group + 1]; s++) {
      int col = a->rows.col[(int64_t)s * CLOTH_ROW_GROUP + lane];
      if (!(a->free[col] > 0)) continue;
      const cloth_real *block = a->rows.val + (int64_t)s * 9 * CLOTH_ROW_GROUP + lane;
      cloth_real *at = slice + 3 * cloth_aggregate_of(col, a->chunks, a->aggregates);
      for (int e = 0; e < 9; e++) at[e / 3 * width + e % 3] += block[e * CLOTH_ROW_GROUP];
    }
    if (a->contact_first) cloth_coarse_contacts(a, row, slice);
  }
}
