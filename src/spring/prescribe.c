// Prescribed motion: where held particles and bodies are at each sub-step of a block.
// All of it is written before the block starts, so that the sub-steps need nothing of the host.
#include "effect/effect.h"

#include <stdlib.h>
#include <string.h>

// ---- holds --------------------------------------------------------------------------------------

static cloth_status check_stiffness(const cloth_sim *sim, cloth_error *err)
{
  for (int h = 0; h < sim->hold_count && sim->compliant_count > 0; h++) {
    const cloth_hold_state *hold = &sim->hold[h];
    for (int i = 0; hold->alive && !hold->rigid && i < hold->count; i++) {
      double limit = cloth_spring_limit(sim, hold->vertex[i], hold->stiffness);
      if (!(sim->springs.step <= limit))
        CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
                   "spring_step = %g [s] is above the stable limit %.4g with a grasp of stiffness "
                   "%g [N/m]",
                   sim->springs.step, limit, hold->stiffness);
    }
  }
  return CLOTH_OK;
}

// place of each vertex among the held ones
cloth_status cloth_spring_holds_write(cloth_sim *sim, cloth_error *err)
{
  size_t n = (size_t)sim->vertex_count;
  if (sim->springs.holds_known) return CLOTH_OK;
  CLOTH_TRY(check_stiffness(sim, err));
  CLOTH_TRY(cloth_staging(sim, n, err)); // an int is no larger than a cloth_real
  int *slot = (int *)(void *)sim->host;
  memset(slot, -1, sizeof *slot * n);
  for (int i = 0; i < sim->held_count; i++) slot[sim->held_index[i]] = i;
  for (int i = 0; i < sim->part_count && sim->held_count > 0; i++) {
    cloth_part *p = &sim->part[i];
    if (p->spring.slot == NULL)
      CLOTH_TRY(cloth_take(sim, p, "slot", sizeof *slot * n, &p->spring.slot, err));
    CLOTH_TRY(sim->backend->write(p->device, p->spring.slot, slot, sizeof *slot * n, err));
    CLOTH_TRY(cloth_grow(sim, p, "impulse", sizeof(cloth_real) * 3 * (size_t)sim->held_count,
                         &p->spring.impulse, err));
  }
  sim->springs.holds_known = true;
  return CLOTH_OK;
}

static bool holds_rest(const cloth_sim *sim)
{
  for (int h = 0; h < sim->hold_count; h++) {
    cloth_pose from = cloth_hold_frame(sim, &sim->hold[h], 0);
    cloth_pose to = cloth_hold_frame(sim, &sim->hold[h], 1);
    if (sim->hold[h].alive && memcmp(&from, &to, sizeof from) != 0) return false;
  }
  return true;
}

// where the held vertices are to be at the end of each sub-step of a block
cloth_status cloth_spring_aims_write(cloth_sim *sim, cloth_spring_frame *f, int begin, int end,
                                     cloth_error *err)
{
  size_t row = 3 * (size_t)sim->held_count;
  int rows = holds_rest(sim) ? 1 : end - begin;
  if (row == 0) return CLOTH_OK;
  f->held_rows = rows > 1 ? sim->held_count : 0;
  CLOTH_TRY(cloth_staging(sim, row * (size_t)rows, err));
  for (int k = 0; k < rows; k++)
    cloth_holds_place(sim, rows > 1 ? cloth_spring_time(f, begin + k + 1) / f->h : 1,
                      sim->host + row * (size_t)k);
  size_t bytes = sizeof(cloth_real) * row;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_grow(sim, p, "aim", bytes * (size_t)rows, &p->spring.aim, err));
    CLOTH_TRY(sim->backend->write(p->device, p->spring.aim, sim->host, bytes * (size_t)rows, err));
    CLOTH_TRY(sim->backend->fill(p->device, p->spring.impulse, 0, bytes, err));
  }
  return CLOTH_OK;
}

// what the holds gave to each vertex in a block: a vertex's own part knows
cloth_status cloth_spring_impulses_add(cloth_sim *sim, cloth_error *err)
{
  size_t n = 3 * (size_t)sim->held_count;
  if (n == 0) return CLOTH_OK;
  CLOTH_TRY(cloth_staging(sim, n, err));
  for (int i = 0; i < sim->part_count; i++) {
    const cloth_part *p = &sim->part[i];
    CLOTH_TRY(
        sim->backend->read(p->device, sim->host, p->spring.impulse, sizeof(cloth_real) * n, err));
    for (int h = 0; h < sim->hold_count; h++) {
      cloth_hold_state *hold = &sim->hold[h];
      cloth_pose pose = cloth_hold_frame(sim, hold, 1);
      for (int k = 0; hold->alive && k < hold->count; k++) {
        int v = hold->vertex[k];
        double j[3], arm[3];
        if (v < p->v0 || v >= p->v1) continue;
        cloth_pose_point(&pose, hold->local + 3 * k, arm);
        for (int c = 0; c < 3; c++) {
          j[c] = (double)sim->host[3 * (hold->first + k) + c];
          arm[c] -= pose.position[c];
          hold->force[c] += j[c];
        }
        for (int c = 0; c < 3; c++)
          hold->torque[c] += arm[(c + 1) % 3] * j[(c + 2) % 3] - arm[(c + 2) % 3] * j[(c + 1) % 3];
      }
    }
  }
  return CLOTH_OK;
}

// impulses of the whole step become mean forces
void cloth_spring_wrenches_scale(cloth_sim *sim, double factor)
{
  for (int h = 0; h < sim->hold_count; h++)
    for (int c = 0; c < 3; c++) sim->hold[h].force[c] *= factor, sim->hold[h].torque[c] *= factor;
}

// ---- bodies -------------------------------------------------------------------------------------

// Bodies that rest are written when they came to rest, not in every block.
static bool resting_known(const cloth_sim *sim, size_t count)
{
  const cloth_springs *s = &sim->springs;
  return s->rest_pose_count == count &&
         memcmp(s->rest_pose, sim->host, sizeof *s->rest_pose * count) == 0;
}

static cloth_status resting_keep(cloth_sim *sim, size_t count, cloth_error *err)
{
  cloth_springs *s = &sim->springs;
  cloth_real *rest_pose = realloc(s->rest_pose, sizeof *rest_pose * count);
  if (rest_pose == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "poses: %zu numbers", count);
  s->rest_pose = rest_pose, s->rest_pose_count = count;
  memcpy(rest_pose, sim->host, sizeof *rest_pose * count);
  return CLOTH_OK;
}

// poses of all bodies at the start of a block and after each of its sub-steps
cloth_status cloth_spring_poses_write(cloth_sim *sim, cloth_spring_frame *f, int begin, int end,
                                      cloth_error *err)
{
  int bodies = sim->def->body_count, rows = 1;
  if (!sim->active[CLOTH_EFFECT_body_contact]) return CLOTH_OK;
  for (int b = 0; b < bodies; b++)
    if (memcmp(&sim->body[b].now, &sim->body[b].target, sizeof(cloth_pose)) != 0)
      rows = end - begin + 1;
  f->body_rows = rows > 1 ? bodies : 0;
  size_t row = 12 * (size_t)bodies, bytes = sizeof(cloth_real) * row * (size_t)rows;
  CLOTH_TRY(cloth_staging(sim, row * (size_t)rows, err));
  for (int k = 0; k < rows; k++)
    for (int b = 0; b < bodies; b++) {
      const cloth_body *body = &sim->body[b];
      // at rest: the same for any cut of the step, for what is between two equal poses is rounded
      double share = rows > 1 ? cloth_spring_time(f, begin + k) / f->h : 0;
      cloth_pose pose = cloth_pose_between(body->now, body->target, share);
      cloth_pose_matrix(&pose, sim->host + row * (size_t)k + 12 * (size_t)b);
    }
  sim->report->bodies_near = bodies;
  if (rows == 1 && resting_known(sim, row)) return CLOTH_OK;
  sim->springs.rest_pose_count = 0;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_grow(sim, p, "shape_pose", bytes, &p->spring.shape_pose, err));
    CLOTH_TRY(sim->backend->write(p->device, p->spring.shape_pose, sim->host, bytes, err));
  }
  return rows == 1 ? resting_keep(sim, row, err) : CLOTH_OK;
}
