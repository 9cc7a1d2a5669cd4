// How many substeps a step is cut into. Holds: none may take a vertex farther than body_motion_max
// from where it would coast to, because one linear system does not know what a cloth does that is
// jerked by twice its edges. Bodies: none may move farther than body_motion_max against the
// cloth near it between two searches. What carries the cloth along moves little against it, however
// fast both are; contacts hardly turn then, and what is swept is tested by src/ccd/ in any case.
#include "box_chunk.h"
#include "effect/effect.h"
#include "hold_jump.h"
#include "motion_chunk.h"
#include "predict.h"
#include "state/sim.h"

#include <math.h>

#define NEAR_MARGIN 0.02 // m; cloth may be taken along farther than it flies by itself

// how a body moves in this step
typedef struct travel {
  double shift[3];     // m, of its middle
  double turn;         // m, what its farthest point moves beside that
  double lo[3], hi[3]; // m, of where it passes
} travel;

static double turned_by(const cloth_body *b)
{
  double dot = 0;
  for (int k = 0; k < 4; k++) dot += b->now.rotation[k] * b->target.rotation[k];
  double angle = 2 * acos(fmin(1, fabs(dot)));
  return angle > 1e-7 ? angle * b->radius : 0;
}

static travel travel_of(const cloth_body *b)
{
  const cloth_pose *pose[2] = {&b->now, &b->target};
  travel t = {.turn = turned_by(b)};
  double c[2][3];
  for (int p = 0; p < 2; p++) {
    cloth_pose_point(pose[p], b->center, c[p]);
    for (int k = 0; k < 3; k++) {
      double reach = 0; // of the box's half edges, turned
      for (int e = 0; e < 3; e++) {
        double edge[3] = {0, 0, 0}, origin[3] = {0, 0, 0}, a[3], o[3];
        edge[e] = b->half[e];
        cloth_pose_point(pose[p], edge, a), cloth_pose_point(pose[p], origin, o);
        reach += fabs(a[k] - o[k]);
      }
      reach += NEAR_MARGIN + t.turn * t.turn / (8 * fmax(b->radius, 1e-9)); // the bulge of an arc
      t.lo[k] = p ? fmin(t.lo[k], c[p][k] - reach) : c[p][k] - reach;
      t.hi[k] = p ? fmax(t.hi[k], c[p][k] + reach) : c[p][k] + reach;
    }
  }
  for (int k = 0; k < 3; k++) t.shift[k] = c[1][k] - c[0][k];
  return t;
}

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

// Where the cloth gets to in this step if nothing stops it, and how its chunks move: box and motion
// [chunks x 6] in sim->host. From the state alone: what was computed before must not show, or a run
// continued from a file would be cut differently.
static cloth_status find_flight(cloth_sim *sim, double h, cloth_error *err)
{
  cloth_part *p = &sim->part[0]; // every part would find the same
  cloth_predict_args a = {.x_t0 = p->x_t0, .v = p->v, .h = (cloth_real)h};
  a.x_pred = p->x_pred, a.x = p->x;
  for (int k = 0; k < 3; k++) a.gravity[k] = (cloth_real)sim->params.gravity[k];
  CLOTH_LAUNCH(sim, p, predict, sim->vertex_count, &a, err);
  cloth_box_chunk_args box = {sim->vertex_count, p->x_t0,        p->x_pred, p->v,
                              (cloth_real)h,     p->box_of_chunk};
  CLOTH_LAUNCH(sim, p, box_chunk, sim->chunks, &box, err);
  size_t n = 6 * (size_t)sim->chunks;
  CLOTH_TRY(cloth_staging(sim, 2 * n, err));
  CLOTH_TRY(sim->backend->read(p->device, sim->host, p->box_of_chunk, sizeof(cloth_real) * n, err));
  cloth_motion_chunk_args motion = {sim->vertex_count, p->x_t0, p->x, p->x_pred, p->box_of_chunk};
  CLOTH_LAUNCH(sim, p, motion_chunk, sim->chunks, &motion, err);
  return sim->backend->read(p->device, sim->host + n, p->box_of_chunk, sizeof(cloth_real) * n, err);
}

// how far the body's farthest point moves against the fastest vertex of the chunks that it may
// meet [m]
static double relative_motion(const cloth_sim *sim, const travel *t)
{
  double most = 0;
  for (int c = 0; c < sim->chunks; c++) {
    const cloth_real *box = sim->host + 6 * c, *motion = sim->host + 6 * (sim->chunks + c);
    double apart[3];
    bool meets = true;
    for (int k = 0; k < 3; k++) {
      meets &= !((double)box[k] > t->hi[k]) && !((double)box[3 + k] < t->lo[k]);
      apart[k] =
          fmax(fabs(t->shift[k] - (double)motion[k]), fabs(t->shift[k] - (double)motion[3 + k]));
    }
    if (meets) most = fmax(most, length(apart) + t->turn);
  }
  return most;
}

// where rigid holds want their vertices at the end of the step, how far compliant ones go in it:
// [held x 3] in sim->host
static cloth_status aims_of_holds(cloth_sim *sim, cloth_error *err)
{
  size_t n = 3 * (size_t)sim->held_count;
  CLOTH_TRY(cloth_staging(sim, 2 * n, err));
  cloth_holds_place(sim, 1, sim->host);
  if (sim->compliant_count == 0) return CLOTH_OK;
  cloth_holds_place(sim, 0, sim->host + n);
  for (int h = 0; h < sim->hold_count; h++) {
    const cloth_hold_state *hold = &sim->hold[h];
    cloth_real *aim = sim->host + 3 * hold->first;
    for (int i = 0; hold->alive && !hold->rigid && i < 3 * hold->count; i++)
      aim[i] -= aim[n + (size_t)i];
  }
  return CLOTH_OK;
}

// how far holds jerk their vertices in this step [m]; a smooth swing hardly does
static cloth_status jerk_of_holds(cloth_sim *sim, double h, double *out, cloth_error *err)
{
  *out = 0;
  if (sim->held_count == 0) return CLOTH_OK;
  cloth_part *p = &sim->part[0]; // every part would find the same
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->held_count;
  CLOTH_TRY(aims_of_holds(sim, err));
  CLOTH_TRY(sim->backend->write(p->device, p->aim, sim->host, bytes, err));
  cloth_hold_jump_args a = {
      p->held,       p->x_t0, p->v, p->mass, sim->compliant_count > 0 ? p->hold_stiffness : NULL,
      (cloth_real)h, p->aim};
  CLOTH_LAUNCH(sim, p, hold_jump, sim->held_count, &a, err);
  CLOTH_TRY(sim->backend->read(p->device, sim->host, p->aim, bytes, err));
  for (int i = 0; i < sim->held_count; i++) {
    double jump[3];
    for (int k = 0; k < 3; k++) jump[k] = (double)sim->host[3 * i + k];
    *out = fmax(*out, length(jump));
  }
  return CLOTH_OK;
}

static void cut(const cloth_sim *sim, double motion, int *substeps)
{
  double n = ceil(motion / sim->params.body_motion_max);
  if (n > *substeps) *substeps = n < sim->params.substeps_max ? (int)n : sim->params.substeps_max;
}

cloth_status cloth_substeps_count(cloth_sim *sim, double h, int *out, cloth_error *err)
{
  double most = 0, fastest = 0, jerk;
  *out = sim->params.substeps;
  CLOTH_TRY(jerk_of_holds(sim, h, &jerk, err));
  cut(sim, jerk, out);
  if (!sim->active[CLOTH_EFFECT_body_contact]) return CLOTH_OK;
  for (int b = 0; b < sim->def->body_count; b++) {
    travel t = travel_of(&sim->body[b]);
    fastest = fmax(fastest, length(t.shift) + t.turn);
  }
  if (fastest <= sim->params.body_motion_max * *out) return CLOTH_OK;
  CLOTH_TRY(find_flight(sim, h, err));
  for (int b = 0; b < sim->def->body_count; b++) {
    travel t = travel_of(&sim->body[b]);
    double own = length(t.shift) + t.turn;
    // one that moves no farther by itself does not cut: fast cloth that meets it is tested by ccd
    if (own > sim->params.body_motion_max * *out)
      most = fmax(most, fmin(own, relative_motion(sim, &t)));
  }
  cut(sim, most, out);
  return CLOTH_OK;
}
