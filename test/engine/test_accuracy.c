// What may be traded for time: the budget and its replay, the estimate of the step error, discrete
// contact detection.
#include "scene.h"

#include <stdbool.h>
#include <unistd.h>

static cloth_def *falling(const char *precision, sheet *s)
{
  cloth_def *def = def_new(precision);
  sheet_make(s, 0.3, 0.3, 9, 9);
  def_cloth(def, "towel", s, cloth_material_default(), pose_at(0, 0, 1));
  return def;
}

static cloth_def *on_ball(const char *precision, sheet *s)
{
  static solid ball;
  cloth_def *def = def_new(precision);
  sheet_make(s, 0.3, 0.3, 9, 9);
  solid_sphere(&ball, 0.1, 12, 7);
  def_cloth(def, "towel", s, cloth_material_default(), pose_at(0, 0, 0.11));
  def_body(def, "ball", &ball, 0.3, pose_at(0, 0, 0));
  return def;
}

// backward Euler falls h^2 g / 2 too far in every step
static int estimate(const char *precision)
{
  static sheet s;
  cloth_scene *scene = scene_new(falling(precision, &s));
  cloth_step_report r = scene_step(scene, 3);
  double h = 1.0 / 60, tol = 100 * epsilon_of(precision);
  CHECK_NEAR(r.error_estimate, G * h * h / 2, tol);
  cloth_scene_free(scene);

  cloth_def *def = falling(precision, &s);
  def_set(def, "substeps", "4");
  scene = scene_new(def);
  r = scene_step(scene, 3);
  CHECK_NEAR(r.error_estimate, G * h * h / 2 / 16, tol); // of a substep
  cloth_scene_free(scene);
  return 0;
}
BOTH(the_estimated_error_of_free_fall_is_that_of_backward_euler, estimate)

static int without(const char *precision)
{
  static sheet s;
  cloth_scene *scene = scene_new(on_ball(precision, &s));
  cloth_step_report r = scene_step(scene, 3);
  CHECK(r.budget_ms == 0 && r.budget_level == 0 && r.chosen_pcg_tolerance == 0);
  CHECK(r.chosen_newton_iterations == 0 && r.deadlines_missed == 0 && r.wall_p99 == 0);
  cloth_scene_free(scene);
  return 0;
}
BOTH(without_a_budget_nothing_is_chosen, without)

// a budget that no machine can hold gives up all it may; one that every machine holds gives up
// nothing
static int bounds(const char *precision)
{
  static sheet s;
  cloth_def *def = on_ball(precision, &s);
  def_set(def, "time_budget", "1e-5");
  cloth_scene *scene = scene_new(def);
  cloth_step_report r = scene_step(scene, 10);
  CHECK(r.budget_ms == 1e-5 && r.budget_level == 0 && r.deadlines_missed == 10);
  CHECK(r.deadline_miss_share == 1 && r.wall_p50 > 1e-5 && r.wall_worst >= r.wall_p99);
  CHECK_NEAR(r.chosen_pcg_tolerance, 0.1, 1e-12);
  CHECK(r.chosen_newton_iterations == 1 && r.chosen_contact_rounds == 1);
  CHECK(r.chosen_pcg_iterations == 20);
  for (int i = 0; i < 40; i++) { // whatever is given up, nothing passes
    r = scene_step(scene, 1);
    CHECK(r.tangles == 0 && r.impacts_left == 0);
  }
  cloth_scene_free(scene);

  def = on_ball(precision, &s);
  def_set(def, "time_budget", "1e5");
  scene = scene_new(def);
  r = scene_step(scene, 10);
  CHECK(r.budget_level == 1 && r.deadlines_missed == 0 && r.chosen_newton_iterations == 3);
  uint64_t with = scene_hash(scene);
  cloth_scene_free(scene);
  scene = scene_new(on_ball(precision, &s));
  scene_step(scene, 10);
  CHECK(scene_hash(scene) == with);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_budget_keeps_to_its_bounds, bounds)

// what was chosen is in the recording: a replay gives the same bits, whatever the clock says then
static int replays(const char *precision)
{
  static sheet s;
  cloth_error err = {0};
  char path[] = "test_accuracy_XXXXXX";
  int file = mkstemp(path);
  CHECK(file >= 0);
  close(file);
  remove(path);
  cloth_def *def = on_ball(precision, &s);
  def_set(def, "time_budget", "1e-5");
  cloth_scene *scene = scene_new(def);
  CHECK_OK(cloth_record_start(scene, path, &err), err);
  scene_step(scene, 12);
  // a choice that no budget would make of itself
  cloth_tuning odd = {0.033, 2, 1, 9, 3e-4};
  CHECK_OK(cloth_tune(scene, &odd, &err), err);
  scene_step(scene, 1);
  scene_step(scene, 5);
  CHECK_OK(cloth_record_stop(scene, &err), err);
  uint64_t first = scene_hash(scene);
  cloth_scene_free(scene);

  def = on_ball(precision, &s);
  def_set(def, "time_budget", "1e-5");
  scene = scene_new(def);
  int64_t steps = 0;
  CHECK_OK(cloth_replay(scene, path, &steps, &err), err);
  CHECK(steps == 18 && scene_hash(scene) == first);
  cloth_scene_free(scene);
  remove(path);
  return 0;
}
BOTH(a_budgeted_run_replays_bit_for_bit, replays)

static int tunes(const char *precision)
{
  static sheet s;
  cloth_error err = {0};
  cloth_scene *scene = scene_new(on_ball(precision, &s));
  scene_step(scene, 5);
  uint64_t before = scene_hash(scene);
  const cloth_tuning wrong[] = {{0.2, 1, 1, 0, 0},  {NAN, 1, 1, 0, 0},  {0.1, 0, 1, 0, 0},
                                {0.1, 1, -1, 0, 0}, {0.1, 1, 1, -1, 0}, {0.1, 1, 1, 0, 0.2}};
  for (int i = 0; i < 6; i++) CHECK(cloth_tune(scene, &wrong[i], &err) == CLOTH_BAD_ARGUMENT);
  CHECK(scene_hash(scene) == before);
  // for one step, then the parameters rule again
  cloth_tuning one = {0.1, 1, 0, 0, 0};
  CHECK_OK(cloth_tune(scene, &one, &err), err);
  cloth_step_report r = scene_step(scene, 1);
  CHECK(r.newton_iterations == r.substeps && r.contact_rounds == 0);
  cloth_tuning many = {1e-6, 7, 2, 0, 0};
  CHECK_OK(cloth_tune(scene, &many, &err), err);
  scene_step(scene, 1);
  r = scene_step(scene, 1);
  CHECK(r.newton_iterations <= 3 * r.substeps + r.contact_rounds);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_tuning_holds_for_one_step, tunes)

// 0.2 m in a step onto a plate of 1 cm, whose upper face is at 0.005 m
static int shot(const char *precision)
{
  static const char *const how[] = {"continuous", "discrete"};
  for (int i = 0; i < 2; i++) {
    static sheet s;
    static solid plate;
    static double x[3 * SHEET_MAX];
    cloth_def *def = def_new(precision);
    sheet_make(&s, 0.2, 0.2, 5, 5);
    solid_box(&plate, 1, 1, 0.01);
    cloth_error err = {0};
    cloth_cloth_view v = {.name = "towel",
                          .mesh = sheet_view(&s),
                          .material = cloth_material_default(),
                          .pose = pose_at(0, 0, 0.1),
                          .velocity = {0, 0, -12}};
    must(cloth_def_add_cloth(def, &v, NULL, &err), &err);
    def_body(def, "plate", &plate, 0.3, pose_at(0, 0, 0));
    def_set(def, "contact_detection", how[i]);
    cloth_scene *scene = scene_new(def);
    cloth_step_report r = scene_step(scene, 3);
    scene_positions(scene, 0, x);
    double lowest = x[2];
    for (int k = 0; k < 25; k++) lowest = fmin(lowest, x[3 * k + 2]);
    if (i == 0) CHECK(lowest > 0.005);
    CHECK(((r.stages_skipped >> CLOTH_STAGE_ccd) & 1) == (i == 1));
    cloth_scene_free(scene);
  }
  return 0;
}
BOTH(continuous_detection_stops_a_shot_and_discrete_skips_its_stage, shot)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(the_estimated_error_of_free_fall_is_that_of_backward_euler);
  RUN(without_a_budget_nothing_is_chosen);
  RUN(a_budget_keeps_to_its_bounds);
  RUN(a_budgeted_run_replays_bit_for_bit);
  RUN(a_tuning_holds_for_one_step);
  RUN(continuous_detection_stops_a_shot_and_discrete_skips_its_stage);
  return failures != 0;
}
