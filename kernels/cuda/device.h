// What the files of the CUDA backend share. Private to kernels/cuda.
#pragma once

#include "backend.h"

#include <cuda_runtime_api.h>

enum { CLOTH_POSTS = 4 }; // runs of few numbers that one read hands to the host

/// Words that go from the device to the host.
struct cloth_post {
  const uint32_t *from;
  void *host;
  int words;
};

struct cloth_device {
  int index;
  cudaStream_t stream[CLOTH_QUEUE_COUNT];
  void *pinned;                 // staging of reads and writes, PINNED_BYTES and a number
  unsigned reads;               // of few bytes so far
  cloth_post post[CLOTH_POSTS]; // what the next read reads; the last one is that read's own
  int posts;
  void *scratch; // of sort, scan and solve: grown, kept
  size_t scratch_bytes;
  int multiprocessors;
  size_t shared_bytes; // most a block may ask for
  int solve_blocks;    // of a cooperative launch; 0: not asked yet
  int cluster_blocks;  // of a cluster; 1: there are none, 0: not asked yet
  int part_blocks;     // the same of solve_parts.cu
  int spring_blocks;   // of a cluster of spring.cu; 0: not asked yet, 1: there are none
  int spring_threads;  // most of a block there
};

struct cloth_event {
  cudaEvent_t event;
  int device;
};

/// A CUDA error as a status: CLOTH_NO_MEMORY, CLOTH_DEVICE_LOST, CLOTH_UNSUPPORTED or
/// CLOTH_INTERNAL.
cloth_status cloth_cuda_fail(cudaError_t e, const char *what, const char *file, int line,
                             cloth_error *err);

/// Call the runtime; on failure return the status.
#define CUDA_TRY(err, call)                                                                        \
  do {                                                                                             \
    cudaError_t e_ = (call);                                                                       \
    if (e_ != cudaSuccess) return cloth_cuda_fail(e_, #call, __FILE__, __LINE__, err);             \
  } while (0)

/// Scratch memory of at least this size; contents are lost. In order with COMPUTE.
cloth_status cloth_cuda_scratch(cloth_device *d, size_t bytes, void **out, cloth_error *err);

/// The table's entries that live in other files.
cloth_status cloth_cuda_launch(cloth_device *d, cloth_kernel k, int n, const void *args,
                               cloth_error *err);
cloth_status cloth_cuda_sort(cloth_device *d, int n, int bits, uint64_t *key, uint32_t *value,
                             uint64_t *key_spare, uint32_t *value_spare, cloth_error *err);
cloth_status cloth_cuda_scan(cloth_device *d, int n, uint32_t *array, cloth_error *err);
cloth_status cloth_cuda_solve(cloth_device *d, const struct cloth_pcg_solve_args *args,
                              bool *finished, cloth_error *err);
/// The same for a cloth that is small enough, which `taken` says; then it is finished, too.
cloth_status cloth_cuda_solve_small(cloth_device *d, const struct cloth_pcg_solve_args *args,
                                    bool *taken, cloth_error *err);
cloth_status cloth_cuda_spring_block(cloth_device *d, const struct cloth_spring_block_args *args,
                                     cloth_error *err);
bool cloth_cuda_joined(int parts, cloth_device *const *device);
cloth_status cloth_cuda_solve_parts(int parts, cloth_device *const *device,
                                    const struct cloth_pcg_part_args *args, cloth_error *err);
void cloth_cuda_range_begin(const char *name);
void cloth_cuda_range_end(void);
