// A whole linear solve as one cooperative kernel: every step is a loop over chunks by all blocks,
// with a barrier behind it. The block that comes last to a barrier adds the chunk sums up and sets
// the scalars before it lets the others go, so an iteration has no launch, no read and no scalar
// kernel.
#include "launch.h"
#include "pcg_solve.h"
#include "reduce.cuh"

namespace {

// four blocks on a multiprocessor: six need 40 registers a thread and were 3 % slower on an H100
enum {
  RESIDENT = 4,
  THREADS = CLOTH_PCG_LANES,
  CHUNKS = THREADS / CLOTH_CHUNK,
  WARPS = THREADS / CLOTH_WARP
};

struct grid_state { // in device memory, zero before the launch
  unsigned arrived, passed;
};

struct grid {
  grid_state *state;
  unsigned barriers; // passed by this block
};

// All blocks are resident (cooperative launch). What a block wrote before is seen by all after.
__device__ void barrier(grid &g)
{
  g.barriers++;
  __syncthreads();
  if (threadIdx.x == 0) {
    volatile unsigned *arrived = &g.state->arrived;
    __threadfence(); // of the whole block: the barrier above came first
    atomicAdd(&g.state->arrived, 1);
    while (*arrived < g.barriers * gridDim.x) {}
    __threadfence();
  }
  __syncthreads();
}

// The same, but `last` runs on the whole block that arrives last before any goes on.
template <typename Last> __device__ void barrier(grid &g, Last last)
{
  __shared__ int is_last;
  g.barriers++;
  __syncthreads();
  if (threadIdx.x == 0) {
    __threadfence();
    is_last = atomicAdd(&g.state->arrived, 1) == g.barriers * gridDim.x - 1;
    __threadfence();
  }
  __syncthreads();
  volatile unsigned *passed = &g.state->passed;
  if (is_last) {
    last();
    __syncthreads();
    if (threadIdx.x == 0) {
      __threadfence();
      *passed = g.barriers;
    }
  } else if (threadIdx.x == 0) {
    while (*passed < g.barriers) {}
    __threadfence();
  }
  __syncthreads();
}

// r = row(k) for each vertex k of the part, then z and the partial sums of each chunk
template <typename Row>
__device__ void for_levels(const cloth_pcg_solve_args &a, cloth_real *upper, Row row)
{
  int chunks = (a.v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK, lane = (int)threadIdx.x % CLOTH_CHUNK;
  for (int c = (int)blockIdx.x * CHUNKS; c < chunks; c += (int)gridDim.x * CHUNKS) {
    int i = c + (int)threadIdx.x / CLOTH_CHUNK, k = a.v.first + i * CLOTH_CHUNK + lane;
    cloth_real sum[CLOTH_PCG_PARTIALS],
        *partial = a.v.partial + CLOTH_PCG_PARTIALS * (k / CLOTH_CHUNK);
    cloth_v3 r = cloth_v3_make(0, 0, 0);
    bool there = k < a.v.first + a.v.count;
    if (there) r = row(k);
    cloth_block_z(&a.v, k, there, r, sum, upper);
    if (lane == 0 && i < chunks)
      for (int f = 0; f < CLOTH_PCG_PARTIALS; f++) partial[f] = sum[f];
  }
}

// q = A x and the partial sums x'q of each chunk
__device__ void for_rows(const cloth_pcg_solve_args &a, cloth_real *upper)
{
  int chunks = (a.v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK, lane = (int)threadIdx.x % CLOTH_CHUNK;
  for (int c = (int)blockIdx.x * CHUNKS; c < chunks; c += (int)gridDim.x * CHUNKS) {
    int i = c + (int)threadIdx.x / CLOTH_CHUNK, row = i * CLOTH_CHUNK + lane;
    cloth_real sum[1] = {};
    if (row < a.v.count)
      sum[0] = cloth_pcg_product_row(row, &a.product,
                                     cloth_block_row_product(&a.product.rows, row, a.product.x));
    cloth_block_chunk_sums(sum, upper);
    if (lane == 0 && i < chunks)
      a.v.partial[CLOTH_PCG_PARTIALS * (a.v.first / CLOTH_CHUNK + i)] = sum[0];
  }
}

__device__ void beta_of(const cloth_pcg_solve_args &a, int start, cloth_real *lanes)
{
  cloth_real sums[2];
  cloth_block_partial_sums(a.beta.partial, a.beta.chunks, sums, lanes);
  cloth_real rz = sums[0], rr = sums[1];
  if (a.v.coarse && threadIdx.x < CLOTH_WARP) { // cloth_coarse_rz() by a warp
    cloth_real sum = 0;
    for (int k = (int)threadIdx.x; k < 3 * a.v.aggregates; k += CLOTH_COARSE_LANES)
      sum += a.beta.rest[k] * a.beta.coarse[k];
    rz += cloth_warp_sum(sum);
  }
  if (threadIdx.x > 0) return;
  cloth_pcg_beta_args beta = a.beta;
  beta.start = start;
  cloth_pcg_beta_set(&beta, rz, rr);
}

// after r, z and their sums: coarse correction, beta, direction
__device__ void turn(const cloth_pcg_solve_args &a, grid &g, int start, cloth_real *lanes)
{
  int warp = (int)threadIdx.x / CLOTH_WARP, lane = (int)threadIdx.x % CLOTH_WARP;
  if (a.v.coarse) { // a warp for each number, by all blocks
    int n = 3 * a.v.aggregates, first = (int)blockIdx.x * WARPS + warp,
        stride = (int)gridDim.x * WARPS;
    barrier(g);
    for (int k = first; k < n; k += stride) {
      cloth_real sum = cloth_warp_sum(cloth_coarse_rest_lane(&a.rest, k / 3, k % 3, lane));
      if (lane == 0) a.rest.rest[k] = sum;
    }
    barrier(g);
    for (int i = first; i < n; i += stride) {
      cloth_real sum = cloth_warp_sum(cloth_coarse_lane(&a.coarse, i, lane));
      if (lane == 0) a.coarse.coarse[i] = *a.coarse.usable > 0 ? sum : 0;
    }
  }
  barrier(g, [&] { beta_of(a, start, lanes); });
  if (a.v.scalar[CLOTH_PCG_DONE] > 0) return;
  cloth_real beta = a.v.scalar[CLOTH_PCG_BETA];
  int end = a.v.first + a.v.count, stride = (int)(gridDim.x * blockDim.x);
  for (int k = a.v.first + (int)(blockIdx.x * blockDim.x + threadIdx.x); k < end; k += stride)
    cloth_pcg_direction_row(k, &a.v, beta, cloth_pcg_coarse_of(k, &a.v));
  barrier(g);
}

__device__ void product(const cloth_pcg_solve_args &a, grid &g, cloth_real *upper,
                        cloth_real *lanes)
{
  int stride = (int)(gridDim.x * blockDim.x);
  for (int i = (int)(blockIdx.x * blockDim.x + threadIdx.x); i < a.contacts; i += stride)
    cloth_contact_product(i, &a.contact);
  if (a.contacts > 0) barrier(g);
  for_rows(a, upper);
  barrier(g, [&] {
    cloth_real pq[1];
    cloth_block_partial_sums(a.v.partial, a.v.chunks, pq, lanes);
    if (threadIdx.x == 0) cloth_pcg_alpha_set(a.v.scalar, pq[0]);
  });
}

__global__ void __launch_bounds__(THREADS, RESIDENT)
    solve_kernel(const __grid_constant__ cloth_pcg_solve_args a, grid_state *state)
{
  __shared__ cloth_real upper[CHUNKS * CLOTH_CHUNK_SHARED], lanes[CLOTH_PCG_LANES / 2];
  grid g = {state, 0};
  volatile const cloth_real *done = a.v.scalar + CLOTH_PCG_DONE;
  for_levels(a, upper, [&](int k) { return cloth_pcg_start_row(k, &a.v); });
  turn(a, g, 1, lanes);
  for (int n = 0; n < a.iterations_max; n++) {
    if (*done > 0) return;
    product(a, g, upper, lanes);
    if (*done > 0) return;
    cloth_real alpha = a.v.scalar[CLOTH_PCG_ALPHA];
    for_levels(a, upper, [&](int k) { return cloth_pcg_update_row(k, &a.v, alpha); });
    turn(a, g, 0, lanes);
  }
}

} // namespace

cloth_status cloth_cuda_solve(cloth_device *d, const cloth_pcg_solve_args *args, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  if (d->solve_blocks == 0) {
    int each = 0;
    CUDA_TRY(err, cudaOccupancyMaxActiveBlocksPerMultiprocessor(&each, solve_kernel, THREADS, 0));
    d->solve_blocks = each * d->multiprocessors;
  }
  int wanted = (args->v.count + THREADS - 1) / THREADS;
  if ((args->contacts + THREADS - 1) / THREADS > wanted)
    wanted = (args->contacts + THREADS - 1) / THREADS;
  int blocks = wanted < d->solve_blocks ? wanted : d->solve_blocks;
  void *state = nullptr;
  CLOTH_TRY(cloth_cuda_scratch(d, sizeof(grid_state), &state, err));
  cudaStream_t stream = d->stream[CLOTH_COMPUTE];
  CUDA_TRY(err, cudaMemsetAsync(state, 0, sizeof(grid_state), stream));
  void *parameters[] = {const_cast<cloth_pcg_solve_args *>(args), &state};
  CUDA_TRY(err, cudaLaunchCooperativeKernel(solve_kernel, dim3((unsigned)blocks), dim3(THREADS),
                                            parameters, 0, stream));
  return CLOTH_OK;
}
