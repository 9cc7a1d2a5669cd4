// A whole linear solve as one kernel: every step is a loop over chunks by all blocks, with a
// barrier behind it, so an iteration has no launch, no read and no scalar kernel. Sums over all
// chunks are added up by each block for itself (group_sums.cuh). Small cloths go to solve_small.cu.
#include "barrier.cuh"
#include "contact_pull.cuh"
#include "group_sums.cuh"
#include "launch.h"
#include "pcg_solve.h"
#include "reduce.cuh"
#include "stopwatch.cuh"

namespace {

// four blocks on a multiprocessor: six need 40 registers a thread and were 3 % slower on an H100
enum {
  RESIDENT = 4,
  SPARSE = 2, // blocks on a multiprocessor for scenes that have no more: registers to load ahead
  THREADS = CLOTH_PCG_LANES,
  CHUNKS = THREADS / CLOTH_CHUNK,
  WARPS = THREADS / CLOTH_WARP
};

// What a block keeps: room for sums, and the scalars as it knows them. What it reads of them is
// the same on every block.
struct shared_room {
  cloth_real upper[CHUNKS * CLOTH_CHUNK_SHARED], lanes[CLOTH_HAT_SHARED];
  cloth_tile_room tiles;
  cloth_real scalar[CLOTH_PCG_SCALARS];
  cloth_pull_room pulls[WARPS];
};

// tiles of the part: see group_sums.cuh
__device__ int tiles_of(const cloth_pcg_solve_args &a)
{
  return (a.v.count + THREADS - 1) / THREADS;
}

// the term of group k of a tile; -1: it is not there
__device__ int term_of(const cloth_pcg_solve_args &a, int tile, int k)
{
  int i = tile * CHUNKS / cloth_chunk_group(a.v.chunks) + k + cloth_own_groups_begin(&a.v);
  return i < cloth_own_groups_end(&a.v) ? i : -1;
}

// r = row(k) for each vertex k of the part, then z and the terms of r'z and r'r
template <typename Row>
__device__ void for_levels(const cloth_pcg_solve_args &a, shared_room *room, Row row)
{
  cloth_for_tiles<2>(
      tiles_of(a), cloth_chunk_group(a.v.chunks), room->tiles,
      [&](int tile, cloth_real(&sum)[2]) {
        int k = a.v.first + tile * THREADS + (int)threadIdx.x;
        cloth_v3 r = cloth_v3_make(0, 0, 0);
        bool there = k < a.v.first + a.v.count;
        if (there) r = row(k);
        cloth_block_z_sums(&a.v, k - (int)threadIdx.x % CLOTH_CHUNK, k, there, r, sum, room->upper);
      },
      [&](int tile, int k, const cloth_real(&sum)[2]) {
        int i = term_of(a, tile, k);
        if (i >= 0) a.terms.rz[i] = sum[0], a.terms.rr[i] = sum[1];
      });
}

// how a row is multiplied: from memory, a few slots at a time
struct rows_in_memory {
  __device__ explicit rows_in_memory(const cloth_pcg_solve_args &) {}
  __device__ cloth_v3 product(const cloth_pcg_solve_args &a, int row)
  {
    return cloth_block_row_product(&a.product.rows, row, a.product.x);
  }
};

// more slots at a time
struct rows_ahead {
  __device__ explicit rows_ahead(const cloth_pcg_solve_args &) {}
  __device__ cloth_v3 product(const cloth_pcg_solve_args &a, int row)
  {
    const cloth_block_rows *r = &a.product.rows;
    int group = row / CLOTH_ROW_GROUP;
    return cloth_block_slots_product_ahead(r, row % CLOTH_ROW_GROUP, r->first[group],
                                           r->first[group + 1], a.product.x,
                                           cloth_v3_make(0, 0, 0));
  }
};

// q = A x and the terms of x'q. pulls: of the contacts, NULL: there are none.
template <typename Rows>
__device__ void for_rows(const cloth_pcg_solve_args &a, Rows &rows, const cloth_pull *pulls,
                         shared_room *room)
{
  cloth_for_tiles<1>(
      tiles_of(a), cloth_chunk_group(a.v.chunks), room->tiles,
      [&](int tile, cloth_real(&sum)[1]) {
        int row = tile * THREADS + (int)threadIdx.x;
        cloth_v3 q = cloth_v3_make(0, 0, 0);
        bool there = row < a.v.count;
        if (there) q = rows.product(a, row);
        if (pulls)
          q = cloth_contact_rows_add(a, pulls, row, there, q,
                                     room->pulls[threadIdx.x / CLOTH_WARP]);
        if (there) sum[0] = cloth_pcg_product_set(row, &a.product, q);
        cloth_block_chunk_sums(sum, room->upper);
      },
      [&](int tile, int k, const cloth_real(&sum)[1]) {
        int i = term_of(a, tile, k);
        if (i >= 0) a.terms.pq[i] = sum[0];
      });
}

// after r, z and their terms: coarse correction, beta, direction
template <typename Barrier>
__device__ void turn(const cloth_pcg_solve_args &a, Barrier &g, int start, shared_room *room)
{
  int warp = (int)threadIdx.x / CLOTH_WARP, lane = (int)threadIdx.x % CLOTH_WARP;
  if (a.v.coarse) { // a warp for each number, by all blocks
    int n = 3 * a.v.aggregates, first = (int)blockIdx.x * WARPS + warp,
        stride = (int)gridDim.x * WARPS;
    g.sync();
    for (int k = first; k < n; k += stride) {
      cloth_real sum = cloth_warp_sum(cloth_coarse_rest_lane(&a.rest, k / 3, k % 3, lane));
      if (lane == 0) a.rest.rest[k] = sum;
    }
    g.sync();
    for (int i = first; i < n; i += stride) {
      cloth_real sum = cloth_warp_sum(cloth_coarse_lane(&a.coarse, i, lane));
      if (lane == 0) a.coarse.coarse[i] = *a.coarse.usable > 0 ? sum : 0;
    }
  }
  const cloth_hats *h = &a.v.hats;
  if (h->nodes > 0) { // the first level from r, the others from the first
    cloth_real *fine = a.terms.rz + cloth_chunk_groups(a.v.chunks);
    cloth_real *upper = fine + cloth_hat_fine_groups(h);
    g.sync();
    for (int i = (int)blockIdx.x; i < cloth_hat_fine_groups(h); i += (int)gridDim.x) {
      cloth_real rz = cloth_block_hat_rest(&a.hats, i, room->lanes);
      if (threadIdx.x == 0) fine[i] = rz;
    }
    g.sync();
    for (int i = (int)blockIdx.x; i < cloth_hat_groups(h); i += (int)gridDim.x) {
      cloth_real rz = cloth_block_hat_upper(&a.hats, i, room->lanes);
      if (threadIdx.x == 0) upper[i] = rz;
    }
  }
  cloth_beta_sums sums(a, a.v.coarse || h->nodes > 0);
  sums.add_early(a.terms);
  g.sync();
  sums.add_rest(a.terms);
  cloth_block_beta(a, start, sums, room->scalar, room->lanes);
  if (room->scalar[CLOTH_PCG_DONE] > 0) return;
  for (int i = (int)(blockIdx.x * blockDim.x + threadIdx.x); i < h->fine;
       i += (int)(gridDim.x * blockDim.x))
    cloth_hat_spread_node(i, h);
  if (h->nodes > 0) g.sync();
  cloth_real beta = room->scalar[CLOTH_PCG_BETA];
  int end = a.v.first + a.v.count, stride = (int)(gridDim.x * blockDim.x);
  for (int k = a.v.first + (int)(blockIdx.x * blockDim.x + threadIdx.x); k < end; k += stride)
    cloth_pcg_direction_row(k, &a.v, beta, cloth_pcg_coarse_of(k, &a.v));
  g.sync();
}

template <typename Barrier, typename Rows>
__device__ void product(const cloth_pcg_solve_args &a, int contacts, Barrier &g, Rows &rows,
                        shared_room *room)
{
  int stride = (int)(gridDim.x * blockDim.x);
  auto *pulls = reinterpret_cast<cloth_pull *>(a.contact.q);
  for (int i = (int)(blockIdx.x * blockDim.x + threadIdx.x); i < contacts; i += stride)
    cloth_contact_pull_write(i, &a.contact, pulls);
  if (contacts > 0) g.sync();
  for_rows(a, rows, contacts > 0 ? pulls : nullptr, room);
  g.sync();
  cloth_block_alpha(a, room->scalar, room->lanes);
}

template <typename Rows, typename Barrier>
__device__ void solve(const cloth_pcg_solve_args &a, Barrier g)
{
  __shared__ shared_room room;
  Rows rows(a);
  int contacts = cloth_pcg_contacts(&a);
  cloth_stopwatch products(a.product_ns);
  if (threadIdx.x < CLOTH_PCG_SCALARS) room.scalar[threadIdx.x] = a.v.scalar[threadIdx.x];
  for_levels(a, &room, [&](int k) { return cloth_pcg_start_row(k, &a.v); });
  turn(a, g, 1, &room);
  for (int n = 0; n < a.iterations_max && !(room.scalar[CLOTH_PCG_DONE] > 0); n++) {
    products.start();
    product(a, contacts, g, rows, &room);
    products.stop();
    if (room.scalar[CLOTH_PCG_DONE] > 0) break;
    cloth_real alpha = room.scalar[CLOTH_PCG_ALPHA];
    for_levels(a, &room, [&](int k) { return cloth_pcg_update_row(k, &a.v, alpha); });
    turn(a, g, 0, &room);
  }
  __syncthreads();
  // every block has read them: all have met since
  if (blockIdx.x == 0 && threadIdx.x < CLOTH_PCG_SCALARS)
    a.v.scalar[threadIdx.x] = room.scalar[threadIdx.x];
}

__global__ void __launch_bounds__(THREADS, RESIDENT)
    solve_by_grid(const __grid_constant__ cloth_pcg_solve_args a, cloth_barrier_state *state)
{
  solve<rows_in_memory>(a, cloth_grid_barrier(state));
}

__global__ void __launch_bounds__(THREADS, SPARSE)
    solve_by_sparse_grid(const __grid_constant__ cloth_pcg_solve_args a, cloth_barrier_state *state)
{
  solve<rows_ahead>(a, cloth_grid_barrier(state));
}

} // namespace

cloth_status cloth_cuda_solve(cloth_device *d, const cloth_pcg_solve_args *args, bool *finished,
                              cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  CLOTH_TRY(cloth_cuda_solve_small(d, args, finished, err));
  if (*finished) return CLOTH_OK;
  if (d->solve_blocks == 0) {
    int each = 0;
    CUDA_TRY(err, cudaOccupancyMaxActiveBlocksPerMultiprocessor(&each, solve_by_grid, THREADS, 0));
    d->solve_blocks = each * d->multiprocessors;
  }
  cudaStream_t stream = d->stream[CLOTH_COMPUTE];
  int wanted = (args->v.count + THREADS - 1) / THREADS;
  if ((args->contacts + THREADS - 1) / THREADS > wanted)
    wanted = (args->contacts + THREADS - 1) / THREADS;
  int blocks = wanted < d->solve_blocks ? wanted : d->solve_blocks;
  void *state = nullptr;
  CLOTH_TRY(cloth_cuda_scratch(d, sizeof(cloth_barrier_state), &state, err));
  CUDA_TRY(err, cudaMemsetAsync(state, 0, sizeof(cloth_barrier_state), stream));
  void *parameters[] = {const_cast<cloth_pcg_solve_args *>(args), &state};
  auto *kernel = blocks <= SPARSE * d->multiprocessors ? solve_by_sparse_grid : solve_by_grid;
  CUDA_TRY(err, cudaLaunchCooperativeKernel(reinterpret_cast<const void *>(kernel),
                                            dim3((unsigned)blocks), dim3(THREADS), parameters, 0,
                                            stream));
  return CLOTH_OK;
}
