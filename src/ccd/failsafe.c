// The last answer to impacts: what would pass through goes only part of its way, and so on until
// nothing does. The way is seen from a carrier: the body or hold that moves into the cloth, whose
// rigid motion the cloth takes part in. Cloth that was held back where it is, as seen from the
// floor, would let the body go on through it. A carrier goes on from cloth to cloth with the
// impacts, so layers behind the first are carried too.
//
// Why it ends. Carriers are numbered, the world last. A vertex's carrier only ever gets a lower
// number, and in the last passes whatever is involved is stopped on the lowest carrier of its pair
// and stays stopped. So a pass either finds no impact, or lowers the carrier of a vertex or stops
// one on it, which can happen only (carriers + 2) times to each; or every impact that it finds has
// all its free cloth stopped on one carrier already. Among those it leaves nothing moves (all
// corners ride on one carrier, which keeps distances but for rounding; rounding is put to exact
// signs), but for bodies and holds that run into cloth which rides on another: there is no room
// between them. Such pairs cannot be cleared this way: then the substep is repeated at half its
// length (step.c), and what is left is reported. Pairs in which nothing gives way at all are in
// zones.driven and no matter of the failsafe.
#include "ccd/carriers.h"
#include "ccd/impacts.h"
#include "contact/close.h"
#include "contact/contact.h"
#include "contact/count.h"
#include "effect/effect.h"
#include "impact_hold_back.h"
#include "impact_limit.h"

// lower what vertices may go and what carries them; moved: only in pairs with a vertex that was
// held back last; count: see impact_limit.h, over all parts
static cloth_status limit(cloth_sim *sim, bool stop, bool moved, uint32_t count[2],
                          cloth_error *err)
{
  count[0] = count[1] = 0;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    uint32_t found[2];
    int pairs;
    CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_LIMITED, err));
    cloth_impact_limit_args a = {.scene = cloth_contact_scene_of(sim, p),
                                 .stop = stop,
                                 .gap = (cloth_real)cloth_impact_gap(sim),
                                 .pair = cloth_close_pairs(sim, p, &pairs),
                                 .moved = moved ? p->zone.moved : NULL,
                                 .allowed = p->allowed,
                                 .claim = p->claim,
                                 .count = cloth_counter(p, CLOTH_COUNT_LIMITED)};
    CLOTH_LAUNCH(sim, p, impact_limit, pairs, &a, err);
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_LIMITED, found, err));
    for (int k = 0; k < 2; k++) count[k] += found[k];
  }
  return CLOTH_OK;
}

static cloth_status hold_back(cloth_sim *sim, uint32_t carriers, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_impact_hold_back_args a = {.world = carriers,
                                     .carriers = {carriers, p->carrier_motion},
                                     .x_t0 = p->x_t0,
                                     .free = p->free,
                                     .allowed = p->allowed,
                                     .claim = p->claim,
                                     .carrier = p->carrier,
                                     .x = p->x,
                                     .moved = p->zone.moved};
    // rows of other parts come by exchange; their limits here are incomplete and only reset
    CLOTH_LAUNCH(sim, p, impact_hold_back, sim->vertex_count, &a, err);
  }
  CLOTH_TRY(
      cloth_exchange(sim, offsetof(cloth_part, carrier), CLOTH_PER_VERTEX, sizeof(uint32_t), err));
  CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, zone.moved), CLOTH_PER_VERTEX, 1, err));
  return cloth_exchange(sim, offsetof(cloth_part, x), CLOTH_PER_VERTEX, 3 * sizeof(cloth_real),
                        err);
}

static cloth_status hold_back_all(cloth_sim *sim, int *left, cloth_error *err)
{
  uint32_t carriers, count[2];
  CLOTH_TRY(cloth_carriers_begin(sim, &carriers, err));
  for (int pass = 0, most = sim->params.failsafe_iterations_max;; pass++) {
    // what was not held back has no new impact; where that is all, all is tested
    bool some = pass > 0 && pass != most;
    CLOTH_TRY(limit(sim, pass >= most, some, count, err));
    if (some && count[1] == 0) CLOTH_TRY(limit(sim, pass >= most, false, count, err));
    if (count[0] == 0) return CLOTH_OK;
    CLOTH_TRY(hold_back(sim, carriers, err)); // also where nothing gives: it resets the limits
    if (count[1] == 0) break;
    CLOTH_TRY(cloth_impacts_cover(sim, err)); // a patch may be flat no more
  }
  CLOTH_TRY(cloth_impacts_find(sim, false, err));
  *left = sim->zones.found_count;
  return CLOTH_OK;
}

cloth_status cloth_failsafe(cloth_sim *sim, int *left, cloth_error *err)
{
  *left = 0;
  sim->zones.carried = true;
  cloth_status status = hold_back_all(sim, left, err);
  sim->zones.carried = false;
  return status;
}
