// One time step: it is cut into substeps (substep.c) so that no body moves far between two
// searches, and a substep that fails is repeated at half its length. What comes before and behind
// them is here.
#include "contact/friction.h"
#include "state/bdf2.h"
#include "state/commit.h"
#include "state/control.h"
#include "state/flight.h"
#include "state/recut.h"
#include "state/state.h"
#include "substep.h"

#include <math.h>

// the substep stands: its end is the next start
static cloth_status accept(cloth_sim *sim, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  CLOTH_TRY(cloth_friction_finish(sim, err));
  CLOTH_TRY(cloth_bdf2_keep(sim, sim->smooth, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_copy_local(sim, p, p->x_t0, p->x, bytes, err));
    cloth_real *v = p->v;
    p->v = p->v_next, p->v_next = v;
  }
  return CLOTH_OK;
}

// ---- the step around it -------------------------------------------------------------------------

// what no sweep could follow is a teleport: the body is where it was told to be
static void place_teleports(cloth_sim *sim)
{
  const double quarter = sqrt(0.5); // cosine of half of it
  for (int b = 0; b < sim->def->body_count; b++) {
    cloth_body *body = &sim->body[b];
    double c0[3], c1[3], d_sq = 0, dot = 0;
    cloth_pose_point(&body->now, body->center, c0);
    cloth_pose_point(&body->target, body->center, c1);
    for (int k = 0; k < 3; k++) d_sq += (c1[k] - c0[k]) * (c1[k] - c0[k]);
    for (int k = 0; k < 4; k++) dot += body->now.rotation[k] * body->target.rotation[k];
    if (sqrt(d_sq) <= sim->params.teleport_distance && fabs(dot) >= quarter * (1 - 1e-9)) continue;
    body->now = body->target;
    sim->pairs_valid = sim->bdf2.known = false;
    sim->report->teleports++;
    cloth_body_settle(sim);
  }
}

static cloth_status stand(cloth_sim *sim, cloth_error *err)
{
  cloth_step_report *report = sim->report;
  int left = sim->impacts_left + sim->zones.driven_count;
  cloth_mean_motion(sim);
  CLOTH_TRY(accept(sim, err));
  sim->tangles.found = false;
  if (left > 0) {
    CLOTH_TRY(cloth_blocking_add(sim, err));
    cloth_body_settle(sim); // worked out when there is room again
  }
  report->substeps++;
  report->contacts_self = (int)sim->along.totals[0];
  report->contacts_body = (int)sim->along.totals[1];
  report->impacts_left += left;
  report->newton_correction = fmax(report->newton_correction, sim->correction);
  report->error_estimate = fmax(report->error_estimate, sim->error_estimate);
  cloth_control_add(sim, sim->error_mean);
  return CLOTH_OK;
}

// the whole step in substeps; a failed one is repeated at half its length
static cloth_status advance_all(cloth_sim *sim, double h, cloth_outcome *result, cloth_error *err)
{
  cloth_cutting c;
  CLOTH_TRY(cloth_cutting_begin(sim, h, &c, err));
  double done = 0;
  sim->h_whole = h / sim->params.substeps;
  sim->h_contact = h * c.share * c.finer;
  while (done < 1) {
    double to = done + c.share < 1 - 1e-9 ? done + c.share : 1;
    sim->h = (to - done) * h;
    sim->time_t0 = sim->time + done * h;
    CLOTH_TRY(cloth_tangles_update(sim, done, err));
    CLOTH_TRY(cloth_advance(sim, done, to, &c, result, err));
    if (*result == OUTCOME_TOUCHES) {
      sim->pairs_valid = sim->bdf2.known = false;
      continue;
    }
    if (cloth_cut_again(sim, *result, &c)) {
      c.halvings++, sim->report->step_halvings++;
      if (*result == OUTCOME_IMPACTS || *result == OUTCOME_CROWDED)
        sim->h_contact /= 2; // stiffer springs keep apart what met
      c.share /= 2;
      sim->pairs_valid = sim->bdf2.known = false;
      continue;
    }
    if (*result == OUTCOME_UNSTABLE) return CLOTH_OK;
    int cut = cloth_control_cut(sim, &c, to - done);
    if (cut > 1) {
      sim->report->accuracy_repeats++;
      c.share /= cut, c.finer *= cut;
      sim->pairs_valid = false;
      continue;
    }
    CLOTH_TRY(stand(sim, err));
    done = to;
  }
  cloth_cutting_end(sim, &c);
  cloth_control_end(sim, h, (int)(1 / c.share + 0.5));
  return CLOTH_OK;
}

static cloth_status save_start(cloth_sim *sim, bool back, cloth_error *err)
{
  const size_t row = 3 * sizeof(cloth_real);
  if (cloth_flies(sim) || (!back && cloth_springs_save(sim))) return CLOTH_OK; // without copies
  for (int i = 0; i < sim->part_count; i++) {                                  // each its own rows
    cloth_part *p = &sim->part[i];
    size_t at = 3 * (size_t)p->v0, bytes = row * (size_t)(p->v1 - p->v0);
    cloth_real *x = p->x_t0 + at, *x_saved = p->x_saved + at;
    cloth_real *v = p->v + at, *v_saved = p->v_saved + at;
    CLOTH_TRY(cloth_copy_local(sim, p, back ? x : x_saved, back ? x_saved : x, bytes, err));
    CLOTH_TRY(cloth_copy_local(sim, p, back ? v : v_saved, back ? v_saved : v, bytes, err));
  }
  if (back) {
    CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, x_t0), CLOTH_PER_VERTEX, row, err));
    CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, v), CLOTH_PER_VERTEX, row, err));
  }
  CLOTH_TRY(cloth_bdf2_save(sim, back, err));
  return cloth_friction_save(sim, back, err);
}

// the state before the step; bodies and holds stay where they were
static cloth_status go_back(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(save_start(sim, true, err));
  sim->pairs_valid = false;
  cloth_tangles_suspect(sim);
  for (int b = 0; b < sim->def->body_count; b++) sim->body[b].target = sim->body[b].now;
  for (int i = 0; i < sim->hold_count; i++) sim->hold[i].target = sim->hold[i].now;
  return CLOTH_OK;
}

// A device is lost or full. While all answer, the state is that before the step; rows of a lost one
// cannot go back, so then it is that after the last whole substep.
static void rescue(cloth_sim *sim)
{
  cloth_error ignored = {0};
  bool started = sim->report->substeps > 0, all = cloth_rescue_probe(sim);
  if (started) cloth_guess_free_fall(sim);
  if (!all || go_back(sim, &ignored) != CLOTH_OK) sim->time = started ? sim->time_t0 : sim->time;
}

// parts with less to do may have waited long enough
static cloth_status recut(cloth_sim *sim, cloth_error *err)
{
  cloth_status status = cloth_recut_if_due(sim, err);
  if (status < 0 && sim->transport->ranks == 1) cloth_rescue_probe(sim);
  for (int i = 0; i < sim->part_count; i++) sim->part[i].load = (cloth_work){0, 0, 0};
  return status;
}

// the whole step by the integrator of the scene
static cloth_status integrate(cloth_sim *sim, double h, cloth_outcome *result, cloth_error *err)
{
  bool good; // flight and sub-steps below the stable limit are not halved
  if (cloth_flies(sim))
    CLOTH_TRY(cloth_flight_advance(sim, h, &good, err)); // state/flight.c
  else if (cloth_is_mass_spring(sim))
    CLOTH_TRY(cloth_springs_advance(sim, h, &good, err)); // spring/advance.c
  else
    return advance_all(sim, h, result, err);
  *result = good ? OUTCOME_GOOD : OUTCOME_UNSTABLE;
  return CLOTH_OK;
}

// bodies and frames have arrived; grasps that pull too hard let go
static cloth_status arrive(cloth_sim *sim, cloth_error *err)
{
  bool broken = false;
  for (int b = 0; b < sim->def->body_count; b++) sim->body[b].now = sim->body[b].target;
  for (int i = 0; i < sim->hold_count; i++) {
    cloth_hold_state *h = &sim->hold[i];
    if (!h->alive) continue;
    h->now = h->target;
    double force =
        sqrt(h->force[0] * h->force[0] + h->force[1] * h->force[1] + h->force[2] * h->force[2]);
    if (!(h->break_force > 0) || force <= h->break_force) {
      sim->report->grasps++;
      continue;
    }
    cloth_hold_end(sim, h), broken = true;
    if (h->pin >= 0) sim->pin_broken[h->pin] = 1;
    sim->report->grasps_broken++;
  }
  return broken ? cloth_holds_refresh(sim, err) : CLOTH_OK;
}

void cloth_sim_tune(void *data, const cloth_tuning *t)
{
  cloth_sim *sim = data;
  sim->params.pcg_tolerance = t->pcg_tolerance;
  sim->params.newton_iterations_max = t->newton_iterations;
  sim->params.contact_rounds_max = t->contact_rounds;
  sim->params.pcg_iterations_max =
      t->pcg_iterations > 0 ? t->pcg_iterations : sim->def->params.pcg_iterations_max;
  double slack = t->pair_slack > 0 ? t->pair_slack : sim->def->params.pair_slack;
  if (slack != sim->params.pair_slack) sim->pairs_valid = false; // made for another
  sim->params.pair_slack = slack;
}

static void begin_report(cloth_sim *sim, cloth_step_report *report, double h)
{
  *report = (cloth_step_report){
      .step_size = h, .vertices = sim->vertex_count, .triangles = sim->triangle_count};
  sim->along = (cloth_along){0};
  report->stages_skipped = ((uint64_t)1 << CLOTH_STAGE_COUNT) - 1;
  sim->report = report;
}

// what follows the last substep
static cloth_status end(cloth_sim *sim, cloth_step_report *report, cloth_error *err)
{
  CLOTH_TRY(arrive(sim, err));
  CLOTH_TRY(cloth_tangles_update(sim, 0, err));
  CLOTH_TRY(cloth_blocking_look(sim, true, err));
  report->tangles = sim->tangles.count;
  report->bodies_blocking = sim->blocking.count;
  report->holds_blocking = sim->blocking.hold_count;
  return cloth_stretch_measure(sim, err);
}

static cloth_status step(cloth_sim *sim, double h, cloth_step_report *report, cloth_error *err)
{
  double start = cloth_now_ms();
  int64_t allocations = sim->allocations, launches = sim->launches, growths = sim->growths;
  cloth_outcome result = OUTCOME_GOOD;
  begin_report(sim, report, h);
  cloth_blocking_clear(sim);
  CLOTH_TRY(recut(sim, err));
  for (int b = 0; b < sim->def->body_count; b++) {
    const cloth_body_def *d = &sim->def->body[b];
    if (!sim->body[b].commanded && cloth_motion_moves(&d->motion))
      sim->body[b].target = cloth_motion_at(&d->motion, d->pose, sim->time + h);
  }
  CLOTH_TRY(cloth_pins_update(sim, sim->time + h, err));
  place_teleports(sim);
  CLOTH_TRY(save_start(sim, false, err));
  cloth_status status = integrate(sim, h, &result, err);
  if (status < 0 && sim->transport->ranks == 1)
    rescue(sim); // other processes are not asked any more
  CLOTH_TRY(status);
  if (result == OUTCOME_UNSTABLE) {
    cloth_guess_free_fall(sim);
    CLOTH_TRY(go_back(sim, err));
    CLOTH_FAIL(err, CLOTH_UNSTABLE,
               "step %lld at %g s: a vertex left the bounds (%g m) or is not finite, also in "
               "substeps of %g s; the state is that before the step",
               (long long)sim->step + 1, sim->time, sim->params.bounds,
               cloth_is_mass_spring(sim) ? sim->springs.step
                                         : h / (1 << sim->params.step_halvings_max));
  }
  status = end(sim, report, err);
  if (status < 0) { // all substeps stand
    sim->time += h;
    if (sim->transport->ranks == 1) cloth_rescue_probe(sim);
  }
  CLOTH_TRY(status);
  cloth_recut_note(sim);
  sim->time += h;
  report->step = ++sim->step;
  report->time = sim->time;
  report->allocations = (int)(sim->allocations - allocations);
  report->launches = (int)(sim->launches - launches);
  report->buffers_grown = (int)(sim->growths - growths);
  report->memory_bytes = sim->bytes;
  for (int i = 0; i < sim->part_count; i++)
    CLOTH_TRY(sim->backend->finish(sim->part[i].device, err));
  report->wall_ms = cloth_now_ms() - start;
  // clocks differ between processes; a budget decides by the time
  return sim->transport->share(sim->transport, 0, report, sizeof *report, err);
}

cloth_status cloth_sim_step(void *data, double h, cloth_step_report *report, cloth_error *err)
{
  cloth_sim *sim = data;
  cloth_range_begin(sim, "step");
  cloth_status status = step(sim, h, report, err);
  cloth_range_end(sim, 0); // a stage that failed left its own open
  return status;
}
