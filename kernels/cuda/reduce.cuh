// Sums by the threads of a block, along the trees of chunk.h: the bits of the loops.
#pragma once

#include "chunk.h"
#include "hat_rest_upper.h"
#include "pcg.h"
#include "pcg_beta.h"

enum { CLOTH_WARP = 32, CLOTH_CHUNK_SHARED = CLOTH_PCG_PARTIALS * CLOTH_WARP };

/// The sum of 32 lanes, on lane 0.
static __device__ __forceinline__ cloth_real cloth_warp_sum(cloth_real v)
{
  for (int width = CLOTH_WARP / 2; width > 0; width /= 2)
    v += __shfl_down_sync(0xffffffffu, v, (unsigned)width);
  return v;
}

/// cloth_coarse_rz() by a warp.
static __device__ __forceinline__ cloth_real cloth_warp_coarse_rz(const cloth_pcg_beta_args &a)
{
  cloth_real sum = 0;
  for (int k = (int)threadIdx.x % CLOTH_WARP; k < 3 * a.aggregates; k += CLOTH_COARSE_LANES)
    sum += a.rest[k] * a.coarse[k];
  return cloth_warp_sum(sum);
}

/// The larger of 32 lanes, on lane 0; NaN if any is.
static __device__ __forceinline__ cloth_real cloth_warp_larger(cloth_real v)
{
  for (int width = CLOTH_WARP / 2; width > 0; width /= 2)
    v = cloth_larger(v, __shfl_down_sync(0xffffffffu, v, (unsigned)width));
  return v;
}

/// The two warps of a chunk wait for each other; those of other chunks in the block go on. Numbers
/// of barriers are written out, because a block that names one at run time reserves all sixteen,
/// and a multiprocessor then holds four blocks.
static __device__ __forceinline__ void cloth_chunk_barrier(void)
{
#ifdef CLOTH_CHUNK_A_BLOCK
  __syncthreads();
#else
  switch (threadIdx.x / CLOTH_CHUNK) {
  case 0:
    asm volatile("bar.sync 1, 64;" ::: "memory");
    break;
  case 1:
    asm volatile("bar.sync 2, 64;" ::: "memory");
    break;
  case 2:
    asm volatile("bar.sync 3, 64;" ::: "memory");
    break;
  default:
    asm volatile("bar.sync 4, 64;" ::: "memory");
    break;
  }
#endif
}

/// Sums of F numbers over each chunk of a block: 64 neighbouring threads are a chunk, and all of
/// them must come here. On the chunk's first thread. shared [chunks x CLOTH_CHUNK_SHARED], in a
/// block of one chunk [F x 32].
template <int F>
static __device__ __forceinline__ void cloth_block_chunk_sums(cloth_real (&v)[F],
                                                              cloth_real *shared)
{
  int lane = (int)threadIdx.x % CLOTH_CHUNK, chunk = (int)threadIdx.x / CLOTH_CHUNK;
  cloth_real *upper =
      shared + chunk * CLOTH_CHUNK_SHARED + lane % CLOTH_WARP; // of this chunk alone
  cloth_chunk_barrier(); // `upper` may still be read from the last time
  if (lane >= CLOTH_WARP)
    for (int f = 0; f < F; f++) upper[f * CLOTH_WARP] = v[f];
  cloth_chunk_barrier();
  if (lane < CLOTH_WARP)
    for (int f = 0; f < F; f++) v[f] = cloth_warp_sum(v[f] + upper[f * CLOTH_WARP]);
}

/// z of vertex k from its r, and the sums r'z, r'r over the chunk of 64 neighbouring threads, on
/// the chunk's first thread, which writes those of r where there are aggregates.
/// cloth_pcg_chunk_finish() by threads. Every thread of the chunk must come here; r is zero where
/// `there` is false. first: of the chunk; shared [chunks x CLOTH_CHUNK_SHARED].
static __device__ __forceinline__ void cloth_block_z_sums(const cloth_pcg_vectors *v, int first,
                                                          int k, bool there, cloth_v3 r,
                                                          cloth_real (&terms)[2],
                                                          cloth_real *shared)
{
  bool writes = threadIdx.x % CLOTH_CHUNK == 0 && there;
  cloth_real *partial = v->partial + CLOTH_PCG_PARTIALS * (first / CLOTH_CHUNK);
  terms[0] = terms[1] = 0;
  if (there) {
    cloth_v3 z = cloth_pcg_z(k, v, r);
    cloth_v3_store(v->z, k, z);
    terms[0] = cloth_v3_dot(r, z), terms[1] = cloth_v3_dot(r, r);
  }
  cloth_block_chunk_sums(terms, shared);
  if (!v->coarse) return;
  cloth_real total[3] = {r.x, r.y, r.z};
  cloth_block_chunk_sums(total, shared);
  for (int f = 0; f < 3 && writes; f++) partial[2 + f] = total[f];
}

/// The same with all sums written.
static __device__ __forceinline__ void cloth_block_z(const cloth_pcg_vectors *v, int first, int k,
                                                     bool there, cloth_v3 r, cloth_real *shared)
{
  cloth_real terms[2], *partial = v->partial + CLOTH_PCG_PARTIALS * (first / CLOTH_CHUNK);
  cloth_block_z_sums(v, first, k, there, r, terms, shared);
  if (threadIdx.x % CLOTH_CHUNK == 0 && there) partial[0] = terms[0], partial[1] = terms[1];
}

/// Sum of three numbers over `Lanes` neighbouring threads, on the first of them.
template <int Lanes> static __device__ __forceinline__ cloth_v3 cloth_lanes_v3(cloth_v3 v)
{
  for (int width = Lanes / 2; width > 0; width /= 2) {
    v.x += __shfl_down_sync(0xffffffffu, v.x, (unsigned)width, Lanes);
    v.y += __shfl_down_sync(0xffffffffu, v.y, (unsigned)width, Lanes);
    v.z += __shfl_down_sync(0xffffffffu, v.z, (unsigned)width, Lanes);
  }
  return v;
}

/// Sum of three numbers over a warp, on all lanes: to add a to b is to add b to a.
static __device__ __forceinline__ cloth_v3 cloth_warp_v3(cloth_v3 v)
{
  for (int width = CLOTH_WARP / 2; width > 0; width /= 2) {
    v.x += __shfl_xor_sync(0xffffffffu, v.x, width);
    v.y += __shfl_xor_sync(0xffffffffu, v.y, width);
    v.z += __shfl_xor_sync(0xffffffffu, v.z, width);
  }
  return v;
}

/// Nodes [begin, begin + Group) from their sums, which are on the first of Lanes threads each, by a
/// block of Lanes x Group threads. Their share of r'z on the first thread. shared [Group]. Every
/// thread of the block must come here.
template <int Lanes, int Group>
static __device__ __forceinline__ cloth_real cloth_block_hats_set(const cloth_hats *h,
                                                                  cloth_v3 rest, int begin, int end,
                                                                  cloth_real *shared)
{
  int node = (int)threadIdx.x / Lanes, lane = (int)threadIdx.x % Lanes, c = begin + node;
  __syncthreads(); // `shared` may still be read from the last time
  if (lane == 0) shared[node] = c < end ? cloth_hat_rest_set(h, c, rest) : 0;
  __syncthreads();
  cloth_real sum = threadIdx.x < Group ? shared[threadIdx.x] : 0;
  if (threadIdx.x < CLOTH_WARP)
    for (int width = Group / 2; width > 0; width /= 2)
      sum += __shfl_down_sync(0xffffffffu, sum, (unsigned)width, Group);
  return sum;
}

/// The same from what they sum: cloth_hat_rest_group().
template <int Lanes, int Group>
static __device__ __forceinline__ cloth_real cloth_block_hats(const cloth_hats *h,
                                                              const cloth_real *from, int begin,
                                                              int end, cloth_real *shared)
{
  int c = begin + (int)threadIdx.x / Lanes;
  cloth_v3 rest = cloth_v3_make(0, 0, 0);
  if (c < end) rest = cloth_hat_rest_lane(h, from, c, (int)threadIdx.x % Lanes, Lanes);
  return cloth_block_hats_set<Lanes, Group>(h, cloth_lanes_v3<Lanes>(rest), begin, end, shared);
}

/// Group i of the first level. Its share of r'z on the first thread.
static __device__ __forceinline__ cloth_real cloth_block_hat_rest(const cloth_hat_rest_args *a,
                                                                  int i, cloth_real *shared)
{
  int begin = i * CLOTH_HAT_FINE_GROUP, end = begin + CLOTH_HAT_FINE_GROUP;
  if (end > a->hats.fine) end = a->hats.fine;
  return cloth_block_hats<CLOTH_HAT_FINE_LANES, CLOTH_HAT_FINE_GROUP>(&a->hats, a->r, begin, end,
                                                                      shared);
}

// CLOTH_PCG_LANES numbers by one warp: lane l has numbers l, l + 32, ... Every warp that does it
// has the sum on all lanes, and none waits for another.
enum { CLOTH_LANES_EACH = CLOTH_PCG_LANES / CLOTH_WARP };

/// number(l) for each l of the lane.
template <typename Number>
static __device__ __forceinline__ void cloth_warp_lanes(cloth_real (&v)[CLOTH_LANES_EACH],
                                                        Number number)
{
#pragma unroll
  for (int k = 0; k < CLOTH_LANES_EACH; k++)
    v[k] = number((int)threadIdx.x % CLOTH_WARP + k * CLOTH_WARP);
}

/// Their sum along the tree of cloth_chunks_sum(). v is overwritten.
static __device__ __forceinline__ cloth_real cloth_warp_lanes_sum(cloth_real (&v)[CLOTH_LANES_EACH])
{
#pragma unroll
  for (int width = CLOTH_LANES_EACH / 2; width > 0; width /= 2)
    for (int k = 0; k < width; k++) v[k] += v[k + width];
  for (int width = CLOTH_WARP / 2; width > 0; width /= 2)
    v[0] += __shfl_xor_sync(0xffffffffu, v[0], width);
  return v[0];
}

/// The sums of F numbers of each thread of a block of CLOTH_PCG_LANES along that tree, on all
/// threads. shared [F x CLOTH_PCG_LANES], which nobody reads any more. Every thread of the block
/// must come here.
template <int F>
static __device__ __forceinline__ void cloth_block_lanes_sums(cloth_real (&sum)[F],
                                                              cloth_real *shared)
{
  for (int f = 0; f < F; f++) shared[f * CLOTH_PCG_LANES + (int)threadIdx.x] = sum[f];
  __syncthreads();
  for (int f = 0; f < F; f++) {
    cloth_real v[CLOTH_LANES_EACH];
    cloth_warp_lanes(v, [&](int l) { return shared[f * CLOTH_PCG_LANES + l]; });
    sum[f] = cloth_warp_lanes_sum(v);
  }
}

static_assert((int)CLOTH_HAT_WIDE_LANES == (int)CLOTH_PCG_LANES, "lanes are a block's threads");

enum { CLOTH_HAT_SHARED = 3 * CLOTH_PCG_LANES }; // numbers of cloth_block_hat_upper()

/// Group i of the other levels, likewise. shared [CLOTH_HAT_SHARED]. Every thread of a block of
/// CLOTH_PCG_LANES must come here.
static __device__ __forceinline__ cloth_real cloth_block_hat_upper(const cloth_hat_rest_args *a,
                                                                   int i, cloth_real *shared)
{
  const cloth_hats *h = &a->hats;
  int narrow = cloth_hat_narrow_groups(h);
  if (i < narrow) {
    int begin = h->fine + i * CLOTH_HAT_GROUP, end = begin + CLOTH_HAT_GROUP;
    if (end > h->wide) end = h->wide;
    return cloth_block_hats<CLOTH_HAT_LANES, CLOTH_HAT_GROUP>(h, h->rest, begin, end, shared);
  }
  int c = h->wide + i - narrow;
  cloth_v3 mine = cloth_hat_rest_lane(h, h->rest, c, (int)threadIdx.x, CLOTH_HAT_WIDE_LANES);
  cloth_real rest[3] = {mine.x, mine.y, mine.z};
  __syncthreads(); // `shared` may still be read from the last time
  cloth_block_lanes_sums(rest, shared);
  if (threadIdx.x > 0) return 0;
  return cloth_hat_rest_set(h, c, cloth_v3_make(rest[0], rest[1], rest[2]));
}

/// cloth_partial_sum() of fields 0 .. F - 1 by a block of CLOTH_PCG_LANES threads, on all of them.
/// shared as above.
template <int F>
static __device__ __forceinline__ void
cloth_block_partial_sums(const cloth_real *partial, int chunks, int more, cloth_real (&sum)[F],
                         cloth_real *shared)
{
  int terms = cloth_chunk_groups(chunks) + more;
  for (int f = 0; f < F; f++) sum[f] = 0;
#pragma unroll 4
  for (int e = (int)threadIdx.x; e < terms; e += CLOTH_PCG_LANES)
    for (int f = 0; f < F; f++)
      sum[f] += cloth_sum_term(partial + f, chunks, CLOTH_PCG_PARTIALS, e);
  cloth_block_lanes_sums(sum, shared);
}
