// Barriers among all blocks of a kernel, two ways: through device memory for as many blocks as are
// resident, and in hardware for one cluster of blocks (sm_90), several times faster. What a block
// wrote before a barrier is seen by all after it.
#pragma once

#include "count.cuh"

#include <cuda_runtime_api.h>

struct cloth_barrier_state { // in device memory, zero before the launch
  unsigned arrived;
};

/// All blocks of a cooperative launch. In two halves, so that a block can work while it waits.
struct cloth_grid_barrier {
  cloth_barrier_state *state;
  unsigned barriers; // passed by this block

  __device__ explicit cloth_grid_barrier(cloth_barrier_state *s) : state(s), barriers(0) {}

  __device__ void arrive()
  {
    barriers++;
    __syncthreads();
    if (threadIdx.x == 0) cloth_count_up(&state->arrived);
  }

  __device__ void wait()
  {
    while (threadIdx.x == 0 && cloth_count_of(&state->arrived) < barriers * gridDim.x) {}
    __syncthreads();
  }

  __device__ void sync()
  {
    arrive();
    wait();
  }
};

/// One cluster of blocks.
struct cloth_cluster_barrier {
  __device__ void sync()
  {
#if __CUDA_ARCH__ >= 900
    asm volatile("barrier.cluster.arrive.release.aligned;\n"
                 "barrier.cluster.wait.acquire.aligned;" ::
                     : "memory");
#endif
  }
};

/// A kernel of one cluster: what the launch needs.
struct cloth_cluster_launch {
  cudaLaunchConfig_t config;
  cudaLaunchAttribute size;
};

/// `blocks` blocks of `threads` threads with `shared` bytes of dynamic shared memory each. config
/// points into *l, so it is filled where it stays.
inline void cloth_cluster_of(cloth_cluster_launch *l, int blocks, int threads, size_t shared,
                             cudaStream_t stream)
{
  *l = {};
  l->size.id = cudaLaunchAttributeClusterDimension;
  l->size.val.clusterDim.x = (unsigned)blocks;
  l->size.val.clusterDim.y = l->size.val.clusterDim.z = 1;
  l->config.gridDim = dim3((unsigned)blocks), l->config.blockDim = dim3((unsigned)threads);
  l->config.dynamicSmemBytes = shared;
  l->config.stream = stream, l->config.attrs = &l->size, l->config.numAttrs = 1;
}
