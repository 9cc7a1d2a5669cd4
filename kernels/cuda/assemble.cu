// Assembly of rows in shared memory: a row's blocks are added to many times and written once. What
// that takes of shared memory leaves few rows on a multiprocessor, so three threads share each: one
// for each line of its blocks.
#include "launch.h"

namespace {

enum {
  ROWS = 64,
  LINES = 3,
  THREADS = ROWS * LINES,
  GROUPS = ROWS / CLOTH_ROW_GROUP,
  BLOCK = 9 * CLOTH_ROW_GROUP
};

// Rows of a block lie behind each other in memory, so the same indices find them in shared memory
// when the array is taken to begin that much earlier. Rows too long for it are assembled in place.
__global__ void __launch_bounds__(THREADS)
    assemble_kernel(int n, int slots_shared, const __grid_constant__ cloth_assemble_row_args args)
{
  extern __shared__ __align__(16) char memory[];
  cloth_real *shared = reinterpret_cast<cloth_real *>(memory);
  cloth_assemble_row_args a = args;
  int groups = (n + CLOTH_ROW_GROUP - 1) / CLOTH_ROW_GROUP, g0 = (int)blockIdx.x * GROUPS;
  int g1 = g0 + GROUPS < groups ? g0 + GROUPS : groups;
  int first = args.rows.first[g0], slots = args.rows.first[g1] - first;
  bool fits = slots <= slots_shared;
  if (fits) a.rows.val = shared - (int64_t)first * BLOCK;

  int i = (int)(blockIdx.x * ROWS + threadIdx.x / LINES);
  cloth_lines line = {(int)threadIdx.x % LINES, 1};
  if (fits && n % CLOTH_ROW_GROUP != 0 && g1 == groups) { // lanes behind the last row are zero
    for (int k = (int)threadIdx.x; k < slots * BLOCK; k += THREADS) shared[k] = 0;
    __syncthreads();
  }
  if (i < n) cloth_assemble_lines(i, &a, line);
  __syncthreads();
  if (i < n && line.first == 0) cloth_assemble_rest(i, &a);
  if (!fits) return;
  cloth_real *val = args.rows.val + (int64_t)first * BLOCK;
  for (int k = (int)threadIdx.x; k < slots * BLOCK; k += THREADS) val[k] = shared[k];
}

} // namespace

cudaError_t cloth_cuda_assemble(cloth_device *d, int n, const void *args, cudaStream_t stream)
{
  int slots = static_cast<const cloth_assemble_row_args *>(args)->rows.widest * GROUPS;
  size_t shared = sizeof(cloth_real) * BLOCK * (size_t)slots;
  if (shared > d->shared_bytes)
    shared = d->shared_bytes, slots = (int)(shared / sizeof(cloth_real) / BLOCK);
  cudaError_t e = cudaFuncSetAttribute(assemble_kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                       (int)shared);
  if (e != cudaSuccess) return e;
  assemble_kernel<<<(unsigned)(n + ROWS - 1) / ROWS, THREADS, shared, stream>>>(
      n, slots, *static_cast<const cloth_assemble_row_args *>(args));
  return cudaGetLastError();
}
