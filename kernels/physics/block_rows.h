// Rows of 3x3 blocks in block ELLPACK, structure of arrays, in groups of rows that share a width
// (SELL: Kreutzer et al. 2014; P-Cloth section 4.1 uses one width for all). Slot 0 is the diagonal.
// Entry e (row-major) of slot s of row i lies at val[((first[g] + s) * 9 + e) * GROUP + lane],
// where i = g * GROUP + lane: the rows of a group are neighbours in memory, so one instruction
// serves all.
#pragma once

#include "real.h"

// A group is what one instruction serves: eight lanes of a CPU, a warp of a GPU. Measured on an
// H100: groups of 32 reach 87 % of the bandwidth of a copy, groups of 8 79 % (test/bench/spmv.cu).
// It does not show in the sums.
#ifdef __CUDACC__
enum { CLOTH_ROW_GROUP = 32 };
#else
enum { CLOTH_ROW_GROUP = 8 };
#endif

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
  int widest;       // slots of the longest row
} cloth_block_rows;

CLOTH_FN cloth_real *cloth_block_at(const cloth_block_rows *r, int row, int slot)
{
  int g = row / CLOTH_ROW_GROUP;
  return r->val + (int64_t)(r->first[g] + slot) * 9 * CLOTH_ROW_GROUP + row % CLOTH_ROW_GROUP;
}

// Which of the three lines of each block of a row somebody works on: all of them, or, where a
// thread of a GPU has one, that. `count` is a constant where this is inlined.
typedef struct cloth_lines {
  int first, count;
} cloth_lines;

CLOTH_FN void cloth_block_clear(const cloth_block_rows *r, int row, cloth_lines lines)
{
  int g = row / CLOTH_ROW_GROUP, width = r->first[g + 1] - r->first[g];
  cloth_real *v = cloth_block_at(r, row, 0) + 3 * lines.first * CLOTH_ROW_GROUP;
  for (int s = 0; s < width; s++)
    for (int e = 0; e < 3 * lines.count; e++) v[(9 * s + e) * CLOTH_ROW_GROUP] = 0;
}

/// The slot of a row that couples it to vertex v, which one does.
CLOTH_FN int cloth_block_slot(const cloth_block_rows *r, int row, int v)
{
  int g = row / CLOTH_ROW_GROUP, s = r->first[g], end = r->first[g + 1] - 1;
  while (s < end && r->col[(int64_t)s * CLOTH_ROW_GROUP + row % CLOTH_ROW_GROUP] != v) s++;
  return s - r->first[g];
}

// Whoever adds several blocks reads them all before he adds the first: for all that a compiler
// knows they may lie among the rows, and what is read after a write waits for it.
// m [lines.count]: the lines of the block.
CLOTH_FN void cloth_block_add(const cloth_block_rows *r, int row, int slot, cloth_lines lines,
                              const cloth_v3 *m)
{
  cloth_real *v = cloth_block_at(r, row, slot) + 3 * lines.first * CLOTH_ROW_GROUP;
  cloth_v3 sum[3];
  for (int l = 0; l < lines.count; l++) {
    const cloth_real *at = v + 3 * l * CLOTH_ROW_GROUP;
    sum[l] = cloth_v3_add(cloth_v3_make(at[0], at[CLOTH_ROW_GROUP], at[2 * CLOTH_ROW_GROUP]), m[l]);
  }
  for (int l = 0; l < lines.count; l++) {
    cloth_real *at = v + 3 * l * CLOTH_ROW_GROUP;
    at[0] = sum[l].x, at[CLOTH_ROW_GROUP] = sum[l].y, at[2 * CLOTH_ROW_GROUP] = sum[l].z;
  }
}

CLOTH_FN void cloth_block_add_sym(const cloth_block_rows *r, int row, int slot, cloth_lines lines,
                                  cloth_sym3 m)
{
  cloth_v3 line[3];
  for (int l = 0; l < lines.count; l++) line[l] = cloth_sym3_line(m, lines.first + l);
  cloth_block_add(r, row, slot, lines, line);
}

// a b'
CLOTH_FN void cloth_block_add_outer(const cloth_block_rows *r, int row, int slot, cloth_lines lines,
                                    cloth_v3 a, cloth_v3 b)
{
  cloth_v3 line[3];
  for (int l = 0; l < lines.count; l++)
    line[l] = cloth_v3_scale(cloth_v3_component(a, lines.first + l), b);
  cloth_block_add(r, row, slot, lines, line);
}

CLOTH_FN cloth_sym3 cloth_block_diagonal(const cloth_block_rows *r, int row)
{
  const cloth_real *v = cloth_block_at(r, row, 0);
  const int g = CLOTH_ROW_GROUP;
  cloth_sym3 m;
  m.xx = v[0], m.xy = v[1 * g], m.zx = v[2 * g], m.yy = v[4 * g], m.yz = v[5 * g], m.zz = v[8 * g];
  return m;
}

// loads of a few slots in flight at once, where a thread has a row to itself
#ifdef __CUDACC__
#define CLOTH_UNROLL      _Pragma("unroll 4")
#define CLOTH_UNROLL_MORE _Pragma("unroll 8")
#else
#define CLOTH_UNROLL
#define CLOTH_UNROLL_MORE
#endif

// The matrix is read once a product and is larger than the cache of a GPU: it shall not push the
// vectors out.
#ifdef __CUDA_ARCH__
#define CLOTH_ONCE(x) __ldcs(&(x))
#else
#define CLOTH_ONCE(x) (x)
#endif

/// y += slots [begin, end) of one row, a thread of the group's.
#define CLOTH_ROW_PRODUCT(name, unroll)                                                            \
  CLOTH_FN cloth_v3 name(const cloth_block_rows *r, int lane, int begin, int end,                  \
                         const cloth_real *x, cloth_v3 y)                                          \
  {                                                                                                \
    unroll for (int s = begin; s < end; s++)                                                       \
    {                                                                                              \
      const int g = CLOTH_ROW_GROUP;                                                               \
      cloth_v3 from = cloth_v3_load(x, CLOTH_ONCE(r->col[(int64_t)s * g + lane]));                 \
      const cloth_real *a = r->val + (int64_t)s * 9 * g + lane;                                    \
      y.x +=                                                                                       \
          CLOTH_ONCE(a[0]) * from.x + CLOTH_ONCE(a[g]) * from.y + CLOTH_ONCE(a[2 * g]) * from.z;   \
      y.y += CLOTH_ONCE(a[3 * g]) * from.x + CLOTH_ONCE(a[4 * g]) * from.y +                       \
             CLOTH_ONCE(a[5 * g]) * from.z;                                                        \
      y.z += CLOTH_ONCE(a[6 * g]) * from.x + CLOTH_ONCE(a[7 * g]) * from.y +                       \
             CLOTH_ONCE(a[8 * g]) * from.z;                                                        \
    }                                                                                              \
    return y;                                                                                      \
  }
CLOTH_ROW_PRODUCT(cloth_block_slots_product, CLOTH_UNROLL)
CLOTH_ROW_PRODUCT(cloth_block_slots_product_ahead, CLOTH_UNROLL_MORE) // where registers are left

/// y = A x for one row: the sums of cloth_block_product(), one lane of it.
CLOTH_FN cloth_v3 cloth_block_row_product(const cloth_block_rows *r, int row, const cloth_real *x)
{
  int group = row / CLOTH_ROW_GROUP;
  return cloth_block_slots_product(r, row % CLOTH_ROW_GROUP, r->first[group], r->first[group + 1],
                                   x, cloth_v3_make(0, 0, 0));
}

// A CPU reads a vertex as one piece of four numbers and turns eight of them into three registers
// of eight: gathered one by one they would cost more than the product. Same sums, same bits. (In
// double eight are two registers, and nothing is gained.)
#if defined(CLOTH_SINGLE_PRECISION) && defined(__GNUC__) && !defined(__CUDACC__) &&                \
    defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define CLOTH_ROW_VECTORS
#endif
#endif

#ifdef CLOTH_ROW_VECTORS
typedef cloth_real cloth_lanes4
    __attribute__((vector_size(4 * sizeof(cloth_real)), aligned(sizeof(cloth_real)), may_alias));
typedef cloth_real cloth_lanes8
    __attribute__((vector_size(8 * sizeof(cloth_real)), aligned(sizeof(cloth_real)), may_alias));

// vertices at col and four further on, side by side; the fourth number is the next vertex's
#define CLOTH_LANES_PAIR(x, col, l)                                                                \
  __builtin_shufflevector(*(const cloth_lanes4 *)((x) + 3 * (col)[l]),                             \
                          *(const cloth_lanes4 *)((x) + 3 * (col)[(l) + 4]), 0, 1, 2, 3, 4, 5, 6,  \
                          7)

/// y = A x for the rows of one group: y is [GROUP x 3]. x is read one number past its last vertex.
CLOTH_FN void cloth_block_product(const cloth_block_rows *r, int group, const cloth_real *x,
                                  cloth_real *y)
{
  const int g = CLOTH_ROW_GROUP;
  cloth_lanes8 y0 = {0}, y1 = {0}, y2 = {0};
  for (int s = r->first[group]; s < r->first[group + 1]; s++) {
    const int *col = r->col + (int64_t)s * g;
    const cloth_lanes8 *a = (const cloth_lanes8 *)(r->val + (int64_t)s * 9 * g);
    cloth_lanes8 v04 = CLOTH_LANES_PAIR(x, col, 0), v15 = CLOTH_LANES_PAIR(x, col, 1);
    cloth_lanes8 v26 = CLOTH_LANES_PAIR(x, col, 2), v37 = CLOTH_LANES_PAIR(x, col, 3);
    cloth_lanes8 xy01 = __builtin_shufflevector(v04, v15, 0, 8, 1, 9, 4, 12, 5, 13);
    cloth_lanes8 xy23 = __builtin_shufflevector(v26, v37, 0, 8, 1, 9, 4, 12, 5, 13);
    cloth_lanes8 z01 = __builtin_shufflevector(v04, v15, 2, 10, 3, 11, 6, 14, 7, 15);
    cloth_lanes8 z23 = __builtin_shufflevector(v26, v37, 2, 10, 3, 11, 6, 14, 7, 15);
    cloth_lanes8 x0 = __builtin_shufflevector(xy01, xy23, 0, 1, 8, 9, 4, 5, 12, 13);
    cloth_lanes8 x1 = __builtin_shufflevector(xy01, xy23, 2, 3, 10, 11, 6, 7, 14, 15);
    cloth_lanes8 x2 = __builtin_shufflevector(z01, z23, 0, 1, 8, 9, 4, 5, 12, 13);
    y0 += a[0] * x0 + a[1] * x1 + a[2] * x2;
    y1 += a[3] * x0 + a[4] * x1 + a[5] * x2;
    y2 += a[6] * x0 + a[7] * x1 + a[8] * x2;
  }
  for (int l = 0; l < g; l++) y[3 * l] = y0[l], y[3 * l + 1] = y1[l], y[3 * l + 2] = y2[l];
}

#else

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

#endif
