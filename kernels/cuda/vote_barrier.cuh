// Barriers with a vote, among all blocks of a kernel: each thread votes when it arrives, and behind
// the barrier all know whether anybody voted yes (__syncthreads_or() of all blocks), at no further
// cost. In two halves, so that a block can work while it waits. Every thread of every block must
// come to both. What a block wrote before it arrived is seen by all that have waited.
#pragma once

#include "count.cuh"

#include <cuda_runtime_api.h>

struct cloth_vote_state { // in device memory, zero before the launch
  unsigned long long arrived[2];
};

/// All blocks of a cooperative launch. Turns alternate between two words: nobody arrives at a word
/// again before all have left it. The lower half of a word counts blocks, the upper half those of
/// them that voted yes.
struct cloth_grid_vote {
  cloth_vote_state *state;
  unsigned turn, known, known_before; // yes votes at this word, at the other one, so far

  __device__ explicit cloth_grid_vote(cloth_vote_state *s)
      : state(s), turn(0), known(0), known_before(0)
  {
  }

  __device__ void arrive(bool yes)
  {
    bool any = __syncthreads_or(yes) != 0;
    unsigned before = known;
    known = known_before, known_before = before;
    turn++;
    if (threadIdx.x == 0)
      cloth_count_up_wide(&state->arrived[turn & 1], any ? (1ull << 32) + 1 : 1);
  }

  __device__ bool wait()
  {
    bool any = false;
    if (threadIdx.x == 0) {
      unsigned blocks = (turn + 1) / 2 * gridDim.x;
      unsigned long long now;
      do now = cloth_count_of_wide(&state->arrived[turn & 1]);
      while ((unsigned)now < blocks);
      any = (unsigned)(now >> 32) != known;
      known = (unsigned)(now >> 32);
    }
    return __syncthreads_or(any) != 0;
  }

  __device__ void sync()
  {
    arrive(false);
    wait();
  }
};

/// One cluster of blocks (sm_90). A block that votes yes writes the turn into the shared memory of
/// every block; two words, as nobody is more than one turn ahead.
struct cloth_cluster_vote {
  unsigned *heard; // [2] in shared memory, the same place in every block
  unsigned turn;

  __device__ explicit cloth_cluster_vote(unsigned *shared) : heard(shared), turn(0)
  {
    if (threadIdx.x < 2) heard[threadIdx.x] = 0; // nobody votes in the first turn, or writes yet
  }

  __device__ void arrive(bool yes)
  {
    bool any = __syncthreads_or(yes) != 0;
    turn++;
    if (any && threadIdx.x < gridDim.x) write(heard + (turn & 1), threadIdx.x, turn);
#if __CUDA_ARCH__ >= 900
    asm volatile("barrier.cluster.arrive.release.aligned;" ::: "memory");
#endif
  }

  __device__ bool wait()
  {
#if __CUDA_ARCH__ >= 900
    asm volatile("barrier.cluster.wait.acquire.aligned;" ::: "memory");
#endif
    return heard[turn & 1] == turn;
  }

  __device__ void sync()
  {
    arrive(false);
    wait();
  }

private:
  static __device__ void write(unsigned *at, unsigned block, unsigned value)
  {
#if __CUDA_ARCH__ >= 900
    unsigned here = (unsigned)__cvta_generic_to_shared(at), there;
    asm volatile("mapa.shared::cluster.u32 %0, %1, %2;" : "=r"(there) : "r"(here), "r"(block));
    asm volatile("st.shared::cluster.u32 [%0], %1;" ::"r"(there), "r"(value) : "memory");
#endif
  }
};
