// Device memory by name and owner, so that "what is not wanted allocates no byte" can be counted.
#include "state/sim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void charge(cloth_sim *sim, int owner, size_t bytes, int sign)
{
  sim->bytes += sign > 0 ? bytes : (uint64_t)0 - bytes;
  if (owner >= 0) sim->effect_bytes[owner] += sign > 0 ? bytes : (uint64_t)0 - bytes;
}

cloth_status cloth_take(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes, void *out,
                        cloth_error *err)
{
  if (part->block_count == part->block_capacity) {
    int capacity = part->block_capacity ? 2 * part->block_capacity : 64;
    cloth_block *block = realloc(part->block, sizeof *block * (size_t)capacity);
    if (block == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: host memory", name);
    part->block = block;
    part->block_capacity = capacity;
  }
  void *data = NULL;
  CLOTH_TRY(sim->backend->alloc(part->device, bytes, &data, err));
  part->block[part->block_count++] = (cloth_block){data, bytes, sim->owner, name};
  charge(sim, sim->owner, bytes, +1);
  sim->allocations++;
  CLOTH_TRY(sim->backend->fill(part->device, data, 0, bytes, err));
  memcpy(out, &data, sizeof data);
  return CLOTH_OK;
}

static void forget(cloth_sim *sim, cloth_part *part, int i)
{
  charge(sim, part->block[i].owner, part->block[i].bytes, -1);
  sim->backend->release(part->device, part->block[i].data);
  part->block[i] = part->block[--part->block_count];
}

// at least `bytes`; if it must be taken anew, `taken`
static cloth_status grow(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes,
                         size_t taken, void *data, cloth_error *err)
{
  void *old;
  memcpy(&old, data, sizeof old);
  for (int i = 0; old != NULL && i < part->block_count; i++) {
    if (part->block[i].data != old) continue;
    if (part->block[i].bytes >= bytes) return CLOTH_OK;
    CLOTH_TRY(sim->backend->finish(part->device, err)); // somebody may still read it
    forget(sim, part, i);
    sim->growths++;
    break;
  }
  old = NULL;
  memcpy(data, &old, sizeof old);
  return cloth_take(sim, part, name, taken, data, err);
}

cloth_status cloth_grow(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes,
                        void *data, cloth_error *err)
{
  return grow(sim, part, name, bytes, bytes + bytes / 2, data, err);
}

cloth_status cloth_grow_little(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes,
                               void *data, cloth_error *err)
{
  return grow(sim, part, name, bytes, bytes + bytes / 8, data, err);
}

cloth_status cloth_extend(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes,
                          size_t kept, void *data, cloth_error *err)
{
  void *old, *next;
  int at = -1;
  memcpy(&old, data, sizeof old);
  for (int i = 0; old != NULL && i < part->block_count; i++)
    if (part->block[i].data == old) at = i;
  if (at >= 0 && part->block[at].bytes >= bytes) return CLOTH_OK;
  CLOTH_TRY(cloth_take(sim, part, name, bytes + bytes / 2, &next, err));
  if (at >= 0) {
    if (kept > 0) CLOTH_TRY(cloth_copy_local(sim, part, next, old, kept, err));
    CLOTH_TRY(sim->backend->finish(part->device, err));
    forget(sim, part, at);
    sim->growths++;
  }
  memcpy(data, &next, sizeof next);
  return CLOTH_OK;
}

cloth_status cloth_upload(cloth_sim *sim, cloth_part *part, const char *name, const void *host,
                          size_t bytes, void *out, cloth_error *err)
{
  CLOTH_TRY(cloth_take(sim, part, name, bytes, out, err));
  void *data;
  memcpy(&data, out, sizeof data);
  return bytes > 0 ? sim->backend->write(part->device, data, host, bytes, err) : CLOTH_OK;
}

cloth_status cloth_staging(cloth_sim *sim, size_t reals, cloth_error *err)
{
  if (sim->host_bytes >= reals * sizeof(cloth_real)) return CLOTH_OK;
  cloth_real *host = realloc(sim->host, reals * sizeof(cloth_real));
  if (host == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "staging: %zu numbers", reals);
  sim->host = host;
  sim->host_bytes = reals * sizeof(cloth_real);
  sim->allocations++;
  return CLOTH_OK;
}

cloth_status cloth_upload_real(cloth_sim *sim, cloth_part *part, const char *name,
                               const double *host, int n, void *out, cloth_error *err)
{
  CLOTH_TRY(cloth_staging(sim, (size_t)n, err));
  for (int i = 0; i < n; i++) sim->host[i] = (cloth_real)host[i];
  return cloth_upload(sim, part, name, sim->host, sizeof(cloth_real) * (size_t)n, out, err);
}

void cloth_drop(cloth_sim *sim, cloth_part *part, int owner)
{
  for (int i = part->block_count - 1; i >= 0; i--)
    if (part->block[i].owner == owner) forget(sim, part, i);
}

void cloth_drop_all(cloth_sim *sim, cloth_part *part)
{
  while (part->block_count > 0) forget(sim, part, part->block_count - 1);
}

double cloth_now_ms(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

void cloth_stage_charge(cloth_sim *sim, cloth_stage stage, double ms)
{
  sim->report->ms[stage] += ms;
  sim->report->stages_skipped &= ~((uint64_t)1 << stage);
}

void cloth_range_begin(cloth_sim *sim, const char *name)
{
  if (sim->backend->range_begin != NULL) sim->backend->range_begin(name);
  sim->ranges++;
}

void cloth_range_end(cloth_sim *sim, int left_open)
{
  for (; sim->ranges > left_open; sim->ranges--)
    if (sim->backend->range_end != NULL) sim->backend->range_end();
}

double cloth_stage_open(cloth_sim *sim, cloth_stage stage)
{
  cloth_range_begin(sim, cloth_stage_name(stage));
  return cloth_now_ms();
}

void cloth_stage_close(cloth_sim *sim, cloth_stage stage, double start)
{
  cloth_stage_charge(sim, stage, cloth_now_ms() - start);
  cloth_range_end(sim, sim->ranges - 1);
}

// Queue one kernel, of the table or, without args, a block of sub-steps.
static cloth_status queue(cloth_sim *sim, cloth_part *part, cloth_kernel k, int n, const void *args,
                          const cloth_spring_block_args *block, cloth_error *err)
{
  if (block) return sim->backend->spring_block(part->device, block, err);
  return sim->backend->launch(part->device, k, n, args, err);
}

// counted, and for an effect timed: by the host's clock where it runs at once, by the device's
// where that is asked for
static cloth_status queue_timed(cloth_sim *sim, cloth_part *part, cloth_kernel k, int n,
                                const void *args, const cloth_spring_block_args *block,
                                cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  sim->launches++;
  if (sim->owner < 0) return queue(sim, part, k, n, args, block, err);
  double *sum = &sim->effect_ms[sim->owner], start = cloth_now_ms(), ms = 0;
  bool events = be->elapsed != NULL, asked = events && sim->params.profile > 1;
  sim->effect_launches[sim->owner]++;
  if (asked) CLOTH_TRY(be->record(part->device, CLOTH_COMPUTE, part->launch_begin, err));
  CLOTH_TRY(queue(sim, part, k, n, args, block, err));
  if (!events) {
    *sum += cloth_now_ms() - start;
  } else if (asked) {
    CLOTH_TRY(be->record(part->device, CLOTH_COMPUTE, part->launch_end, err));
    CLOTH_TRY(be->elapsed(part->launch_begin, part->launch_end, &ms, err));
    *sum += ms;
  }
  return CLOTH_OK;
}

cloth_status cloth_read_largest(cloth_sim *sim, cloth_part *part, const cloth_real *from, int n,
                                double *out, cloth_error *err)
{
  CLOTH_TRY(cloth_staging(sim, (size_t)n, err));
  CLOTH_TRY(sim->backend->read(part->device, sim->host, from, sizeof(cloth_real) * (size_t)n, err));
  for (int i = 0; i < n && !isnan(*out); i++)
    if (!((double)sim->host[i] <= *out)) *out = (double)sim->host[i];
  return CLOTH_OK;
}

bool cloth_reads_along(const cloth_sim *sim)
{
  return sim->part_count == 1 && sim->backend->read_with != NULL;
}

cloth_status cloth_read_along(cloth_sim *sim, void *host, const void *src, size_t bytes,
                              cloth_error *err)
{
  return sim->backend->read_with(sim->part[0].device, host, src, bytes, err);
}

cloth_status cloth_launch(cloth_sim *sim, cloth_part *part, cloth_kernel k, int n, const void *args,
                          cloth_error *err)
{
  return n > 0 ? queue_timed(sim, part, k, n, args, NULL, err) : CLOTH_OK;
}

cloth_status cloth_launch_spring_block(cloth_sim *sim, cloth_part *part,
                                       const cloth_spring_block_args *block, cloth_error *err)
{
  return queue_timed(sim, part, CLOTH_KERNEL_spring_step, block->rows, NULL, block, err);
}
