// Says which element kernels were compiled for the GPU. Where a GPU is present, the driver is asked
// whether it finds code for it in every wrapper.
#include <cstdio>
#include <cuda_runtime_api.h>

extern "C" const void *const cloth_cuda_kernels_f32[];
extern "C" const void *const cloth_cuda_kernels_f64[];

static const char *const name[] = {
#define CLOTH_KERNEL(name, serial) #name,
#include "kernels.inl"
#undef CLOTH_KERNEL
};

static int check(const char *precision, const void *const *kernel, bool gpu)
{
  int failures = 0, count = static_cast<int>(sizeof name / sizeof *name);
  for (int k = 0; k < count; k++) {
    cudaFuncAttributes a;
    cudaError_t e = gpu ? cudaFuncGetAttributes(&a, kernel[k]) : cudaSuccess;
    if (e != cudaSuccess) std::printf("%s: %s\n", name[k], cudaGetErrorString(e));
    std::printf("%s %s_%s_compiles_for_cuda\n", e == cudaSuccess ? "ok  " : "FAIL", name[k],
                precision);
    failures += e != cudaSuccess;
  }
  return failures;
}

int main()
{
  int devices = 0;
  bool gpu = cudaGetDeviceCount(&devices) == cudaSuccess && devices > 0;
  if (!gpu) std::printf("no GPU here: compiled, not asked of a driver\n");
  return check("f32", cloth_cuda_kernels_f32, gpu) + check("f64", cloth_cuda_kernels_f64, gpu) > 0;
}
