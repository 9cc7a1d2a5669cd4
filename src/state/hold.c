// Holds: pins of the scene file and grasps. Rigid holds make rows exact; compliant ones are
// springs. The force a hold exerts is read back from the residual of the solve.
#include "hold.h"

#include "effect/effect.h"
#include "hold_measure.h"
#include "state/state.h"

#include <stdlib.h>
#include <string.h>

// ---- memory -------------------------------------------------------------------------------------

static cloth_status take_room(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  int bodies = sim->def->body_count > 0 ? sim->def->body_count : 1;
  size_t n = (size_t)sim->held_capacity;
  if (part->target == NULL)
    CLOTH_TRY(cloth_take(sim, part, "target", sizeof(cloth_real) * 3 * (size_t)sim->vertex_count,
                         &part->target, err));
  CLOTH_TRY(cloth_grow(sim, part, "held", sizeof(int) * n, &part->held, err));
  CLOTH_TRY(cloth_grow(sim, part, "aim", sizeof(cloth_real) * 6 * n, &part->aim, err));
  return cloth_grow(sim, part, "ignore", (size_t)(sim->hold_capacity * bodies), &part->ignore, err);
}

cloth_status cloth_holds_reserve(cloth_sim *sim, int holds, int vertices, cloth_error *err)
{
  bool more_holds = holds > sim->hold_capacity, more_vertices = vertices > sim->held_capacity;
  if (more_holds) {
    int capacity = holds < 8 ? 8 : 2 * holds;
    cloth_hold_state *hold = realloc(sim->hold, sizeof *hold * (size_t)capacity);
    if (hold == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d holds", holds);
    memset(hold + sim->hold_capacity, 0, sizeof *hold * (size_t)(capacity - sim->hold_capacity));
    sim->hold = hold, sim->hold_capacity = capacity;
  }
  if (more_vertices) {
    int capacity = vertices < 64 ? 64 : 2 * vertices;
    int *index = realloc(sim->held_index, sizeof *index * (size_t)capacity);
    if (index == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d held vertices", vertices);
    sim->held_index = index, sim->held_capacity = capacity;
  }
  if (!more_holds && !more_vertices) return CLOTH_OK;
  sim->owner = CLOTH_EFFECT_pins;
  for (int p = 0; p < sim->part_count; p++) CLOTH_TRY(take_room(sim, &sim->part[p], err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

// ---- the list of held vertices ------------------------------------------------------------------

static cloth_status write_flags(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  size_t n = (size_t)sim->vertex_count, bodies = (size_t)sim->def->body_count;
  const cloth_backend *be = sim->backend;
  CLOTH_TRY(cloth_staging(sim, 2 * n, err));
  for (size_t v = 0; v < n; v++) sim->host[v] = 1;
  for (int h = 0; h < sim->hold_count; h++)
    for (int i = 0; sim->hold[h].alive && sim->hold[h].rigid && i < sim->hold[h].count; i++)
      sim->host[sim->hold[h].vertex[i]] = 0;
  CLOTH_TRY(be->write(part->device, part->free, sim->host, sizeof(cloth_real) * n, err));

  if (sim->compliant_count > 0) {
    if (part->hold_stiffness == NULL)
      CLOTH_TRY(cloth_take(sim, part, "hold_stiffness", sizeof(cloth_real) * n,
                           &part->hold_stiffness, err));
    for (size_t v = 0; v < n; v++) sim->host[v] = 0;
    for (int h = 0; h < sim->hold_count; h++)
      for (int i = 0; sim->hold[h].alive && i < sim->hold[h].count; i++)
        sim->host[sim->hold[h].vertex[i]] = (cloth_real)sim->hold[h].stiffness;
    CLOTH_TRY(
        be->write(part->device, part->hold_stiffness, sim->host, sizeof(cloth_real) * n, err));
  }
  if (part->grasp_of == NULL) return CLOTH_OK;
  int *of = (int *)(void *)sim->host;
  memset(of, 0, sizeof *of * n);
  for (int h = 0; h < sim->hold_count; h++)
    for (int i = 0; sim->hold[h].alive && i < sim->hold[h].count; i++)
      of[sim->hold[h].vertex[i]] = 1 + h;
  CLOTH_TRY(be->write(part->device, part->grasp_of, of, sizeof *of * n, err));
  for (int h = 0; h < sim->hold_count && bodies > 0; h++)
    if (sim->hold[h].ignore != NULL)
      CLOTH_TRY(be->write(part->device, part->ignore + (size_t)h * bodies, sim->hold[h].ignore,
                          bodies, err));
  return CLOTH_OK;
}

static cloth_status write_list(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  CLOTH_TRY(write_flags(sim, part, err));
  return sim->backend->write(part->device, part->held, sim->held_index,
                             sizeof(int) * (size_t)sim->held_count, err);
}

cloth_status cloth_holds_take(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  if (sim->held_capacity == 0) return CLOTH_OK;
  sim->owner = CLOTH_EFFECT_pins;
  CLOTH_TRY(take_room(sim, part, err));
  CLOTH_TRY(write_list(sim, part, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

cloth_status cloth_holds_refresh(cloth_sim *sim, cloth_error *err)
{
  sim->held_count = sim->compliant_count = 0;
  cloth_tangles_suspect(sim); // what a gripper held may reach into its fingers
  sim->springs.holds_known = false;
  sim->bdf2.known = false;
  for (int h = 0; h < sim->hold_count; h++) {
    cloth_hold_state *hold = &sim->hold[h];
    if (!hold->alive) continue;
    hold->first = sim->held_count;
    for (int i = 0; i < hold->count; i++) sim->held_index[sim->held_count++] = hold->vertex[i];
    sim->compliant_count += !hold->rigid;
  }
  sim->owner = CLOTH_EFFECT_pins;
  for (int p = 0; p < sim->part_count; p++)
    if (sim->part[p].held != NULL) CLOTH_TRY(write_list(sim, &sim->part[p], err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

// ---- frames -------------------------------------------------------------------------------------

static cloth_pose frame_now(const cloth_sim *sim, const cloth_hold_state *h)
{
  return h->body >= 0 ? sim->body[h->body].now : h->now;
}

cloth_pose cloth_hold_frame(const cloth_sim *sim, const cloth_hold_state *h, double share)
{
  if (h->body >= 0)
    return cloth_pose_between(sim->body[h->body].now, sim->body[h->body].target, share);
  return cloth_pose_between(h->now, h->target, share);
}

void cloth_holds_place(const cloth_sim *sim, double share, cloth_real *aim)
{
  for (int h = 0; h < sim->hold_count; h++) {
    const cloth_hold_state *hold = &sim->hold[h];
    if (!hold->alive) continue;
    cloth_pose frame = cloth_hold_frame(sim, hold, share);
    for (int i = 0; i < hold->count; i++) {
      double x[3];
      cloth_pose_point(&frame, hold->local + 3 * i, x);
      for (int k = 0; k < 3; k++) aim[3 * (hold->first + i) + k] = (cloth_real)x[k];
    }
  }
}

cloth_status cloth_holds_aim(cloth_sim *sim, double share, cloth_error *err)
{
  CLOTH_TRY(cloth_staging(sim, 3 * (size_t)sim->held_count, err));
  cloth_holds_place(sim, share, sim->host);
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    CLOTH_TRY(sim->backend->write(part->device, part->aim, sim->host,
                                  sizeof(cloth_real) * 3 * (size_t)sim->held_count, err));
    cloth_hold_args a = {part->held, part->aim, part->free, part->target, part->x};
    CLOTH_LAUNCH(sim, part, hold, sim->held_count, &a, err);
  }
  return CLOTH_OK;
}

// place and residual of each held vertex [held x 6] in sim->host, each from the part that owns it
static cloth_status measure_held(cloth_sim *sim, cloth_error *err)
{
  size_t n = 6 * (size_t)sim->held_count;
  CLOTH_TRY(cloth_staging(sim, 2 * n, err));
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    cloth_real *read = p == 0 ? sim->host : sim->host + n;
    cloth_hold_measure_args a = {part->held, part->x, part->r, part->aim};
    CLOTH_LAUNCH(sim, part, hold_measure, sim->held_count, &a, err);
    CLOTH_TRY(sim->backend->read(part->device, read, part->aim, sizeof(cloth_real) * n, err));
    for (int i = 0; p > 0 && i < sim->held_count; i++)
      if (sim->held_index[i] >= part->v0 && sim->held_index[i] < part->v1)
        memcpy(sim->host + 6 * i, read + 6 * i, 6 * sizeof *read);
  }
  return CLOTH_OK;
}

bool cloth_hold_clear_force(const cloth_sim *sim, cloth_hold_state *hold, cloth_pose *frame)
{
  memset(hold->force, 0, sizeof hold->force), memset(hold->torque, 0, sizeof hold->torque);
  if (hold->alive) *frame = cloth_hold_frame(sim, hold, 1);
  return hold->alive;
}

void cloth_hold_add_force(cloth_hold_state *hold, const cloth_pose *frame, const double x[3],
                          const double f[3])
{
  double arm[3];
  for (int k = 0; k < 3; k++) arm[k] = x[k] - frame->position[k], hold->force[k] += f[k];
  for (int k = 0; k < 3; k++) {
    int a = (k + 1) % 3, b = (k + 2) % 3;
    hold->torque[k] += arm[a] * f[b] - arm[b] * f[a];
  }
}

// a rigid hold's force is minus the residual of its rows; a spring's is its own
cloth_status cloth_holds_measure(cloth_sim *sim, cloth_error *err)
{
  if (sim->held_count == 0) return CLOTH_OK;
  CLOTH_TRY(measure_held(sim, err));
  for (int h = 0; h < sim->hold_count; h++) {
    cloth_hold_state *hold = &sim->hold[h];
    cloth_pose frame;
    if (!cloth_hold_clear_force(sim, hold, &frame)) continue;
    for (int i = 0; i < hold->count; i++) {
      const cloth_real *x = sim->host + 6 * (hold->first + i), *r = x + 3;
      double f[3], at[3], aim[3];
      cloth_pose_point(&frame, hold->local + 3 * i, aim);
      for (int k = 0; k < 3; k++) {
        at[k] = (double)x[k];
        f[k] = hold->rigid ? -(double)r[k] : hold->stiffness * (aim[k] - at[k]);
      }
      cloth_hold_add_force(hold, &frame, at, f);
    }
  }
  return CLOTH_OK;
}

// ---- taking and letting go ----------------------------------------------------------------------

static void inverse_point(const cloth_pose *pose, const double p[3], double out[3])
{
  cloth_pose back = {
      {0, 0, 0}, {-pose->rotation[0], -pose->rotation[1], -pose->rotation[2], pose->rotation[3]}};
  double d[3] = {p[0] - pose->position[0], p[1] - pose->position[1], p[2] - pose->position[2]};
  cloth_pose_point(&back, d, out);
}

static int free_hold(cloth_sim *sim)
{
  for (int h = 0; h < sim->hold_count; h++)
    if (!sim->hold[h].alive) return h;
  return sim->hold_count;
}

static cloth_status hold_arrays(cloth_hold_state *h, int count, int bodies, cloth_error *err)
{
  int *vertex = realloc(h->vertex, sizeof *vertex * (size_t)count);
  if (vertex != NULL) h->vertex = vertex;
  double *local = realloc(h->local, sizeof *local * 3 * (size_t)count);
  if (local != NULL) h->local = local;
  unsigned char *ignore = realloc(h->ignore, (size_t)bodies + 1);
  if (ignore != NULL) h->ignore = ignore;
  if (!vertex || !local || !ignore) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "grasp of %d vertices", count);
  memset(ignore, 0, (size_t)bodies + 1);
  return CLOTH_OK;
}

static cloth_status check_not_held(const cloth_sim *sim, const cloth_grasp_view *g,
                                   cloth_error *err)
{
  for (int i = 0; i < g->count; i++) {
    int v = sim->internal[sim->cloth_first[g->cloth] + g->vertex[i]];
    for (int k = 0; k < sim->held_count; k++)
      if (sim->held_index[k] == v)
        CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "vertex %d of cloth %s is held already", g->vertex[i],
                   sim->def->cloth[g->cloth].name);
    for (int k = 0; k < i; k++)
      if (g->vertex[k] == g->vertex[i])
        CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "vertex %d of cloth %s is named twice in one grasp",
                   g->vertex[i], sim->def->cloth[g->cloth].name);
  }
  return CLOTH_OK;
}

cloth_status cloth_sim_grasp(void *data, const cloth_grasp_view *g, cloth_grasp_id *out,
                             cloth_error *err)
{
  cloth_sim *sim = data;
  CLOTH_TRY(check_not_held(sim, g, err));
  int at = free_hold(sim);
  CLOTH_TRY(cloth_holds_reserve(sim, at + 1, sim->held_count + g->count, err));
  cloth_hold_state *h = &sim->hold[at];
  CLOTH_TRY(hold_arrays(h, g->count, sim->def->body_count, err));
  size_t n = 3 * (size_t)sim->vertex_count;
  CLOTH_TRY(cloth_staging(sim, n, err));
  CLOTH_TRY(sim->backend->read(sim->part[0].device, sim->host, sim->part[0].x_t0,
                               sizeof(cloth_real) * n, err));

  h->alive = true, h->rigid = !(g->stiffness > 0);
  h->generation++;
  h->cloth = g->cloth, h->count = g->count, h->body = g->body, h->pin = -1;
  h->now = h->target = g->body >= 0 ? cloth_pose_identity() : g->frame;
  h->stiffness = g->stiffness, h->break_force = g->break_force;
  memset(h->force, 0, sizeof h->force), memset(h->torque, 0, sizeof h->torque);
  for (int i = 0; i < g->ignore_count; i++) h->ignore[g->ignore_body[i]] = 1;
  cloth_pose frame = frame_now(sim, h);
  for (int i = 0; i < g->count; i++) {
    int v = h->vertex[i] = sim->internal[sim->cloth_first[g->cloth] + g->vertex[i]];
    double x[3] = {(double)sim->host[3 * v], (double)sim->host[3 * v + 1],
                   (double)sim->host[3 * v + 2]};
    inverse_point(&frame, x, h->local + 3 * i);
  }
  if (at == sim->hold_count) sim->hold_count++;
  cloth_effect_activate(sim, CLOTH_EFFECT_pins, "vertices are grasped");
  *out = (cloth_grasp_id){at + 1, h->generation};
  return cloth_holds_refresh(sim, err);
}

static cloth_hold_state *find(const cloth_sim *sim, cloth_grasp_id id)
{
  if (id.index1 < 1 || id.index1 > sim->hold_count) return NULL;
  cloth_hold_state *h = &sim->hold[id.index1 - 1];
  return h->alive && h->generation == id.generation ? h : NULL;
}

bool cloth_sim_grasp_alive(const void *sim, cloth_grasp_id id) { return find(sim, id) != NULL; }

cloth_status cloth_sim_grasp_move(void *sim, cloth_grasp_id id, const cloth_pose *frame,
                                  cloth_error *err)
{
  cloth_hold_state *h = find(sim, id);
  if (h == NULL) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "this grasp does not hold any more");
  if (h->body >= 0) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "this grasp follows a body: move the body");
  h->target = *frame;
  return CLOTH_OK;
}

void cloth_hold_end(cloth_sim *sim, cloth_hold_state *h)
{
  h->alive = false;
  if (h->ignore != NULL && memchr(h->ignore, 1, (size_t)sim->def->body_count))
    cloth_body_settle(sim);
}

cloth_status cloth_sim_grasp_release(void *data, cloth_grasp_id id, cloth_error *err)
{
  cloth_hold_state *h = find(data, id);
  if (h == NULL) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "this grasp does not hold any more");
  cloth_hold_end(data, h);
  return cloth_holds_refresh(data, err);
}

cloth_status cloth_sim_grasp_wrench(const void *sim, cloth_grasp_id id, double force[3],
                                    double torque[3], cloth_error *err)
{
  const cloth_hold_state *h = find(sim, id);
  if (h == NULL) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "this grasp does not hold any more");
  memcpy(force, h->force, sizeof h->force);
  memcpy(torque, h->torque, sizeof h->torque);
  return CLOTH_OK;
}

// ---- pins of the scene file ---------------------------------------------------------------------

static cloth_hold_state *hold_of_pin(cloth_sim *sim, int pin)
{
  for (int h = 0; h < sim->hold_count; h++)
    if (sim->hold[h].alive && sim->hold[h].pin == pin) return &sim->hold[h];
  return NULL;
}

// a pin's own frame lies at the centroid of its vertices; the motion is relative to it
static cloth_pose pin_frame(const cloth_pin_def *pin, const double centroid[3], double time)
{
  cloth_pose frame = cloth_motion_at(&pin->motion, cloth_pose_identity(), time);
  for (int k = 0; k < 3; k++) frame.position[k] += centroid[k];
  return frame;
}

static void pin_centroid(const cloth_sim *sim, const cloth_pin_def *pin, double out[3])
{
  const cloth_group_def *g = &sim->def->cloth[pin->cloth].group[pin->group];
  out[0] = out[1] = out[2] = 0;
  for (int i = 0; i < g->count; i++)
    for (int k = 0; k < 3; k++)
      out[k] +=
          sim->rest[3 * sim->internal[sim->cloth_first[pin->cloth] + g->vertex[i]] + k] / g->count;
}

static cloth_status pin_start(cloth_sim *sim, int index, cloth_error *err)
{
  const cloth_pin_def *pin = &sim->def->pin[index];
  const cloth_group_def *group = &sim->def->cloth[pin->cloth].group[pin->group];
  double centroid[3];
  pin_centroid(sim, pin, centroid);
  cloth_grasp_view g = {.cloth = pin->cloth,
                        .count = group->count,
                        .vertex = group->vertex,
                        .body = pin->body,
                        .frame = pin_frame(pin, centroid, sim->time),
                        .stiffness = pin->stiffness,
                        .break_force = pin->break_force};
  cloth_grasp_id id;
  CLOTH_TRY(cloth_sim_grasp(sim, &g, &id, err));
  sim->hold[id.index1 - 1].pin = index;
  return CLOTH_OK;
}

cloth_status cloth_pins_update(cloth_sim *sim, double time, cloth_error *err)
{
  for (int i = 0; i < sim->def->pin_count; i++) {
    const cloth_pin_def *pin = &sim->def->pin[i];
    cloth_hold_state *h = hold_of_pin(sim, i);
    bool wanted = sim->time >= pin->start && sim->time < pin->end && !sim->pin_broken[i];
    if (wanted && h == NULL) {
      CLOTH_TRY(pin_start(sim, i, err));
      h = hold_of_pin(sim, i);
    }
    if (!wanted && h != NULL) {
      cloth_hold_end(sim, h);
      CLOTH_TRY(cloth_holds_refresh(sim, err));
      continue;
    }
    if (h == NULL || h->body >= 0) continue;
    double centroid[3];
    pin_centroid(sim, pin, centroid);
    h->target = pin_frame(pin, centroid, time);
  }
  return CLOTH_OK;
}
