// How far the cloth is stretched at the end of a step, for the report.
#include "chunk.h"
#include "effect/effect.h"
#include "membrane_stretch.h"
#include "reduce_max.h"
#include "state/sim.h"

#include <math.h>

// the largest of each chunk, then of chunks of them, until few are left for the host to read
static cloth_status reduce(cloth_sim *sim, cloth_part *p, cloth_real **out, int *count,
                           cloth_error *err)
{
  const cloth_real *value = p->stretch;
  *count = p->membrane.count, *out = p->stretch_largest;
  do {
    cloth_reduce_max_args r = {*count, value, *out + (value == p->stretch ? 0 : *count)};
    int chunks = (*count + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
    CLOTH_LAUNCH(sim, p, reduce_max, chunks, &r, err);
    value = *out = r.largest, *count = chunks;
  } while (*count > CLOTH_STRETCH_READ);
  return CLOTH_OK;
}

// of cloth at x
static cloth_status measure(cloth_sim *sim, cloth_part *p, const cloth_real *x, cloth_real **out,
                            int *count, cloth_error *err)
{
  int owner = sim->owner;
  *count = 0;
  if (p->membrane.count == 0) return CLOTH_OK;
  sim->owner = cloth_is_mass_spring(sim) ? CLOTH_EFFECT_springs : CLOTH_EFFECT_membrane;
  cloth_membrane_stretch_args a = {p->membrane.vertex, p->membrane_rest, x, p->stretch};
  CLOTH_LAUNCH(sim, p, membrane_stretch, p->membrane.count, &a, err);
  CLOTH_TRY(reduce(sim, p, out, count, err));
  sim->owner = owner;
  return CLOTH_OK;
}

static double largest_of(const cloth_real *value, int count, double worst)
{
  for (int c = 0; c < count; c++) worst = fmax(worst, (double)value[c]);
  return worst;
}

cloth_status cloth_stretch_look(cloth_sim *sim, const cloth_real *x, cloth_error *err)
{
  cloth_along *along = &sim->along;
  cloth_part *p = &sim->part[0];
  cloth_real *largest;
  along->stretch = cloth_reads_along(sim);
  if (!along->stretch) return CLOTH_OK;
  CLOTH_TRY(measure(sim, p, x, &largest, &along->stretched_count, err));
  if (along->stretched_count == 0) return CLOTH_OK;
  return cloth_read_along(sim, along->stretched, largest,
                          sizeof(cloth_real) * (size_t)along->stretched_count, err);
}

// all parts work before the host asks the first
cloth_status cloth_stretch_measure(cloth_sim *sim, cloth_error *err)
{
  cloth_real *largest[CLOTH_DEVICES_MAX];
  int count[CLOTH_DEVICES_MAX];
  double worst = largest_of(sim->along.stretched, sim->along.stretched_count, 0);
  for (int i = 0; i < sim->part_count && !sim->along.stretch; i++)
    CLOTH_TRY(measure(sim, &sim->part[i], sim->part[i].x_t0, &largest[i], &count[i], err));
  for (int i = 0; i < sim->part_count && !sim->along.stretch; i++) {
    cloth_part *p = &sim->part[i];
    if (count[i] == 0) continue;
    CLOTH_TRY(cloth_staging(sim, (size_t)count[i], err));
    CLOTH_TRY(sim->backend->read(p->device, sim->host, largest[i],
                                 sizeof(cloth_real) * (size_t)count[i], err));
    worst = largest_of(sim->host, count[i], worst);
  }
  sim->report->stretch_max = worst;
  return CLOTH_OK;
}
