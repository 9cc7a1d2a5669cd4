// The solver's small levels: runs of 8 vertices and whole chunks that move together. Element i is a
// chunk: the 3x3 sums of its rows' blocks over each run and over the chunk, inverted. Between
// single vertices and the aggregates of the coarse level these carry what is stiff over short
// distances, and they need nothing from beyond the chunk (additive multilevel: Bramble, Pasciak, Xu
// 1990).
#pragma once

#include "coarse_chunk.h"

typedef struct cloth_levels_chunk_args {
  cloth_coarse_chunk_args rows; // its slice is not used
  cloth_real *run_inverse;      // [vertices / RUN x 6] m/N, written
  cloth_real *chunk_inverse;    // [chunks x 6] m/N, written
} cloth_levels_chunk_args;

CLOTH_FN cloth_sym3 cloth_levels_inverse(const cloth_real *m) // [9]
{
  cloth_sym3 s;
  s.xx = m[0], s.xy = (m[1] + m[3]) / 2, s.zx = (m[2] + m[6]) / 2;
  s.yy = m[4], s.yz = (m[5] + m[7]) / 2, s.zz = m[8];
  if (s.xx > 0 && s.yy > 0 && s.zz > 0) return cloth_sym3_inverse(s);
  return cloth_sym3_axis(0, 0, cloth_v3_make(0, 0, 0)); // all held
}

// the blocks of a row whose columns are in the run, in the chunk: added to run [9], chunk [9]
CLOTH_FN void cloth_levels_add(int at, int v, const cloth_real *block, int stride, cloth_real scale,
                               cloth_real *run, cloth_real *chunk)
{
  if (v / CLOTH_CHUNK != at / CLOTH_CHUNK) return;
  for (int e = 0; e < 9; e++) chunk[e] += scale * block[e * stride];
  if (v / CLOTH_RUN == at / CLOTH_RUN)
    for (int e = 0; e < 9; e++) run[e] += scale * block[e * stride];
}

CLOTH_FN void cloth_levels_row(int row, const cloth_coarse_chunk_args *a, cloth_real *run,
                               cloth_real *chunk)
{
  int group = row / CLOTH_ROW_GROUP, lane = row % CLOTH_ROW_GROUP, at = a->first + row;
  if (!(a->free[at] > 0)) return;
  for (int s = a->rows.first[group]; s < a->rows.first[group + 1]; s++) {
    int v = a->rows.col[(int64_t)s * CLOTH_ROW_GROUP + lane];
    if (a->free[v] > 0)
      cloth_levels_add(at, v, a->rows.val + (int64_t)s * 9 * CLOTH_ROW_GROUP + lane,
                       CLOTH_ROW_GROUP, 1, run, chunk);
  }
  if (!a->contact_first) return;
  for (uint32_t n = a->contact_first[row]; n < a->contact_first[row + 1]; n++) {
    int corner = (int)a->contact_entry[n];
    const cloth_real *t = a->contact_tangent + 6 * (corner / 4); // xx yy zz yz zx xy
    cloth_real full[9];
    full[0] = t[0], full[1] = t[5], full[2] = t[4];
    full[3] = t[5], full[4] = t[1], full[5] = t[3];
    full[6] = t[4], full[7] = t[3], full[8] = t[2];
    for (int k = 0; k < 4; k++) {
      int v = a->contact_vertex[corner / 4 * 4 + k];
      if (v < a->cloth_vertices && a->free[v] > 0)
        cloth_levels_add(at, v, full, 1,
                         a->contact_weight[corner] * a->contact_weight[corner / 4 * 4 + k], run,
                         chunk);
    }
  }
}

CLOTH_FN void cloth_levels_chunk(int i, const cloth_levels_chunk_args *a)
{
  cloth_real run[9][CLOTH_CHUNK], chunk[9][CLOTH_CHUNK], sum[9];
  int begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->rows.count, i), first = a->rows.first;
  for (int lane = 0; lane < CLOTH_CHUNK; lane++) {
    cloth_real r[9] = {0}, c[9] = {0};
    if (begin + lane < end) cloth_levels_row(begin + lane, &a->rows, r, c);
    for (int e = 0; e < 9; e++) run[e][lane] = r[e], chunk[e][lane] = c[e];
  }
  for (int k = 0; k < CLOTH_CHUNK; k += CLOTH_RUN) {
    for (int e = 0; e < 9; e++) sum[e] = cloth_lanes_sum(run[e] + k, CLOTH_RUN);
    cloth_sym3_store(a->run_inverse, (first + begin + k) / CLOTH_RUN, cloth_levels_inverse(sum));
  }
  for (int e = 0; e < 9; e++) sum[e] = cloth_chunk_sum(chunk[e]);
  cloth_sym3_store(a->chunk_inverse, (first + begin) / CLOTH_CHUNK, cloth_levels_inverse(sum));
}
