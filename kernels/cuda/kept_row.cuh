// What a thread keeps at hand for as long as a solve takes: a row of the matrix in its registers,
// its share of a node of hats in shared memory.
#pragma once

#include "block_rows.h"
#include "hat.h"

template <int Slots> struct cloth_kept_row {
  int col[Slots], more, end; // slots [more, end) stay in memory
  cloth_real val[9 * Slots];

  /// Row `row` of `count`; slots that it does not have name the row itself and hold zeros.
  __device__ void load(const cloth_block_rows *r, int row, int count)
  {
    const int g = CLOTH_ROW_GROUP;
    bool there = row < count;
    int lane = row % g, begin = there ? r->first[row / g] : 0;
    int width = there ? r->first[row / g + 1] - begin : 0;
    more = begin + Slots, end = begin + width;
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
    return cloth_block_slots_product(r, row % CLOTH_ROW_GROUP, more, end, x, y);
  }
};

/// The first children of a node of hats for each of Threads threads, in shared memory.
template <int Children, int Threads> struct cloth_kept_node {
  int child[Children * Threads], more[Threads], end[Threads]; // [more, end) stays in memory
  cloth_real weight[Children * Threads];

  /// The share of lane l of `lanes` in node c of the first level, if there is one; children that it
  /// does not have name the node's first and weigh nothing.
  __device__ void load(const cloth_hats *h, int c, int l, int lanes)
  {
    int begin = c < h->fine ? h->first[c] : 0, last = c < h->fine ? h->first[c + 1] : 0;
    more[threadIdx.x] = begin + l + Children * lanes, end[threadIdx.x] = last;
    for (int k = 0; k < Children; k++) {
      int n = begin + l + k * lanes, at = k * Threads + (int)threadIdx.x;
      child[at] = begin < last ? h->child[n < last ? n : begin] : 0;
      weight[at] = n < last ? h->child_weight[n] : 0;
    }
  }

  /// cloth_hat_rest_lane(): the same bits, as for the row.
  __device__ cloth_v3 rest(const cloth_hats *h, const cloth_real *from, int lanes) const
  {
    cloth_v3 sum = cloth_v3_make(0, 0, 0);
#pragma unroll
    for (int k = 0; k < Children; k++) {
      int at = k * Threads + (int)threadIdx.x;
      sum = cloth_v3_add_scaled(sum, weight[at], cloth_v3_load(from, child[at]));
    }
    for (int n = more[threadIdx.x]; n < end[threadIdx.x]; n += lanes)
      sum = cloth_v3_add_scaled(sum, h->child_weight[n], cloth_v3_load(from, h->child[n]));
    return sum;
  }
};
