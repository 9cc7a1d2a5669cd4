// One substep. cloth_advance() is the map of the engine: each stage is one call, in the order in
// which it runs, with the file that holds it (the list is stages.inl).
#include "substep.h"

#include "contact/contact.h"
#include "contact/friction.h"
#include "effect/effect.h"
#include "shift_chunk.h"
#include "state/bdf2.h"
#include "state/commit.h"
#include "state/state.h"

#include <math.h>

// Shares of the mean edge. A correction that is still above the first asks for further Newton
// iterations; one above the second for a shorter substep, as do impact zones that move a vertex
// that far: what they move stretches the cloth around it, which had no say in it.
#define UNSETTLED 0.05
#define ROUGH     0.15

// Newton iterations; those around what is held begin where the cloth had sprung back.
enum { FURTHER_ITERATIONS = 4, HELD_ITERATIONS = 2 };

// A correction above so many edges, and above all that the cloth spans: it diverges.
#define AWAY 10

static bool is_rough(const cloth_sim *sim, double distance)
{
  return !(distance <= ROUGH * sim->mean_edge);
}

// the first correction is the whole answer to the prediction, not what is left of the error
static bool is_far_from_linear(const cloth_sim *sim)
{
  return sim->solve_failed || (sim->iteration > 0 && is_rough(sim, sim->correction));
}

// The time of a stage: that of the host, or with `profile` that of the first part's device, between
// events. Without it the host runs ahead of a GPU, and a stage is charged with what it waits for.
static cloth_status stage_begin(cloth_sim *sim, cloth_stage stage, double *start, cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  *start = cloth_stage_open(sim, stage);
  if (!sim->params.profile || be->elapsed == NULL) return CLOTH_OK;
  return be->record(sim->part[0].device, CLOTH_COMPUTE, sim->part[0].stage_begin, err);
}

static cloth_status stage_end(cloth_sim *sim, cloth_stage stage, double start, cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  cloth_part *p = &sim->part[0];
  double ms = cloth_now_ms() - start;
  if (sim->params.profile && be->elapsed != NULL) {
    CLOTH_TRY(be->record(p->device, CLOTH_COMPUTE, p->stage_end, err));
    CLOTH_TRY(be->elapsed(p->stage_begin, p->stage_end, &ms, err));
  }
  cloth_stage_charge(sim, stage, ms);
  cloth_range_end(sim, sim->ranges - 1);
  return CLOTH_OK;
}

// Run one stage and add its time to the report.
#define STAGE(name, call)                                                                          \
  do {                                                                                             \
    double start_;                                                                                 \
    CLOTH_TRY(stage_begin(sim, CLOTH_STAGE_##name, &start_, err));                                 \
    CLOTH_TRY(call);                                                                               \
    CLOTH_TRY(stage_end(sim, CLOTH_STAGE_##name, start_, err));                                    \
  } while (0)

// Newton iterations `first` to `last` - 1, and up to `further` more where the last still is a large
// one
static cloth_status solve(cloth_sim *sim, int first, int last, int further, cloth_error *err)
{
  int owner = sim->owner, most = last + (last > 1 ? further : 0);
  double correction = 0;
  sim->owner = CLOTH_CORE;
  sim->iteration_first = first;
  for (int n = first; n < last; n++) {
    bool settled;
    sim->iteration = n, sim->iteration_last = last - 1;
    STAGE(effects, cloth_effects_apply(sim, n, err)); // effect/effect.c    forces, tangents
    STAGE(assemble, cloth_assemble(sim, err));        // solve/assemble.c   block rows
    STAGE(solve, cloth_pcg(sim, &correction, err));   // solve/pcg.c        A dx = b, n parts
    if (n + 1 == last && last < most && !(correction <= UNSETTLED * sim->mean_edge)) last++;
    if (n + 1 == last || !(correction <= sim->params.newton_tolerance * sim->params.thickness))
      continue;
    CLOTH_TRY(cloth_friction_settled(sim, &settled, err)); // contact/friction.c sticks or slides
    if (settled) break;
  }
  sim->correction = correction;
  CLOTH_TRY(cloth_balance(sim, err)); // solve/balance.c    momentum of free flight
  if (!sim->solve_failed) CLOTH_TRY(cloth_holds_measure(sim, err));
  sim->owner = owner;
  return CLOTH_OK;
}

// how far the zones and the failsafe have moved vertices from the end of the solve [m]
static cloth_status measure_shift(cloth_sim *sim, double *out, cloth_error *err)
{
  cloth_part *p = &sim->part[0]; // every part has the same
  cloth_shift_chunk_args a = {sim->vertex_count, p->zone.x_solved, p->x, p->largest};
  CLOTH_LAUNCH(sim, p, shift_chunk, sim->chunks, &a, err);
  return cloth_read_largest(sim, p, p->largest, sim->chunks, out, err);
}

// Has the solution left all that the cloth spans and sweeps? Then looking for impacts costs much
// and tells nothing.
static bool ran_away(const cloth_sim *sim)
{
  double x = sim->correction, span = sim->span;
  return !(x <= sim->params.bounds) ||
         (sim->iteration > 0 && x > AWAY * sim->mean_edge && x > span);
}

// the longest side of the box around all cloth, from the start to where it would fly
static double span_of(const cloth_box *box)
{
  return fmax((double)(box->hi.x - box->lo.x),
              fmax((double)(box->hi.y - box->lo.y), (double)(box->hi.z - box->lo.z)));
}

// The solve knew nothing of what zones and the failsafe moved: as it had it, the vertex under a tip
// springs back, and the cloth around need not come along. So what the failsafe held back is felt:
// the cloth is solved for once more around all that was moved. Not where bodies leave no room, and
// not for zones alone, which keep momentum as holding still does not.
static cloth_status follow_held(cloth_sim *sim, int *left, cloth_error *err)
{
  int impacts, rounds = sim->params.contact_rounds_max;
  int n = sim->params.newton_iterations_max + rounds;
  for (int k = 0; k < rounds && sim->zones.held_back > 0 && *left == 0 && !sim->solve_failed; k++) {
    CLOTH_TRY(cloth_ccd_pin(sim, k > 0, err));
    cloth_status status = solve(sim, n, n + HELD_ITERATIONS, 0, err);
    cloth_ccd_unpin(sim);
    CLOTH_TRY(status);
    sim->report->contact_rounds++;
    sim->solve_failed = sim->solve_failed || ran_away(sim);
    if (!sim->solve_failed) {
      STAGE(ccd, cloth_ccd_detect(sim, &impacts, err));
      STAGE(ccd, cloth_ccd_resolve(sim, left, err));
    }
    if (sim->solve_failed || *left > 0) {
      *left = 0;
      return cloth_ccd_back_to_held(sim, err);
    }
  }
  return CLOTH_OK;
}

// What would pass through becomes contacts of a further system; what then still would is moved
// apart, or held back.
static cloth_status part_what_meets(cloth_sim *sim, const cloth_cutting *c, cloth_outcome *result,
                                    int *left, bool *met, cloth_error *err)
{
  int impacts, first, n = sim->params.newton_iterations_max;
  if (sim->params.contact_detection == CLOTH_DISCRETE) return cloth_contact_totals(sim, err);
  STAGE(ccd, cloth_ccd_detect(sim, &impacts, err)); // ccd/ccd.c
  *met = impacts > 0, first = impacts;
  if (*met && sim->bdf2.used) return CLOTH_OK;
  for (int round = 0; impacts > 0 && round < sim->params.contact_rounds_max; round++) {
    CLOTH_TRY(cloth_ccd_keep(sim, false, err));
    STAGE(contact, cloth_contact_add_impacts(sim, err));
    CLOTH_TRY(solve(sim, n + round, n + round + 1, 0, err));
    sim->report->contact_rounds++;
    sim->solve_failed = sim->solve_failed || ran_away(sim);
    if (sim->solve_failed)
      CLOTH_TRY(cloth_ccd_keep(sim, true, err)); // zones are left, and shorter steps
    STAGE(ccd, cloth_ccd_detect(sim, &impacts, err));
    if (sim->solve_failed) break;
  }
  sim->crowd = cloth_impacts_of_cloth(sim) / cloth_crowded(sim);
  sim->helpless = 2 * impacts > first && sim->params.contact_rounds_max > 0;
  *result = sim->crowd > 1                              ? OUTCOME_CROWDED
            : is_far_from_linear(sim) && !sim->helpless ? OUTCOME_ROUGH
                                                        : OUTCOME_GOOD;
  if (cloth_may_cut(sim, c, *result)) return CLOTH_OK; // no work for what will be thrown away
  *result = OUTCOME_GOOD;
  STAGE(ccd, cloth_ccd_resolve(sim, left, err)); // ccd/zones.c, ccd/failsafe.c
  double shift = 0;
  if (impacts > 0) CLOTH_TRY(measure_shift(sim, &shift, err));
  if (is_rough(sim, shift)) *result = OUTCOME_ROUGH;
  if (*result == OUTCOME_GOOD || !cloth_may_cut(sim, c, *result))
    CLOTH_TRY(follow_held(sim, left, err));
  return cloth_contact_totals(sim, err);
}

cloth_status cloth_advance(cloth_sim *sim, double from, double to, const cloth_cutting *c,
                           cloth_outcome *result, cloth_error *err)
{
  int left = 0;
  sim->crowd = 0, sim->helpless = false;
  sim->zones.driven_count = 0;
  *result = OUTCOME_GOOD;
  bool touch = sim->active[CLOTH_EFFECT_self_contact], met = false;
  CLOTH_TRY(cloth_bdf2_begin(sim, err)); // state/bdf2.c       of order 2, or backward Euler
  CLOTH_TRY(cloth_damping_set(sim, sim->gamma, err));
  STAGE(predict,
        cloth_predict_stage(sim, from, to, err)); // state/predict.c    x* = x + h v + h^2 g

  touch = touch || sim->report->bodies_near > 0;
  sim->span = touch ? span_of(&sim->cloth_box) : sim->params.bounds;
  sim->owner = cloth_contact_owner(sim);
  if (touch) {
    STAGE(pairs, cloth_pairs_find(sim, err));            // contact/pairs.c    what may touch
    STAGE(contact, cloth_contact_build_stage(sim, err)); // contact/contact.c  what touches
  } else {
    for (int p = 0; p < sim->part_count; p++)
      sim->part[p].pair_count = sim->part[p].contact_count = 0;
    sim->pairs_valid = false;
  }
  sim->owner = CLOTH_CORE;
  if (sim->bdf2.used && cloth_bdf2_touches(sim)) {
    *result = OUTCOME_TOUCHES;
    return CLOTH_OK;
  }

  // where bodies or holds leave no room, iterating further is work for nothing
  int further = c->for_impacts > 0 || cloth_tangles_forced(sim) ? 0 : FURTHER_ITERATIONS;
  CLOTH_TRY(solve(sim, 0, sim->params.newton_iterations_max, further, err));
  if (ran_away(sim)) {
    *result = OUTCOME_UNSTABLE;
    return CLOTH_OK;
  }
  sim->owner = cloth_contact_owner(sim);
  if (!touch && sim->active[CLOTH_EFFECT_body_contact]) {
    CLOTH_TRY(cloth_bodies_join(sim, err)); // the cloth may have gone farther than predicted
    touch = sim->report->bodies_near > 0;
  }
  if (touch) CLOTH_TRY(part_what_meets(sim, c, result, &left, &met, err));
  sim->owner = CLOTH_CORE;
  if (sim->bdf2.used && met) *result = OUTCOME_TOUCHES;
  if (*result == OUTCOME_UNSTABLE || *result == OUTCOME_TOUCHES) return CLOTH_OK;
  sim->smooth = !met && !cloth_bdf2_touches(sim);
  sim->impacts_left = left;
  if (left > 0)
    *result = OUTCOME_IMPACTS;
  else if (*result == OUTCOME_GOOD && is_far_from_linear(sim))
    *result = OUTCOME_ROUGH;
  bool good;
  if (to == 1)
    CLOTH_TRY(cloth_stretch_look(sim, sim->part[0].x, err)); // state/stretch.c  for the report
  STAGE(commit, cloth_commit(sim, &good, err));              // state/commit.c     v = (x - x0) / h
  if (!good) *result = OUTCOME_UNSTABLE;
  return CLOTH_OK;
}
