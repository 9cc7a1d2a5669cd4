// Counters in device memory by which blocks tell each other that they are so far. Counting up
// releases: what the block wrote before its threads met is there before the count. Looking
// acquires. That is cheaper than full fences, and enough, because a block's threads meet before and
// after. "Far": of several devices, which reach each other's memory. "Wide": of 64 bits.
#pragma once

#define CLOTH_COUNTER(scope, count_up, count_of)                                                   \
  static __device__ __forceinline__ void count_up(unsigned *at)                                    \
  {                                                                                                \
    asm volatile("red.release." scope ".global.add.u32 [%0], 1;" ::"l"(at) : "memory");            \
  }                                                                                                \
  static __device__ __forceinline__ unsigned count_of(const unsigned *at)                          \
  {                                                                                                \
    unsigned now;                                                                                  \
    asm volatile("ld.acquire." scope ".global.u32 %0, [%1];" : "=r"(now) : "l"(at) : "memory");    \
    return now;                                                                                    \
  }
CLOTH_COUNTER("gpu", cloth_count_up, cloth_count_of)
CLOTH_COUNTER("sys", cloth_count_up_far, cloth_count_of_far)
#undef CLOTH_COUNTER

static __device__ __forceinline__ void cloth_count_up_wide(unsigned long long *at,
                                                           unsigned long long by)
{
  asm volatile("red.release.gpu.global.add.u64 [%0], %1;" ::"l"(at), "l"(by) : "memory");
}

static __device__ __forceinline__ unsigned long long
cloth_count_of_wide(const unsigned long long *at)
{
  unsigned long long now;
  asm volatile("ld.acquire.gpu.global.u64 %0, [%1];" : "=l"(now) : "l"(at) : "memory");
  return now;
}
