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

// `number` if what moves from t0 to t1 is a carrier, with its motion written, else the world
static uint32_t carrier(const cloth_pose *t0, const cloth_pose *t1, const double center[3],
                        uint32_t number, uint32_t world, cloth_real *motion)
{
  if (!moves(t0, t1)) return world;
  measure(t0, t1, center, motion + MOTION * number);
  return number;
}

// fills motion [world x MOTION] and of [world]: the carrier of each body and then of each hold
static void list_carriers(const cloth_sim *sim, uint32_t world, cloth_real *motion, uint32_t *of)
{
  static const double origin[3] = {0, 0, 0};
  uint32_t n = 0;
  memset(motion, 0, sizeof *motion * MOTION * world);
  for (int b = 0; b < sim->def->body_count; b++, n++) {
    const cloth_body *body = &sim->body[b];
    of[n] = carrier(&body->t0, &body->t1, body->center, n, world, motion);
  }
  for (int h = 0; h < sim->hold_count; h++, n++) {
    const cloth_hold_state *hold = &sim->hold[h];
    of[n] = world;
    if (!hold->alive) continue;
    of[n] =
        hold->body >= 0 ? of[hold->body] : carrier(&hold->t0, &hold->t1, origin, n, world, motion);
  }
}

cloth_status cloth_carriers_begin(cloth_sim *sim, uint32_t *count, cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  size_t driving = (size_t)sim->def->body_count + (size_t)sim->hold_count;
  size_t row = sizeof(cloth_real) * MOTION;
  CLOTH_TRY(cloth_staging(sim, (MOTION + 1) * driving + 1, err));
  cloth_real *motion = sim->host;
  uint32_t *of = (uint32_t *)(void *)(motion + MOTION * driving);
  *count = (uint32_t)driving;
  list_carriers(sim, *count, motion, of);
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_grow(sim, p, "carrier_motion", row * (driving + 1), &p->carrier_motion, err));
    CLOTH_TRY(be->write(p->device, p->carrier_motion, motion, row * driving, err));
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
