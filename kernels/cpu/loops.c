#include "loops.h"

// share() is a plain loop over a range, so that the compiler may vectorise and clone it; the
// parallel loop around it deals out equal ranges.
#define CLOTH_KERNEL(name, serial)                                                                 \
  CLOTH_CLONES static void share_##name(int begin, int end, const cloth_##name##_args *a)          \
  {                                                                                                \
    for (int i = begin; i < end; i++) cloth_##name(i, a);                                          \
  }                                                                                                \
  static void loop_##name(int n, int threads, const void *args)                                    \
  {                                                                                                \
    if (n < serial || threads == 1) {                                                              \
      share_##name(0, n, args);                                                                    \
      return;                                                                                      \
    }                                                                                              \
    int shares = threads * 4;                                                                      \
    _Pragma("omp parallel for schedule(dynamic) num_threads(threads)") for (int s = 0; s < shares; \
                                                                            s++)                   \
        share_##name((int)((int64_t)n * s / shares), (int)((int64_t)n * (s + 1) / shares), args);  \
  }
#include "kernels.inl"
#undef CLOTH_KERNEL

const cloth_loop_entry cloth_loops[] = {
#define CLOTH_KERNEL(name, serial) {loop_##name, sizeof(cloth_##name##_args)},
#include "kernels.inl"
#undef CLOTH_KERNEL
};
