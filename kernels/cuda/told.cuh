// Barriers among all blocks of a kernel at which a block may tell the others something: behind the
// barrier all know whether anybody did, at no further cost, and all know the same. In two halves,
// so that a block can work while it waits. Every thread of every block must come to both. What a
// block wrote before it arrived is seen by all that have waited.
#pragma once

#include <cuda_runtime_api.h>

struct cloth_told_state { // in device memory, zero before the launch
  unsigned long long arrived[2];
};

/// All blocks of a cooperative launch. Turns alternate between two words: nobody arrives at a word
/// again before all have left it. A word counts blocks below, and those of them that told above.
struct cloth_told_grid {
  cloth_told_state *state;
  unsigned turn, known, known_before; // told at this word, at the other one, so far

  __device__ explicit cloth_told_grid(cloth_told_state *s)
      : state(s), turn(0), known(0), known_before(0)
  {
  }

  __device__ void arrive(bool tell)
  {
    bool any = __syncthreads_or(tell) != 0;
    unsigned before = known;
    known = known_before, known_before = before;
    turn++;
    if (threadIdx.x == 0) count_up(&state->arrived[turn & 1], any ? (1ull << 32) + 1 : 1);
  }

  __device__ bool wait()
  {
    bool told = false;
    if (threadIdx.x == 0) {
      unsigned blocks = (turn + 1) / 2 * gridDim.x;
      unsigned long long now;
      do now = look(&state->arrived[turn & 1]);
      while ((unsigned)now < blocks);
      told = (unsigned)(now >> 32) != known;
      known = (unsigned)(now >> 32);
    }
    return __syncthreads_or(told) != 0;
  }

  __device__ void sync()
  {
    arrive(false);
    wait();
  }

private:
  // Counting releases and looking acquires: enough, because a block's threads meet before and
  // after.
  static __device__ void count_up(unsigned long long *at, unsigned long long by)
  {
    asm volatile("red.release.gpu.global.add.u64 [%0], %1;" ::"l"(at), "l"(by) : "memory");
  }

  static __device__ unsigned long long look(const unsigned long long *at)
  {
    unsigned long long now;
    asm volatile("ld.acquire.gpu.global.u64 %0, [%1];" : "=l"(now) : "l"(at) : "memory");
    return now;
  }
};

/// One cluster of blocks (sm_90). Who tells something writes the turn into the shared memory of
/// every block; two words, as nobody is more than one turn ahead.
struct cloth_told_cluster {
  unsigned *heard; // [2] in shared memory, the same place in every block
  unsigned turn;

  __device__ explicit cloth_told_cluster(unsigned *shared) : heard(shared), turn(0)
  {
    if (threadIdx.x < 2) heard[threadIdx.x] = 0; // the first turn tells nothing: nobody writes yet
  }

  __device__ void arrive(bool tell)
  {
    bool any = __syncthreads_or(tell) != 0;
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
