// Start of a substep: bodies and holds move to where they are at its end, everything else flies on.
#include "predict.h"

#include "body_vertex.h"
#include "box_chunk.h"
#include "box_merge.h"
#include "chunk.h"
#include "contact/contact.h"
#include "effect/effect.h"
#include "state/control.h"
#include "state/sim.h"

#include <math.h>
#include <string.h>

// ---- poses --------------------------------------------------------------------------------------

cloth_pose cloth_pose_between(cloth_pose a, cloth_pose b, double share)
{
  double time[2] = {0, 1};
  cloth_pose pose[2] = {a, b};
  cloth_motion m = {.key_count = 2, .time = time, .pose = pose};
  return cloth_motion_at(&m, a, share);
}

void cloth_pose_point(const cloth_pose *pose, const double p[3], double out[3])
{
  const double *q = pose->rotation;
  double u[3] = {q[1] * p[2] - q[2] * p[1] + q[3] * p[0], q[2] * p[0] - q[0] * p[2] + q[3] * p[1],
                 q[0] * p[1] - q[1] * p[0] + q[3] * p[2]};
  double r[3] = {p[0] + 2 * (q[1] * u[2] - q[2] * u[1]), p[1] + 2 * (q[2] * u[0] - q[0] * u[2]),
                 p[2] + 2 * (q[0] * u[1] - q[1] * u[0])};
  for (int k = 0; k < 3; k++) out[k] = r[k] + pose->position[k];
}

void cloth_pose_matrix(const cloth_pose *pose, cloth_real out[12])
{
  cloth_pose turn = *pose;
  memset(turn.position, 0, sizeof turn.position);
  for (int c = 0; c < 3; c++) {
    double axis[3] = {c == 0, c == 1, c == 2}, col[3];
    cloth_pose_point(&turn, axis, col);
    for (int r = 0; r < 3; r++) out[3 * r + c] = (cloth_real)col[r];
  }
  for (int k = 0; k < 3; k++) out[9 + k] = (cloth_real)pose->position[k];
}

// ---- what is near -------------------------------------------------------------------------------

enum { BOXES_READ = 256 }; // more of them are merged on the device first

cloth_status cloth_box_update(cloth_sim *sim, double h, cloth_error *err)
{
  cloth_part *p = &sim->part[0];
  cloth_box_chunk_args a = {sim->vertex_count, p->x_t0, p->x, p->v, (cloth_real)h, p->box_of_chunk};
  CLOTH_LAUNCH(sim, p, box_chunk, sim->chunks, &a, err);
  int n = sim->chunks;
  cloth_real *box = p->box_of_chunk;
  while (n > BOXES_READ) {
    cloth_box_merge_args m = {n, box, box + 6 * n};
    int chunks = (n + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
    CLOTH_LAUNCH(sim, p, box_merge, chunks, &m, err);
    box = m.out, n = chunks;
  }
  CLOTH_TRY(cloth_staging(sim, 6 * (size_t)n, err));
  CLOTH_TRY(sim->backend->read(p->device, sim->host, box, sizeof(cloth_real) * 6 * (size_t)n, err));
  sim->cloth_box = cloth_box_load(sim->host, 0);
  for (int c = 1; c < n; c++)
    sim->cloth_box = cloth_box_union(sim->cloth_box, cloth_box_load(sim->host, c));
  return CLOTH_OK;
}

// does the ball around a body, on its way through the substep, come near the cloth's box?
static bool is_near(const cloth_sim *sim, const cloth_body *b, double gap)
{
  double c[2][3];
  cloth_pose_point(&b->t0, b->center, c[0]);
  cloth_pose_point(&b->t1, b->center, c[1]);
  double lo[3] = {(double)sim->cloth_box.lo.x, (double)sim->cloth_box.lo.y,
                  (double)sim->cloth_box.lo.z};
  double hi[3] = {(double)sim->cloth_box.hi.x, (double)sim->cloth_box.hi.y,
                  (double)sim->cloth_box.hi.z};
  for (int k = 0; k < 3; k++)
    if (!(fmin(c[0][k], c[1][k]) - b->radius <= hi[k] + gap &&
          fmax(c[0][k], c[1][k]) + b->radius >= lo[k] - gap))
      return false;
  return b->vertex_count > 0;
}

static cloth_status move_body(cloth_sim *sim, const cloth_body *body, cloth_error *err)
{
  cloth_body_vertex_args a = {.first = body->vertex_first};
  cloth_pose_matrix(&body->t0, a.pose_t0);
  cloth_pose_matrix(&body->t1, a.pose_t1);
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    a.local = part->body_local + 3 * (body->vertex_first - sim->vertex_count);
    a.x_t0 = part->x_t0, a.x = part->x;
    CLOTH_LAUNCH(sim, part, body_vertex, body->vertex_count, &a, err);
  }
  return CLOTH_OK;
}

// Pairs keep for vertices that stray by the slack from the box of all cloth (vertex_escape.h), so
// what is near does too.
static double near_gap(const cloth_sim *sim)
{
  return sim->params.thickness + cloth_contact_reach(sim) + 2 * sim->params.pair_slack;
}

static cloth_status move_bodies(cloth_sim *sim, cloth_error *err)
{
  for (int b = 0; b < sim->def->body_count; b++) {
    cloth_body *body = &sim->body[b];
    bool near = is_near(sim, body, near_gap(sim));
    if (near != body->near) sim->pairs_valid = false;
    body->near = near;
    if (!near) continue;
    sim->report->bodies_near++;
    CLOTH_TRY(move_body(sim, body, err));
  }
  return CLOTH_OK;
}

cloth_status cloth_bodies_join(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(cloth_box_update(sim, sim->h, err));
  bool wanted = sim->active[CLOTH_EFFECT_body_contact];
  for (int b = 0; b < sim->def->body_count && wanted; b++) {
    cloth_body *body = &sim->body[b];
    if (body->near || !is_near(sim, body, near_gap(sim))) continue;
    body->near = true;
    sim->pairs_valid = false;
    sim->report->bodies_near++;
    CLOTH_TRY(move_body(sim, body, err));
  }
  return CLOTH_OK;
}

// how much of free fall the cloth as a whole did in the last substep, in [0, 1]
static double share_of_fall(const cloth_sim *sim, int cloth)
{
  const double *a = sim->acceleration + 3 * cloth, *g = sim->params.gravity;
  double along = 0, g_sq = 0;
  for (int k = 0; k < 3; k++) along += a[k] * g[k], g_sq += g[k] * g[k];
  double share = g_sq > 0 ? along / g_sq : 0;
  return share > 0 ? (share < 1 ? share : 1) : 0;
}

void cloth_guess_free_fall(cloth_sim *sim)
{
  bool falls = sim->active[CLOTH_EFFECT_gravity];
  for (int i = 0; i < 3 * sim->def->cloth_count; i++)
    sim->acceleration[i] = falls ? sim->params.gravity[i % 3] : 0;
  sim->mean_known = sim->bdf2.known = false, sim->substeps_crowded = 0;
  cloth_control_forget(sim);
}

cloth_status cloth_predict_stage(cloth_sim *sim, double from, double to, cloth_error *err)
{
  for (int b = 0; b < sim->def->body_count; b++) {
    cloth_body *body = &sim->body[b];
    body->t0 = cloth_pose_between(body->now, body->target, from);
    body->t1 = cloth_pose_between(body->now, body->target, to);
  }
  for (int i = 0; i < sim->hold_count; i++) {
    cloth_hold_state *hold = &sim->hold[i];
    if (!hold->alive) continue;
    hold->t0 = cloth_hold_frame(sim, hold, from);
    hold->t1 = cloth_hold_frame(sim, hold, to);
  }
  cloth_predict_args a = {.h = (cloth_real)sim->gamma};
  for (int k = 0; k < 3 && sim->active[CLOTH_EFFECT_gravity]; k++)
    a.gravity[k] = (cloth_real)sim->params.gravity[k];
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    a.x_t0 = cloth_step_from(sim, part), a.v = cloth_step_velocity(sim, part);
    a.x_pred = part->x_pred, a.x = part->x;
    a.mass_drag = sim->active[CLOTH_EFFECT_damping] ? part->mass_drag : NULL;
    sim->owner = sim->active[CLOTH_EFFECT_gravity] ? CLOTH_EFFECT_gravity : CLOTH_CORE;
    for (int c = 0; c < sim->def->cloth_count; c++) {
      a.first = sim->cloth_first[c];
      double falls = share_of_fall(sim, c);
      for (int k = 0; k < 3; k++) a.acceleration[k] = (cloth_real)falls * a.gravity[k];
      CLOTH_LAUNCH(sim, part, predict, sim->cloth_first[c + 1] - a.first, &a, err);
    }
  }
  sim->owner = CLOTH_EFFECT_pins;
  if (sim->held_count > 0) CLOTH_TRY(cloth_holds_aim(sim, to, err));
  sim->owner = CLOTH_CORE;
  sim->report->bodies_near = 0;
  bool self = sim->active[CLOTH_EFFECT_self_contact], body = sim->active[CLOTH_EFFECT_body_contact];
  sim->owner = cloth_contact_owner(sim);
  if (self || body) CLOTH_TRY(cloth_box_update(sim, sim->h, err));
  sim->owner = CLOTH_EFFECT_body_contact;
  if (body) CLOTH_TRY(move_bodies(sim, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

cloth_status cloth_freeze_bodies_at(cloth_sim *sim, double share, cloth_error *err)
{
  CLOTH_TRY(cloth_box_update(sim, 0, err));
  for (int b = 0; b < sim->def->body_count; b++) {
    cloth_body *body = &sim->body[b];
    body->t0 = body->t1 =
        share > 0 ? cloth_pose_between(body->now, body->target, share) : body->now;
  }
  return sim->active[CLOTH_EFFECT_body_contact] ? move_bodies(sim, err) : CLOTH_OK;
}

cloth_status cloth_freeze_bodies(cloth_sim *sim, cloth_error *err)
{
  return cloth_freeze_bodies_at(sim, 0, err);
}
