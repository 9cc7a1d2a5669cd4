#include "transport/spread.h"

#include <stdlib.h>

struct cloth_event {
  cloth_spread_device *device;
  cloth_event *here; // inner's
};

static const cloth_backend *inner_of_open;
static cloth_transport *transport_of_open;

static cloth_spread_device *of(cloth_device *device)
{
  return (cloth_spread_device *)(void *)device;
}

// ---- errors -------------------------------------------------------------------------------------

static bool is_here(const cloth_spread_device *d) { return d->here && d->failed == CLOTH_OK; }

// how a call to inner went, for later
static cloth_status keep(cloth_spread_device *d, cloth_status status)
{
  d->failed = status;
  return CLOTH_OK;
}

// run on one's own device; otherwise nothing
#define HERE(device, call)                                                                         \
  (is_here(of(device)) ? keep(of(device), of(device)->inner->call) : CLOTH_OK)

static cloth_status tell(const cloth_spread_device *d, cloth_error *err)
{
  if (d->failed == CLOTH_OK) return CLOTH_OK;
  return cloth_fail(err, d->failed, d->why.file, d->why.line, "process %d: %s", d->rank,
                    d->why.text);
}

// how it went on the owner is how it went for all
static cloth_status agreed(const cloth_spread_device *d, cloth_error *err)
{
  cloth_error mine = {0};
  cloth_status status = d->transport->agree(d->transport, tell(d, &mine), &mine);
  if (status == CLOTH_OK) return CLOTH_OK;
  return cloth_fail(err, status, mine.file, mine.line, "%s", mine.text);
}

// ---- devices ------------------------------------------------------------------------------------

static int device_count(void) { return transport_of_open->ranks; }

// processes of one host take its devices in turn
static int own_index(void)
{
  int n = inner_of_open->device_count();
  return n > 0 ? transport_of_open->rank_on_host % n : 0;
}

static void close_device(cloth_device *device)
{
  if (device == NULL) return;
  cloth_spread_device *d = of(device);
  if (d->here) d->inner->close(d->here);
  free(d);
}

static cloth_status open_device(int index, int threads, cloth_device **out, cloth_error *err)
{
  cloth_transport *t = transport_of_open;
  *out = NULL;
  cloth_spread_device *d = calloc(1, sizeof *d);
  if (d == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "device of process %d: host memory", index);
  *d = (cloth_spread_device){.inner = inner_of_open, .transport = t, .rank = index};
  if (index == t->rank) d->failed = d->inner->open(own_index(), threads, &d->here, &d->why);
  cloth_status status = agreed(d, err);
  if (status != CLOTH_OK) {
    close_device((cloth_device *)(void *)d);
    return status;
  }
  *out = (cloth_device *)(void *)d;
  return CLOTH_OK;
}

// ---- memory -------------------------------------------------------------------------------------

// memory of another process's device is an address like any other here, with nothing behind it
static cloth_status alloc(cloth_device *device, size_t bytes, void **out, cloth_error *err)
{
  cloth_spread_device *d = of(device);
  *out = NULL;
  if (is_here(d)) d->failed = d->inner->alloc(d->here, bytes, out, &d->why);
  CLOTH_TRY(agreed(d, err));
  if (d->here) return CLOTH_OK;
  *out = malloc(1);
  if (*out == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "host memory");
  return CLOTH_OK;
}

static void release(cloth_device *device, void *memory)
{
  if (of(device)->here)
    of(device)->inner->release(of(device)->here, memory);
  else
    free(memory);
}

static cloth_status write(cloth_device *device, void *dst, const void *host, size_t bytes,
                          cloth_error *err)
{
  (void)err;
  return HERE(device, write(of(device)->here, dst, host, bytes, &of(device)->why));
}

static cloth_status read(cloth_device *device, void *host, const void *src, size_t bytes,
                         cloth_error *err)
{
  cloth_spread_device *d = of(device);
  const cloth_transport *t = d->transport;
  if (is_here(d)) d->failed = d->inner->read(d->here, host, src, bytes, &d->why);
  int failed = (int)d->failed;
  CLOTH_TRY(t->share(t, d->rank, &failed, sizeof failed, err));
  if (failed != CLOTH_OK) return agreed(d, err);
  return t->share(t, d->rank, host, bytes, err);
}

static cloth_status copy(cloth_device *from, cloth_device *to, void *dst, const void *src,
                         size_t bytes, cloth_error *err)
{
  if (from != to) CLOTH_FAIL(err, CLOTH_INTERNAL, "rows go to another process by the transport");
  cloth_spread_device *d = of(from);
  return HERE(from, copy(d->here, d->here, dst, src, bytes, &d->why));
}

static cloth_status move(cloth_device *device, void *dst, const void *src, size_t bytes,
                         cloth_error *err)
{
  (void)err;
  return HERE(device, move(of(device)->here, dst, src, bytes, &of(device)->why));
}

static cloth_status fill(cloth_device *device, void *dst, int byte, size_t bytes, cloth_error *err)
{
  (void)err;
  return HERE(device, fill(of(device)->here, dst, byte, bytes, &of(device)->why));
}

// ---- work ---------------------------------------------------------------------------------------

static cloth_status solve(cloth_device *device, const struct cloth_pcg_solve_args *args,
                          bool *finished, cloth_error *err)
{
  (void)err;
  return HERE(device, solve(of(device)->here, args, finished, &of(device)->why));
}

static cloth_status launch(cloth_device *device, cloth_kernel k, int n, const void *args,
                           cloth_error *err)
{
  (void)err;
  return HERE(device, launch(of(device)->here, k, n, args, &of(device)->why));
}

static cloth_status sort(cloth_device *device, int n, int bits, uint64_t *key, uint32_t *value,
                         uint64_t *key_spare, uint32_t *value_spare, cloth_error *err)
{
  (void)err;
  return HERE(device, sort(of(device)->here, n, bits, key, value, key_spare, value_spare,
                           &of(device)->why));
}

static cloth_status scan(cloth_device *device, int n, uint32_t *array, cloth_error *err)
{
  (void)err;
  return HERE(device, scan(of(device)->here, n, array, &of(device)->why));
}

// ---- order --------------------------------------------------------------------------------------

static cloth_status event_new(cloth_device *device, cloth_event **out, cloth_error *err)
{
  cloth_event *e = calloc(1, sizeof *e);
  if (e == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "event: host memory");
  e->device = of(device);
  *out = e;
  return HERE(device, event_new(of(device)->here, &e->here, &of(device)->why));
}

static void event_free(cloth_event *event)
{
  if (event == NULL) return;
  if (event->device->here) event->device->inner->event_free(event->here);
  free(event);
}

static cloth_status record(cloth_device *device, cloth_queue queue, cloth_event *event,
                           cloth_error *err)
{
  (void)err;
  return HERE(device, record(of(device)->here, queue, event->here, &of(device)->why));
}

// other processes are waited for where rows come from them
static cloth_status wait(cloth_device *device, cloth_queue queue, const cloth_event *event,
                         cloth_error *err)
{
  (void)err;
  if (event->device != of(device)) return CLOTH_OK;
  return HERE(device, wait(of(device)->here, queue, event->here, &of(device)->why));
}

static cloth_status elapsed(const cloth_event *from, const cloth_event *to, double *ms,
                            cloth_error *err)
{
  cloth_spread_device *d = from->device;
  if (is_here(d)) d->failed = d->inner->elapsed(from->here, to->here, ms, &d->why);
  CLOTH_TRY(agreed(d, err));
  return d->transport->share(d->transport, d->rank, ms, sizeof *ms, err);
}

// one's own alone: also a process that gives up by itself calls it
static cloth_status finish(cloth_device *device, cloth_error *err)
{
  (void)err;
  return HERE(device, finish(of(device)->here, &of(device)->why));
}

cloth_status cloth_spread_connect(cloth_device *own, cloth_transport *transport, cloth_error *err)
{
  return transport->connect(transport, of(own)->inner, of(own)->here, err);
}

const cloth_backend *cloth_backend_spread(const cloth_backend *inner, cloth_transport *transport)
{
  // one for each inner backend: a scene keeps its table
  static cloth_backend tables[2];
  cloth_backend *table = &tables[inner != cloth_backend_cpu()];
  *table = (cloth_backend){
      .name = inner->name,
      .row_group = inner->row_group,
      .run_ahead = inner->run_ahead,
      .device_count = device_count,
      .open = open_device,
      .close = close_device,
      .alloc = alloc,
      .release = release,
      .write = write,
      .read = read,
      .copy = copy,
      .move = move,
      .fill = fill,
      .solve = inner->solve ? solve : NULL,
      .launch = launch,
      .sort = sort,
      .scan = scan,
      .event_new = event_new,
      .event_free = event_free,
      .record = record,
      .wait = wait,
      .elapsed = inner->elapsed ? elapsed : NULL,
      .range_begin = inner->range_begin,
      .range_end = inner->range_end,
      .finish = finish,
  };
  inner_of_open = inner, transport_of_open = transport;
  return table;
}
