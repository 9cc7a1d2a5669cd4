// CUDA's words for kernels that run on a CPU, so that a test can run what no GPU is there for. A
// thread of a block is a fiber, a block is a thread of the host; barriers and warps are counted
// out. What a GPU may do and this does not: run two threads of a block at the same instant, or let
// others see writes late.
#pragma once

#include <stddef.h>
#include <stdint.h>

#define __device__
#define __host__
#define __global__
#define __forceinline__ inline
#define __grid_constant__
#define __launch_bounds__(...)
#define __align__(n) __attribute__((aligned(n)))
#define __shared__   static thread_local
#define asm                                                                                        \
  if (0) __asm__ // PTX is what the emulator does otherwise

struct dim3 {
  unsigned x, y, z;
  constexpr dim3(unsigned a = 1, unsigned b = 1, unsigned c = 1) : x(a), y(b), z(c) {}
};

extern thread_local dim3 threadIdx, blockIdx, blockDim, gridDim;

// ---- threads of a block -------------------------------------------------------------------------

namespace emulated {

/// `kernel` by `blocks` blocks of `threads` threads. Called by a thread of the host for each block.
void run_block(unsigned block, unsigned blocks, unsigned threads, void (*kernel)(void *),
               void *args);

/// The other threads of the block get on.
void yield();

/// All threads of the block, of the warp.
void meet_block();
void meet_warp();

/// A lane's place in its warp's shared memory.
uint64_t *lane_slot(unsigned lane);

template <typename T> T exchange(T value, unsigned from)
{
  T *mine = reinterpret_cast<T *>(lane_slot(threadIdx.x % 32));
  *mine = value;
  meet_warp();
  value = *reinterpret_cast<T *>(lane_slot(from));
  meet_warp();
  return value;
}

} // namespace emulated

inline void __syncthreads() { emulated::meet_block(); }
inline void __syncwarp() { emulated::meet_warp(); }
inline void __threadfence() { __atomic_thread_fence(__ATOMIC_SEQ_CST); }
inline void __threadfence_system() { __atomic_thread_fence(__ATOMIC_SEQ_CST); }
inline int __popc(unsigned v) { return __builtin_popcount(v); }

template <typename T> T __shfl_down_sync(unsigned, T v, unsigned by, unsigned width = 32)
{
  unsigned lane = threadIdx.x % 32;
  return emulated::exchange(v, lane % width + by < width ? lane + by : lane);
}

template <typename T> T __shfl_xor_sync(unsigned, T v, unsigned by)
{
  return emulated::exchange(v, threadIdx.x % 32 ^ by);
}

template <typename T> T __shfl_sync(unsigned, T v, unsigned from)
{
  return emulated::exchange(v, from);
}

inline unsigned __ballot_sync(unsigned, bool there)
{
  unsigned all = 0;
  *emulated::lane_slot(threadIdx.x % 32) = there;
  emulated::meet_warp();
  for (unsigned lane = 0; lane < 32; lane++)
    all |= (unsigned)(*emulated::lane_slot(lane) != 0) << lane;
  emulated::meet_warp();
  return all;
}

template <typename T> T atomicAdd(T *at, T by)
{
  return __atomic_fetch_add(at, by, __ATOMIC_RELAXED);
}
inline unsigned atomicAdd(unsigned *at, int by)
{
  return __atomic_fetch_add(at, (unsigned)by, __ATOMIC_RELAXED);
}

// ---- the host's half: nothing is there ----------------------------------------------------------

typedef int cudaError_t;
typedef struct stream *cudaStream_t;
typedef struct event *cudaEvent_t;
enum {
  cudaSuccess,
  cudaErrorNotSupported,
  cudaLaunchAttributeClusterDimension,
  cudaDevAttrComputeCapabilityMajor,
  cudaFuncAttributeNonPortableClusterSizeAllowed,
  cudaFuncAttributeMaxDynamicSharedMemorySize
};

struct cudaLaunchAttribute {
  int id;
  struct {
    dim3 clusterDim;
  } val;
};

struct cudaLaunchConfig_t {
  dim3 gridDim, blockDim;
  size_t dynamicSmemBytes;
  cudaStream_t stream;
  cudaLaunchAttribute *attrs;
  unsigned numAttrs;
};

inline cudaError_t cudaSetDevice(int) { return cudaErrorNotSupported; }
inline cudaError_t cudaGetLastError() { return cudaErrorNotSupported; }
inline cudaError_t cudaDeviceCanAccessPeer(int *, int, int) { return cudaErrorNotSupported; }
inline cudaError_t cudaMemsetAsync(void *, int, size_t, cudaStream_t)
{
  return cudaErrorNotSupported;
}

template <typename Kernel>
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessor(int *, Kernel, int, size_t)
{
  return cudaErrorNotSupported;
}

template <typename Kernel>
cudaError_t cudaLaunchCooperativeKernel(Kernel, dim3, dim3, void **, size_t, cudaStream_t)
{
  return cudaErrorNotSupported;
}

inline cudaError_t cudaDeviceGetAttribute(int *, int, int) { return cudaErrorNotSupported; }

template <typename Kernel> cudaError_t cudaFuncSetAttribute(Kernel, int, int)
{
  return cudaErrorNotSupported;
}

template <typename Kernel>
cudaError_t cudaOccupancyMaxActiveClusters(int *, Kernel, const cudaLaunchConfig_t *)
{
  return cudaErrorNotSupported;
}

template <typename Kernel, typename Args>
cudaError_t cudaLaunchKernelEx(const cudaLaunchConfig_t *, Kernel, const Args &)
{
  return cudaErrorNotSupported;
}
