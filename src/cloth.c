// The public interface: checks arguments, calls the engine of the scene's precision, and tells the
// recorder. What a function means is said in cloth.h.
#include "front.h"
#include "processes.h"
#include "record_digest.h"
#include "scene/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CALL(scene, function, ...) ((scene)->engine->function((scene)->sim, __VA_ARGS__))

// ---- life ---------------------------------------------------------------------------------------

static void rotate(const double q[4], const double p[3], double out[3])
{
  double u[3] = {q[1] * p[2] - q[2] * p[1] + q[3] * p[0], q[2] * p[0] - q[0] * p[2] + q[3] * p[1],
                 q[0] * p[1] - q[1] * p[0] + q[3] * p[2]};
  out[0] = p[0] + 2 * (q[1] * u[2] - q[2] * u[1]);
  out[1] = p[1] + 2 * (q[2] * u[0] - q[0] * u[2]);
  out[2] = p[2] + 2 * (q[0] * u[1] - q[1] * u[0]);
}

static cloth_status rest_positions(cloth_scene *s, cloth_error *err)
{
  s->rest = calloc((size_t)s->def->cloth_count + 1, sizeof *s->rest);
  if (s->rest == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "scene");
  for (int c = 0; c < s->def->cloth_count; c++) {
    const cloth_cloth_def *d = &s->def->cloth[c];
    s->rest[c] = malloc(sizeof(double) * 3 * (size_t)d->mesh.vertex_count);
    if (s->rest[c] == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "scene");
    for (int v = 0; v < d->mesh.vertex_count; v++) {
      rotate(d->pose.rotation, d->mesh.position + 3 * v, s->rest[c] + 3 * v);
      for (int k = 0; k < 3; k++) s->rest[c][3 * v + k] += d->pose.position[k];
    }
  }
  return CLOTH_OK;
}

enum { MASS_SPRING = 1 }; // a choice of the parameter integrator

// the two ends of one trade; and an integrator whose step is its stability's
static cloth_status check_accuracy(const cloth_params *p, cloth_error *err)
{
  if (!(p->accuracy > 0)) return CLOTH_OK;
  if (p->time_budget != 0)
    CLOTH_FAIL(
        err, CLOTH_BAD_ARGUMENT,
        "accuracy = %g [1] and time_budget = %g [ms] are both set: one of them is to be held",
        p->accuracy, p->time_budget);
  if (p->integrator == MASS_SPRING)
    CLOTH_FAIL(err, CLOTH_UNSUPPORTED,
               "accuracy = %g [1]: integrator mass_spring has no estimate of its error; "
               "backward_euler and bdf2 have",
               p->accuracy);
  return CLOTH_OK;
}

// A message about a scene begins with its file, where it has one.
static cloth_status bad_scene(const cloth_def *def, cloth_status status, const char *what,
                              cloth_error *err)
{
  if (def->path == NULL) CLOTH_FAIL(err, status, "%s", what);
  CLOTH_FAIL(err, status, "%s: %s", def->path, what);
}

static cloth_status check(const cloth_def *def, cloth_error *err)
{
  if (def == NULL) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "no description");
  CLOTH_TRY(cloth_params_check(&def->params, err));
  CLOTH_TRY(check_accuracy(&def->params, err));
  if (def->cloth_count == 0)
    return bad_scene(def, CLOTH_BAD_SCENE, "the scene has no cloth: nothing to simulate", err);
  for (int c = 0; c < def->cloth_count; c++)
    CLOTH_TRY(cloth_material_check(&def->cloth[c].material, err));
  return CLOTH_OK;
}

static cloth_status check_edges(const cloth_scene *s, cloth_error *err)
{
  const cloth_def *d = s->def;
  bool is_float = strcmp(d->precision, "float") == 0;
  for (int c = 0; c < d->cloth_count; c++) {
    cloth_error cause = {0};
    cloth_status status =
        cloth_mesh_check_edges(d->cloth[c].name, is_float, &d->cloth[c].mesh, s->rest[c], &cause);
    if (status != CLOTH_OK) return bad_scene(d, status, cause.text, err);
  }
  return CLOTH_OK;
}

static cloth_record_subject subject(cloth_scene *s)
{
  return (cloth_record_subject){s, &s->def->params, s->def->precision, s->fresh};
}

// `devices: mpi`: every process must have read the same, or they would wait for each other for ever
static cloth_status join_processes(cloth_scene *s, cloth_transport **out, cloth_error *err)
{
  if (!s->def->devices_are_processes) return CLOTH_OK;
  CLOTH_TRY(cloth_processes_join(out, err));
  const cloth_transport *t = *out;
  cloth_record_subject sub = subject(s);
  uint64_t mine = cloth_record_digest(&sub, s->def), first = mine;
  cloth_status status = CLOTH_OK;
  CLOTH_TRY(t->share(t, 0, &first, sizeof first, err));
  if (first != mine)
    status = cloth_fail(err, CLOTH_BAD_SCENE, __FILE__, __LINE__,
                        "process %d has read another scene than process 0: other files or options",
                        t->rank);
  return t->agree(t, status, err);
}

cloth_status cloth_scene_new(const cloth_def *def, cloth_scene **out, cloth_error *err)
{
  CLOTH_TRY(check(def, err));
  cloth_scene *s = calloc(1, sizeof *s);
  if (s == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "scene");
  cloth_status status;
  cloth_transport *transport = NULL;
  s->engine = strcmp(def->precision, "float") == 0 ? &cloth_engine_f32 : &cloth_engine_f64;
  s->fresh = true;
  cloth_budget_reset(&s->budget);
  CLOTH_TRY_GOTO(cloth_def_clone(def, &s->def, err), status, fail);
  CLOTH_TRY_GOTO(rest_positions(s, err), status, fail);
  CLOTH_TRY_GOTO(check_edges(s, err), status, fail);
  CLOTH_TRY_GOTO(join_processes(s, &transport, err), status, fail);
  CLOTH_TRY_GOTO(s->engine->create(s->def, transport, &s->sim, err), status, fail);
  *out = s;
  return CLOTH_OK;
fail:
  cloth_scene_free(s);
  return status;
}

void cloth_scene_free(cloth_scene *s)
{
  if (s == NULL) return;
  cloth_recorder_close(s->recorder, NULL);
  if (s->sim != NULL) s->engine->destroy(s->sim);
  for (int c = 0; s->rest != NULL && c < s->def->cloth_count; c++) free(s->rest[c]);
  free(s->rest);
  cloth_def_free(s->def);
  free(s);
}

// ---- step ---------------------------------------------------------------------------------------

static void tune(cloth_scene *s, const cloth_tuning *tuning)
{
  s->chosen = *tuning;
  s->engine->tune(s->sim, tuning);
}

cloth_status cloth_tune(cloth_scene *s, const cloth_tuning *t, cloth_error *err)
{
  cloth_params p = s->def->params;
  p.pcg_tolerance = t->pcg_tolerance;
  p.newton_iterations_max = t->newton_iterations;
  p.contact_rounds_max = t->contact_rounds;
  if (t->pcg_iterations != 0) p.pcg_iterations_max = t->pcg_iterations;
  if (t->pair_slack != 0) p.pair_slack = t->pair_slack;
  CLOTH_TRY(cloth_params_check(&p, err));
  tune(s, t);
  s->tuned = true;
  cloth_record_tune(s->recorder, t);
  return CLOTH_OK;
}

// the settings of the next step: those of the parameters, unless a budget or a caller chose others
static void choose(cloth_scene *s, double allowed)
{
  const cloth_params *p = &s->def->params;
  if (s->tuned) return;
  cloth_tuning t = {p->pcg_tolerance, p->newton_iterations_max, p->contact_rounds_max,
                    p->pcg_iterations_max, p->pair_slack};
  if (p->accuracy > 0) t.pcg_tolerance = cloth_accuracy_tolerance(p);
  if (allowed > 0) {
    t = cloth_budget_choose(&s->budget, p, allowed);
    cloth_record_tune(s->recorder, &t); // wall time does not come again, so a replay must know
  }
  tune(s, &t);
}

cloth_status cloth_step(cloth_scene *s, double h, cloth_step_report *report, cloth_error *err)
{
  if (h != 0 && !(h >= 1e-5 && h <= 0.1))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "step length %g [s] is not in [1e-05, 0.1]", h);
  cloth_step_report mine;
  if (report == NULL) report = &mine;
  double length = h > 0 ? h : s->def->params.time_step;
  double allowed = cloth_budget_allowed(&s->def->params, length);
  s->fresh = false;
  choose(s, allowed);
  cloth_record_step_begin(s->recorder, length);
  cloth_status status = CALL(s, step, length, report, err);
  s->tuned = false;
  if (status == CLOTH_OK && allowed > 0) {
    cloth_budget_time time = {report->wall_ms, report->ms[CLOTH_STAGE_solve],
                              report->pcg_iterations, report->newton_iterations};
    cloth_budget_measured(&s->budget, allowed, &time);
    cloth_budget_report(&s->budget, allowed, &s->chosen, report);
  }
  if (s->def->params.accuracy > 0) report->chosen_pcg_tolerance = s->chosen.pcg_tolerance;
  report->state_hash = 0;
  if (status == CLOTH_OK && (s->hash_steps || s->recorder != NULL))
    status = CALL(s, hash, &report->state_hash, err);
  cloth_record_step_end(s->recorder, status, report->state_hash);
  return status;
}

void cloth_scene_hash_steps(cloth_scene *s, bool on) { s->hash_steps = on; }
cloth_status cloth_state_hash(cloth_scene *s, uint64_t *out, cloth_error *err)
{
  return CALL(s, hash, out, err);
}
const char *cloth_backend_of(const cloth_scene *scene)
{
  return scene->engine->backend(scene->sim);
}

const char *cloth_backend_why(const cloth_scene *scene)
{
  return scene->engine->backend_why(scene->sim);
}

double cloth_time(const cloth_scene *s) { return s->engine->time(s->sim); }

// ---- what is in it ------------------------------------------------------------------------------

static bool is_cloth(const cloth_scene *s, int c) { return c >= 0 && c < s->def->cloth_count; }
static bool is_body(const cloth_scene *s, int b) { return b >= 0 && b < s->def->body_count; }

int cloth_count(const cloth_scene *s) { return s->def->cloth_count; }
int cloth_find(const cloth_scene *s, const char *name)
{
  return cloth_def_find_cloth(s->def, name);
}
const char *cloth_name(const cloth_scene *s, int c)
{
  return is_cloth(s, c) ? s->def->cloth[c].name : NULL;
}
int cloth_vertex_count(const cloth_scene *s, int c)
{
  return is_cloth(s, c) ? s->def->cloth[c].mesh.vertex_count : 0;
}
int cloth_triangle_count(const cloth_scene *s, int c)
{
  return is_cloth(s, c) ? s->def->cloth[c].mesh.triangle_count : 0;
}
const int *cloth_triangles(const cloth_scene *s, int c)
{
  return is_cloth(s, c) ? s->def->cloth[c].mesh.triangle : NULL;
}
const double *cloth_rest_positions(const cloth_scene *s, int c)
{
  return is_cloth(s, c) ? s->rest[c] : NULL;
}
int cloth_group_count(const cloth_scene *s, int c)
{
  return is_cloth(s, c) ? s->def->cloth[c].group_count : 0;
}

cloth_group_view cloth_group(const cloth_scene *s, int c, int g)
{
  cloth_group_view none = {NULL, 0, NULL};
  if (!is_cloth(s, c) || g < 0 || g >= s->def->cloth[c].group_count) return none;
  const cloth_group_def *d = &s->def->cloth[c].group[g];
  return (cloth_group_view){d->name, d->count, d->vertex};
}

int cloth_body_count(const cloth_scene *s) { return s->def->body_count; }
int cloth_body_find(const cloth_scene *s, const char *name)
{
  return cloth_def_find_body(s->def, name);
}
const char *cloth_body_name(const cloth_scene *s, int b)
{
  return is_body(s, b) ? s->def->body[b].name : NULL;
}

cloth_mesh_view cloth_body_mesh(const cloth_scene *s, int b)
{
  cloth_mesh_view none = {0, 0, NULL, NULL, NULL};
  if (!is_body(s, b)) return none;
  const cloth_mesh *m = &s->def->body[b].mesh;
  return (cloth_mesh_view){m->vertex_count, m->triangle_count, m->position, m->triangle, NULL};
}

cloth_pose cloth_body_pose(const cloth_scene *s, int b)
{
  return is_body(s, b) ? s->engine->body_pose(s->sim, b) : cloth_pose_identity();
}

int cloth_effect_count(void) { return cloth_engine_f64.effect_count(); }

cloth_status cloth_effect_describe(const cloth_scene *s, int effect, cloth_effect_info *out,
                                   cloth_error *err)
{
  if (effect < 0 || effect >= cloth_effect_count())
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "effect %d is not in [0, %d)", effect,
               cloth_effect_count());
  return CALL(s, effect_describe, effect, out, err);
}

// ---- state --------------------------------------------------------------------------------------

static cloth_status check_array(const cloth_scene *s, int c, const void *array, int count,
                                cloth_error *err)
{
  if (!is_cloth(s, c))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "cloth %d is not in [0, %d)", c, s->def->cloth_count);
  if (array == NULL || count != s->def->cloth[c].mesh.vertex_count)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "cloth %s has %d vertices, the array %d",
               s->def->cloth[c].name, s->def->cloth[c].mesh.vertex_count, array ? count : 0);
  return CLOTH_OK;
}

cloth_status cloth_positions(cloth_scene *s, int c, double *out, int count, cloth_error *err)
{
  CLOTH_TRY(check_array(s, c, out, count, err));
  return CALL(s, positions, c, out, err);
}

cloth_status cloth_velocities(cloth_scene *s, int c, double *out, int count, cloth_error *err)
{
  CLOTH_TRY(check_array(s, c, out, count, err));
  return CALL(s, velocities, c, out, err);
}

cloth_status cloth_held(const cloth_scene *s, int c, uint8_t *out, int count, cloth_error *err)
{
  CLOTH_TRY(check_array(s, c, out, count, err));
  return CALL(s, held, c, out, err);
}

static cloth_status check_finite(const char *what, const double *a, int n, double most,
                                 cloth_error *err)
{
  for (int i = 0; a != NULL && i < n; i++)
    if (!(fabs(a[i]) <= most))
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s of vertex %d = %g is not in [%g, %g]", what, i / 3,
                 a[i], -most, most);
  return CLOTH_OK;
}

cloth_status cloth_state_set(cloth_scene *s, int c, const double *position, const double *velocity,
                             int count, cloth_error *err)
{
  CLOTH_TRY(check_array(s, c, position != NULL ? position : velocity, count, err));
  CLOTH_TRY(check_finite("position [m]", position, 3 * count, s->def->params.bounds, err));
  CLOTH_TRY(check_finite("velocity [m/s]", velocity, 3 * count, 1e4, err));
  CLOTH_TRY(CALL(s, state_set, c, position, velocity, err));
  s->fresh = false;
  cloth_record_state_set(s->recorder, c, position, velocity, count);
  return CLOTH_OK;
}

cloth_status cloth_reset(cloth_scene *s, cloth_error *err)
{
  CLOTH_TRY(s->engine->reset(s->sim, err));
  cloth_budget_reset(&s->budget);
  s->tuned = false;
  s->fresh = true;
  cloth_record_reset(s->recorder);
  return CLOTH_OK;
}

cloth_status cloth_state_save(cloth_scene *s, const char *path, cloth_error *err)
{
  return CALL(s, save, path, err);
}

cloth_status cloth_state_load(cloth_scene *s, const char *path, cloth_error *err)
{
  CLOTH_TRY(CALL(s, load, path, err));
  s->fresh = false;
  cloth_record_state_load(s->recorder, s);
  return CLOTH_OK;
}

// ---- bodies and grasps --------------------------------------------------------------------------

// a usable copy of a pose: finite, quaternion of length 1
static cloth_status check_pose(const cloth_pose *pose, cloth_pose *out, cloth_error *err)
{
  if (pose == NULL) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "no pose");
  double norm = 0;
  for (int k = 0; k < 4; k++) norm += pose->rotation[k] * pose->rotation[k];
  norm = sqrt(norm);
  for (int k = 0; k < 3; k++)
    if (!(fabs(pose->position[k]) <= 1e6))
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "position[%d] = %g [m] of a pose is not in [-1e6, 1e6]",
                 k, pose->position[k]);
  if (!(norm > 1e-3 && norm < 1e3))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "quaternion (%g %g %g %g) of a pose has no direction",
               pose->rotation[0], pose->rotation[1], pose->rotation[2], pose->rotation[3]);
  *out = *pose;
  for (int k = 0; k < 4; k++) out->rotation[k] /= norm;
  return CLOTH_OK;
}

static cloth_status check_body(const cloth_scene *s, int b, cloth_error *err)
{
  if (!is_body(s, b))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "body %d is not in [0, %d)", b, s->def->body_count);
  return CLOTH_OK;
}

cloth_status cloth_body_move(cloth_scene *s, int body, const cloth_pose *pose, cloth_error *err)
{
  cloth_pose p;
  CLOTH_TRY(check_body(s, body, err));
  CLOTH_TRY(check_pose(pose, &p, err));
  CLOTH_TRY(CALL(s, body_move, body, &p, err));
  s->fresh = false;
  cloth_record_body_move(s->recorder, body, pose);
  return CLOTH_OK;
}

cloth_status cloth_body_place(cloth_scene *s, int body, const cloth_pose *pose, cloth_error *err)
{
  cloth_pose p;
  CLOTH_TRY(check_body(s, body, err));
  CLOTH_TRY(check_pose(pose, &p, err));
  CLOTH_TRY(CALL(s, body_place, body, &p, err));
  s->fresh = false;
  cloth_record_body_place(s->recorder, body, pose);
  return CLOTH_OK;
}

static cloth_status check_grasp(const cloth_scene *s, const cloth_grasp_view *g, cloth_error *err)
{
  if (!is_cloth(s, g->cloth))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "grasp: cloth %d is not in [0, %d)", g->cloth,
               s->def->cloth_count);
  const cloth_cloth_def *c = &s->def->cloth[g->cloth];
  if (g->count < 1 || g->vertex == NULL)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "grasp: no vertices to hold");
  for (int i = 0; i < g->count; i++)
    if (g->vertex[i] < 0 || g->vertex[i] >= c->mesh.vertex_count)
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "grasp: vertex %d is not in [0, %d) of cloth %s",
                 g->vertex[i], c->mesh.vertex_count, c->name);
  if (g->body != -1) CLOTH_TRY(check_body(s, g->body, err));
  for (int i = 0; i < g->ignore_count; i++) CLOTH_TRY(check_body(s, g->ignore_body[i], err));
  if (!(g->stiffness >= 0 && g->stiffness <= 1e9))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "grasp: stiffness = %g [N/m] is not in [0, 1e9]",
               g->stiffness);
  if (!(g->break_force >= 0))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "grasp: break_force = %g [N] is negative", g->break_force);
  return CLOTH_OK;
}

cloth_status cloth_grasp(cloth_scene *s, const cloth_grasp_view *grasp, cloth_grasp_id *out,
                         cloth_error *err)
{
  *out = (cloth_grasp_id){0, 0};
  CLOTH_TRY(check_grasp(s, grasp, err));
  cloth_grasp_view g = *grasp;
  if (g.body == -1) CLOTH_TRY(check_pose(&grasp->frame, &g.frame, err));
  CLOTH_TRY(CALL(s, grasp, &g, out, err));
  s->fresh = false;
  cloth_record_grasp(s->recorder, grasp, *out);
  return CLOTH_OK;
}

cloth_status cloth_grasp_move(cloth_scene *s, cloth_grasp_id id, const cloth_pose *frame,
                              cloth_error *err)
{
  cloth_pose p;
  CLOTH_TRY(check_pose(frame, &p, err));
  CLOTH_TRY(CALL(s, grasp_move, id, &p, err));
  cloth_record_grasp_move(s->recorder, id, frame);
  return CLOTH_OK;
}

cloth_status cloth_grasp_release(cloth_scene *s, cloth_grasp_id id, cloth_error *err)
{
  CLOTH_TRY(CALL(s, grasp_release, id, err));
  cloth_record_grasp_release(s->recorder, id);
  return CLOTH_OK;
}

bool cloth_grasp_alive(const cloth_scene *s, cloth_grasp_id id) { return CALL(s, grasp_alive, id); }

cloth_status cloth_grasp_wrench(const cloth_scene *s, cloth_grasp_id id, double force[3],
                                double torque[3], cloth_error *err)
{
  return CALL(s, grasp_wrench, id, force, torque, err);
}

// ---- looking at contact -------------------------------------------------------------------------

cloth_status cloth_body_pairs(cloth_scene *s, double margin, cloth_body_pair *out, int capacity,
                              int *count, cloth_error *err)
{
  if (!(margin >= 0 && margin <= 0.1))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "margin = %g [m] is not in [0, 0.1]", margin);
  return CALL(s, body_pairs, margin, out, capacity, count, err);
}

cloth_status cloth_contacts(cloth_scene *s, cloth_contact_view *out, int capacity, int *count,
                            cloth_error *err)
{
  return CALL(s, contacts, out, capacity, count, err);
}

cloth_status cloth_tangles(cloth_scene *s, cloth_tangle_view *out, int capacity, int *count,
                           cloth_error *err)
{
  return CALL(s, tangles, out, capacity, count, err);
}

cloth_status cloth_blocking_bodies(cloth_scene *s, int *out, int capacity, int *count,
                                   cloth_error *err)
{
  return CALL(s, blocking_bodies, out, capacity, count, err);
}

cloth_status cloth_blocking_holds(cloth_scene *s, cloth_hold_view *out, int capacity, int *count,
                                  cloth_error *err)
{
  return CALL(s, blocking_holds, out, capacity, count, err);
}

// ---- recorder -----------------------------------------------------------------------------------

cloth_status cloth_record_start(cloth_scene *s, const char *path, cloth_error *err)
{
  if (s->recorder != NULL) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "a recording is running already");
  cloth_record_subject sub = subject(s);
  return cloth_recorder_open(&sub, path, &s->recorder, err);
}

cloth_status cloth_record_stop(cloth_scene *s, cloth_error *err)
{
  cloth_recorder *r = s->recorder;
  s->recorder = NULL;
  return cloth_recorder_close(r, err);
}

cloth_status cloth_replay(cloth_scene *s, const char *path, int64_t *steps, cloth_error *err)
{
  cloth_record_subject sub = subject(s);
  return cloth_record_replay(&sub, path, steps, err);
}
