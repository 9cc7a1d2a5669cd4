// A row of the matrix in the registers of a thread, for as long as a solve takes.
#pragma once

#include "block_rows.h"

template <int Slots> struct cloth_kept_row {
  int col[Slots];
  cloth_real val[9 * Slots];

  /// Row `row` of `count`; slots that it does not have name the row itself and hold zeros.
  __device__ void load(const cloth_block_rows *r, int row, int count)
  {
    const int g = CLOTH_ROW_GROUP;
    bool there = row < count;
    int lane = row % g, begin = there ? r->first[row / g] : 0;
    int width = there ? r->first[row / g + 1] - begin : 0;
#pragma unroll
    for (int s = 0; s < Slots; s++) {
      bool in = s < width;
      col[s] = in ? r->col[(int64_t)(begin + s) * g + lane] : there ? row : 0;
#pragma unroll
      for (int e = 0; e < 9; e++)
        val[9 * s + e] = in ? r->val[((int64_t)(begin + s) * 9 + e) * g + lane] : 0;
    }
  }

  /// The row times x: the bits of cloth_block_row_product(), since a sum that began with +0 is
  /// never -0, so adding zeros does not change it.
  __device__ cloth_v3 product(const cloth_block_rows *r, int row, const cloth_real *x)
  {
    cloth_v3 y = cloth_v3_make(0, 0, 0);
#pragma unroll
    for (int s = 0; s < Slots; s++) {
      cloth_v3 from = cloth_v3_load(x, col[s]);
      const cloth_real *a = val + 9 * s;
      y.x += a[0] * from.x + a[1] * from.y + a[2] * from.z;
      y.y += a[3] * from.x + a[4] * from.y + a[5] * from.z;
      y.z += a[6] * from.x + a[7] * from.y + a[8] * from.z;
    }
    int begin = r->first[row / CLOTH_ROW_GROUP], end = r->first[row / CLOTH_ROW_GROUP + 1];
    return cloth_block_slots_product(r, row % CLOTH_ROW_GROUP, begin + Slots, end, x, y);
  }
};
