// Every element kernel as a CUDA kernel, one thread for each element, from kernels.inl.
#include "launch.h"

namespace {

enum { THREADS = 128 };

// CUDA passes at most 4 KiB of arguments to a kernel on every architecture
#define CLOTH_KERNEL(name, serial)                                                                 \
  static_assert(sizeof(cloth_##name##_args) + sizeof(int) <= 4096, #name);                         \
  __global__ void __launch_bounds__(THREADS)                                                       \
      name##_kernel(int n, const __grid_constant__ cloth_##name##_args args)                       \
  {                                                                                                \
    int i = (int)(blockIdx.x * blockDim.x + threadIdx.x);                                          \
    if (i < n) cloth_##name(i, &args);                                                             \
  }                                                                                                \
  cudaError_t launch_##name(cloth_device *, int n, const void *args, cudaStream_t stream)          \
  {                                                                                                \
    name##_kernel<<<(unsigned)(n + THREADS - 1) / THREADS, THREADS, 0, stream>>>(                  \
        n, *static_cast<const cloth_##name##_args *>(args));                                       \
    return cudaGetLastError();                                                                     \
  }
#include "kernels.inl"
#undef CLOTH_KERNEL

struct entry {
  const char *name;
  cloth_cuda_launcher *launch;
};

const entry table[] = {
#define CLOTH_KERNEL(name, serial) {#name, launch_##name},
#include "kernels.inl"
#undef CLOTH_KERNEL
};

} // namespace

cloth_status cloth_cuda_launch(cloth_device *d, cloth_kernel k, int n, const void *args,
                               cloth_error *err)
{
  if (n <= 0) return CLOTH_OK;
  CUDA_TRY(err, cudaSetDevice(d->index));
  cloth_cuda_launcher *launch = cloth_cuda_block_launcher(k);
  if (launch == nullptr) launch = table[k].launch;
  cudaError_t e = launch(d, n, args, d->stream[CLOTH_COMPUTE]);
  return e == cudaSuccess ? CLOTH_OK : cloth_cuda_fail(e, table[k].name, __FILE__, __LINE__, err);
}
