// What the engine asks of a machine: memory, copies, launches, ordering, and the few operations whose
// shape depends on the machine (sort, scan). Everything the engine does on n devices is written
// against this table, so that two "devices" can be two GPUs, or two arrays on one CPU in a unit test.
#pragma once

#include "status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// One enumerator per line of kernels.inl.
typedef enum cloth_kernel {
#define CLOTH_KERNEL(name, serial) CLOTH_KERNEL_##name,
#include "kernels.inl"
#undef CLOTH_KERNEL
  CLOTH_KERNEL_COUNT
} cloth_kernel;

/// A device runs two in-order queues; work on different queues is ordered by events only.
typedef enum cloth_queue { CLOTH_COMPUTE, CLOTH_COPY, CLOTH_QUEUE_COUNT } cloth_queue;

typedef struct cloth_device cloth_device; // private to the backend
typedef struct cloth_event cloth_event;   // private to the backend

struct cloth_pcg_solve_args; // pcg_solve.h
struct cloth_pcg_part_args;  // pcg_part.h
struct cloth_spring_block_args; // spring_block.h

typedef struct cloth_backend {
  const char *name; // "cpu", "cuda", "shuffle"
  int row_group;    // rows that share a width, as the kernels were compiled: block_rows.h
  int run_ahead;    // solver iterations to queue before the host asks whether it is done

  int (*device_count)(void);
  cloth_status (*open)(int index, int threads, cloth_device **out, cloth_error *err);
  void (*close)(cloth_device *device); // NULL is allowed

  // Memory lives until release(). write() and read() block until COMPUTE is empty; copy() is queued
  // on from's COPY; move() copies inside a device and fill() sets bytes, both queued on COMPUTE.
  cloth_status (*alloc)(cloth_device *device, size_t bytes, void **out, cloth_error *err);
  void (*release)(cloth_device *device, void *memory);
  cloth_status (*write)(cloth_device *device, void *dst, const void *host, size_t bytes, cloth_error *err);
  cloth_status (*read)(cloth_device *device, void *host, const void *src, size_t bytes, cloth_error *err);
  // NULL where a read costs nothing. The next read() also reads this, as it is then; until that has
  // returned, *host must live.
  cloth_status (*read_with)(cloth_device *device, void *host, const void *src, size_t bytes,
                            cloth_error *err);
  cloth_status (*copy)(cloth_device *from, cloth_device *to, void *dst, const void *src, size_t bytes,
                       cloth_error *err);
  cloth_status (*move)(cloth_device *device, void *dst, const void *src, size_t bytes, cloth_error *err);
  cloth_status (*fill)(cloth_device *device, void *dst, int byte, size_t bytes, cloth_error *err);

  // NULL where there is no better way than launch by launch. A whole linear solve of one part on
  // COMPUTE: same steps, same bits. *finished: with the true residual, x += dx and what the host asks.
  cloth_status (*solve)(cloth_device *device, const struct cloth_pcg_solve_args *args, bool *finished,
                        cloth_error *err);

  // NULL where several parts go launch by launch. The same of n parts at once, on COMPUTE of each; they
  // read and write each other's memory, which joined() asks first. A part that does not answer leaves
  // CLOTH_PCG_LOST or is CLOTH_DEVICE_LOST.
  bool (*joined)(int parts, cloth_device *const *device);
  cloth_status (*solve_parts)(int parts, cloth_device *const *device, const struct cloth_pcg_part_args *args,
                              cloth_error *err);

  // NULL where sub-steps of the mass-spring cloth go launch by launch. A block of them of one part on
  // COMPUTE: same bits.
  cloth_status (*spring_block)(cloth_device *device, const struct cloth_spring_block_args *args,
                               cloth_error *err);

  // Run kernel `k` for i in [0, n) on COMPUTE. args is copied before the call returns.
  cloth_status (*launch)(cloth_device *device, cloth_kernel k, int n, const void *args, cloth_error *err);

  // Stable sort of n pairs by the key, which is below 2^bits, on COMPUTE; `value` may be NULL. The spare
  // arrays are as long as the others; the result is in key and value.
  cloth_status (*sort)(cloth_device *device, int n, int bits, uint64_t *key, uint32_t *value,
                       uint64_t *key_spare, uint32_t *value_spare, cloth_error *err);

  // Exclusive prefix sum in place, on COMPUTE: array has n + 1 entries and the last becomes the total.
  cloth_status (*scan)(cloth_device *device, int n, uint32_t *array, cloth_error *err);

  // wait() orders a queue after the record() most recently issued on the event, if any.
  cloth_status (*event_new)(cloth_device *device, cloth_event **out, cloth_error *err);
  void (*event_free)(cloth_event *event); // NULL is allowed
  cloth_status (*record)(cloth_device *device, cloth_queue queue, cloth_event *event, cloth_error *err);
  cloth_status (*wait)(cloth_device *device, cloth_queue queue, const cloth_event *event, cloth_error *err);

  // Time from one event to the other, both recorded on COMPUTE; blocks until the second has passed.
  cloth_status (*elapsed)(const cloth_event *from, const cloth_event *to, double *ms, cloth_error *err);

  // NULL where nobody listens. Name what the host does from here on, for a profiler; ranges nest. Free
  // where no profiler runs.
  void (*range_begin)(const char *name);
  void (*range_end)(void);

  // Block until both queues are empty.
  cloth_status (*finish)(cloth_device *device, cloth_error *err);

  // NULL where memory is the host's. For libraries that work on device memory: COMPUTE as a
  // cudaStream_t, and CUDA's number of the device.
  void *(*stream)(cloth_device *device, int *ordinal);
} cloth_backend;

/// The plain CPU: every call runs at once, element loops in parallel with OpenMP.
const cloth_backend *cloth_backend_cpu(void);

/// NVIDIA GPUs; NULL in a build without CUDA. device_count() is 0 without a driver or a device.
const cloth_backend *cloth_backend_cuda(void);

/// The CPU again, but each finish() runs queued work in a random order that the events allow.
/// A missing wait() is a wrong answer here, on a laptop, instead of a rare one on eight GPUs.
/// Not thread-safe: one scene at a time.
const cloth_backend *cloth_backend_shuffle(unsigned seed);

#ifdef __cplusplus
}
#endif
