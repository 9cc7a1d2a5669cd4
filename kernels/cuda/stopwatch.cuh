// Time inside a kernel, by the device's own clock.
#pragma once

#include <stdint.h>

static inline __device__ uint64_t cloth_nanoseconds(void)
{
  uint64_t t;
  asm volatile("mov.u64 %0, %globaltimer;" : "=l"(t));
  return t;
}

/// What one thread of a kernel, the first of all, adds up between start() and stop(). NULL: nothing.
struct cloth_stopwatch {
  uint64_t *total; // [1] ns
  uint64_t since;

  __device__ explicit cloth_stopwatch(uint64_t *ns)
      : total(blockIdx.x == 0 && threadIdx.x == 0 ? ns : nullptr), since(0)
  {
  }

  __device__ void start()
  {
    if (total) since = cloth_nanoseconds();
  }

  __device__ void stop() const
  {
    if (total) *total += cloth_nanoseconds() - since;
  }
};
