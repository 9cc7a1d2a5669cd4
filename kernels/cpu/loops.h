// The element kernels as OpenMP loops, one table entry per line of kernels.inl.
#pragma once

#include "all.h"

#include <stddef.h>

typedef void cloth_loop(int n, int threads, const void *args);
typedef void cloth_loop_share(int begin, int end, const void *args);

// Clones for processors with AVX2 are chosen when the program starts. Without contraction to fused
// multiply-add (-ffp-contract=off) they give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__)
#define CLOTH_CLONES __attribute__((target_clones("avx2", "default"), flatten))
#else
#define CLOTH_CLONES
#endif

typedef struct cloth_loop_entry {
  cloth_loop *run;
  cloth_loop_share *share; // a part of it by the calling thread
  size_t args_bytes;
} cloth_loop_entry;

/// [CLOTH_KERNEL_COUNT], in loops.c.
extern const cloth_loop_entry cloth_loops[];
