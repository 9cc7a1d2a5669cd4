// When pairs are searched: a few vertices that move get regions that last, a crowd does not, and
// the number of parts has no say.
#include "scene.h"

enum { STEPS = 40, LYING = 25, FLYING = 4 };

static sheet lying, flying;

// a sheet that floats at rest and one or several that fly over it, by three slacks a step; pairs:
// in the first and the last step. Returns the searches.
static int searches(const char *precision, const char *devices, bool crowd, int pairs[2])
{
  sheet_make(&lying, 0.4, 0.4, LYING, LYING);
  sheet_make(&flying, 0.05, 0.05, FLYING, FLYING);
  cloth_def *def = def_new(precision);
  def_set(def, "devices", devices);
  def_set(def, "gravity", "0 0 0");
  def_set(def, "time_step", "0.01");
  def_set(def, "pair_slack", "0.001");
  def_cloth(def, "lying", &lying, cloth_material_default(), pose_at(0, 0, 0));
  def_cloth(def, "flying", &flying, cloth_material_default(), pose_at(-0.1, 0, 0.0045));
  cloth_scene *scene = scene_new(def);
  for (int c = crowd ? 0 : 1; c < 2; c++) {
    const sheet *s = c ? &flying : &lying;
    static double v[3 * SHEET_MAX];
    for (int i = 0; i < s->columns * s->rows; i++) v[3 * i] = 0.3, v[3 * i + 1] = v[3 * i + 2] = 0;
    cloth_error err = {0};
    must(cloth_state_set(scene, c, NULL, v, s->columns * s->rows, &err), &err);
  }
  int sum = 0;
  for (int n = 0; n < STEPS; n++) {
    cloth_step_report r = scene_step(scene, 1);
    sum += r.pair_searches, pairs[n > 0] = r.pairs;
    if (r.contacts_self != 0) return -1;
  }
  cloth_scene_free(scene);
  return sum;
}

// The sheet above turns, its vertices by up to 0.9 slacks a step: some leave their regions in two
// steps, some in three, four, five. Returns the searches.
static int searches_for_turning(const char *precision)
{
  enum { TURNING = 7 };
  static double v[3 * SHEET_MAX];
  sheet_make(&lying, 0.4, 0.4, LYING, LYING);
  sheet_make(&flying, 0.05, 0.05, TURNING, TURNING);
  cloth_def *def = def_new(precision);
  def_set(def, "gravity", "0 0 0");
  def_set(def, "time_step", "0.01");
  def_set(def, "pair_slack", "0.001");
  def_cloth(def, "lying", &lying, cloth_material_default(), pose_at(0, 0, 0));
  def_cloth(def, "turning", &flying, cloth_material_default(), pose_at(0, 0, 0.0045));
  cloth_scene *scene = scene_new(def);
  for (int i = 0; i < TURNING * TURNING; i++)
    v[3 * i] = -2.5 * (flying.x[3 * i + 1] - 0.025), v[3 * i + 1] = 2.5 * (flying.x[3 * i] - 0.025);
  cloth_error err = {0};
  must(cloth_state_set(scene, 1, NULL, v, TURNING * TURNING, &err), &err);
  int sum = 0;
  for (int n = 0; n < STEPS; n++) sum += scene_step(scene, 1).pair_searches;
  cloth_scene_free(scene);
  return sum;
}

static int soon(const char *precision)
{
  int n = searches_for_turning(precision);
  CHECK(n > 0 && n <= STEPS / 5);
  return 0;
}
BOTH(vertices_that_would_leave_soon_are_not_searched_for_one_after_the_other, soon)

static int few(const char *precision)
{
  int pairs[2];
  int one = searches(precision, "cpu", false, pairs);
  CHECK(one > 0 && one <= STEPS / 3);
  CHECK(searches(precision, "cpu,cpu,cpu", false, pairs) == one);
  return 0;
}
BOTH(a_few_vertices_that_fly_are_not_searched_for_at_every_step, few)

static int crowd(const char *precision)
{
  int pairs[2];
  CHECK(searches(precision, "cpu", true, pairs) == STEPS);
  CHECK(pairs[0] > 0 && pairs[1] == pairs[0]); // as they fly together, and no region grew
  return 0;
}
BOTH(a_crowd_is_and_its_regions_stay_small, crowd)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_few_vertices_that_fly_are_not_searched_for_at_every_step);
  RUN(vertices_that_would_leave_soon_are_not_searched_for_one_after_the_other);
  RUN(a_crowd_is_and_its_regions_stay_small);
  return failures > 0;
}
