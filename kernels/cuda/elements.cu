// Elements and rows that write many numbers each: a block collects them in shared memory and writes
// them side by side. As in assemble.cu the kernel's own indices find their place in an array that
// is taken to begin that much earlier.
#include "launch.h"

namespace {

enum { THREADS = 64 };

// an array that a kernel writes: `Width` numbers for each element
template <auto Member, int Width> struct written {
  static constexpr int size = THREADS * Width;

  template <typename Args> static __device__ void collect_in(cloth_real *shared, Args &a, int first)
  {
    a.*Member = shared - (int64_t)first * Width;
  }

  template <typename Args>
  static __device__ void write_out(const cloth_real *shared, const Args &args, int first, int rows)
  {
    cloth_real *to = args.*Member;
    for (int k = (int)threadIdx.x; k < rows * Width; k += THREADS)
      to[(int64_t)first * Width + k] = shared[k];
  }
};

// the row of element 0 in what is written
template <typename Args> __device__ int row_of_first(const Args &) { return 0; }
__device__ int row_of_first(const cloth_hat_row_args &args) { return args.first; }

template <typename Args, void (*Element)(int, const Args *), typename... Written>
__global__ void __launch_bounds__(THREADS)
    collecting_kernel(int n, const __grid_constant__ Args args)
{
  __shared__ cloth_real shared[(Written::size + ...)];
  int first = (int)blockIdx.x * THREADS, rows = n - first < THREADS ? n - first : THREADS;
  int row = row_of_first(args) + first, at = 0;
  Args a = args;
  ((Written::collect_in(shared + at, a, row), at += Written::size), ...);
  if ((int)threadIdx.x < rows) Element(first + (int)threadIdx.x, &a);
  __syncthreads();
  at = 0;
  ((Written::write_out(shared + at, args, row, rows), at += Written::size), ...);
}

template <typename Args, void (*Element)(int, const Args *), typename... Written>
cudaError_t start(int n, const void *args, cudaStream_t stream)
{
  unsigned blocks = (unsigned)(n + THREADS - 1) / THREADS;
  collecting_kernel<Args, Element, Written...>
      <<<blocks, THREADS, 0, stream>>>(n, *static_cast<const Args *>(args));
  return cudaGetLastError();
}

} // namespace

cudaError_t cloth_cuda_membrane(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  return start<cloth_membrane_args, cloth_membrane, written<&cloth_membrane_args::force, 9>,
               written<&cloth_membrane_args::tangent, 45>>(n, args, stream);
}

cudaError_t cloth_cuda_bend(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  return start<cloth_bend_args, cloth_bend, written<&cloth_bend_args::force, 12>,
               written<&cloth_bend_args::gradient, 12>>(n, args, stream);
}

cudaError_t cloth_cuda_bend_shape(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  return start<cloth_bend_shape_args, cloth_bend_shape, written<&cloth_bend_shape_args::force, 18>,
               written<&cloth_bend_shape_args::gradient, 36>,
               written<&cloth_bend_shape_args::weight, 6>>(n, args, stream);
}

cudaError_t cloth_cuda_hat_row(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  return start<cloth_hat_row_args, cloth_hat_row,
               written<&cloth_hat_row_args::block, 6 * (CLOTH_HAT_CORNERS + 1)>>(n, args, stream);
}
