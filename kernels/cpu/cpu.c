// The plain CPU backend: calls run at once, so queues and events have nothing to do.
#include "backend.h"
#include "loops.h"
#include "solve.h"
#include "solve_parts.h"
#include "sort.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

struct cloth_device {
  int index;
  int threads;
};

static int device_count(void) { return 64; } // as many parts as a scene may have

static cloth_status open_device(int index, int threads, cloth_device **out, cloth_error *err)
{
  cloth_device *d = malloc(sizeof *d);
  if (d == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "cpu device %d: out of memory", index);
  d->index = index;
  d->threads = threads > 0 ? threads : omp_get_max_threads();
  *out = d;
  return CLOTH_OK;
}

static void close_device(cloth_device *device) { free(device); }

static cloth_status alloc(cloth_device *device, size_t bytes, void **out, cloth_error *err)
{
  *out = calloc(1, bytes ? bytes : 1);
  if (*out == NULL)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "cpu device %d: %zu bytes", device->index, bytes);
  return CLOTH_OK;
}

static void release(cloth_device *device, void *memory) { (void)device, free(memory); }

static cloth_status put(cloth_device *d, void *dst, const void *src, size_t bytes, cloth_error *err)
{
  (void)d, (void)err;
  if (bytes > 0) memcpy(dst, src, bytes);
  return CLOTH_OK;
}

static cloth_status copy(cloth_device *from, cloth_device *to, void *dst, const void *src,
                         size_t bytes, cloth_error *err)
{
  (void)to;
  return put(from, dst, src, bytes, err);
}

static cloth_status fill(cloth_device *d, void *dst, int byte, size_t bytes, cloth_error *err)
{
  (void)d, (void)err;
  if (bytes > 0) memset(dst, byte, bytes);
  return CLOTH_OK;
}

static cloth_status launch(cloth_device *d, cloth_kernel k, int n, const void *args,
                           cloth_error *err)
{
  (void)err;
  cloth_loops[k].run(n, d->threads, args);
  return CLOTH_OK;
}

static cloth_status solve(cloth_device *d, const cloth_pcg_solve_args *args, bool *finished,
                          cloth_error *err)
{
  (void)err;
  *finished = false; // a launch costs nothing here
  cloth_cpu_solve(args, d->threads);
  return CLOTH_OK;
}

static cloth_status sort(cloth_device *d, int n, int bits, uint64_t *key, uint32_t *value,
                         uint64_t *key_spare, uint32_t *value_spare, cloth_error *err)
{
  (void)err;
  cloth_cpu_sort(n, bits, key, value, key_spare, value_spare, d->threads);
  return CLOTH_OK;
}

static cloth_status scan(cloth_device *d, int n, uint32_t *array, cloth_error *err)
{
  (void)d, (void)err;
  cloth_cpu_scan(n, array);
  return CLOTH_OK;
}

static bool joined(int parts, cloth_device *const *device)
{
  (void)device;
  return parts <= CLOTH_PARTS_MAX;
}

static cloth_status solve_parts(int parts, cloth_device *const *device,
                                const cloth_pcg_part_args *args, cloth_error *err)
{
  return cloth_cpu_solve_parts(parts, args, device[0]->threads, 1, -1, err);
}

static cloth_status event_new(cloth_device *d, cloth_event **out, cloth_error *err)
{
  (void)d, (void)err;
  *out = NULL;
  return CLOTH_OK;
}

static void event_free(cloth_event *event) { (void)event; }

static cloth_status record(cloth_device *d, cloth_queue q, cloth_event *e, cloth_error *err)
{
  (void)d, (void)q, (void)e, (void)err;
  return CLOTH_OK;
}

static cloth_status wait(cloth_device *d, cloth_queue q, const cloth_event *e, cloth_error *err)
{
  (void)d, (void)q, (void)e, (void)err;
  return CLOTH_OK;
}

static cloth_status finish(cloth_device *d, cloth_error *err)
{
  (void)d, (void)err;
  return CLOTH_OK;
}

const cloth_backend *cloth_backend_cpu(void)
{
  static const cloth_backend backend = {
      .name = "cpu",
      .row_group = CLOTH_ROW_GROUP,
      .run_ahead = 1,
      .device_count = device_count,
      .open = open_device,
      .close = close_device,
      .alloc = alloc,
      .release = release,
      .write = put,
      .read = put,
      .copy = copy,
      .move = put,
      .fill = fill,
      .joined = joined,
      .solve_parts = solve_parts,
      .launch = launch,
      .solve = solve,
      .sort = sort,
      .scan = scan,
      .event_new = event_new,
      .event_free = event_free,
      .record = record,
      .wait = wait,
      .finish = finish,
  };
  return &backend;
}
