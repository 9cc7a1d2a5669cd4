// Every element kernel, compiled for a GPU: the physics headers are C11 that is also CUDA C++, and
// this is the proof. Each line of kernels.inl becomes the __global__ wrapper that a CUDA backend
// launches (static: two precisions meet in one program). Nothing is launched here, so no GPU is
// needed. Built once for float and once for double.
#include "all.h"

// CUDA passes at most 4 KiB of arguments to a kernel on every architecture
#define CLOTH_KERNEL(name, serial)                                                                         \
  static_assert(sizeof(cloth_##name##_args) + sizeof(int) <= 4096, #name);                         \
  static __global__ void cloth_##name##_kernel(int n, const cloth_##name##_args args)              \
  {                                                                                                \
    int i = (int)(blockIdx.x * blockDim.x + threadIdx.x);                                          \
    if (i < n) cloth_##name(i, &args);                                                             \
  }
#include "kernels.inl"
#undef CLOTH_KERNEL

#ifdef CLOTH_SINGLE_PRECISION
#define CLOTH_CUDA_KERNELS cloth_cuda_kernels_f32
#else
#define CLOTH_CUDA_KERNELS cloth_cuda_kernels_f64
#endif

extern "C" {
extern const void *const CLOTH_CUDA_KERNELS[];
/// The wrappers, in the order of kernels.inl.
const void *const CLOTH_CUDA_KERNELS[] = {
#define CLOTH_KERNEL(name, serial) (const void *)cloth_##name##_kernel,
#include "kernels.inl"
#undef CLOTH_KERNEL
};
}
