// Cloth that lies: on a table and over a ball it comes to rest, stays outside, and a warm step
// allocates nothing.
#include "scene.h"

static sheet cloth;
static solid body;
static double x[3 * SHEET_MAX];

#ifdef CLOTH_TEST_SHORT
enum { WARM = 50, LONG = 20, SIDE = 13 };
#else
enum { WARM = 50, LONG = 200, SIDE = 25 };
#endif

// steps of a warm scene: nothing is allocated and nothing grows
static int check_warm(cloth_scene *scene, int steps, cloth_step_report *last)
{
  uint64_t memory = 0;
  for (int n = 0; n < steps; n++) {
    *last = scene_step(scene, 1);
    CHECK(last->allocations == 0 && last->buffers_grown == 0);
    if (n == 0) memory = last->memory_bytes;
    CHECK(last->memory_bytes == memory && memory > 0);
  }
  return 0;
}

static int table_of(const char *precision, int side)
{
  sheet_make(&cloth, 0.4, 0.4, side, side);
  solid_box(&body, 1, 1, 0.1);
  cloth_def *def = def_new(precision);
  def_body(def, "table", &body, 0.5, pose_at(0, 0, -0.05));
  def_cloth(def, "towel", &cloth, cloth_material_default(), pose_turned(0, 0, 0.01, 2, 0.3));
  cloth_scene *scene = scene_new(def);
  scene_step(scene, WARM);
  cloth_step_report r;
  if (check_warm(scene, LONG, &r)) return 1;
  CHECK(r.contacts_body >= side * side && r.impacts == 0 && r.impacts_left == 0);
  if (LONG >= 200) CHECK_NEAR(r.speed_max, 0, 2e-3); // gravity alone makes 160 mm/s of one step
  scene_positions(scene, 0, x);
  for (int i = 0; i < side * side; i++) CHECK(x[3 * i + 2] > 0 && x[3 * i + 2] < 0.003 + 1e-3);
  cloth_scene_free(scene);
  return 0;
}
static int table(const char *precision)
{
  // the coarse one once swung for ever between contacts on the diagonal of the table's top
  return table_of(precision, SIDE) || table_of(precision, 13);
}
BOTH(a_towel_on_a_table_comes_to_rest_above_it_and_allocates_nothing, table)

static int ball(const char *precision)
{
  const double radius = 0.1;
  const int around = 24, rings = 15;
  sheet_make(&cloth, 0.3, 0.3, SIDE, SIDE);
  solid_sphere(&body, radius, around, rings);
  cloth_material m = cloth_material_default();
  m.damping_mass = 2; // it swings down within the test
  cloth_def *def = def_new(precision);
  def_body(def, "ball", &body, 0.8, pose_at(0, 0, 0));
  def_cloth(def, "towel", &cloth, m, pose_at(0, 0, radius + 0.005));
  cloth_scene *scene = scene_new(def);
  cloth_step_report r = {0};
  // the ball is a polyhedron; inside its inscribed ball is inside for certain. Rings are the
  // farther apart of the two: half of pi / 16 off a vertex
  double inner = radius * pow(cos(acos(-1) / 2 / (rings + 1)), 2) * 0.999;
  for (int n = 0; n < WARM + LONG; n++) {
    r = scene_step(scene, 1);
    scene_positions(scene, 0, x);
    for (int i = 0; i < SIDE * SIDE; i++)
      CHECK(sqrt(x[3 * i] * x[3 * i] + x[3 * i + 1] * x[3 * i + 1] + x[3 * i + 2] * x[3 * i + 2]) >
            inner);
    CHECK(r.impacts_left == 0);
  }
  CHECK(r.contacts_body > 20);
  CHECK(x[2] < 0.05); // a corner hangs
  if (LONG >= 200) CHECK_NEAR(r.speed_max, 0, 2e-2);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_towel_over_a_ball_hangs_still_and_never_enters_it, ball)

static int hanging(const char *precision)
{
  sheet_make(&cloth, 0.4, 0.3, 17, 13);
  cloth_material m = cloth_material_default();
  m.damping_mass = 5;
  cloth_def *def = def_new(precision);
  def_cloth(def, "towel", &cloth, m, pose_turned(0, 0, 0, 0, acos(-1) / 2));
  cloth_scene *scene = scene_new(def);
  const int corners[2] = {12 * 17, 12 * 17 + 16};
  scene_hold(scene, 0, corners, 2, pose_at(0, 0, 0.15));
  scene_step(scene, WARM + 50);
  cloth_step_report r;
  if (check_warm(scene, LONG, &r)) return 1;
  if (LONG >= 200) CHECK_NEAR(r.speed_max, 0, 2e-3); // the solver must not shake it
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_hanging_towel_hangs_still_and_allocates_nothing, hanging)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_towel_on_a_table_comes_to_rest_above_it_and_allocates_nothing);
  RUN(a_towel_over_a_ball_hangs_still_and_never_enters_it);
  RUN(a_hanging_towel_hangs_still_and_allocates_nothing);
  return failures > 0;
}
