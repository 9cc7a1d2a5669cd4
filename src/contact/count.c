#include "contact/count.h"

// how many numbers lie side by side
static int width(cloth_count_place place)
{
  bool one = place == CLOTH_COUNT_TANGLES || place == CLOTH_COUNT_FACTORED ||
             place == CLOTH_COUNT_PAIRS || place == CLOTH_COUNT_UNSETTLED;
  return one ? 1 : place == CLOTH_COUNT_ESCAPED ? 4 : 2;
}

uint32_t *cloth_counter(const cloth_part *part, cloth_count_place place)
{
  return part->counter + CLOTH_COUNT_ROUNDS * place + width(place) * part->counter_round[place];
}

cloth_status cloth_count_read(cloth_sim *sim, cloth_part *part, cloth_count_place place,
                              uint32_t *out, cloth_error *err)
{
  return sim->backend->read(part->device, out, cloth_counter(part, place),
                            sizeof *out * (size_t)width(place), err);
}

cloth_status cloth_count_clear(cloth_sim *sim, cloth_part *part, cloth_count_place place,
                               cloth_error *err)
{
  if (++part->counter_round[place] < CLOTH_COUNT_ROUNDS) return CLOTH_OK;
  part->counter_round[place] = 0;
  return sim->backend->fill(part->device, cloth_counter(part, place), 0,
                            sizeof(uint32_t) * (size_t)(width(place) * CLOTH_COUNT_ROUNDS), err);
}
