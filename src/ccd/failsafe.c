// The last answer to impacts: what would pass through goes only part of its way, and so on until
// nothing does. It ends because in the last passes whatever is still involved stays where it was.
// A body or a held vertex that runs into cloth held back cannot be cleared this way: then the
// substep is repeated at half its length (step.c), and what is left is reported. Pairs in which
// nothing gives way at all are in zones.driven and no matter of the failsafe.
#include "ccd/impacts.h"
#include "contact/close.h"
#include "contact/contact.h"
#include "contact/pairs.h"
#include "effect/effect.h"
#include "impact_hold_back.h"
#include "impact_limit.h"

enum { STOPPING_PASSES = 5 };

// lower what vertices may go; how many impacts the parts saw
static cloth_status limit(cloth_sim *sim, bool stop, int *seen, cloth_error *err)
{
  *seen = 0;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    uint32_t count;
    int pairs;
    CLOTH_TRY(cloth_count_clear(sim, p, COUNT_LIMITED, 1, err));
    cloth_impact_limit_args a = {.scene = cloth_contact_scene_of(sim, p),
                                 .stop = stop,
                                 .gap = (cloth_real)cloth_impact_gap(sim),
                                 .pair = cloth_close_pairs(sim, p, &pairs),
                                 .allowed = p->allowed,
                                 .count = p->counter + COUNT_LIMITED};
    CLOTH_LAUNCH(sim, p, impact_limit, pairs, &a, err);
    CLOTH_TRY(cloth_count_read(sim, p, COUNT_LIMITED, &count, err));
    *seen += (int)count;
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
  return cloth_exchange(sim, offsetof(cloth_part, x), CLOTH_PER_VERTEX, 3 * sizeof(cloth_real),
                        err);
}

cloth_status cloth_failsafe(cloth_sim *sim, int *left, cloth_error *err)
{
  int seen, passes = sim->params.failsafe_iterations_max;
  *left = 0;
  for (int pass = 0; pass < passes + STOPPING_PASSES; pass++) {
    CLOTH_TRY(limit(sim, pass >= passes, &seen, err));
    if (seen == 0) return CLOTH_OK;
    CLOTH_TRY(hold_back(sim, err));
    CLOTH_TRY(cloth_impacts_cover(sim, err)); // a patch may be flat no more
  }
  CLOTH_TRY(cloth_impacts_find(sim, false, err));
  *left = sim->zones.found_count;
  return CLOTH_OK;
}
