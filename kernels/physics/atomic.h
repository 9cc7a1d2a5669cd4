// Integer atomics for element kernels. Used only where the result does not depend on the order:
// counting, setting bits, appending to a list that is sorted afterwards, taking a minimum.
#pragma once

#include "real.h"

/// Add n to *p; the value before.
CLOTH_FN uint32_t cloth_atomic_add(uint32_t *p, uint32_t n)
{
#ifdef __CUDA_ARCH__
  return atomicAdd(p, n);
#else
  return __atomic_fetch_add(p, n, __ATOMIC_RELAXED);
#endif
}

/// Add 1 to *p; the value before. On a GPU the threads of a warp that are here together ask once.
CLOTH_FN uint32_t cloth_atomic_next(uint32_t *p)
{
#ifdef __CUDA_ARCH__
  unsigned here = __activemask(), lane;
  asm("mov.u32 %0, %%laneid;" : "=r"(lane));
  int leader = __ffs((int)here) - 1;
  uint32_t first = 0;
  if ((int)lane == leader) first = atomicAdd(p, (uint32_t)__popc(here));
  first = __shfl_sync(here, first, leader);
  return first + (uint32_t)__popc(here & ((1u << lane) - 1));
#else
  return cloth_atomic_add(p, 1);
#endif
}

/// Lower *p to v if v is smaller.
CLOTH_FN void cloth_atomic_min(uint32_t *p, uint32_t v)
{
#ifdef __CUDA_ARCH__
  atomicMin(p, v);
#else
  uint32_t old = __atomic_load_n(p, __ATOMIC_RELAXED);
  while (v < old &&
         !__atomic_compare_exchange_n(p, &old, v, 1, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
#endif
}

/// Set the bits of v in *p.
CLOTH_FN void cloth_atomic_or(uint32_t *p, uint32_t v)
{
#ifdef __CUDA_ARCH__
  atomicOr(p, v);
#else
  __atomic_fetch_or(p, v, __ATOMIC_RELAXED);
#endif
}
