// The terms of sums over all chunks (pcg.h), by the blocks that have the chunks, and their sum by
// every block for itself.
//
// What costs time are barriers, and one block that works while all others wait. So nobody adds up
// for the others: a block goes through its vertices in tiles of a group, so it has whole groups and
// writes their sums instead of their chunks'; behind the barrier that all pass anyway each block
// reads all terms, side by side, a 256th of the numbers that a vertex vector has. That is one
// barrier for a sum, and no way back from one block to the others. (A second tree level, by the
// block that is the last one to bring a term of it, would take a fence and an atomic more of every
// block; to read less by that pays only if the terms are more than a block reads within a barrier.)
#pragma once

#include "pcg_alpha.h"
#include "pcg_solve.h"
#include "reduce.cuh"

enum {
  CLOTH_TILE_CHUNKS = CLOTH_PCG_LANES / CLOTH_CHUNK, // of a block of CLOTH_PCG_LANES threads
  CLOTH_TILES_KEPT = 32,
  CLOTH_TILE_SUMS = 2
};

static_assert((int)CLOTH_TILE_CHUNKS == (int)CLOTH_CHUNK_GROUP, "a block has whole groups");

/// What a block keeps in shared memory until it writes terms: sums of chunks of its last tiles.
typedef cloth_real cloth_tile_room[CLOTH_TILES_KEPT][CLOTH_TILE_SUMS][CLOTH_TILE_CHUNKS];

/// Tiles [0, tiles) by all blocks of the kernel. each(tile, sum) sets F sums on the first thread of
/// each chunk, zero for a chunk that is not there; write(tile, k, sum) gets a term: that of group k
/// of the tile, of `group` chunks. Called by whole blocks. Nobody else uses `room` before all have
/// met.
template <int F, typename Each, typename Write>
static __device__ __forceinline__ void cloth_for_tiles(int tiles, int group, cloth_tile_room &room,
                                                       Each each, Write write)
{
  int groups = CLOTH_TILE_CHUNKS / group, stride = (int)gridDim.x, kept = 0;
  for (int tile = (int)blockIdx.x; tile < tiles; tile += stride) {
    cloth_real sum[F] = {};
    each(tile, sum);
    if (threadIdx.x % CLOTH_CHUNK == 0)
      for (int f = 0; f < F; f++) room[kept][f][threadIdx.x / CLOTH_CHUNK] = sum[f];
    if (++kept < CLOTH_TILES_KEPT && tile + stride < tiles) continue;
    __syncthreads();
    int first = tile - (kept - 1) * stride;
    for (int e = (int)threadIdx.x; e < kept * groups; e += CLOTH_PCG_LANES) {
      int t = e / groups, k = e % groups;
      for (int f = 0; f < F; f++) {
        cloth_real v[CLOTH_CHUNK_GROUP];
        for (int c = 0; c < CLOTH_CHUNK_GROUP; c++) v[c] = room[t][f][c];
        sum[f] = group == 1 ? room[t][f][k] : cloth_lanes_sum(v, CLOTH_CHUNK_GROUP);
      }
      write(first + t * stride, k, sum);
    }
    kept = 0;
    if (tile + stride < tiles) __syncthreads(); // it may be overwritten
  }
}

/// What a thread adds of terms [begin, end), where it is the lane of cloth_terms_sum().
static __device__ __forceinline__ cloth_real cloth_add_terms(cloth_real sum, const cloth_real *term,
                                                             int begin, int end)
{
  int l = (int)threadIdx.x;
  int e = begin + ((l - begin) % CLOTH_PCG_LANES + CLOTH_PCG_LANES) % CLOTH_PCG_LANES;
#pragma unroll 8
  for (; e < end; e += CLOTH_PCG_LANES) sum += term[e];
  return sum;
}

/// r'z and r'r in two halves, because some terms come one barrier earlier than others: all but a
/// few. Those are added up, lane by lane, by a block for each sum, while others are at the hats'
/// upper levels. (All blocks read all of them once: at four million triangles that was 80 KB each,
/// and as long as the upper levels.)
struct cloth_beta_sums {
  cloth_real of[2];
  int groups, early, all; // terms of r'r; those of r'z that are there early, all

  /// later: is there a barrier between the terms of the chunks and those of the hats' upper levels?
  __device__ __forceinline__ cloth_beta_sums(const cloth_pcg_solve_args &a, bool later)
      : of{0, 0}, groups(cloth_chunk_groups(a.v.chunks)), all(groups + a.beta.more)
  {
    early = !later ? 0 : groups + (a.v.hats.nodes > 0 ? cloth_hat_fine_groups(&a.v.hats) : 0);
  }

  /// Before the later barrier. The last blocks: the first ones have the upper levels.
  __device__ __forceinline__ void add_early(const cloth_pcg_terms &t) const
  {
    if (early == 0) return;
    unsigned last = gridDim.x - 1, other = last > 0 ? last - 1 : 0;
    if (blockIdx.x == last) t.lanes[threadIdx.x] = cloth_add_terms(0, t.rz, 0, early);
    if (blockIdx.x == other)
      t.lanes[CLOTH_PCG_LANES + threadIdx.x] = cloth_add_terms(0, t.rr, 0, groups);
  }

  /// Behind it.
  __device__ __forceinline__ void add_rest(const cloth_pcg_terms &t)
  {
    if (early > 0) of[0] = t.lanes[threadIdx.x], of[1] = t.lanes[CLOTH_PCG_LANES + threadIdx.x];
    of[0] = cloth_add_terms(of[0], t.rz, early, all);
    if (early == 0) of[1] = cloth_add_terms(of[1], t.rr, 0, groups);
  }
};

/// The scalars of the block, from what its threads have added. lanes [2 x CLOTH_PCG_LANES] shared.
/// Every thread of the block must come here.
static __device__ __forceinline__ void cloth_block_beta(const cloth_pcg_solve_args &a, int start,
                                                        cloth_beta_sums &sums, cloth_real *scalar,
                                                        cloth_real *lanes)
{
  cloth_block_lanes_sums(sums.of, lanes);
  cloth_real rz = sums.of[0];
  if (a.v.coarse && threadIdx.x < CLOTH_WARP) rz += cloth_warp_coarse_rz(a.beta);
  if (threadIdx.x == 0) {
    cloth_pcg_beta_args beta = a.beta;
    beta.start = start, beta.scalar = scalar;
    cloth_pcg_beta_set(&beta, rz, sums.of[1]);
  }
  __syncthreads();
}

static __device__ __forceinline__ void cloth_block_alpha(const cloth_pcg_solve_args &a,
                                                         cloth_real *scalar, cloth_real *lanes)
{
  cloth_real pq[1] = {cloth_add_terms(0, a.terms.pq, 0, cloth_chunk_groups(a.v.chunks))};
  cloth_block_lanes_sums(pq, lanes);
  if (threadIdx.x == 0) cloth_pcg_alpha_set(scalar, pq[0]);
  __syncthreads();
}
