// What a block of the small solve keeps in its shared memory (solve_small.cu).
#pragma once

#include "kept_row.cuh"
#include "pcg_solve.h"
#include "reduce.cuh"

namespace {

enum {
  THREADS = CLOTH_PCG_LANES,
  CHUNKS = THREADS / CLOTH_CHUNK, // of a block at most
  WARPS = THREADS / CLOTH_WARP,
  BLOCKS = 16, // of a cluster at most
  // of a row in registers: a vertex of a regular mesh with hinges has 13
  KEPT_SLOTS = sizeof(cloth_real) == 4 ? 14 : 5,
  KEPT_CHILDREN = 8, // of a lane's share of a node of the first level
  NODES_AT_ONCE = 4, // upper nodes of a warp
  COPIED_AT_ONCE = 3 // by a thread
};

// Its rows, and the first level's group of nodes that it sums. Physics finds them by the indices of
// the whole, in arrays that are taken to begin that much earlier.
struct own_room {
  cloth_real dx[3 * THREADS], r[3 * THREADS], z[3 * THREADS], p[3 * THREADS], q[3 * THREADS];
  cloth_real inverse_diagonal[6 * THREADS], free[THREADS], weight[CLOTH_HAT_CORNERS * THREADS];
  int corner[CLOTH_HAT_CORNERS * THREADS];
  cloth_real node_inverse[6 * CLOTH_HAT_FINE_GROUP];
  cloth_kept_node<KEPT_CHILDREN, THREADS> node;
  cloth_real upper[CHUNKS * CLOTH_CHUNK_SHARED], shares[CLOTH_HAT_FINE_GROUP];
  cloth_real coarse_rest[3 * CLOTH_AGGREGATES_MAX];
};

// Behind it, of every block the same: numbers of all nodes, and what the upper ones read.
struct hats_room {
  cloth_real *rest, *correction;           // [nodes x 3]
  cloth_real *inverse;                     // [upper nodes x 6]
  cloth_real *share;                       // [whole groups of upper nodes] of r'z
  cloth_real *child_weight, *upper_weight; // [fine x uppers]
  int *first, *child, *upper;              // [upper nodes + 1], [fine x uppers] twice
};

__host__ __device__ int upper_shares(const cloth_hats *h)
{
  return cloth_hat_groups(h) * CLOTH_HAT_GROUP;
}

__host__ __device__ size_t room_bytes(const cloth_hats *h)
{
  size_t uppers = (size_t)(h->nodes - h->fine), shared = (size_t)h->fine * (size_t)h->uppers;
  if (h->nodes == 0) return sizeof(own_room);
  return sizeof(own_room) +
         sizeof(cloth_real) *
             (6 * (size_t)h->nodes + 6 * uppers + (size_t)upper_shares(h) + 2 * shared) +
         sizeof(int) * (uppers + 1 + 2 * shared);
}

__device__ hats_room hats_room_at(char *memory, const cloth_hats *h)
{
  int uppers = h->nodes - h->fine, shared = h->fine * h->uppers;
  hats_room room;
  room.rest = reinterpret_cast<cloth_real *>(memory);
  room.correction = room.rest + 3 * h->nodes;
  room.inverse = room.correction + 3 * h->nodes;
  room.share = room.inverse + 6 * uppers;
  room.child_weight = room.share + upper_shares(h);
  room.upper_weight = room.child_weight + shared;
  room.first = reinterpret_cast<int *>(room.upper_weight + shared);
  room.child = room.first + uppers + 1;
  room.upper = room.child + shared;
  return room;
}

template <typename T> __device__ void copy_in(T *to, const T *from, int count)
{
  for (int k = (int)threadIdx.x; k < count; k += THREADS) to[k] = from[k];
}

// two arrays, with all loads of a round under way before the first is waited for
__device__ void copy_in(cloth_real *to, const cloth_real *from, cloth_real *to_too,
                        const cloth_real *from_too, int count)
{
  for (int first = (int)threadIdx.x; first < count; first += COPIED_AT_ONCE * THREADS) {
    cloth_real v[COPIED_AT_ONCE], w[COPIED_AT_ONCE];
#pragma unroll
    for (int n = 0; n < COPIED_AT_ONCE; n++) {
      int k = first + n * THREADS < count ? first + n * THREADS : first;
      v[n] = from[k], w[n] = from_too[k];
    }
#pragma unroll
    for (int n = 0; n < COPIED_AT_ONCE; n++) {
      int k = first + n * THREADS;
      if (k < count) to[k] = v[n], to_too[k] = w[n];
    }
  }
}

} // namespace
