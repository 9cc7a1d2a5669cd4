// A whole linear solve as one kernel: every step is a loop over chunks by all blocks, with a
// barrier behind it, so an iteration has no launch, no read and no scalar kernel. Chunk sums are
// added up by each block for itself; where they are many, by the block that comes last to the
// barrier before it lets the others go. Small cloths go to solve_small.cu.
#include "contact_pull.cuh"
#include "launch.h"
#include "pcg_solve.h"
#include "reduce.cuh"
#include "stopwatch.cuh"
#include "together.cuh"

namespace {

// four blocks on a multiprocessor: six need 40 registers a thread and were 3 % slower on an H100
enum {
  RESIDENT = 4,
  SPARSE = 2, // blocks on a multiprocessor for scenes that have no more: registers to load ahead
  FEW_SUMS = 4 * CLOTH_PCG_LANES, // that each block adds up for itself
  THREADS = CLOTH_PCG_LANES,
  CHUNKS = THREADS / CLOTH_CHUNK,
  WARPS = THREADS / CLOTH_WARP
};

// What a block keeps: room for sums, and the scalars as it knows them. What it reads of them is
// the same on every block.
struct shared_room {
  cloth_real upper[CHUNKS * CLOTH_CHUNK_SHARED], lanes[CLOTH_PCG_LANES / 2];
  cloth_real scalar[CLOTH_PCG_SCALARS];
  cloth_pull_room pulls[WARPS];
};

// r = row(k) for each vertex k of the part, then z and the partial sums of each chunk
template <typename Row>
__device__ void for_levels(const cloth_pcg_solve_args &a, cloth_real *upper, Row row)
{
  int chunks = (a.v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK, lane = (int)threadIdx.x % CLOTH_CHUNK;
  for (int c = (int)blockIdx.x * CHUNKS; c < chunks; c += (int)gridDim.x * CHUNKS) {
    int k = a.v.first + (c + (int)threadIdx.x / CLOTH_CHUNK) * CLOTH_CHUNK + lane;
    cloth_v3 r = cloth_v3_make(0, 0, 0);
    bool there = k < a.v.first + a.v.count;
    if (there) r = row(k);
    cloth_block_z(&a.v, k - lane, k, there, r, upper);
  }
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

// q = A x and the partial sums x'q of each chunk. pulls: of the contacts, NULL: there are none.
template <typename Rows>
__device__ void for_rows(const cloth_pcg_solve_args &a, Rows &rows, const cloth_pull *pulls,
                         shared_room *room)
{
  int chunks = (a.v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK, lane = (int)threadIdx.x % CLOTH_CHUNK;
  for (int c = (int)blockIdx.x * CHUNKS; c < chunks; c += (int)gridDim.x * CHUNKS) {
    int i = c + (int)threadIdx.x / CLOTH_CHUNK, row = i * CLOTH_CHUNK + lane;
    cloth_real sum[1] = {};
    cloth_v3 q = cloth_v3_make(0, 0, 0);
    bool there = row < a.v.count;
    if (there) q = rows.product(a, row);
    if (pulls)
      q = cloth_contact_rows_add(a, pulls, row, there, q, room->pulls[threadIdx.x / CLOTH_WARP]);
    if (there) sum[0] = cloth_pcg_product_set(row, &a.product, q);
    cloth_block_chunk_sums(sum, room->upper);
    if (lane == 0 && i < chunks)
      a.more_partial[CLOTH_PCG_PARTIALS * (a.v.first / CLOTH_CHUNK + i)] = sum[0];
  }
}

// A barrier, and set(scalar) by one thread of each block, or of the last one where there are many
// sums. `set` is called by whole blocks.
template <typename Together, typename Set>
__device__ void meet(const cloth_pcg_solve_args &a, Together &g, shared_room *room, Set set)
{
  if (a.beta.sums <= FEW_SUMS) {
    g.sync();
    set(room->scalar);
  } else {
    g.sync([&] { set(a.v.scalar); });
    if (threadIdx.x < CLOTH_PCG_SCALARS) room->scalar[threadIdx.x] = a.v.scalar[threadIdx.x];
  }
  __syncthreads();
}

__device__ void beta_of(const cloth_pcg_solve_args &a, int start, cloth_real *lanes,
                        cloth_real *scalar)
{
  cloth_real sums[2];
  cloth_block_partial_sums(a.beta.partial, a.beta.sums, sums, lanes);
  cloth_real rz = sums[0], rr = sums[1];
  if (a.v.coarse && threadIdx.x < CLOTH_WARP) rz += cloth_warp_coarse_rz(a.beta);
  if (threadIdx.x > 0) return;
  cloth_pcg_beta_args beta = a.beta;
  beta.start = start, beta.scalar = scalar;
  cloth_pcg_beta_set(&beta, rz, rr);
}

// after r, z and their sums: coarse correction, beta, direction
template <typename Together>
__device__ void turn(const cloth_pcg_solve_args &a, Together &g, int start, shared_room *room)
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
    g.sync();
    for (int i = (int)blockIdx.x; i < cloth_hat_fine_groups(h); i += (int)gridDim.x)
      cloth_block_hat_rest(&a.hats, i, room->lanes);
    g.sync();
    for (int i = (int)blockIdx.x; i < cloth_hat_groups(h); i += (int)gridDim.x)
      cloth_block_hat_upper(&a.hats, i, room->lanes);
  }
  meet(a, g, room, [&](cloth_real *scalar) { beta_of(a, start, room->lanes, scalar); });
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

template <typename Together, typename Rows>
__device__ void product(const cloth_pcg_solve_args &a, int contacts, Together &g, Rows &rows,
                        shared_room *room)
{
  int stride = (int)(gridDim.x * blockDim.x);
  auto *pulls = reinterpret_cast<cloth_pull *>(a.contact.q);
  for (int i = (int)(blockIdx.x * blockDim.x + threadIdx.x); i < contacts; i += stride)
    cloth_contact_pull_write(i, &a.contact, pulls);
  if (contacts > 0) g.sync();
  for_rows(a, rows, contacts > 0 ? pulls : nullptr, room);
  meet(a, g, room, [&](cloth_real *scalar) {
    cloth_real pq[1];
    cloth_block_partial_sums(a.more_partial, a.v.chunks, pq, room->lanes);
    if (threadIdx.x == 0) cloth_pcg_alpha_set(scalar, pq[0]);
  });
}

template <typename Rows, typename Together>
__device__ void solve(const cloth_pcg_solve_args &a, Together g)
{
  __shared__ shared_room room;
  Rows rows(a);
  int contacts = cloth_pcg_contacts(&a);
  cloth_stopwatch products(a.product_ns);
  if (threadIdx.x < CLOTH_PCG_SCALARS) room.scalar[threadIdx.x] = a.v.scalar[threadIdx.x];
  for_levels(a, room.upper, [&](int k) { return cloth_pcg_start_row(k, &a.v); });
  turn(a, g, 1, &room);
  for (int n = 0; n < a.iterations_max && !(room.scalar[CLOTH_PCG_DONE] > 0); n++) {
    products.start();
    product(a, contacts, g, rows, &room);
    products.stop();
    if (room.scalar[CLOTH_PCG_DONE] > 0) break;
    cloth_real alpha = room.scalar[CLOTH_PCG_ALPHA];
    for_levels(a, room.upper, [&](int k) { return cloth_pcg_update_row(k, &a.v, alpha); });
    turn(a, g, 0, &room);
  }
  __syncthreads();
  // every block has read them: all have met since
  if (blockIdx.x == 0 && threadIdx.x < CLOTH_PCG_SCALARS)
    a.v.scalar[threadIdx.x] = room.scalar[threadIdx.x];
}

__global__ void __launch_bounds__(THREADS, RESIDENT)
    solve_by_grid(const __grid_constant__ cloth_pcg_solve_args a, cloth_together_state *state)
{
  solve<rows_in_memory>(a, cloth_together_grid(state));
}

__global__ void __launch_bounds__(THREADS, SPARSE)
    solve_by_sparse_grid(const __grid_constant__ cloth_pcg_solve_args a,
                         cloth_together_state *state)
{
  solve<rows_ahead>(a, cloth_together_grid(state));
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
  CLOTH_TRY(cloth_cuda_scratch(d, sizeof(cloth_together_state), &state, err));
  CUDA_TRY(err, cudaMemsetAsync(state, 0, sizeof(cloth_together_state), stream));
  void *parameters[] = {const_cast<cloth_pcg_solve_args *>(args), &state};
  auto *kernel = blocks <= SPARSE * d->multiprocessors ? solve_by_sparse_grid : solve_by_grid;
  CUDA_TRY(err, cudaLaunchCooperativeKernel(reinterpret_cast<const void *>(kernel),
                                            dim3((unsigned)blocks), dim3(THREADS), parameters, 0,
                                            stream));
  return CLOTH_OK;
}
