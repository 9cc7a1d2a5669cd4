// The rows of chunk i summed into the coarse matrix P' A P: three rows, three columns per
// aggregate. Held rows and columns are left out. Blocks inside the chunk's own aggregate, by far
// the most, are summed row by row and the rows pairwise; those that couple to others follow one by
// one.
#pragma once

#include "pcg.h"

typedef struct cloth_coarse_chunk_args {
  cloth_block_rows rows; // of this part
  int first, count;      // owned vertices
  int cloth_vertices, chunks, aggregates;
  const cloth_real *free;            // [cloth vertices]
  const uint32_t *contact_first;     // [2 rows + 1] contact_row.h; NULL: no contacts
  const uint32_t *contact_entry;     // [entries] 4 contact + corner
  const int *contact_vertex;         // [contacts x 4]
  const cloth_real *contact_weight;  // [contacts x 4]
  const cloth_real *contact_tangent; // [contacts x 6] N/m
  cloth_real *slice;                 // [chunks x 3 x 3 aggregates] N/m, written
} cloth_coarse_chunk_args;

// entry e of the 3x3 block that couples to vertex v
CLOTH_FN cloth_real *cloth_coarse_at(const cloth_coarse_chunk_args *a, cloth_real *slice, int v,
                                     int e)
{
  return slice + 3 * cloth_aggregate_of(v, a->chunks, a->aggregates) + e / 3 * 3 * a->aggregates +
         e % 3;
}

// couples the row to a free vertex: 1 of its own aggregate, 2 of another; 0: held, or of a body
CLOTH_FN int cloth_coarse_side(const cloth_coarse_chunk_args *a, int own, int v)
{
  if (v >= a->cloth_vertices || !(a->free[v] > 0)) return 0;
  return cloth_aggregate_of(v, a->chunks, a->aggregates) == own ? 1 : 2;
}

// entry e of a contact's tangent, weighted for the corner of the row and corner k
CLOTH_FN cloth_real cloth_coarse_contact(const cloth_coarse_chunk_args *a, int corner, int k, int e)
{
  const cloth_real *t = a->contact_tangent + 6 * (corner / 4); // xx yy zz yz zx xy
  int r = e / 3, c = e % 3, at = r == c ? r : r + c == 1 ? 5 : r + c == 2 ? 4 : 3;
  return a->contact_weight[corner] * a->contact_weight[corner / 4 * 4 + k] * t[at];
}

/// The blocks of a row inside its own aggregate, added to sum [9]; are there others?
CLOTH_FN int cloth_coarse_row(int row, const cloth_coarse_chunk_args *a, cloth_real *sum)
{
  int others = 0, group = row / CLOTH_ROW_GROUP, lane = row % CLOTH_ROW_GROUP;
  if (!(a->free[a->first + row] > 0)) return 0;
  int own = cloth_aggregate_of(a->first + row, a->chunks, a->aggregates);
  for (int s = a->rows.first[group]; s < a->rows.first[group + 1]; s++) {
    int side = cloth_coarse_side(a, own, a->rows.col[(int64_t)s * CLOTH_ROW_GROUP + lane]);
    const cloth_real *block = a->rows.val + (int64_t)s * 9 * CLOTH_ROW_GROUP + lane;
    if (side == 2) others = 1;
    if (side == 1)
      for (int e = 0; e < 9; e++) sum[e] += block[e * CLOTH_ROW_GROUP];
  }
  if (!a->contact_first) return others;
  for (uint32_t n = a->contact_first[2 * row + 1]; n < a->contact_first[2 * row + 2]; n++) {
    int corner = (int)a->contact_entry[n];
    for (int k = 0; k < 4; k++) {
      int side = cloth_coarse_side(a, own, a->contact_vertex[corner / 4 * 4 + k]);
      if (side == 2) others = 1;
      if (side == 1)
        for (int e = 0; e < 9; e++) sum[e] += cloth_coarse_contact(a, corner, k, e);
    }
  }
  return others;
}

/// The other blocks of a row, added to the slice: entries [first, last) of the nine of each block.
/// A loop takes all, a thread of a GPU one.
CLOTH_FN void cloth_coarse_foreign(int row, const cloth_coarse_chunk_args *a, int first, int last,
                                   cloth_real *slice)
{
  int group = row / CLOTH_ROW_GROUP, lane = row % CLOTH_ROW_GROUP;
  int own = cloth_aggregate_of(a->first + row, a->chunks, a->aggregates);
  for (int s = a->rows.first[group]; s < a->rows.first[group + 1]; s++) {
    int col = a->rows.col[(int64_t)s * CLOTH_ROW_GROUP + lane];
    const cloth_real *block = a->rows.val + (int64_t)s * 9 * CLOTH_ROW_GROUP + lane;
    if (cloth_coarse_side(a, own, col) == 2)
      for (int e = first; e < last; e++)
        *cloth_coarse_at(a, slice, col, e) += block[e * CLOTH_ROW_GROUP];
  }
  if (!a->contact_first) return;
  for (uint32_t n = a->contact_first[2 * row + 1]; n < a->contact_first[2 * row + 2]; n++) {
    int corner = (int)a->contact_entry[n];
    for (int k = 0; k < 4; k++) {
      int v = a->contact_vertex[corner / 4 * 4 + k];
      if (cloth_coarse_side(a, own, v) == 2)
        for (int e = first; e < last; e++)
          *cloth_coarse_at(a, slice, v, e) += cloth_coarse_contact(a, corner, k, e);
    }
  }
}

CLOTH_FN void cloth_coarse_chunk(int i, const cloth_coarse_chunk_args *a)
{
  cloth_real own[9][CLOTH_CHUNK];
  int others[CLOTH_CHUNK], size = 9 * a->aggregates;
  int begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i);
  cloth_real *slice = a->slice + (int64_t)(a->first / CLOTH_CHUNK + i) * size;
  for (int k = 0; k < size; k++) slice[k] = 0;
  for (int lane = 0; lane < CLOTH_CHUNK; lane++) {
    cloth_real sum[9] = {0};
    others[lane] = begin + lane < end && cloth_coarse_row(begin + lane, a, sum);
    for (int e = 0; e < 9; e++) own[e][lane] = sum[e];
  }
  for (int e = 0; e < 9; e++)
    *cloth_coarse_at(a, slice, a->first + begin, e) = cloth_chunk_sum(own[e]);
  for (int lane = 0; lane < CLOTH_CHUNK; lane++)
    if (others[lane]) cloth_coarse_foreign(begin + lane, a, 0, 9, slice);
}
