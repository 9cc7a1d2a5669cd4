// Counters in device memory by which blocks tell each other that they are so far. Counting up
// releases: what the block wrote before its threads met is there before the count. Looking
// acquires. That is cheaper than full fences, and enough, because a block's threads meet before and
// after. "Far": of several devices, which reach each other's memory.
#pragma once

static __device__ __forceinline__ void cloth_count_up(unsigned *at)
{
  asm volatile("red.release.gpu.global.add.u32 [%0], 1;" ::"l"(at) : "memory");
}

static __device__ __forceinline__ unsigned cloth_count_of(const unsigned *at)
{
  unsigned now;
  asm volatile("ld.acquire.gpu.global.u32 %0, [%1];" : "=r"(now) : "l"(at) : "memory");
  return now;
}

static __device__ __forceinline__ void cloth_count_up_far(unsigned *at)
{
  asm volatile("red.release.sys.global.add.u32 [%0], 1;" ::"l"(at) : "memory");
}

static __device__ __forceinline__ unsigned cloth_count_of_far(const unsigned *at)
{
  unsigned now;
  asm volatile("ld.acquire.sys.global.u32 %0, [%1];" : "=r"(now) : "l"(at) : "memory");
  return now;
}
