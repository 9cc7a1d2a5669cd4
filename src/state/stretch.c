// How far the cloth is stretched at the end of a step, for the report.
#include "chunk.h"
#include "effect/effect.h"
#include "membrane_stretch.h"
#include "reduce_max.h"
#include "state/sim.h"

#include <math.h>

enum { STRETCH_READ = 256 }; // more numbers are reduced on the device before they are read

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
  } while (*count > STRETCH_READ);
  return CLOTH_OK;
}

// all parts work before the host asks the first
cloth_status cloth_stretch_measure(cloth_sim *sim, cloth_error *err)
{
  cloth_real *largest[CLOTH_DEVICES_MAX];
  int count[CLOTH_DEVICES_MAX];
  double worst = 0;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    if (p->membrane.count == 0) continue;
    sim->owner = cloth_is_mass_spring(sim) ? CLOTH_EFFECT_springs : CLOTH_EFFECT_membrane;
    cloth_membrane_stretch_args a = {p->membrane.vertex, p->membrane_rest, p->x_t0, p->stretch};
    CLOTH_LAUNCH(sim, p, membrane_stretch, p->membrane.count, &a, err);
    CLOTH_TRY(reduce(sim, p, &largest[i], &count[i], err));
    sim->owner = CLOTH_CORE;
  }
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    if (p->membrane.count == 0) continue;
    CLOTH_TRY(cloth_staging(sim, (size_t)count[i], err));
    CLOTH_TRY(sim->backend->read(p->device, sim->host, largest[i],
                                 sizeof(cloth_real) * (size_t)count[i], err));
    for (int c = 0; c < count[i]; c++) worst = fmax(worst, (double)sim->host[c]);
  }
  sim->report->stretch_max = worst;
  return CLOTH_OK;
}
