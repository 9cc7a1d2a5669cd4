// Contacts of cloth with cloth in a product of the large solve, so that memory is asked for whole
// pieces: what a contact pulls with is written in one piece, side by side with the next one's, and
// a warp reads what its 32 rows are to add together, into shared memory. (Four shares of a contact
// written where each row reads them, contact_product.h, are twelve scattered numbers; a thread that
// reads its row's alone asks for as many sectors as it has numbers. Together they took 126 of 268
// us of an iteration on an H100, 440,000 contacts on 277,000 rows.) The bits are those of
// contact_product.h and pcg_product.h.
#pragma once

#include "chunk.h"
#include "pcg_solve.h"
#include "reduce.cuh"

/// What a contact pulls with at a weight of one, and its weights: a sector in float.
struct __align__(16) cloth_pull { cloth_real x, y, z, none, weight[4]; };

static_assert(sizeof(cloth_pull) <= 12 * sizeof(cloth_real), "a contact's place in contact_q");

enum { CLOTH_PULL_TILE = 128 }; // entries of a warp's rows at a time

/// A warp's room: x y z of each entry.
typedef cloth_real cloth_pull_room[3 * CLOTH_PULL_TILE];

template <typename T, int N> struct __align__(N * sizeof(T) < 16 ? N * sizeof(T) : 16) cloth_piece
{
  T at[N];
};

/// N numbers as one load or two; `from` is aligned to them, or to 16 bytes.
template <int N, typename T>
static __device__ __forceinline__ cloth_piece<T, N> cloth_piece_of(const T *from)
{
  return *reinterpret_cast<const cloth_piece<T, N> *>(from);
}

/// Contact i: its pull into pulls[i]; zeros for one that lies in the matrix.
static __device__ __forceinline__ void
cloth_contact_pull_write(int i, const cloth_contact_product_args *a, cloth_pull *pulls)
{
  cloth_piece<int, 4> vertex = cloth_piece_of<4>(a->vertex + 4 * (int64_t)i);
  cloth_piece<cloth_real, 4> weight = cloth_piece_of<4>(a->weight + 4 * (int64_t)i);
  cloth_piece<cloth_real, 2> t[3];
  for (int k = 0; k < 3; k++) t[k] = cloth_piece_of<2>(a->tangent + 6 * (int64_t)i + 2 * k);
  cloth_sym3 tangent = {t[0].at[0], t[0].at[1], t[1].at[0], t[1].at[1], t[2].at[0], t[2].at[1]};
  cloth_v3 u = cloth_v3_make(0, 0, 0);
  if (cloth_contact_is_factored(vertex.at, a->body_first))
    u = cloth_contact_pull_of(a, vertex.at, weight.at, tangent);
  cloth_pull pull = {u.x, u.y, u.z, 0, {weight.at[0], weight.at[1], weight.at[2], weight.at[3]}};
  pulls[i] = pull;
}

/// q of a row from its mesh part, with what its contacts add in their order. All threads of a warp
/// come here with neighbouring rows; `there`: has the thread one? They are the warp's first.
static __device__ __forceinline__ cloth_v3 cloth_contact_rows_add(const cloth_pcg_solve_args &a,
                                                                  const cloth_pull *pulls, int row,
                                                                  bool there, cloth_v3 q,
                                                                  cloth_real *room)
{
  int lane = (int)threadIdx.x % CLOTH_WARP, rows = __popc(__ballot_sync(0xffffffffu, there));
  if (rows == 0) return q;
  uint32_t begin = there ? a.product.contact_first[2 * row + 1] : 0;
  uint32_t end = there ? a.product.contact_first[2 * row + 2] : 0;
  uint32_t from = __shfl_sync(0xffffffffu, begin, 0), to = __shfl_sync(0xffffffffu, end, rows - 1);
  for (uint32_t tile = from; tile < to; tile += CLOTH_PULL_TILE) {
#pragma unroll
    for (int k = lane; k < CLOTH_PULL_TILE; k += CLOTH_WARP) {
      uint32_t n = tile + (uint32_t)k;
      uint32_t e = a.contact.entry[n < to ? n : from];
      cloth_piece<cloth_real, 4> u = cloth_piece_of<4>(&pulls[e / 4].x);
      cloth_real weight = pulls[e / 4].weight[e % 4];
      for (int c = 0; c < 3; c++) room[3 * k + c] = weight * u.at[c];
    }
    __syncwarp();
    uint32_t stop = end < tile + CLOTH_PULL_TILE ? end : tile + CLOTH_PULL_TILE;
    for (uint32_t n = begin > tile ? begin : tile; n < stop; n++)
      q = cloth_v3_add(q, cloth_v3_load(room, (int)(n - tile)));
    __syncwarp(); // it may be overwritten
  }
  return q;
}
