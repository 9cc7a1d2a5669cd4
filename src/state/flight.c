#include "state/flight.h"

#include "effect/effect.h"
#include "fly_chunk.h"
#include "hold_pull.h"
#include "state/commit.h"
#include "state/control.h"

#include <math.h>

bool cloth_flies(const cloth_sim *sim)
{
  for (int e = 0; e < CLOTH_EFFECT_COUNT; e++)
    if (sim->active[e] && e != CLOTH_EFFECT_gravity && e != CLOTH_EFFECT_pins) return false;
  return sim->params.integrator == CLOTH_BACKWARD_EULER;
}

cloth_status cloth_flight_take(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * CLOTH_COMMIT_FIELDS * (size_t)sim->chunks;
  return cloth_take(sim, p, "commit", bytes, &p->commit, err);
}

static void swap(cloth_real **a, cloth_real **b)
{
  cloth_real *c = *a;
  *a = *b, *b = c;
}

// ---- a substep ----------------------------------------------------------------------------------

static cloth_fly_chunk_args fly_args(const cloth_sim *sim, const cloth_part *p)
{
  bool held = sim->held_count > 0;
  cloth_fly_chunk_args a = {.commit = {.first = 0,
                                       .count = sim->vertex_count,
                                       .x_t0 = p->x_t0,
                                       .x = p->x,
                                       .mass = p->mass,
                                       .inverse_step = (cloth_real)(1 / sim->h),
                                       .v = p->v,
                                       .free = p->free,
                                       .v_next = p->v_next,
                                       .out = p->commit},
                            .h = (cloth_real)sim->h,
                            .free = held ? p->free : NULL,
                            .hold_stiffness = sim->compliant_count > 0 ? p->hold_stiffness : NULL,
                            .target = p->target,
                            .x = p->x};
  for (int k = 0; k < 3 && sim->active[CLOTH_EFFECT_gravity]; k++)
    a.gravity[k] = (cloth_real)sim->params.gravity[k];
  return a;
}

// where holds want their vertices, and the forces they need for that, into `aim`
static cloth_status aim_holds(cloth_sim *sim, double share, cloth_error *err)
{
  if (sim->held_count == 0) return CLOTH_OK;
  sim->owner = CLOTH_EFFECT_pins;
  CLOTH_TRY(cloth_holds_aim(sim, share, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_hold_pull_args a = {fly_args(sim, p), p->held, p->aim};
    CLOTH_LAUNCH(sim, p, hold_pull, sim->held_count, &a, err);
  }
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

// a rigid hold has its vertex where it wants it, a spring is stretched by its force
static cloth_status measure_holds(cloth_sim *sim, cloth_error *err)
{
  if (sim->held_count == 0) return CLOTH_OK;
  CLOTH_TRY(cloth_staging(sim, 3 * (size_t)sim->held_count, err));
  CLOTH_TRY(sim->backend->read(sim->part[0].device, sim->host, sim->part[0].aim,
                               sizeof(cloth_real) * 3 * (size_t)sim->held_count, err));
  for (int h = 0; h < sim->hold_count; h++) {
    cloth_hold_state *hold = &sim->hold[h];
    cloth_pose frame;
    if (!cloth_hold_clear_force(sim, hold, &frame)) continue;
    for (int i = 0; i < hold->count; i++) {
      double x[3], f[3];
      cloth_pose_point(&frame, hold->local + 3 * i, x);
      for (int k = 0; k < 3; k++) {
        f[k] = (double)sim->host[3 * (hold->first + i) + k];
        if (!hold->rigid) x[k] -= f[k] / hold->stiffness;
      }
      cloth_hold_add_force(hold, &frame, x, f);
    }
  }
  return CLOTH_OK;
}

static cloth_status fly(cloth_sim *sim, cloth_error *err)
{
  sim->owner = sim->active[CLOTH_EFFECT_gravity] ? CLOTH_EFFECT_gravity : CLOTH_CORE;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_fly_chunk_args a = fly_args(sim, &sim->part[i]);
    CLOTH_LAUNCH(sim, &sim->part[i], fly_chunk, sim->chunks, &a, err);
  }
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

static cloth_status judge(cloth_sim *sim, bool *good, cloth_error *err)
{
  cloth_change change;
  CLOTH_TRY(cloth_commit_sums(sim, good, &change, err));
  cloth_step_report *r = sim->report;
  double estimate = sim->h * change.largest / 2; // as in commit.c
  r->error_estimate = fmax(r->error_estimate, estimate);
  cloth_control_add(sim, estimate);
  r->substeps++;
  return CLOTH_OK;
}

// ---- the step -----------------------------------------------------------------------------------

cloth_status cloth_flight_advance(cloth_sim *sim, double h, bool *good, cloth_error *err)
{
  int parts = cloth_control_begin(sim, h, sim->params.substeps);
  for (int s = 0; s < parts; s++) {
    double start = cloth_now_ms();
    sim->h = h / parts;
    sim->time_t0 = sim->time + s * sim->h;
    CLOTH_TRY(aim_holds(sim, (s + 1.0) / parts, err));
    CLOTH_TRY(fly(sim, err));
    cloth_stage_charge(sim, CLOTH_STAGE_predict, cloth_now_ms() - start);
    start = cloth_now_ms();
    CLOTH_TRY(measure_holds(sim, err));
    CLOTH_TRY(judge(sim, good, err));
    for (int i = 0; i < sim->part_count; i++) {
      cloth_part *p = &sim->part[i];
      // the first of several keeps the start of the step, which a later one may ask for
      bool exchange = *good ? s == 0 && parts > 1 : s > 0;
      if (exchange) swap(&p->x_t0, &p->x_saved), swap(&p->v, &p->v_saved);
      if (*good) swap(&p->x_t0, &p->x), swap(&p->v, &p->v_next);
    }
    cloth_stage_charge(sim, CLOTH_STAGE_commit, cloth_now_ms() - start);
    if (!*good) break;
  }
  cloth_control_end(sim, h, parts);
  return CLOTH_OK;
}
