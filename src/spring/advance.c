// One step of the mass-spring cloth. The step is cut into sub-steps of spring_step, the last one
// shorter, and these into blocks. A block asks nothing of the host but to queue one launch per
// sub-step: where bodies and holds will be is written before, and whether all went well is read
// after it. If particles strayed from the candidates of their search, the block is done again with
// half as many sub-steps; the result is the same for any cut.
//
// Sub-steps are equal unless asked otherwise: a step that is shorter now and then makes modes near
// the limit grow (doc/mass_spring.md).
#include "effect/effect.h"
#include "spring_block.h"
#include "spring_chunk.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static cloth_status frame_of(const cloth_sim *sim, double h, cloth_spring_frame *f,
                             cloth_error *err)
{
  *f = (cloth_spring_frame){.h = h, .step = fmin(sim->springs.step, h)};
  CLOTH_TRY(cloth_spring_sub_steps(sim, h, &f->count, err));
  if (sim->params.spring_cut == 0) f->step = h / f->count;
  return CLOTH_OK;
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
    a.strayed = s->sums + CLOTH_SPRING_STRAYED;
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

// the wind of each sub-step of a block; NULL where it does not change
static const cloth_real *wind_of(cloth_sim *sim, const cloth_spring_frame *f, int begin, int end,
                                 cloth_real *mean)
{
  const cloth_params *q = &sim->params;
  bool gusts = sim->active[CLOTH_EFFECT_air] && q->gust > 0;
  for (int c = 0; c < 3; c++) mean[c] = (cloth_real)q->wind[c];
  for (int k = 0; k < end - begin && gusts; k++) {
    double gust = cloth_gust(q, sim->time + cloth_spring_time(f, begin + k));
    for (int c = 0; c < 3; c++) sim->springs.wind[3 * k + c] = (cloth_real)(gust * q->wind[c]);
  }
  return gusts ? sim->springs.wind : NULL;
}

// sub-steps [begin, end) of a step
static cloth_spring_block_args block_of(cloth_sim *sim, cloth_part *p, const cloth_spring_frame *f,
                                        int begin, int end)
{
  const cloth_springs *s = &sim->springs;
  cloth_spring_block_args b = {.step = args_of(sim, p),
                               .rows = p->v1 - p->v0,
                               .begin = begin,
                               .count = end - begin,
                               .h = f->h,
                               .sub_step = f->step,
                               .sub_steps = f->count,
                               .body_rows = f->body_rows,
                               .held_rows = f->held_rows,
                               .last = end == f->count && p->spring.touch != NULL,
                               .x = p->x_t0,
                               .v = p->v};
  b.step.shapes.pose_t0 = p->spring.shape_pose;
  b.step.holds.aim = p->spring.aim;
  b.step.touch = p->spring.touch;
  b.wind = wind_of(sim, f, begin, end, b.step.air.wind);
  for (int c = 0; c < 3; c++) b.mean[c] = s->mean[c], b.mean_change[c] = s->mean_change[c];
  if (uses_bins(sim)) {
    b.x_ref = p->spring.x_ref, b.v_ref = p->spring.v_ref;
    b.find = cloth_spring_find(sim, p);
    b.head = p->spring.bin_first, b.next = p->spring.binned;
  }
  if (begin == 0) b.x_saved = p->x_saved, b.v_saved = p->v_saved;
  return b;
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

// one launch for each sub-step and part
static cloth_status run_each(cloth_sim *sim, const cloth_spring_frame *f, int begin, int end,
                             cloth_error *err)
{
  cloth_spring_block_args block[CLOTH_DEVICES_MAX];
  for (int i = 0; i < sim->part_count; i++) block[i] = block_of(sim, &sim->part[i], f, begin, end);
  for (int k = 0; k < end - begin; k++) {
    for (int i = 0; i < sim->part_count; i++) {
      cloth_part *p = &sim->part[i];
      cloth_spring_step_args a = block[i].step;
      cloth_spring_inputs inputs = cloth_spring_inputs_at(&block[i], k);
      cloth_spring_inputs_set(&block[i], k, &inputs, &a);
      a.x = p->x_t0, a.v = p->v, a.x_next = p->x, a.v_next = p->v_next;
      CLOTH_LAUNCH(sim, p, spring_step, p->v1 - p->v0, &a, err);
    }
    CLOTH_TRY(swap_buffers(sim, err));
  }
  return CLOTH_OK;
}

bool cloth_springs_at_once(const cloth_sim *sim)
{
  return sim->part_count == 1 && sim->backend->spring_block != NULL; // nothing to exchange
}

static cloth_status run_at_once(cloth_sim *sim, const cloth_spring_frame *f, int begin, int end,
                                cloth_error *err)
{
  cloth_part *p = &sim->part[0];
  cloth_spring_block_args b = block_of(sim, p, f, begin, end);
  size_t bytes = 3 * sizeof *b.wind * (size_t)b.count;
  if (b.wind != NULL) {
    CLOTH_TRY(cloth_grow(sim, p, "wind", bytes, &p->spring.wind, err));
    CLOTH_TRY(sim->backend->write(p->device, p->spring.wind, b.wind, bytes, err));
    b.wind = p->spring.wind;
  }
  return cloth_launch_spring_block(sim, p, &b, err);
}

static cloth_status run_block(cloth_sim *sim, const cloth_spring_frame *f, int begin, int end,
                              cloth_error *err)
{
  sim->owner = sim->active[CLOTH_EFFECT_springs] ? CLOTH_EFFECT_springs : CLOTH_CORE;
  if (cloth_springs_at_once(sim))
    CLOTH_TRY(run_at_once(sim, f, begin, end, err));
  else
    CLOTH_TRY(run_each(sim, f, begin, end, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

static cloth_status search(cloth_sim *sim, cloth_error *err)
{
  double start = cloth_stage_open(sim, CLOTH_STAGE_pairs);
  sim->owner = CLOTH_EFFECT_self_contact;
  sim->report->pair_searches++;
  sim->report->pairs = 0;
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(cloth_spring_search(sim, &sim->part[i], err));
  sim->owner = CLOTH_CORE;
  cloth_stage_close(sim, CLOTH_STAGE_pairs, start);
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

// What the end of a step sums up.
typedef struct totals {
  double worst, sum[CLOTH_SPRING_SUMS]; // m; energy, velocity, contacts
} totals;

static void sum_chunks(cloth_sim *sim, const cloth_real *field, size_t chunks, totals *t)
{
  cloth_step_report *r = sim->report;
  for (; chunks > 0; chunks--, field += CLOTH_SPRING_FIELDS) {
    if (!((double)field[CLOTH_SPRING_WORST] <= t->worst))
      t->worst = (double)field[CLOTH_SPRING_WORST];
    if (t->worst != t->worst) return;
    r->speed_max = fmax(r->speed_max, (double)field[CLOTH_SPRING_SPEED]);
    for (int k = 0; k < CLOTH_SPRING_SUMS; k++) t->sum[k] += (double)field[CLOTH_SPRING_ENERGY + k];
  }
}

// What a part has to say after a block: of its candidates, and at the end of a step of its
// particles, in one read.
static cloth_status read_part(cloth_sim *sim, cloth_part *p, bool last, cloth_spring_verdict *v,
                              totals *t, cloth_error *err)
{
  const size_t head = sizeof(uint32_t) * CLOTH_SPRING_HEAD;
  size_t row = sizeof(cloth_real) * CLOTH_SPRING_FIELDS;
  size_t at = (size_t)((p->v0 + CLOTH_CHUNK - 1) / CLOTH_CHUNK);
  size_t chunks = (size_t)((p->v1 + CLOTH_CHUNK - 1) / CLOTH_CHUNK) - at;
  size_t bytes = head + (last ? row * (at + chunks) : 0);
  cloth_spring_chunk_args a = {p->v0,   p->v1 - p->v0,   p->x_t0,        p->v,
                               p->mass, p->spring.touch, p->spring.chunk};
  if (chunks == 0) return CLOTH_OK;
  if (last) CLOTH_LAUNCH(sim, p, spring_chunk, (int)chunks, &a, err);
  if (last) CLOTH_TRY(cloth_stretch_look(sim, p->x_t0, err));
  CLOTH_TRY(cloth_staging(sim, bytes / sizeof(cloth_real) + 1, err));
  CLOTH_TRY(sim->backend->read(p->device, sim->host, p->spring.sums, bytes, err));
  uint32_t sum[CLOTH_SPRING_HEAD];
  memcpy(sum, sim->host, head);
  if (last)
    sum_chunks(sim, sim->host + head / sizeof *sim->host + CLOTH_SPRING_FIELDS * at, chunks, t);
  return uses_bins(sim) ? cloth_spring_found(sim, p, sum, v, err) : CLOTH_OK;
}

// were the candidates complete? If not, the state is that of the start of the block. The next block
// is as long as speeds allow: shorter after particles strayed, longer when all stayed near.
static cloth_status judge(cloth_sim *sim, int length, bool last, bool *good, totals *t,
                          cloth_error *err)
{
  cloth_springs *s = &sim->springs;
  cloth_spring_verdict v = {.room = true};
  *good = true;
  *t = (totals){0};
  for (int i = 0; i < sim->part_count && (last || uses_bins(sim)); i++)
    CLOTH_TRY(read_part(sim, &sim->part[i], last, &v, t, err));
  if (!uses_bins(sim)) return CLOTH_OK;
  if (v.strayed) s->block = length / 2;
  if (!v.nearly && length >= s->block)
    s->block = 2 * length < CLOTH_SPRING_BLOCK_MAX ? 2 * length : CLOTH_SPRING_BLOCK_MAX;
  *good = v.room && !v.strayed;
  return *good ? CLOTH_OK : go_back(sim, err);
}

// ---- the step -----------------------------------------------------------------------------------

static cloth_status run_all(cloth_sim *sim, cloth_spring_frame *f, totals *t, cloth_error *err)
{
  cloth_springs *s = &sim->springs;
  if (s->block == 0) s->block = CLOTH_SPRING_BLOCK_MAX;
  for (int done = 0; done < f->count;) {
    int most = uses_bins(sim) ? s->block : CLOTH_SPRING_BLOCK_MAX;
    int end = done + most < f->count ? done + most : f->count;
    double start = cloth_stage_open(sim, CLOTH_STAGE_predict);
    bool good;
    sim->owner = CLOTH_EFFECT_pins;
    CLOTH_TRY(cloth_spring_aims_write(sim, f, done, end, err));
    sim->owner = CLOTH_EFFECT_body_contact;
    CLOTH_TRY(cloth_spring_poses_write(sim, f, done, end, err));
    sim->owner = CLOTH_CORE;
    cloth_stage_close(sim, CLOTH_STAGE_predict, start);
    if (uses_bins(sim)) CLOTH_TRY(search(sim, err));
    start = cloth_stage_open(sim, CLOTH_STAGE_effects);
    CLOTH_TRY(run_block(sim, f, done, end, err));
    CLOTH_TRY(judge(sim, end - done, end == f->count, &good, t, err));
    cloth_stage_close(sim, CLOTH_STAGE_effects, start);
    if (!good) continue;
    CLOTH_TRY(cloth_spring_impulses_add(sim, err));
    done = end;
  }
  sim->report->substeps = f->count;
  return CLOTH_OK;
}

#define MEAN_MOST 1e3 // m/s; a mean beyond it, as NaN, is none to go on from

static void commit(cloth_sim *sim, double h, const totals *t, bool *good)
{
  cloth_springs *s = &sim->springs;
  enum { VELOCITY = CLOTH_SPRING_VELOCITY - CLOTH_SPRING_ENERGY };
  *good = t->worst <= sim->params.bounds;
  for (int c = 0; c < 3; c++) {
    double mean = t->sum[VELOCITY + c] / sim->vertex_count;
    bool usable = fabs(mean) < MEAN_MOST;
    s->mean_change[c] = usable ? (mean - s->mean[c]) / h : 0;
    s->mean[c] = usable ? mean : 0;
  }
  sim->report->energy_kinetic = t->sum[0];
  sim->report->contacts_self = (int)(t->sum[CLOTH_SPRING_PARTICLES - CLOTH_SPRING_ENERGY] / 2);
  sim->report->contacts_body = (int)t->sum[CLOTH_SPRING_BODIES - CLOTH_SPRING_ENERGY];
}

cloth_status cloth_springs_advance(cloth_sim *sim, double h, bool *good, cloth_error *err)
{
  cloth_spring_frame f;
  totals t;
  CLOTH_TRY(frame_of(sim, h, &f, err));
  sim->owner = CLOTH_EFFECT_pins;
  CLOTH_TRY(cloth_spring_holds_write(sim, err));
  sim->owner = CLOTH_CORE;
  cloth_spring_wrenches_scale(sim, 0);
  CLOTH_TRY(run_all(sim, &f, &t, err));
  cloth_spring_wrenches_scale(sim, 1 / h);
  double start = cloth_stage_open(sim, CLOTH_STAGE_commit);
  commit(sim, h, &t, good);
  cloth_stage_close(sim, CLOTH_STAGE_commit, start);
  return CLOTH_OK;
}

bool cloth_springs_save(const cloth_sim *sim)
{
  return cloth_is_mass_spring(sim) && cloth_springs_at_once(sim);
}
