#include "loops.h"

// share() is a plain loop over a range, so that the compiler may vectorise and clone it. The
// parallel loop around it gives each thread the same part of the range in every launch, so that
// what one kernel wrote is still in the cache of the core on which the next one reads it; only
// kernels whose elements differ much are dealt out in smaller pieces to whoever is free.
#define LOOP(name, serial, pieces, how)                                                            \
  CLOTH_CLONES static void share_##name(int begin, int end, const void *args)                      \
  {                                                                                                \
    const cloth_##name##_args *a = args;                                                           \
    for (int i = begin; i < end; i++) cloth_##name(i, a);                                          \
  }                                                                                                \
  static void loop_##name(int n, int threads, const void *args)                                    \
  {                                                                                                \
    if (n < serial || threads == 1) {                                                              \
      share_##name(0, n, args);                                                                    \
      return;                                                                                      \
    }                                                                                              \
    int shares = threads * pieces;                                                                 \
    _Pragma(how) for (int s = 0; s < shares; s++)                                                  \
        share_##name((int)((int64_t)n * s / shares), (int)((int64_t)n * (s + 1) / shares), args);  \
  }
#define CLOTH_KERNEL(name, serial)                                                                 \
  LOOP(name, serial, 1, "omp parallel for schedule(static) num_threads(threads)")
#define CLOTH_KERNEL_UNEVEN(name, serial)                                                          \
  LOOP(name, serial, 4, "omp parallel for schedule(dynamic) num_threads(threads)")
#include "kernels.inl"
#undef CLOTH_KERNEL
#undef CLOTH_KERNEL_UNEVEN

const cloth_loop_entry cloth_loops[] = {
#define CLOTH_KERNEL(name, serial) {loop_##name, share_##name, sizeof(cloth_##name##_args)},
#include "kernels.inl"
#undef CLOTH_KERNEL
};
