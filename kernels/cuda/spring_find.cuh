// Candidates of the mass-spring kernel, found within it: everybody into the list of a bin, then
// each looks around. The order of a list is that in which threads came, and shows nowhere: what is
// found is sorted.
#pragma once

#include "spring_room.cuh"

namespace {

// the table of bins is empty; counts as well. `again`: not at the start of the block.
__device__ void empty_bins(const cloth_spring_block_args &b, bool again)
{
  int first = (int)(blockIdx.x * blockDim.x + threadIdx.x), stride = (int)(gridDim.x * blockDim.x);
  for (int k = first; k <= (int)b.find.bins.mask; k += stride) b.head[k] = (uint32_t)NOBODY;
  for (int k = first; k < (again ? 1 : CLOTH_SPRING_HEAD); k += stride) b.find.sums[k] = 0;
}

// Who moves a particle inserts it.
__device__ void insert(const cloth_spring_block_args &b, const tile &here, int own_row, int stride)
{
  bool moves = (int)threadIdx.x < (int)blockDim.x / LANES;
  for (int i = own_row; moves && i < b.rows; i += stride) {
    cloth_bin c = cloth_bin_of(&b.find.bins, here.position_of(i));
    b.next[i] = atomicExch(b.head + cloth_bin_place(&b.find.bins, c.x, c.y, c.z), (unsigned)i);
  }
}

// cell k of the 27 around c
__device__ __forceinline__ cloth_bin around(cloth_bin c, int k)
{
  c.x += k % 3 - 1, c.y += k / 3 % 3 - 1, c.z += k / 9 - 1;
  return c;
}

// Calls found(j) for all near particle i in cells lane, lane + LANES, ... around it. Lists are
// walked as one, so that threads side by side wait for the longest sum and not for the longest of
// each. heads [HEADS]: scratch.
template <typename Found>
__device__ void look_around(const cloth_spring_block_args &b, const tile &here, int i, int lane,
                            int *heads, Found found)
{
  const cloth_bins *bins = &b.find.bins;
  cloth_v3 p = here.position_of(i);
  cloth_bin middle = cloth_bin_of(bins, p), c = middle;
  int head[HEADS], j = NOBODY;
#pragma unroll
  for (int n = 0; n < HEADS; n++) { // loads that wait for nothing
    c = around(middle, lane + LANES * n);
    head[n] = lane + LANES * n < 27 ? (int)b.head[cloth_bin_place(bins, c.x, c.y, c.z)] : NOBODY;
  }
#pragma unroll
  for (int n = 0; n < HEADS; n++) heads[n] = head[n];
  for (int n = 0;;) {
    for (; j == NOBODY && n < HEADS; n++) j = heads[n], c = around(middle, lane + LANES * n);
    if (j == NOBODY) return;
    int after = (int)b.next[j];
    if (cloth_bin_is_near(bins, i, p, c.x, c.y, c.z, j, here.position_of(j))) found(j);
    j = after;
  }
}

// The candidates of particle i by its threads: each keeps what it finds, and every one goes to its
// rank among all. Where a thread has no room, the first one finds all of them by itself, cells of
// one thread after those of the other. Returns how many, on the first thread.
__device__ uint32_t find_row(const cloth_spring_block_args &b, const tile &here, int i, bool there,
                             int lane, kept *mine)
{
  int n = 0, all = 0, most = 0, count[LANES];
  uint32_t *list = b.find.candidate + (uint64_t)i * b.find.room, listed = 0;
  int *heads = mine->search(), *found = heads + HEADS, room = here.found();
  if (there)
    look_around(b, here, i, lane, heads, [&](int j) {
      if (n < room) found[n] = j;
      n++;
    });
  __syncwarp();
  for (int l = 0; l < LANES; l++) {
    count[l] = __shfl_sync(0xffffffffu, n, l, LANES);
    all += count[l];
    if (count[l] > most) most = count[l];
  }
  if (most <= room) {
    for (int k = 0; k < n; k++) {
      uint32_t rank = 0;
      for (int l = 0; l < LANES; l++) {
        const int *his = here.kept_of_other(mine, l - lane)->search() + HEADS;
        for (int m = 0; m < count[l]; m++) rank += his[m] < found[k];
      }
      if (rank < b.find.room) list[rank] = (uint32_t)found[k];
    }
  } else if (there && lane == 0) {
    for (int l = 0; l < LANES; l++)
      look_around(b, here, i, l, heads,
                  [&](int j) { listed = cloth_bin_insert(&b.find, (uint32_t)j, listed, list); });
  }
  if (there && lane == 0)
    b.find.count[i] = (uint32_t)all < b.find.room ? (uint32_t)all : b.find.room;
  __syncwarp(); // its threads read the list and fill what they keep
  return there && lane == 0 ? (uint32_t)all : 0;
}

// of all particles, the first `row` of the thread; stride: particles of a go
__device__ void find(const cloth_spring_block_args &b, const tile &here, int row, int stride,
                     kept *mine)
{
  uint32_t found = 0, full = 0;
  for (int from = 0; from < b.rows; from += stride) {
    bool there = from + row < b.rows;
    uint32_t n = find_row(b, here, there ? from + row : 0, there, (int)threadIdx.x % LANES, mine);
    found += n, full += n > b.find.room;
  }
  for (int width = WARP / 2; width > 0; width /= 2) {
    found += __shfl_xor_sync(0xffffffffu, found, width);
    full += __shfl_xor_sync(0xffffffffu, full, width);
  }
  if (threadIdx.x % WARP > 0) return;
  cloth_atomic_add(b.find.sums + CLOTH_SPRING_CANDIDATES, found);
  if (full > 0) cloth_atomic_add(b.find.sums + CLOTH_SPRING_FULL, full);
}

// all of it; behind it everybody's list is written, and what another thread keeps is his again
template <typename Barrier>
__device__ void search(const cloth_spring_block_args &b, const tile &here, int row, int own_row,
                       int stride, bool again, kept *mine, Barrier &g)
{
  empty_bins(b, again);
  g.sync();
  insert(b, here, own_row, stride);
  g.sync();
  find(b, here, row, stride, mine);
}

} // namespace
