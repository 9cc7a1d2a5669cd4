// Nothing passes through: candidates are tested along the straight way from the start to the end of
// the substep; what would pass goes only part of the way, and so on until nothing does. It ends
// because in the last passes whatever is still involved stays where it was. A body that runs into
// cloth held back cannot be cleared this way: then the substep is repeated at half its length
// (step.c). (Impact zones will come between the two.)
#include "contact/contact.h"
#include "contact/pairs.h"
#include "effect/effect.h"
#include "impact_find.h"
#include "impact_hold_back.h"

#define IMPACT_GAP 0.05 // distance that counts as an impact, as a share of the thickness

enum { COUNT_IMPACTS = 4, COUNT_ANY = 5, STOPPING_PASSES = 5 };

// impacts on the present way, each counted once; `seen` also counts those of borders
static cloth_status detect(cloth_sim *sim, bool stop, int *impacts, int *seen, cloth_error *err)
{
  *impacts = *seen = 0;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    uint32_t count[2];
    CLOTH_TRY(cloth_count_clear(sim, p, COUNT_IMPACTS, 2, err));
    cloth_impact_find_args a = {.scene = cloth_contact_scene_of(sim, p),
                                .first = p->v0,
                                .last = p->v1,
                                .stop = stop,
                                .gap = (cloth_real)(IMPACT_GAP * sim->params.thickness),
                                .pair = p->pair,
                                .allowed = p->allowed,
                                .count = p->counter + COUNT_IMPACTS,
                                .any = p->counter + COUNT_ANY};
    CLOTH_LAUNCH(sim, p, impact_find, p->pair_count, &a, err);
    CLOTH_TRY(sim->backend->read(p->device, count, p->counter + COUNT_IMPACTS, sizeof count, err));
    *impacts += (int)count[0];
    *seen += (int)count[1];
  }
  return CLOTH_OK;
}

static cloth_status hold_back(cloth_sim *sim, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_impact_hold_back_args a = {0, p->x_t0, p->free, p->allowed, p->x};
    // rows of other parts come by exchange; their limits here are incomplete and only reset
    CLOTH_LAUNCH(sim, p, impact_hold_back, sim->vertex_count, &a, err);
  }
  return cloth_exchange(sim, offsetof(cloth_part, x), false, 3 * sizeof(cloth_real), err);
}

cloth_status cloth_failsafe(cloth_sim *sim, int *left, cloth_error *err)
{
  bool escaped;
  int seen = 0;
  *left = 0;
  CLOTH_TRY(cloth_pairs_escaped(sim, &escaped, err));
  if (escaped) CLOTH_TRY(cloth_pairs_search(sim, err)); // the solve went farther than predicted
  int passes = sim->params.failsafe_iterations_max;
  for (int pass = 0; pass < passes + STOPPING_PASSES; pass++) {
    CLOTH_TRY(detect(sim, pass >= passes, left, &seen, err));
    if (seen == 0) return CLOTH_OK;
    if (pass == 0) sim->report->impacts += *left;
    CLOTH_TRY(hold_back(sim, err));
  }
  return detect(sim, true, left, &seen, err);
}
