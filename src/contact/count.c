#include "contact/count.h"

cloth_status cloth_count_read(cloth_sim *sim, cloth_part *part, int place, int n, uint32_t *out,
                              cloth_error *err)
{
  return sim->backend->read(part->device, out, part->counter + place, sizeof *out * (size_t)n, err);
}

cloth_status cloth_count_clear(cloth_sim *sim, cloth_part *part, int place, int n, cloth_error *err)
{
  return sim->backend->fill(part->device, part->counter + place, 0, sizeof(uint32_t) * (size_t)n,
                            err);
}
