// A CPU backend for tests: work is queued, and finish() runs the queues of all devices in a
// random order that respects only what a GPU would respect: the order within a queue and the
// events between queues. It finds missing waits without a GPU.
#include "backend.h"
#include "loops.h"
#include "sort.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEVICES = 16, MAX_JOBS = 4096, MAX_ARGS = 512, MAX_READS = 16 };

struct cloth_event {
  int issued; // records queued so far
  int passed; // records executed so far
};

typedef struct job {
  enum { JOB_COPY, JOB_FILL, JOB_LAUNCH, JOB_SORT, JOB_SCAN, JOB_RECORD, JOB_WAIT } type;
  void *dst; // sort: keys
  const void *src;
  size_t bytes;
  cloth_kernel kernel;
  int n;
  int bits; // of a sort; the byte of a fill
  uint32_t *value, *value_spare;
  uint64_t *key_spare;
  cloth_event *event;
  int ticket; // which record of the event
  _Alignas(max_align_t) unsigned char args[MAX_ARGS];
} job;

typedef struct promise { // of a read
  void *host;
  const void *src;
  size_t bytes;
} promise;

struct cloth_device {
  job *jobs[CLOTH_QUEUE_COUNT];
  int head[CLOTH_QUEUE_COUNT], tail[CLOTH_QUEUE_COUNT];
  promise promised[MAX_READS]; // with the next read
  int promises;
};

// the backend is a process-wide test tool; its open devices and its dice are its only state
static cloth_device *g_device[MAX_DEVICES];
static uint64_t g_dice;

static uint32_t roll(void)
{
  g_dice = g_dice * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)(g_dice >> 33);
}

static int device_count(void) { return MAX_DEVICES; }

static cloth_status open_device(int index, int threads, cloth_device **out, cloth_error *err)
{
  (void)threads;
  int free_slot = 0; // several devices may share an index: parts of one machine
  while (free_slot < MAX_DEVICES && g_device[free_slot] != NULL) free_slot++;
  cloth_device *d = free_slot < MAX_DEVICES ? calloc(1, sizeof *d) : NULL;
  if (d == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "shuffle device %d", index);
  g_device[free_slot] = d;
  *out = d;
  for (int q = 0; q < CLOTH_QUEUE_COUNT; q++) {
    d->jobs[q] = calloc(MAX_JOBS, sizeof(job));
    if (d->jobs[q] == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "shuffle device %d", index);
  }
  return CLOTH_OK;
}

static void close_device(cloth_device *d)
{
  if (d == NULL) return;
  for (int i = 0; i < MAX_DEVICES; i++)
    if (g_device[i] == d) g_device[i] = NULL;
  for (int q = 0; q < CLOTH_QUEUE_COUNT; q++) free(d->jobs[q]);
  free(d);
}

static cloth_status alloc(cloth_device *d, size_t bytes, void **out, cloth_error *err)
{
  (void)d;
  *out = malloc(bytes ? bytes : 1);
  if (*out == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "shuffle: %zu bytes", bytes);
  memset(*out, 0xff, bytes); // NaN: reading what nobody wrote is visible
  return CLOTH_OK;
}

static void release(cloth_device *d, void *memory) { (void)d, free(memory); }

// run the head of one queue if the events allow it; return 1 if it ran
static int advance(cloth_device *d, int q)
{
  if (d->head[q] == d->tail[q]) return 0;
  job *j = &d->jobs[q][d->head[q] % MAX_JOBS];
  if (j->type == JOB_WAIT && j->event->passed < j->ticket) return 0;
  if (j->type == JOB_COPY && j->bytes > 0) memcpy(j->dst, j->src, j->bytes);
  if (j->type == JOB_FILL && j->bytes > 0) memset(j->dst, j->bits, j->bytes);
  if (j->type == JOB_LAUNCH) cloth_loops[j->kernel].run(j->n, 1, j->args);
  if (j->type == JOB_SORT)
    cloth_cpu_sort(j->n, j->bits, j->dst, j->value, j->key_spare, j->value_spare, 1);
  if (j->type == JOB_SCAN) cloth_cpu_scan(j->n, j->dst);
  if (j->type == JOB_RECORD) j->event->passed = j->ticket;
  d->head[q]++;
  return 1;
}

// run everything that the events allow, in random order: at each turn every queue that has work is
// equally likely to come first
static void drain(void)
{
  for (;;) {
    int waiting[MAX_DEVICES * CLOTH_QUEUE_COUNT], n = 0, done = 0;
    for (int s = 0; s < MAX_DEVICES * CLOTH_QUEUE_COUNT; s++) {
      const cloth_device *d = g_device[s / CLOTH_QUEUE_COUNT];
      int q = s % CLOTH_QUEUE_COUNT;
      if (d != NULL && d->head[q] != d->tail[q]) waiting[n++] = s;
    }
    int first = n > 0 ? (int)(roll() % (unsigned)n) : 0;
    for (int k = 0; k < n && !done; k++) { // the first that can advance
      int s = waiting[(first + k) % n];
      done = advance(g_device[s / CLOTH_QUEUE_COUNT], s % CLOTH_QUEUE_COUNT);
    }
    if (!done) return; // nothing can advance
  }
}

static job *push(cloth_device *d, cloth_queue q)
{
  if (d->tail[q] - d->head[q] == MAX_JOBS) drain(); // full: run what may run
  job *j = &d->jobs[q][d->tail[q]++ % MAX_JOBS];
  memset(j, 0, sizeof *j);
  return j;
}

static cloth_status copy_on(cloth_device *d, cloth_queue q, void *dst, const void *src,
                            size_t bytes)
{
  job *j = push(d, q);
  j->type = JOB_COPY, j->dst = dst, j->src = src, j->bytes = bytes;
  return CLOTH_OK;
}

static cloth_status copy(cloth_device *from, cloth_device *to, void *dst, const void *src,
                         size_t bytes, cloth_error *err)
{
  (void)to, (void)err;
  return copy_on(from, CLOTH_COPY, dst, src, bytes);
}

static cloth_status move(cloth_device *d, void *dst, const void *src, size_t bytes,
                         cloth_error *err)
{
  (void)err;
  return copy_on(d, CLOTH_COMPUTE, dst, src, bytes);
}

static cloth_status fill(cloth_device *d, void *dst, int byte, size_t bytes, cloth_error *err)
{
  (void)err;
  job *j = push(d, CLOTH_COMPUTE);
  j->type = JOB_FILL, j->dst = dst, j->bits = byte, j->bytes = bytes;
  return CLOTH_OK;
}

static cloth_status sort(cloth_device *d, int n, int bits, uint64_t *key, uint32_t *value,
                         uint64_t *key_spare, uint32_t *value_spare, cloth_error *err)
{
  (void)err;
  job *j = push(d, CLOTH_COMPUTE);
  j->type = JOB_SORT, j->dst = key, j->n = n, j->bits = bits;
  j->value = value, j->key_spare = key_spare, j->value_spare = value_spare;
  return CLOTH_OK;
}

static cloth_status scan(cloth_device *d, int n, uint32_t *array, cloth_error *err)
{
  (void)err;
  job *j = push(d, CLOTH_COMPUTE);
  j->type = JOB_SCAN, j->dst = array, j->n = n;
  return CLOTH_OK;
}

static cloth_status launch(cloth_device *d, cloth_kernel k, int n, const void *args,
                           cloth_error *err)
{
  if (cloth_loops[k].args_bytes > MAX_ARGS)
    CLOTH_FAIL(err, CLOTH_INTERNAL, "kernel %d: args too big", k);
  job *j = push(d, CLOTH_COMPUTE);
  j->type = JOB_LAUNCH, j->kernel = k, j->n = n;
  memcpy(j->args, args, cloth_loops[k].args_bytes);
  return CLOTH_OK;
}

static cloth_status event_new(cloth_device *d, cloth_event **out, cloth_error *err)
{
  (void)d;
  *out = calloc(1, sizeof **out);
  if (*out == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "shuffle: event");
  return CLOTH_OK;
}

static void event_free(cloth_event *event) { free(event); }

static cloth_status record(cloth_device *d, cloth_queue q, cloth_event *e, cloth_error *err)
{
  (void)err;
  job *j = push(d, q);
  j->type = JOB_RECORD, j->event = e, j->ticket = ++e->issued;
  return CLOTH_OK;
}

static cloth_status wait(cloth_device *d, cloth_queue q, const cloth_event *e, cloth_error *err)
{
  (void)err;
  job *j = push(d, q);
  j->type = JOB_WAIT, j->event = (cloth_event *)(uintptr_t)e, j->ticket = e->issued;
  return CLOTH_OK;
}

static cloth_status finish(cloth_device *device, cloth_error *err)
{
  drain();
  for (int q = 0; q < CLOTH_QUEUE_COUNT; q++)
    if (device->head[q] != device->tail[q]) CLOTH_FAIL(err, CLOTH_INTERNAL, "queue %d is stuck", q);
  return CLOTH_OK;
}

static cloth_status put(cloth_device *d, void *dst, const void *src, size_t bytes, cloth_error *err)
{
  CLOTH_TRY(finish(d, err));
  memcpy(dst, src, bytes);
  return CLOTH_OK;
}

static cloth_status get(cloth_device *d, void *host, const void *src, size_t bytes,
                        cloth_error *err)
{
  CLOTH_TRY(put(d, host, src, bytes, err));
  for (int k = 0; k < d->promises; k++)
    memcpy(d->promised[k].host, d->promised[k].src, d->promised[k].bytes);
  d->promises = 0;
  return CLOTH_OK;
}

static cloth_status get_with(cloth_device *d, void *host, const void *src, size_t bytes,
                             cloth_error *err)
{
  if (d->promises == MAX_READS) return get(d, host, src, bytes, err);
  memset(host, 0xff, bytes); // looking before the read is visible
  d->promised[d->promises++] = (promise){host, src, bytes};
  return CLOTH_OK;
}

const cloth_backend *cloth_backend_shuffle(unsigned seed)
{
  static const cloth_backend backend = {
      .name = "shuffle",
      .row_group = CLOTH_ROW_GROUP,
      .run_ahead = 3,
      .device_count = device_count,
      .open = open_device,
      .close = close_device,
      .alloc = alloc,
      .release = release,
      .write = put,
      .read = get,
      .read_with = get_with,
      .copy = copy,
      .move = move,
      .fill = fill,
      .launch = launch,
      .sort = sort,
      .scan = scan,
      .event_new = event_new,
      .event_free = event_free,
      .record = record,
      .wait = wait,
      .finish = finish,
  };
  g_dice = seed;
  return &backend;
}
