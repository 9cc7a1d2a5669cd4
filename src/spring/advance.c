// One step of the mass-spring cloth. The step is cut into sub-steps of spring_step, the last one
// shorter, and these into blocks. A block asks nothing of the host but to queue one launch per
// sub-step: where bodies and holds will be is written before, and whether all went well is read
// after it. If particles strayed from the candidates of their search, the block is done again with
// half as many sub-steps; the result is the same for any cut.
//
// Sub-steps are equal unless asked otherwise: a step that is shorter now and then makes modes near
// the limit grow (doc/mass_spring.md).
#include "effect/effect.h"
#include "spring_chunk.h"
#include "spring_step.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum { BLOCK_MAX = 128 }; // sub-steps

static cloth_spring_frame frame_of(const cloth_sim *sim, double h)
{
  cloth_spring_frame f = {.h = h, .step = fmin(sim->springs.step, h)};
  f.count = (int)ceil(h / f.step - 1e-9);
  if (f.count < 1) f.count = 1;
  if (sim->params.spring_cut == 0) f.step = h / f.count;
  return f;
}

// ---- a block of sub-steps -----------------------------------------------------------------------

static bool uses_bins(const cloth_sim *sim)
{
  return sim->active[CLOTH_EFFECT_self_contact] && sim->params.particle_search == 0;
}

// what stays the same in all sub-steps of a block
static cloth_spring_step_args args_of(const cloth_sim *sim, const cloth_part *p)
{
  const cloth_spring_part *s = &p->spring;
  cloth_spring_step_args a = {.first = p->v0, .mass = p->mass};
  if (sim->active[CLOTH_EFFECT_springs]) a.springs = (cloth_spring_rows){s->first, s->to, s->law};
  if (sim->active[CLOTH_EFFECT_damping]) a.mass_drag = p->mass_drag;
  for (int k = 0; k < 3 && sim->active[CLOTH_EFFECT_gravity]; k++)
    a.gravity[k] = (cloth_real)sim->params.gravity[k];
  if (sim->active[CLOTH_EFFECT_air])
    a.air = (cloth_spring_air){.first = s->air_first,
                               .triangle = s->air_triangle,
                               .drag = s->air_drag,
                               .half_density = (cloth_real)(sim->params.air_density / 2)};
  if (sim->active[CLOTH_EFFECT_self_contact])
    a.particles = (cloth_particles){
        .count = sim->vertex_count,
        .diameter = (cloth_real)(2 * sim->springs.radius),
        .inverse_step = (cloth_real)(1 / sim->springs.step),
        .friction = sim->active[CLOTH_EFFECT_friction] ? (cloth_real)sim->params.friction : 0,
        .x_rest = p->x_rest,
        .mass = p->mass};
  if (uses_bins(sim)) {
    a.particles.listed = s->listed, a.particles.candidate = s->candidate;
    a.particles.room = s->candidate_room;
    a.stray = (cloth_real)cloth_spring_stray(sim);
    a.strayed = s->sums + 2;
  }
  if (sim->active[CLOTH_EFFECT_body_contact])
    a.shapes = (cloth_shapes){.count = sim->def->body_count,
                              .kind = s->shape_kind,
                              .size = s->shape_size,
                              .friction = s->shape_friction,
                              .gap = (cloth_real)sim->springs.radius};
  if (sim->held_count > 0)
    a.holds = (cloth_spring_holds){
        .slot = s->slot, .free = p->free, .stiffness = p->hold_stiffness, .impulse = s->impulse};
  return a;
}

// what changes from sub-step to sub-step; k counts from the start of the block
static void args_at(const cloth_sim *sim, const cloth_part *p, const cloth_spring_frame *f,
                    int begin, int k, cloth_spring_step_args *a)
{
  const cloth_params *q = &sim->params;
  const cloth_springs *s = &sim->springs;
  int n = begin + k;
  double t = cloth_spring_time(f, n), since = t - cloth_spring_time(f, begin);
  a->h = (cloth_real)(n + 1 < f->count ? f->step : f->h - t);
  a->x = p->x_t0, a->v = p->v, a->x_next = p->x, a->v_next = p->v_next;
  double gust = sin(2 * 3.14159265358979323846 * (sim->time + t) / q->gust_period);
  for (int c = 0; c < 3; c++) {
    a->air.wind[c] = (cloth_real)((1 + q->gust * gust) * q->wind[c]);
    a->drift[c] = (cloth_real)(since * (s->mean[c] + since / 2 * s->mean_change[c]));
  }
  if (a->shapes.count > 0) {
    a->shapes.pose_t0 = p->spring.shape_pose + 12 * (size_t)f->body_rows * (size_t)k;
    a->shapes.pose_t1 = a->shapes.pose_t0 + 12 * (size_t)f->body_rows;
  }
  if (a->holds.slot) a->holds.aim = p->spring.aim + 3 * (size_t)f->held_rows * (size_t)k;
  a->x_ref = uses_bins(sim) && k > 0 ? p->spring.x_ref : NULL; // at first nobody has moved yet
  a->touch = n + 1 == f->count ? p->spring.touch : NULL;
}

static cloth_status swap_buffers(cloth_sim *sim, cloth_error *err)
{
  const size_t row = 3 * sizeof(cloth_real);
  CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, x), CLOTH_PER_VERTEX, row, err));
  CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, v_next), CLOTH_PER_VERTEX, row, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_real *x = p->x, *v = p->v_next;
    p->x = p->x_t0, p->x_t0 = x;
    p->v_next = p->v, p->v = v;
  }
  return CLOTH_OK;
}

static cloth_status run_block(cloth_sim *sim, const cloth_spring_frame *f, int begin, int end,
                              cloth_error *err)
{
  cloth_spring_step_args args[CLOTH_DEVICES_MAX];
  sim->owner = sim->active[CLOTH_EFFECT_springs] ? CLOTH_EFFECT_springs : CLOTH_CORE;
  for (int i = 0; i < sim->part_count; i++) args[i] = args_of(sim, &sim->part[i]);
  for (int k = 0; k < end - begin; k++) {
    for (int i = 0; i < sim->part_count; i++) {
      cloth_part *p = &sim->part[i];
      args_at(sim, p, f, begin, k, &args[i]);
      CLOTH_LAUNCH(sim, p, spring_step, p->v1 - p->v0, &args[i], err);
    }
    CLOTH_TRY(swap_buffers(sim, err));
  }
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

static cloth_status search(cloth_sim *sim, cloth_error *err)
{
  double start = cloth_now_ms();
  sim->owner = CLOTH_EFFECT_self_contact;
  sim->report->pair_searches++;
  sim->report->pairs = 0;
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(cloth_spring_search(sim, &sim->part[i], err));
  sim->owner = CLOTH_CORE;
  cloth_stage_charge(sim, CLOTH_STAGE_pairs, cloth_now_ms() - start);
  return CLOTH_OK;
}

// back to the start of the block
static cloth_status go_back(cloth_sim *sim, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_copy_local(sim, p, p->x_t0, p->spring.x_ref, bytes, err));
    CLOTH_TRY(cloth_copy_local(sim, p, p->v, p->spring.v_ref, bytes, err));
  }
  return CLOTH_OK;
}

// were the candidates complete? If not, the state is that of the start of the block. The next block
// is as long as speeds allow: shorter after particles strayed, longer when all stayed near.
static cloth_status judge(cloth_sim *sim, int length, bool *good, cloth_error *err)
{
  cloth_springs *s = &sim->springs;
  cloth_spring_verdict v = {.room = true};
  *good = true;
  if (!uses_bins(sim)) return CLOTH_OK;
  sim->owner = CLOTH_EFFECT_self_contact;
  for (int i = 0; i < sim->part_count; i++)
    CLOTH_TRY(cloth_spring_searched(sim, &sim->part[i], &v, err));
  sim->owner = CLOTH_CORE;
  if (v.strayed) s->block = length / 2;
  if (!v.nearly && length >= s->block) s->block = 2 * length < BLOCK_MAX ? 2 * length : BLOCK_MAX;
  *good = v.room && !v.strayed;
  return *good ? CLOTH_OK : go_back(sim, err);
}

// ---- the step -----------------------------------------------------------------------------------

static cloth_status run_all(cloth_sim *sim, cloth_spring_frame *f, cloth_error *err)
{
  cloth_springs *s = &sim->springs;
  if (s->block == 0) s->block = BLOCK_MAX;
  for (int done = 0; done < f->count;) {
    int most = uses_bins(sim) ? s->block : BLOCK_MAX;
    int end = done + most < f->count ? done + most : f->count;
    double start = cloth_now_ms();
    bool good;
    sim->owner = CLOTH_EFFECT_pins;
    CLOTH_TRY(cloth_spring_aims_write(sim, f, done, end, err));
    sim->owner = CLOTH_EFFECT_body_contact;
    CLOTH_TRY(cloth_spring_poses_write(sim, f, done, end, err));
    sim->owner = CLOTH_CORE;
    cloth_stage_charge(sim, CLOTH_STAGE_predict, cloth_now_ms() - start);
    if (uses_bins(sim)) CLOTH_TRY(search(sim, err));
    start = cloth_now_ms();
    CLOTH_TRY(run_block(sim, f, done, end, err));
    CLOTH_TRY(judge(sim, end - done, &good, err));
    cloth_stage_charge(sim, CLOTH_STAGE_effects, cloth_now_ms() - start);
    if (!good) continue;
    CLOTH_TRY(cloth_spring_impulses_add(sim, err));
    done = end;
  }
  sim->report->substeps = f->count;
  return CLOTH_OK;
}

static void sum_chunks(cloth_sim *sim, const cloth_real *field, double *worst, double sum[6])
{
  cloth_step_report *r = sim->report;
  for (int c = 0; c < sim->chunks; c++, field += CLOTH_SPRING_FIELDS) {
    if (!((double)field[CLOTH_SPRING_WORST] <= *worst)) *worst = (double)field[CLOTH_SPRING_WORST];
    if (*worst != *worst) return;
    r->speed_max = fmax(r->speed_max, (double)field[CLOTH_SPRING_SPEED]);
    for (int k = 0; k < 6; k++) sum[k] += (double)field[CLOTH_SPRING_ENERGY + k];
  }
}

static cloth_status commit(cloth_sim *sim, double h, bool *good, cloth_error *err)
{
  double worst = 0, sum[6] = {0}; // energy, velocity, contacts
  size_t row = sizeof(cloth_real) * CLOTH_SPRING_FIELDS;
  CLOTH_TRY(cloth_staging(sim, CLOTH_SPRING_FIELDS * (size_t)sim->chunks, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    size_t at = (size_t)((p->v0 + CLOTH_CHUNK - 1) / CLOTH_CHUNK);
    size_t chunks = (size_t)((p->v1 + CLOTH_CHUNK - 1) / CLOTH_CHUNK) - at;
    cloth_spring_chunk_args a = {p->v0,   p->v1 - p->v0,   p->x_t0,        p->v,
                                 p->mass, p->spring.touch, p->spring.chunk};
    if (chunks == 0) continue;
    CLOTH_LAUNCH(sim, p, spring_chunk, (int)chunks, &a, err);
    CLOTH_TRY(sim->backend->read(p->device, sim->host + CLOTH_SPRING_FIELDS * at,
                                 p->spring.chunk + CLOTH_SPRING_FIELDS * at, row * chunks, err));
  }
  sum_chunks(sim, sim->host, &worst, sum);
  *good = worst <= sim->params.bounds;
  cloth_springs *s = &sim->springs;
  for (int c = 0; c < 3; c++) {
    double mean = sum[1 + c] / sim->vertex_count;
    bool usable = fabs(mean) < 1e3; // false for NaN
    s->mean_change[c] = usable ? (mean - s->mean[c]) / h : 0;
    s->mean[c] = usable ? mean : 0;
  }
  sim->report->energy_kinetic = sum[0];
  sim->report->contacts_self = (int)(sum[4] / 2), sim->report->contacts_body = (int)sum[5];
  return CLOTH_OK;
}

cloth_status cloth_springs_advance(cloth_sim *sim, double h, bool *good, cloth_error *err)
{
  cloth_spring_frame f = frame_of(sim, h);
  sim->owner = CLOTH_EFFECT_pins;
  CLOTH_TRY(cloth_spring_holds_write(sim, err));
  sim->owner = CLOTH_CORE;
  cloth_spring_wrenches_scale(sim, 0);
  CLOTH_TRY(run_all(sim, &f, err));
  cloth_spring_wrenches_scale(sim, 1 / h);
  double start = cloth_now_ms();
  CLOTH_TRY(commit(sim, h, good, err));
  cloth_stage_charge(sim, CLOTH_STAGE_commit, cloth_now_ms() - start);
  return CLOTH_OK;
}
