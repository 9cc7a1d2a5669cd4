// What a robot's joint states become when they are bad: poses that are not finite, far beyond the
// world or no rotation at all, and poses that jump. The engine sees them as cloth_body_move(),
// cloth_body_place() and cloth_grasp_move(). The first kind is refused and leaves no trace: a twin
// that never heard of it has the same bits. The second is taken, and whatever it does to the cloth,
// all stays finite and bounded.
#include "scene.h"

#include <float.h>

enum { N = 9, ROBOT = 0, TABLE = 1 };

static sheet cloth;
static solid gripper, table;

#ifdef CLOTH_TEST_SHORT
enum { STEPS = 10, SEEDS = 1 };
#else
enum { STEPS = 25, SEEDS = 1 };
#endif

// xorshift64*: the same numbers everywhere (Vigna 2016)
static uint64_t dice;

static double draw(double low, double high)
{
  dice ^= dice >> 12, dice ^= dice << 25, dice ^= dice >> 27;
  return low + (high - low) * ((double)((dice * 2685821657736338717u) >> 11) / 9007199254740992.0);
}

static int pick(int n) { return (int)draw(0, n); }

typedef struct robot {
  cloth_scene *scene;
  cloth_grasp_id free, held; // by a frame; by the gripper
} robot;

static robot robot_new(const char *precision)
{
  static const int left[2] = {N * (N - 1), N * (N - 1) + 1}, right[2] = {N * N - 2, N * N - 1};
  robot r;
  cloth_error err = {0};
  cloth_def *def = def_new(precision);
  solid_box(&gripper, 0.04, 0.04, 0.04);
  solid_box(&table, 0.5, 0.5, 0.1);
  def_body(def, "gripper", &gripper, 0.5, pose_at(0.15, 0.19, 0));
  def_body(def, "table", &table, 0.5, pose_at(0, 0, -0.3));
  def_cloth(def, "towel", &cloth, cloth_material_default(), pose_at(0, 0, 0));
  r.scene = scene_new(def);
  r.free = scene_hold(r.scene, 0, left, 2, cloth_pose_identity());
  cloth_grasp_view g = {.count = 2,
                        .vertex = right,
                        .body = ROBOT,
                        .frame = cloth_pose_identity(),
                        .break_force = 30};
  must(cloth_grasp(r.scene, &g, &r.held, &err), &err);
  return r;
}

static cloth_pose turned_at_random(double x, double y, double z, double angle)
{
  return pose_turned(x, y, z, pick(3), draw(-angle, angle));
}

// one number of the pose is bad, or its rotation is none
static cloth_pose spoiled(cloth_pose p)
{
  static const double bad[] = {NAN, INFINITY, -INFINITY, 1e300, -DBL_MAX};
  int where = pick(8), what = pick(5);
  if (where < 3)
    p.position[where] = bad[what];
  else if (where < 7)
    p.rotation[where - 3] = bad[what < 3 ? what : 0];
  else
    memset(p.rotation, 0, sizeof p.rotation);
  return p;
}

static cloth_status tell_bad(robot *r, cloth_error *err)
{
  static double x[3 * N * N];
  cloth_pose p = spoiled(turned_at_random(0, 0, 0, 1));
  const double h[] = {NAN, -1, INFINITY, 1e-300, 0.2};
  switch (pick(5)) {
  case 0:
    return cloth_body_move(r->scene, pick(2), &p, err);
  case 1:
    return cloth_body_place(r->scene, pick(2), &p, err);
  case 2:
    return cloth_grasp_move(r->scene, r->free, &p, err);
  case 3:
    return cloth_step(r->scene, h[pick(5)], NULL, err);
  default:
    scene_positions(r->scene, 0, x);
    x[pick(3 * N * N)] = pick(2) ? NAN : 1e30;
    return cloth_state_set(r->scene, 0, pick(2) ? x : NULL, x, N * N, err);
  }
}

static void good_news(robot *r, double t)
{
  cloth_error err = {0};
  cloth_pose body = pose_at(0.15 - 0.1 * t, 0.19, 0.1 * t), frame = pose_at(0.1 * t, 0, 0.1 * t);
  must(cloth_body_move(r->scene, ROBOT, &body, &err), &err);
  must(cloth_grasp_move(r->scene, r->free, &frame, &err), &err);
}

static int bad_numbers(const char *precision)
{
  for (int seed = 1; seed <= SEEDS; seed++) {
    robot r = robot_new(precision), twin = robot_new(precision);
    dice = (uint64_t)seed;
    for (int i = 0; i < STEPS; i++) {
      good_news(&r, 0.01 * i), good_news(&twin, 0.01 * i);
      for (int k = pick(4); k > 0; k--) { // after good news for the same step
        uint64_t before = scene_hash(r.scene);
        cloth_error err = {0};
        cloth_status status = tell_bad(&r, &err);
        if (status != CLOTH_BAD_ARGUMENT)
          printf("  seed %d, step %d: status %d\n", seed, i, status);
        CHECK(status == CLOTH_BAD_ARGUMENT && err.text[0] != '\0');
        CHECK(scene_hash(r.scene) == before);
      }
      scene_step(r.scene, 1), scene_step(twin.scene, 1);
      CHECK(scene_hash(r.scene) == scene_hash(twin.scene));
    }
    cloth_scene_free(r.scene), cloth_scene_free(twin.scene);
  }
  return 0;
}
BOTH(what_is_not_finite_is_refused_and_leaves_no_trace, bad_numbers)

// Small moves, jumps that are swept (up to 0.4 m within a step), jumps that are placed, half turns;
// the driver goes back to where it was, as after a lost message. A step that is refused keeps the
// state.
static void jump(robot *r)
{
  cloth_error err = {0};
  double far = pick(3) ? 0.05 : pick(2) ? 0.4 : 3, x = draw(-far, far), z = draw(-far, far);
  cloth_pose p = turned_at_random(0.15 + x, 0.19, z, pick(4) ? 0.3 : 3.1);
  cloth_pose q = turned_at_random(x, 0, z, pick(4) ? 0.3 : 3.1);
  must(cloth_body_move(r->scene, ROBOT, &p, &err), &err);
  if (cloth_grasp_alive(r->scene, r->free))
    must(cloth_grasp_move(r->scene, r->free, &q, &err), &err);
}

static int all_finite(robot *r)
{
  static double x[3 * N * N], v[3 * N * N];
  scene_positions(r->scene, 0, x), scene_velocities(r->scene, 0, v);
  for (int i = 0; i < 3 * N * N; i++) CHECK(fabs(x[i]) <= 100 && fabs(v[i]) <= 1e5);
  return 0;
}

static int jumps(const char *precision)
{
  for (int seed = 1; seed <= SEEDS; seed++) {
    robot r = robot_new(precision);
    int refused = 0;
    dice = (uint64_t)seed;
    for (int i = 0; i < STEPS; i++) {
      cloth_error err = {0};
      cloth_step_report report = {0};
      jump(&r);
      uint64_t before = scene_hash(r.scene);
      double time = cloth_time(r.scene);
      cloth_status status = cloth_step(r.scene, 0, &report, &err);
      CHECK(status == CLOTH_OK || status == CLOTH_UNSTABLE);
      if (status == CLOTH_UNSTABLE) {
        refused++;
        CHECK(err.text[0] != '\0' && scene_hash(r.scene) == before && cloth_time(r.scene) == time);
      } else {
        CHECK(isfinite(report.energy_kinetic) && isfinite(report.stretch_max));
      }
      if (all_finite(&r)) return 1;
    }
    // and nothing of it is left after a reset
    cloth_error err = {0};
    must(cloth_reset(r.scene, &err), &err);
    robot fresh = robot_new(precision);
    cloth_grasp_release(fresh.scene, fresh.free, &err),
        cloth_grasp_release(fresh.scene, fresh.held, &err);
    scene_step(r.scene, 5), scene_step(fresh.scene, 5);
    CHECK(scene_hash(r.scene) == scene_hash(fresh.scene));
    cloth_scene_free(fresh.scene);
    if (refused > 0) printf("  seed %d: %d of %d steps refused\n", seed, refused, STEPS);
    cloth_scene_free(r.scene);
  }
  return 0;
}
BOTH(jumps_leave_everything_finite_and_a_refused_step_keeps_the_state, jumps)

int main(int argc, char **argv)
{
  int failures = 0;
  sheet_make(&cloth, 0.3, 0.3, N, N);
  RUN(what_is_not_finite_is_refused_and_leaves_no_trace);
  RUN(jumps_leave_everything_finite_and_a_refused_step_keeps_the_state);
  return failures > 0;
}
