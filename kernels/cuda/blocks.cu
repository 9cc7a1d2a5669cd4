// Kernels of which one element is much work: a whole chunk, all chunks, a dense matrix. Here a
// block of threads shares it. What a thread does for its vertex or entry is the physics header's;
// only loops and sums are replaced, along the same trees, so the bits are those of the plain
// kernels.
#define CLOTH_CHUNK_A_BLOCK
#include "launch.h"
#include "reduce.cuh"

namespace {

enum {
  CHUNK_THREADS = CLOTH_CHUNK,
  FACTOR_THREADS = 1024,
  HAT_THREADS = CLOTH_HAT_FINE_LANES * CLOTH_HAT_FINE_GROUP
};
static_assert(HAT_THREADS == CLOTH_HAT_LANES * CLOTH_HAT_GROUP, "");
static_assert((int)HAT_THREADS == (int)CLOTH_HAT_WIDE_LANES, "");

// ---- a chunk of vertices for each block ---------------------------------------------------------

__global__ void __launch_bounds__(CHUNK_THREADS)
    start_kernel(const __grid_constant__ cloth_pcg_start_args a)
{
  __shared__ cloth_real upper[CLOTH_PCG_PARTIALS * CLOTH_WARP];
  int i = (int)blockIdx.x, first = a.v.first + i * CLOTH_CHUNK, k = first + (int)threadIdx.x;
  cloth_v3 r = cloth_v3_make(0, 0, 0);
  bool there = k < cloth_chunk_end(a.v.first, a.v.count, i);
  if (there) r = cloth_pcg_start_row(k, &a.v);
  cloth_block_z(&a.v, first, k, there, r, upper);
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    update_kernel(const __grid_constant__ cloth_pcg_update_args a)
{
  __shared__ cloth_real upper[CLOTH_PCG_PARTIALS * CLOTH_WARP];
  if (a.v.scalar[CLOTH_PCG_DONE] > 0) return;
  int i = (int)blockIdx.x, first = a.v.first + i * CLOTH_CHUNK, k = first + (int)threadIdx.x;
  cloth_v3 r = cloth_v3_make(0, 0, 0);
  bool there = k < cloth_chunk_end(a.v.first, a.v.count, i);
  if (there) r = cloth_pcg_update_row(k, &a.v, a.v.scalar[CLOTH_PCG_ALPHA]);
  cloth_block_z(&a.v, first, k, there, r, upper);
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    direction_kernel(const __grid_constant__ cloth_pcg_direction_args a)
{
  if (a.v.scalar[CLOTH_PCG_DONE] > 0) return;
  int i = (int)blockIdx.x, begin = a.v.first + i * CLOTH_CHUNK, k = begin + (int)threadIdx.x;
  if (k < cloth_chunk_end(a.v.first, a.v.count, i))
    cloth_pcg_direction_row(k, &a.v, a.v.scalar[CLOTH_PCG_BETA], cloth_pcg_coarse_of(k, &a.v));
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    product_kernel(const __grid_constant__ cloth_pcg_product_args a)
{
  __shared__ cloth_real upper[CLOTH_WARP];
  if (a.done && *a.done > 0) return;
  int i = (int)blockIdx.x, row = i * CLOTH_CHUNK + (int)threadIdx.x;
  cloth_real sum[1] = {};
  if (row < a.count)
    sum[0] = cloth_pcg_product_row(row, &a, cloth_block_row_product(&a.rows, row, a.x));
  cloth_block_chunk_sums(sum, upper);
  if (threadIdx.x == 0) a.partial[CLOTH_PCG_PARTIALS * (a.first / CLOTH_CHUNK + i)] = sum[0];
}

// the larger over the chunk of a block, on thread 0; order does not matter
__device__ cloth_real chunk_larger(cloth_real v, cloth_real *shared)
{
  v = cloth_warp_larger(v);
  if (threadIdx.x == CLOTH_WARP) *shared = v;
  __syncthreads();
  v = cloth_larger(v, *shared);
  __syncthreads();
  return v;
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    residual_kernel(const __grid_constant__ cloth_pcg_residual_args a)
{
  __shared__ cloth_real upper[CLOTH_WARP], larger;
  int i = (int)blockIdx.x, k = a.v.first + i * CLOTH_CHUNK + (int)threadIdx.x;
  cloth_real sum[1] = {}, length_sq = 0;
  if (k < cloth_chunk_end(a.v.first, a.v.count, i))
    sum[0] = cloth_pcg_residual_row(k, &a.v, &length_sq);
  cloth_block_chunk_sums(sum, upper);
  length_sq = chunk_larger(length_sq, &larger);
  cloth_real *partial = a.v.partial + CLOTH_PCG_PARTIALS * (a.v.first / CLOTH_CHUNK + i);
  if (threadIdx.x == 0) partial[0] = sum[0], partial[1] = length_sq;
}

// the fields of the block's chunk from those of its threads
__device__ void commit_fields(const cloth_real *field, cloth_real *out)
{
  __shared__ cloth_real upper[CLOTH_COMMIT_SUMS * CLOTH_WARP], larger;
  cloth_real sum[CLOTH_COMMIT_SUMS];
  for (int f = 0; f < CLOTH_COMMIT_SUMS; f++) sum[f] = field[CLOTH_COMMIT_ENERGY + f];
  cloth_block_chunk_sums(sum, upper);
  cloth_real worst = chunk_larger(field[CLOTH_COMMIT_WORST], &larger);
  cloth_real speed = chunk_larger(field[CLOTH_COMMIT_SPEED], &larger);
  cloth_real change = chunk_larger(field[CLOTH_COMMIT_CHANGE], &larger);
  if (threadIdx.x > 0) return;
  out[CLOTH_COMMIT_WORST] = worst;
  out[CLOTH_COMMIT_SPEED] = cloth_sqrt(speed);
  out[CLOTH_COMMIT_CHANGE] = cloth_sqrt(change);
  for (int f = 0; f < CLOTH_COMMIT_SUMS; f++) out[CLOTH_COMMIT_ENERGY + f] = sum[f];
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    commit_kernel(const __grid_constant__ cloth_commit_chunk_args a)
{
  int i = (int)blockIdx.x, k = a.first + i * CLOTH_CHUNK + (int)threadIdx.x;
  cloth_real field[CLOTH_COMMIT_FIELDS] = {};
  if (k < cloth_chunk_end(a.first, a.count, i)) cloth_commit_vertex(k, &a, field);
  commit_fields(field, a.out + CLOTH_COMMIT_FIELDS * (a.first / CLOTH_CHUNK + i));
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    fly_kernel(const __grid_constant__ cloth_fly_chunk_args a)
{
  int i = (int)blockIdx.x, k = i * CLOTH_CHUNK + (int)threadIdx.x;
  cloth_real field[CLOTH_COMMIT_FIELDS] = {};
  if (k < cloth_chunk_end(0, a.commit.count, i)) cloth_fly_vertex(k, &a, field);
  commit_fields(field, a.commit.out + CLOTH_COMMIT_FIELDS * i);
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    spring_chunk_kernel(const __grid_constant__ cloth_spring_chunk_args a)
{
  __shared__ cloth_real upper[CLOTH_SPRING_SUMS * CLOTH_WARP], larger;
  int i = (int)blockIdx.x, k = a.first + i * CLOTH_CHUNK + (int)threadIdx.x;
  cloth_real field[CLOTH_SPRING_FIELDS] = {}, sum[CLOTH_SPRING_SUMS];
  if (k < cloth_chunk_end(a.first, a.count, i)) cloth_spring_chunk_particle(k, &a, field);
  for (int f = 0; f < CLOTH_SPRING_SUMS; f++) sum[f] = field[CLOTH_SPRING_ENERGY + f];
  cloth_block_chunk_sums(sum, upper);
  cloth_real worst = chunk_larger(field[CLOTH_SPRING_WORST], &larger);
  cloth_real speed_sq = chunk_larger(field[CLOTH_SPRING_SPEED], &larger);
  if (threadIdx.x > 0) return;
  cloth_real *out = a.out + CLOTH_SPRING_FIELDS * (a.first / CLOTH_CHUNK + i);
  out[CLOTH_SPRING_WORST] = worst;
  out[CLOTH_SPRING_SPEED] = cloth_sqrt(speed_sq);
  for (int f = 0; f < CLOTH_SPRING_SUMS; f++) out[CLOTH_SPRING_ENERGY + f] = sum[f];
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    correct_kernel(const __grid_constant__ cloth_correct_args a)
{
  __shared__ cloth_real larger;
  int i = (int)blockIdx.x, v = a.first + i * CLOTH_CHUNK + (int)threadIdx.x;
  cloth_real size = 0;
  if (v < cloth_chunk_end(a.first, a.count, i)) size = cloth_correct_vertex(v, &a);
  size = chunk_larger(size, &larger);
  if (threadIdx.x == 0) a.largest[a.first / CLOTH_CHUNK + i] = size;
}

__global__ void __launch_bounds__(CHUNK_THREADS)
    max_kernel(const __grid_constant__ cloth_reduce_max_args a)
{
  __shared__ cloth_real larger;
  int i = (int)blockIdx.x, begin = i * CLOTH_CHUNK, k = begin + (int)threadIdx.x;
  cloth_real v = chunk_larger(a.value[k < a.count ? k : begin], &larger);
  if (threadIdx.x == 0) a.largest[i] = v;
}

// the union over a warp, in its first lane
__device__ cloth_box warp_box(cloth_box b)
{
  for (int width = CLOTH_WARP / 2; width > 0; width /= 2) {
    cloth_box other;
    const cloth_real *mine = &b.lo.x;
    cloth_real *theirs = &other.lo.x;
    for (int k = 0; k < 6; k++) theirs[k] = __shfl_down_sync(0xffffffffu, mine[k], (unsigned)width);
    b = cloth_box_union(b, other);
  }
  return b;
}

__global__ void __launch_bounds__(CLOTH_WARP)
    box_kernel(const __grid_constant__ cloth_box_chunk_args a)
{
  int i = (int)blockIdx.x, begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a.count, i);
  int v = begin + (int)threadIdx.x;
  if (v >= end) v = begin;
  cloth_box b = cloth_box_of_way(&a, v);
  v += CLOTH_WARP;
  if (v < end) b = cloth_box_union(b, cloth_box_of_way(&a, v));
  b = warp_box(b);
  if (threadIdx.x == 0) cloth_box_store(a.box, i, b);
}

__global__ void __launch_bounds__(CLOTH_WARP)
    merge_kernel(const __grid_constant__ cloth_box_merge_args a)
{
  int i = (int)blockIdx.x, begin = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a.count, i);
  int k = begin + (int)threadIdx.x;
  if (k >= end) k = begin;
  cloth_box b = cloth_box_load(a.box, k);
  k += CLOTH_WARP;
  if (k < end) b = cloth_box_union(b, cloth_box_load(a.box, k));
  b = warp_box(b);
  if (threadIdx.x == 0) cloth_box_store(a.out, i, b);
}

// ---- all chunks by one block --------------------------------------------------------------------

__global__ void __launch_bounds__(CLOTH_PCG_LANES)
    alpha_kernel(const __grid_constant__ cloth_pcg_alpha_args a)
{
  __shared__ cloth_real lanes[CLOTH_PCG_LANES];
  if (a.scalar[CLOTH_PCG_DONE] > 0) return;
  cloth_real pq[1];
  cloth_block_partial_sums(a.partial, a.chunks, 0, pq, lanes);
  if (threadIdx.x == 0) cloth_pcg_alpha_set(a.scalar, pq[0]);
}

__global__ void __launch_bounds__(CLOTH_PCG_LANES)
    beta_kernel(const __grid_constant__ cloth_pcg_beta_args a)
{
  __shared__ cloth_real lanes[2 * CLOTH_PCG_LANES];
  if (!a.start && a.scalar[CLOTH_PCG_DONE] > 0) return;
  cloth_real sum[2];
  cloth_block_partial_sums(a.partial, a.chunks, a.more, sum, lanes);
  if (threadIdx.x > 0) return;
  cloth_real rz = sum[0], rr = sum[1];
  if (a.aggregates > 0) rz += cloth_coarse_rz(a.rest, a.coarse, a.aggregates);
  cloth_pcg_beta_set(&a, rz, rr);
}

__global__ void __launch_bounds__(CLOTH_PCG_LANES)
    finish_kernel(const __grid_constant__ cloth_pcg_finish_args a)
{
  enum { WARPS = CLOTH_PCG_LANES / CLOTH_WARP };
  __shared__ cloth_real lanes[CLOTH_PCG_LANES], larger[2][WARPS];
  cloth_real rr[1], largest = 0, length_sq = 0;
  cloth_block_partial_sums(a.partial, a.chunks, 0, rr, lanes);
  for (int c = (int)threadIdx.x; c < a.chunks; c += CLOTH_PCG_LANES) {
    largest = cloth_larger(largest, a.largest[c]);
    length_sq = cloth_larger(length_sq, a.partial[CLOTH_PCG_PARTIALS * c + 1]);
  }
  largest = cloth_warp_larger(largest), length_sq = cloth_warp_larger(length_sq);
  int warp = (int)threadIdx.x / CLOTH_WARP;
  if (threadIdx.x % CLOTH_WARP == 0) larger[0][warp] = largest, larger[1][warp] = length_sq;
  __syncthreads();
  if (threadIdx.x > 0) return;
  for (int w = 1; w < WARPS; w++) {
    largest = cloth_larger(largest, larger[0][w]);
    length_sq = cloth_larger(length_sq, larger[1][w]);
  }
  a.scalar[CLOTH_PCG_LARGEST] = largest;
  a.scalar[CLOTH_PCG_RESIDUAL_LENGTH] = cloth_sqrt(length_sq);
  a.scalar[CLOTH_PCG_RESIDUAL] = rr[0];
}

// ---- the coarse level ---------------------------------------------------------------------------

// a thread for each row; what couples to other aggregates is left to nine threads, one for each
// entry of a block, in the order of the loop
__global__ void __launch_bounds__(CHUNK_THREADS)
    coarse_chunk_kernel(const __grid_constant__ cloth_coarse_chunk_args a)
{
  __shared__ cloth_real upper[9 * CLOTH_WARP];
  int i = (int)blockIdx.x, size = 9 * a.aggregates, e = (int)threadIdx.x, row = i * CLOTH_CHUNK + e;
  cloth_real *slice = a.slice + (int64_t)(a.first / CLOTH_CHUNK + i) * size, own[9] = {};
  for (int k = e; k < size; k += CHUNK_THREADS) slice[k] = 0;
  bool foreign = row < a.count && cloth_coarse_row(row, &a, own);
  cloth_block_chunk_sums(own, upper);
  if (e == 0)
    for (int k = 0; k < 9; k++) *cloth_coarse_at(&a, slice, a.first + row, k) = own[k];
  __shared__ unsigned rows[2]; // those that have foreign blocks
  unsigned mask = __ballot_sync(0xffffffffu, foreign);
  if (e % CLOTH_WARP == 0) rows[e / CLOTH_WARP] = mask;
  __syncthreads();
  if (e >= 9) return;
  for (int w = 0; w < 2; w++)
    for (unsigned left = rows[w]; left != 0; left &= left - 1)
      cloth_coarse_foreign(i * CLOTH_CHUNK + w * CLOTH_WARP + __ffs((int)left) - 1, &a, e, e + 1,
                           slice);
}

__global__ void coarse_sum_kernel(const __grid_constant__ cloth_coarse_sum_args a)
{
  int k = (int)(blockIdx.x * blockDim.x + threadIdx.x);
  if (k < 9 * a.aggregates) cloth_coarse_sum_range((int)blockIdx.y, &a, k, k + 1);
}

// right-looking, column by column: each entry takes its corrections in the order of the loop
__global__ void __launch_bounds__(FACTOR_THREADS)
    coarse_factor_kernel(const __grid_constant__ cloth_coarse_factor_args a)
{
  int n = 3 * a.aggregates, thread = (int)threadIdx.x;
  int lane = thread % CLOTH_WARP, warp = thread / CLOTH_WARP, warps = FACTOR_THREADS / CLOTH_WARP;
  if (thread == 0) *a.usable = 0;
  for (int j = 0; j < n; j++) {
    cloth_real *col = a.factor + (int64_t)j * n, pivot = col[j];
    if (!(pivot > 0)) {
      int lost = 0;
      for (int r = j + thread; r < n; r += FACTOR_THREADS) lost |= !(col[r] == 0);
      if (__syncthreads_or(lost)) return;
      for (int k = j + 1 + thread; k < n; k += FACTOR_THREADS) a.factor[(int64_t)k * n + j] = 0;
      __syncthreads();
      continue;
    }
    cloth_real s = 1 / cloth_sqrt(pivot);
    __syncthreads(); // all have the pivot
    for (int r = j + thread; r < n; r += FACTOR_THREADS) col[r] = r == j ? s : col[r] * s;
    __syncthreads();
    for (int k = j + 1 + warp; k < n; k += warps) {
      cloth_real *to = a.factor + (int64_t)k * n, f = col[k];
      if (lane == 0) to[j] = f;
      if (f == 0) continue;
      for (int r = k + lane; r < n; r += CLOTH_WARP) to[r] -= f * col[r];
    }
    __syncthreads();
  }
  if (thread == 0) *a.usable = 1;
}

// a warp for each row
__global__ void __launch_bounds__(CLOTH_WARP)
    coarse_inverse_kernel(const __grid_constant__ cloth_coarse_inverse_args a)
{
  extern __shared__ char memory[];
  cloth_real *y = reinterpret_cast<cloth_real *>(memory);
  int i = (int)blockIdx.x, n = 3 * a.aggregates, lane = (int)threadIdx.x;
  if (!(*a.usable > 0)) return;
  for (int k = lane; k < n; k += CLOTH_WARP) y[k] = k == i ? 1 : 0;
  __syncwarp();
  for (int j = i; j < n; j++) {
    const cloth_real *col = a.factor + (int64_t)j * n;
    cloth_real f = y[j] * col[j];
    __syncwarp();
    if (lane == 0) y[j] = f;
    for (int r = j + 1 + lane; r < n; r += CLOTH_WARP) y[r] -= f * col[r];
    __syncwarp();
  }
  for (int j = n - 1; j >= 0; j--) {
    const cloth_real *col = a.factor + (int64_t)j * n;
    cloth_real f = y[j] * col[j];
    __syncwarp();
    if (lane == 0) y[j] = f;
    for (int r = lane; r < j; r += CLOTH_WARP) y[r] -= f * col[r];
    __syncwarp();
  }
  for (int k = lane; k < n; k += CLOTH_WARP) a.inverse[(int64_t)i * n + k] = y[k];
}

__global__ void __launch_bounds__(CLOTH_WARP)
    coarse_rest_kernel(const __grid_constant__ cloth_coarse_rest_args a)
{
  if (a.done && *a.done > 0) return;
  int i = (int)blockIdx.x;
  for (int k = 0; k < 3; k++) {
    cloth_real sum = cloth_warp_sum(cloth_coarse_rest_lane(&a, i, k, (int)threadIdx.x));
    if (threadIdx.x == 0) a.rest[3 * i + k] = sum;
  }
}

__global__ void __launch_bounds__(CLOTH_WARP)
    coarse_solve_kernel(const __grid_constant__ cloth_coarse_solve_args a)
{
  if (a.done && *a.done > 0) return;
  int i = (int)blockIdx.x;
  cloth_real sum = cloth_warp_sum(cloth_coarse_lane(&a, i, (int)threadIdx.x));
  if (threadIdx.x == 0) a.coarse[i] = *a.usable > 0 ? sum : 0;
}

// ---- levels of hats ---------------------------------------------------------------------------

__global__ void __launch_bounds__(HAT_THREADS)
    hat_rest_kernel(const __grid_constant__ cloth_hat_rest_args a)
{
  __shared__ cloth_real shares[CLOTH_HAT_FINE_GROUP];
  if (a.done && *a.done > 0) return;
  cloth_real rz = cloth_block_hat_rest(&a, (int)blockIdx.x, shares);
  if (threadIdx.x == 0) a.partial[CLOTH_PCG_PARTIALS * (int)blockIdx.x] = rz;
}

__global__ void __launch_bounds__(HAT_THREADS)
    hat_rest_upper_kernel(const __grid_constant__ cloth_hat_rest_upper_args a)
{
  __shared__ cloth_real shares[CLOTH_HAT_SHARED];
  if (a.done && *a.done > 0) return;
  cloth_real rz = cloth_block_hat_upper(&a, (int)blockIdx.x, shares);
  int group = cloth_hat_fine_groups(&a.hats) + (int)blockIdx.x;
  if (threadIdx.x == 0) a.partial[CLOTH_PCG_PARTIALS * group] = rz;
}

// a warp for each node
__global__ void __launch_bounds__(CLOTH_HAT_LANES)
    hat_matrix_kernel(const __grid_constant__ cloth_hat_matrix_args a)
{
  int i = a.first + (int)blockIdx.x;
  cloth_real sum[CLOTH_HAT_MATRIX_SUMS] = {};
  cloth_hat_matrix_lane(&a, i, (int)threadIdx.x, sum);
  for (int f = 0; f < CLOTH_HAT_MATRIX_SUMS; f++) sum[f] = cloth_warp_sum(sum[f]);
  if (threadIdx.x == 0) cloth_hat_matrix_set(&a, i, sum);
}

__global__ void __launch_bounds__(CLOTH_HAT_LANES)
    hat_upper_kernel(const __grid_constant__ cloth_hat_upper_args a)
{
  int c = a.hats.fine + (int)blockIdx.x;
  cloth_real sum[CLOTH_HAT_UPPER_SUMS] = {};
  cloth_hat_upper_lane(&a, c, (int)threadIdx.x, sum);
  for (int f = 0; f < CLOTH_HAT_UPPER_SUMS; f++) sum[f] = cloth_warp_sum(sum[f]);
  if (threadIdx.x == 0) cloth_hat_upper_set(&a, c, sum);
}

// ---- starting them ------------------------------------------------------------------------------

// a kernel of n blocks
template <typename Args, void (*Kernel)(const Args), int Threads>
cudaError_t blocks(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  Kernel<<<(unsigned)n, Threads, 0, stream>>>(*static_cast<const Args *>(args));
  return cudaGetLastError();
}

cudaError_t coarse_sum(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  auto *a = static_cast<const cloth_coarse_sum_args *>(args);
  dim3 grid((unsigned)(9 * a->aggregates + 127) / 128, (unsigned)n);
  coarse_sum_kernel<<<grid, 128, 0, stream>>>(*a);
  return cudaGetLastError();
}

cudaError_t coarse_inverse(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  auto *a = static_cast<const cloth_coarse_inverse_args *>(args);
  size_t shared = sizeof(cloth_real) * 3 * (size_t)a->aggregates;
  coarse_inverse_kernel<<<(unsigned)n, CLOTH_WARP, shared, stream>>>(*a);
  return cudaGetLastError();
}

} // namespace

#define CHUNKS(name, kernel)                                                                       \
  case CLOTH_KERNEL_##name:                                                                        \
    return blocks<cloth_##name##_args, kernel, CHUNK_THREADS>
#define BLOCKS(name, kernel, threads)                                                              \
  case CLOTH_KERNEL_##name:                                                                        \
    return blocks<cloth_##name##_args, kernel, threads>

cloth_cuda_launcher *cloth_cuda_block_launcher(cloth_kernel k)
{
  switch (k) {
    CHUNKS(pcg_start, start_kernel);
    CHUNKS(pcg_update, update_kernel);
    CHUNKS(pcg_direction, direction_kernel);
    CHUNKS(pcg_product, product_kernel);
    CHUNKS(pcg_residual, residual_kernel);
    CHUNKS(commit_chunk, commit_kernel);
    CHUNKS(fly_chunk, fly_kernel);
    CHUNKS(correct, correct_kernel);
    CHUNKS(spring_chunk, spring_chunk_kernel);
    CHUNKS(reduce_max, max_kernel);
    BLOCKS(box_chunk, box_kernel, CLOTH_WARP);
    BLOCKS(box_merge, merge_kernel, CLOTH_WARP);
    BLOCKS(pcg_alpha, alpha_kernel, CLOTH_PCG_LANES);
    BLOCKS(pcg_beta, beta_kernel, CLOTH_PCG_LANES);
    BLOCKS(pcg_finish, finish_kernel, CLOTH_PCG_LANES);
    CHUNKS(coarse_chunk, coarse_chunk_kernel);
    BLOCKS(hat_rest, hat_rest_kernel, HAT_THREADS);
    BLOCKS(hat_rest_upper, hat_rest_upper_kernel, HAT_THREADS);
    BLOCKS(hat_upper, hat_upper_kernel, CLOTH_HAT_LANES);
    BLOCKS(hat_matrix, hat_matrix_kernel, CLOTH_HAT_LANES);
    BLOCKS(coarse_factor, coarse_factor_kernel, FACTOR_THREADS);
    BLOCKS(coarse_rest, coarse_rest_kernel, CLOTH_WARP);
    BLOCKS(coarse_solve, coarse_solve_kernel, CLOTH_WARP);
  case CLOTH_KERNEL_coarse_sum:
    return coarse_sum;
  case CLOTH_KERNEL_coarse_inverse:
    return coarse_inverse;
  case CLOTH_KERNEL_assemble_row:
    return cloth_cuda_assemble;
  case CLOTH_KERNEL_membrane:
    return cloth_cuda_membrane;
  case CLOTH_KERNEL_bend:
    return cloth_cuda_bend;
  case CLOTH_KERNEL_bend_shape:
    return cloth_cuda_bend_shape;
  case CLOTH_KERNEL_hat_row:
    return cloth_cuda_hat_row;
  case CLOTH_KERNEL_pair_share:
    return cloth_cuda_pair_share;
  case CLOTH_KERNEL_pair_large:
    return cloth_cuda_pair_large;
  case CLOTH_KERNEL_zone_solve:
    return cloth_cuda_zone_solve;
  default:
    return nullptr;
  }
}
