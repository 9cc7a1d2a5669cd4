#include "ccd/carriers.h"

#include "carrier_start.h"

#include <string.h>

enum { MOTION = 15 }; // numbers of one, see carrier.h

// would any coordinate differ in cloth_real?
static bool moves(const cloth_pose *t0, const cloth_pose *t1)
{
  cloth_real m0[12], m1[12];
  cloth_pose_matrix(t0, m0), cloth_pose_matrix(t1, m1);
  return memcmp(m0, m1, sizeof m0) != 0;
}

static void rotation(const cloth_pose *pose, double out[9])
{
  cloth_pose turn = *pose;
  memset(turn.position, 0, sizeof turn.position);
  for (int c = 0; c < 3; c++) {
    double axis[3] = {c == 0, c == 1, c == 2}, column[3];
    cloth_pose_point(&turn, axis, column);
    for (int r = 0; r < 3; r++) out[3 * r + c] = column[r];
  }
}

// in double, so that what cancels is exact to the last digit of cloth_real
static void measure(const cloth_pose *t0, const cloth_pose *t1, const double center[3],
                    cloth_real *out)
{
  double r0[9], r1[9], c0[3], c1[3];
  rotation(t0, r0), rotation(t1, r1);
  for (int i = 0; i < 9; i++) {
    double sum = i % 4 == 0 ? -1 : 0; // less the unit matrix
    for (int k = 0; k < 3; k++) sum += r1[3 * (i / 3) + k] * r0[3 * (i % 3) + k];
    out[i] = (cloth_real)sum;
  }
  cloth_pose_point(t0, center, c0), cloth_pose_point(t1, center, c1);
  for (int k = 0; k < 3; k++) {
    out[9 + k] = (cloth_real)c0[k];
    out[12 + k] = (cloth_real)(c1[k] - c0[k]);
  }
}

// motions into sim->host
static cloth_status list_motions(cloth_sim *sim, uint32_t *count, cloth_error *err)
{
  static const double origin[3] = {0, 0, 0};
  size_t most = (size_t)sim->def->body_count + (size_t)sim->hold_count;
  CLOTH_TRY(cloth_staging(sim, MOTION * most + 1, err));
  cloth_real *to = sim->host;
  for (int b = 0; b < sim->def->body_count; b++) {
    const cloth_body *body = &sim->body[b];
    if (!moves(&body->t0, &body->t1)) continue;
    measure(&body->t0, &body->t1, body->center, to);
    to += MOTION;
  }
  for (int h = 0; h < sim->hold_count; h++) {
    const cloth_hold_state *hold = &sim->hold[h];
    if (!hold->alive || hold->body >= 0 || !moves(&hold->t0, &hold->t1)) continue;
    measure(&hold->t0, &hold->t1, origin, to);
    to += MOTION;
  }
  *count = (uint32_t)((to - sim->host) / MOTION);
  return CLOTH_OK;
}

// the carrier of each body and then of each hold into sim->host, in the order of list_motions()
static uint32_t *number(cloth_sim *sim, uint32_t world)
{
  uint32_t *of = (uint32_t *)(void *)sim->host, next = 0;
  int bodies = sim->def->body_count;
  for (int b = 0; b < bodies; b++)
    of[b] = moves(&sim->body[b].t0, &sim->body[b].t1) ? next++ : world;
  for (int h = 0; h < sim->hold_count; h++) {
    const cloth_hold_state *hold = &sim->hold[h];
    of[bodies + h] = world;
    if (!hold->alive) continue;
    if (hold->body >= 0)
      of[bodies + h] = of[hold->body];
    else if (moves(&hold->t0, &hold->t1))
      of[bodies + h] = next++;
  }
  return of;
}

cloth_status cloth_carriers_begin(cloth_sim *sim, uint32_t *count, cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  size_t driving = (size_t)sim->def->body_count + (size_t)sim->hold_count;
  size_t row = sizeof(cloth_real) * MOTION;
  CLOTH_TRY(list_motions(sim, count, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_grow(sim, p, "carrier_motion", row * (driving + 1), &p->carrier_motion, err));
    CLOTH_TRY(be->write(p->device, p->carrier_motion, sim->host, row * *count, err));
  }
  uint32_t *of = number(sim, *count);
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_grow(sim, p, "carrier_of", sizeof *of * (driving + 1), &p->carrier_of, err));
    CLOTH_TRY(be->write(p->device, p->carrier_of, of, sizeof *of * driving, err));
    cloth_carrier_start_args a = {.cloth_vertices = sim->vertex_count,
                                  .world = *count,
                                  .free = p->free,
                                  .grasp_of = p->grasp_of,
                                  .body_of = p->body_of,
                                  .of_hold = p->carrier_of + sim->def->body_count,
                                  .of_body = p->carrier_of,
                                  .carrier = p->carrier,
                                  .claim = p->claim};
    CLOTH_LAUNCH(sim, p, carrier_start, sim->all_vertices, &a, err);
  }
  return CLOTH_OK;
}
