// Elements and rows that write many numbers each: a block collects them in shared memory and writes
// them side by side. As in assemble.cu the kernel's own indices find their place in an array that
// is taken to begin that much earlier.
#include "launch.h"

namespace {

enum {
  THREADS = 64,
  MEMBRANE_FORCE = 9,
  MEMBRANE_TANGENT = 45,
  BEND = 12,
  SHAPE_FORCE = 18,
  SHAPE_GRADIENT = 36,
  SHAPE_WEIGHT = 6,
  HAT_BLOCKS = 6 * (CLOTH_HAT_CORNERS + 1)
};

// the block's rows of a [n x Width] array
template <int Width>
__device__ void write_out(cloth_real *to, const cloth_real *shared, int first, int rows)
{
  for (int k = (int)threadIdx.x; k < rows * Width; k += THREADS)
    to[(int64_t)first * Width + k] = shared[k];
}

__global__ void __launch_bounds__(THREADS)
    membrane_kernel(int n, const __grid_constant__ cloth_membrane_args args)
{
  __shared__ cloth_real force[THREADS * MEMBRANE_FORCE], tangent[THREADS * MEMBRANE_TANGENT];
  int first = (int)blockIdx.x * THREADS, rows = n - first < THREADS ? n - first : THREADS;
  cloth_membrane_args a = args;
  a.force = force - (int64_t)first * MEMBRANE_FORCE;
  a.tangent = tangent - (int64_t)first * MEMBRANE_TANGENT;
  if ((int)threadIdx.x < rows) cloth_membrane(first + (int)threadIdx.x, &a);
  __syncthreads();
  write_out<MEMBRANE_FORCE>(args.force, force, first, rows);
  write_out<MEMBRANE_TANGENT>(args.tangent, tangent, first, rows);
}

__global__ void __launch_bounds__(THREADS)
    bend_kernel(int n, const __grid_constant__ cloth_bend_args args)
{
  __shared__ cloth_real force[THREADS * BEND], gradient[THREADS * BEND];
  int first = (int)blockIdx.x * THREADS, rows = n - first < THREADS ? n - first : THREADS;
  cloth_bend_args a = args;
  a.force = force - (int64_t)first * BEND;
  a.gradient = gradient - (int64_t)first * BEND;
  if ((int)threadIdx.x < rows) cloth_bend(first + (int)threadIdx.x, &a);
  __syncthreads();
  write_out<BEND>(args.force, force, first, rows);
  write_out<BEND>(args.gradient, gradient, first, rows);
}

__global__ void __launch_bounds__(THREADS)
    bend_shape_kernel(int n, const __grid_constant__ cloth_bend_shape_args args)
{
  __shared__ cloth_real force[THREADS * SHAPE_FORCE], gradient[THREADS * SHAPE_GRADIENT];
  __shared__ cloth_real weight[THREADS * SHAPE_WEIGHT];
  int first = (int)blockIdx.x * THREADS, rows = n - first < THREADS ? n - first : THREADS;
  cloth_bend_shape_args a = args;
  a.force = force - (int64_t)first * SHAPE_FORCE;
  a.gradient = gradient - (int64_t)first * SHAPE_GRADIENT;
  a.weight = weight - (int64_t)first * SHAPE_WEIGHT;
  if ((int)threadIdx.x < rows) cloth_bend_shape(first + (int)threadIdx.x, &a);
  __syncthreads();
  write_out<SHAPE_FORCE>(args.force, force, first, rows);
  write_out<SHAPE_GRADIENT>(args.gradient, gradient, first, rows);
  write_out<SHAPE_WEIGHT>(args.weight, weight, first, rows);
}

__global__ void __launch_bounds__(THREADS)
    hat_row_kernel(int n, const __grid_constant__ cloth_hat_row_args args)
{
  __shared__ cloth_real block[THREADS * HAT_BLOCKS];
  int first = (int)blockIdx.x * THREADS, rows = n - first < THREADS ? n - first : THREADS;
  cloth_hat_row_args a = args;
  a.block = block - ((int64_t)args.first + first) * HAT_BLOCKS;
  if ((int)threadIdx.x < rows) cloth_hat_row(first + (int)threadIdx.x, &a);
  __syncthreads();
  write_out<HAT_BLOCKS>(args.block, block, args.first + first, rows);
}

} // namespace

cudaError_t cloth_cuda_membrane(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  membrane_kernel<<<(unsigned)(n + THREADS - 1) / THREADS, THREADS, 0, stream>>>(
      n, *static_cast<const cloth_membrane_args *>(args));
  return cudaGetLastError();
}

cudaError_t cloth_cuda_bend(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  bend_kernel<<<(unsigned)(n + THREADS - 1) / THREADS, THREADS, 0, stream>>>(
      n, *static_cast<const cloth_bend_args *>(args));
  return cudaGetLastError();
}

cudaError_t cloth_cuda_bend_shape(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  bend_shape_kernel<<<(unsigned)(n + THREADS - 1) / THREADS, THREADS, 0, stream>>>(
      n, *static_cast<const cloth_bend_shape_args *>(args));
  return cudaGetLastError();
}

cudaError_t cloth_cuda_hat_row(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  hat_row_kernel<<<(unsigned)(n + THREADS - 1) / THREADS, THREADS, 0, stream>>>(
      n, *static_cast<const cloth_hat_row_args *>(args));
  return cudaGetLastError();
}
