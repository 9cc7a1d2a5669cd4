// Rows of 3x3 blocks in block ELLPACK, structure of arrays, in groups of rows that share a width
// (SELL: Kreutzer et al. 2014; P-Cloth section 4.1 uses one width for all). Slot 0 is the diagonal.
// Entry e (row-major) of slot s of row i lies at val[((first[g] + s) * 9 + e) * GROUP + lane],
// where i = g * GROUP + lane: the rows of a group are neighbours in memory, so one instruction
// serves all.
#pragma once

#include "real.h"

enum { CLOTH_ROW_GROUP = 8 };

// a loop over the rows of a group, one lane each
#if defined(_OPENMP) && !defined(__CUDACC__)
#define CLOTH_LANES _Pragma("omp simd")
#else
#define CLOTH_LANES
#endif

typedef struct cloth_block_rows {
  const int *first; // [groups + 1] slots before the group
  const int *col;   // [slots x GROUP] vertex; unused slots name the row itself and hold zeros
  cloth_real *val;  // [slots x 9 x GROUP] N/m
} cloth_block_rows;

CLOTH_FN cloth_real *cloth_block_at(const cloth_block_rows *r, int row, int slot)
{
  int g = row / CLOTH_ROW_GROUP;
  return r->val + (int64_t)(r->first[g] + slot) * 9 * CLOTH_ROW_GROUP + row % CLOTH_ROW_GROUP;
}

CLOTH_FN void cloth_block_clear(const cloth_block_rows *r, int row)
{
  int g = row / CLOTH_ROW_GROUP, width = r->first[g + 1] - r->first[g];
  cloth_real *v = cloth_block_at(r, row, 0);
  for (int e = 0; e < 9 * width; e++) v[e * CLOTH_ROW_GROUP] = 0;
}

CLOTH_FN void cloth_block_add(const cloth_block_rows *r, int row, int slot, const cloth_real *m)
{
  cloth_real *v = cloth_block_at(r, row, slot);
  for (int e = 0; e < 9; e++) v[e * CLOTH_ROW_GROUP] += m[e];
}

CLOTH_FN void cloth_block_add_transposed(const cloth_block_rows *r, int row, int slot,
                                         const cloth_real *m)
{
  cloth_real *v = cloth_block_at(r, row, slot);
  for (int e = 0; e < 9; e++) v[e * CLOTH_ROW_GROUP] += m[3 * (e % 3) + e / 3];
}

CLOTH_FN void cloth_block_add_sym(const cloth_block_rows *r, int row, int slot, cloth_sym3 m)
{
  cloth_real full[9];
  full[0] = m.xx, full[1] = m.xy, full[2] = m.zx;
  full[3] = m.xy, full[4] = m.yy, full[5] = m.yz;
  full[6] = m.zx, full[7] = m.yz, full[8] = m.zz;
  cloth_block_add(r, row, slot, full);
}

// a b'
CLOTH_FN void cloth_block_add_outer(const cloth_block_rows *r, int row, int slot, cloth_v3 a,
                                    cloth_v3 b)
{
  cloth_real full[9];
  full[0] = a.x * b.x, full[1] = a.x * b.y, full[2] = a.x * b.z;
  full[3] = a.y * b.x, full[4] = a.y * b.y, full[5] = a.y * b.z;
  full[6] = a.z * b.x, full[7] = a.z * b.y, full[8] = a.z * b.z;
  cloth_block_add(r, row, slot, full);
}

CLOTH_FN cloth_sym3 cloth_block_diagonal(const cloth_block_rows *r, int row)
{
  const cloth_real *v = cloth_block_at(r, row, 0);
  const int g = CLOTH_ROW_GROUP;
  cloth_sym3 m;
  m.xx = v[0], m.xy = v[1 * g], m.zx = v[2 * g], m.yy = v[4 * g], m.yz = v[5 * g], m.zz = v[8 * g];
  return m;
}

/// y = A x for the rows of one group: y is [GROUP x 3].
CLOTH_FN void cloth_block_product(const cloth_block_rows *r, int group, const cloth_real *x,
                                  cloth_real *y)
{
  cloth_real y0[CLOTH_ROW_GROUP], y1[CLOTH_ROW_GROUP], y2[CLOTH_ROW_GROUP];
  cloth_real x0[CLOTH_ROW_GROUP], x1[CLOTH_ROW_GROUP], x2[CLOTH_ROW_GROUP];
  for (int l = 0; l < CLOTH_ROW_GROUP; l++) y0[l] = y1[l] = y2[l] = 0;
  for (int s = r->first[group]; s < r->first[group + 1]; s++) {
    const int *col = r->col + (int64_t)s * CLOTH_ROW_GROUP;
    const cloth_real *a = r->val + (int64_t)s * 9 * CLOTH_ROW_GROUP;
    for (int l = 0; l < CLOTH_ROW_GROUP; l++) {
      const cloth_real *from = x + 3 * col[l];
      x0[l] = from[0], x1[l] = from[1], x2[l] = from[2];
    }
    const int g = CLOTH_ROW_GROUP;
    CLOTH_LANES
    for (int l = 0; l < CLOTH_ROW_GROUP; l++)
      y0[l] += a[l] * x0[l] + a[g + l] * x1[l] + a[2 * g + l] * x2[l];
    CLOTH_LANES
    for (int l = 0; l < CLOTH_ROW_GROUP; l++)
      y1[l] += a[3 * g + l] * x0[l] + a[4 * g + l] * x1[l] + a[5 * g + l] * x2[l];
    CLOTH_LANES
    for (int l = 0; l < CLOTH_ROW_GROUP; l++)
      y2[l] += a[6 * g + l] * x0[l] + a[7 * g + l] * x1[l] + a[8 * g + l] * x2[l];
  }
  for (int l = 0; l < CLOTH_ROW_GROUP; l++)
    y[3 * l] = y0[l], y[3 * l + 1] = y1[l], y[3 * l + 2] = y2[l];
}
