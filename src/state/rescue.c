// What a device that is lost or full leaves: every part holds the whole cloth, so its last state
// can be read and saved as long as one device answers. Which one, is asked by reading a number.
#include "state/sim.h"

static bool answers(const cloth_sim *sim, const cloth_part *p)
{
  cloth_error ignored = {0};
  cloth_real x;
  return sim->backend->finish(p->device, &ignored) == CLOTH_OK &&
         sim->backend->read(p->device, &x, p->x_t0, sizeof x, &ignored) == CLOTH_OK;
}

bool cloth_rescue_probe(cloth_sim *sim)
{
  bool all = true;
  for (int i = 0; i < sim->part_count; i++) {
    sim->part[i].lost = sim->part[i].lost || !answers(sim, &sim->part[i]);
    all &= !sim->part[i].lost;
  }
  return all;
}

cloth_part *cloth_rescue_part(cloth_sim *sim)
{
  int i = 0;
  while (i + 1 < sim->part_count && sim->part[i].lost) i++;
  return &sim->part[i];
}
