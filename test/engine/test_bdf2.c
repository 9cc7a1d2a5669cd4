// The integrator bdf2: of order 2 where all is smooth, backward Euler where it is not; its history
// is part of the state.
#include "scene.h"

#include <unistd.h>

static sheet cloth;
static solid body;
static double x[3 * 200], reference[3 * 200];
enum { COLUMNS = 3, ROWS = 5, COUNT = COLUMNS * ROWS };

// a sheet whose fastest mode (100 rad/s) the steps below resolve, clamped along its top, let go 20
// degrees aside; systems are solved as far as double can
static cloth_scene *swing(const char *precision, const char *integrator, double h,
                          const char *devices)
{
  char text[32];
  sheet_make(&cloth, 0.2, 0.4, COLUMNS, ROWS);
  cloth_material m = cloth_material_default();
  m.stretch_warp = m.stretch_weft = 8, m.shear = 3, m.damping_stretch = m.damping_bend = 0;
  cloth_def *def = def_new(precision);
  snprintf(text, sizeof text, "%.17g", h);
  def_set(def, "time_step", text), def_set(def, "integrator", integrator);
  def_set(def, "pcg_tolerance", strcmp(precision, "double") == 0 ? "1e-11" : "1e-5");
  def_set(def, "newton_tolerance", strcmp(precision, "double") == 0 ? "1e-9" : "1e-3");
  def_set(def, "newton_iterations_max", "20"), def_set(def, "gravity", "0 0 -2");
  def_set(def, "effects.self_contact", "off");
  if (devices) def_set(def, "devices", devices);
  def_cloth(def, "sheet", &cloth, m, pose_turned(0, 0, 0, 0, 1.9));
  cloth_scene *scene = scene_new(def);
  int held[COLUMNS];
  for (int k = 0; k < COLUMNS; k++) held[k] = COLUMNS * (ROWS - 1) + k;
  scene_hold(scene, 0, held, COLUMNS, cloth_pose_identity());
  return scene;
}

// root mean square distance to the reference after 0.2 s
static double error_of(const char *integrator, int steps)
{
  double sum = 0;
  cloth_scene *scene = swing("double", integrator, 0.2 / steps, NULL);
  scene_step(scene, steps);
  scene_positions(scene, 0, x);
  for (int k = 0; k < 3 * COUNT; k++) sum += (x[k] - reference[k]) * (x[k] - reference[k]);
  cloth_scene_free(scene);
  return sqrt(sum / COUNT);
}

static int swings_are_of_order_two_and_of_backward_euler_of_order_one(void)
{
  cloth_scene *scene = swing("double", "bdf2", 0.2 / 2048, NULL);
  scene_step(scene, 2048);
  scene_positions(scene, 0, reference);
  cloth_scene_free(scene);
  double two[3], one[3];
  for (int i = 0; i < 3; i++)
    two[i] = error_of("bdf2", 64 << i), one[i] = error_of("backward_euler", 64 << i);
  for (int i = 0; i < 2; i++) {
    double p2 = log2(two[i] / two[i + 1]), p1 = log2(one[i] / one[i + 1]);
    if (!(p2 > 1.8 && p2 < 2.2 && p1 > 0.8 && p1 < 1.2))
      printf("  errors %g %g %g (bdf2), %g %g %g m\n", two[0], two[1], two[2], one[0], one[1],
             one[2]);
    CHECK(p2 > 1.8 && p2 < 2.2);
    CHECK(p1 > 0.8 && p1 < 1.2);
  }
  CHECK(two[2] < one[2] / 10);
  return 0;
}

// of constant acceleration BDF2 makes no error: all there is comes from the first step
// ...
static int fall(const char *precision)
{
  sheet_make(&cloth, 0.2, 0.4, COLUMNS, ROWS);
  double error[2], h = 0.01;
  for (int steps = 20; steps <= 40; steps += 20) {
    cloth_def *def = def_new(precision);
    def_set(def, "time_step", "0.01"), def_set(def, "integrator", "bdf2");
    def_set(def, "effects.self_contact", "off");
    def_cloth(def, "sheet", &cloth, cloth_material_default(), pose_at(0, 0, 0));
    cloth_scene *scene = scene_new(def);
    cloth_step_report r = scene_step(scene, 1);
    CHECK(r.bdf2_substeps == 0 && r.substeps == 1);
    for (int i = 1; i < steps; i++) {
      r = scene_step(scene, 1);
      CHECK(r.bdf2_substeps == 1);
    }
    double t = steps * h;
    scene_positions(scene, 0, x);
    error[steps / 20 - 1] = x[2] + 9.81 * t * t / 2;
    CHECK_NEAR(r.speed_max, 9.81 * t, 1e3 * epsilon_of(precision) * 9.81 * t + 1e-5);
    CHECK(r.error_estimate < 1e-5); // constant acceleration
    cloth_scene_free(scene);
  }
  // the first step falls too far by g h^2 / 2; the recurrence 3/2, -2, 1/2 makes half as much more
  // of it
  CHECK_NEAR(error[0], -9.81 * h * h * 0.75, 1e-6 + 1e3 * epsilon_of(precision));
  CHECK_NEAR(error[1], error[0], 1e-6 + 1e3 * epsilon_of(precision));
  return 0;
}
BOTH(free_fall_is_exact_after_the_first_step, fall)

static int falls_back(const char *precision)
{
  sheet_make(&cloth, 0.1, 0.1, 6, 6);
  solid_box(&body, 0.4, 0.4, 0.02);
  cloth_def *def = def_new(precision);
  def_set(def, "integrator", "bdf2");
  def_cloth(def, "sheet", &cloth, cloth_material_default(), pose_at(0, 0, 0.05));
  def_body(def, "table", &body, 0.5, pose_at(0, 0, -0.01));
  cloth_scene *scene = scene_new(def);
  cloth_error err = {0};
  bool landed = false;
  for (int i = 0; i < 40; i++) {
    cloth_step_report r = scene_step(scene, 1);
    CHECK(r.bdf2_substeps == (i > 0 && r.contacts_body == 0 && !landed && r.impacts == 0));
    landed |= r.contacts_body > 0 || r.impacts > 0;
    CHECK(r.impacts_left == 0);
  }
  CHECK(landed);
  cloth_pose up = pose_at(0, 0, -2);
  CHECK_OK(cloth_body_place(scene, 0, &up, &err), err); // it falls again
  CHECK(scene_step(scene, 1).bdf2_substeps == 0 && scene_step(scene, 1).bdf2_substeps == 1);
  static const int corner[1] = {0};
  cloth_grasp_id id = scene_hold(scene, 0, corner, 1, cloth_pose_identity());
  CHECK(scene_step(scene, 1).bdf2_substeps == 0 && scene_step(scene, 1).bdf2_substeps > 0);
  CHECK_OK(cloth_grasp_release(scene, id, &err), err);
  CHECK(scene_step(scene, 1).bdf2_substeps == 0 && scene_step(scene, 1).bdf2_substeps > 0);
  CHECK_OK(cloth_reset(scene, &err), err);
  CHECK(scene_step(scene, 1).bdf2_substeps == 0);
  cloth_scene_free(scene);
  return 0;
}
BOTH(starts_contacts_and_grasps_are_steps_of_backward_euler, falls_back)

static int same_bits(const char *precision)
{
  char path[] = "/tmp/cloth-bdf2-XXXXXX";
  cloth_error err = {0};
  cloth_scene *scene = swing(precision, "bdf2", 1.0 / 60, NULL), *other;
  scene_step(scene, 10);
  int file = mkstemp(path);
  CHECK(file >= 0 && close(file) == 0);
  CHECK_OK(cloth_state_save(scene, path, &err), err);
  uint64_t middle = scene_hash(scene);
  scene_step(scene, 10);
  uint64_t end = scene_hash(scene);
  CHECK(middle != end);
  cloth_scene_free(scene);

  other = swing(precision, "bdf2", 1.0 / 60, "cpu,cpu,cpu"); // from the file, in three parts
  CHECK_OK(cloth_state_load(other, path, &err), err);
  CHECK(scene_hash(other) == middle);
  CHECK(scene_step(other, 10).bdf2_substeps == 1);
  CHECK(scene_hash(other) == end);
  // a substep that has another history is another state
  static double v[3 * COUNT];
  CHECK_OK(cloth_state_load(other, path, &err), err);
  CHECK_OK(cloth_velocities(other, 0, v, COUNT, &err), err);
  CHECK_OK(cloth_state_set(other, 0, NULL, v, COUNT, &err), err); // the same, but not continued
  CHECK(scene_hash(other) != middle);
  cloth_scene_free(other);

  other = swing(precision, "backward_euler", 1.0 / 60, NULL); // has no use for the history
  CHECK_OK(cloth_state_load(other, path, &err), err);
  CHECK(scene_step(other, 1).bdf2_substeps == 0);
  cloth_scene_free(other);
  remove(path);
  return 0;
}
BOTH(history_is_part_of_the_state, same_bits)

static int undone(const char *precision)
{
  cloth_scene *scene = swing(precision, "bdf2", 1.0 / 60, NULL);
  cloth_error err = {0};
  scene_step(scene, 5);
  uint64_t before = scene_hash(scene);
  cloth_grasp_id id = {1, 1};
  cloth_pose far = pose_at(9e5, 0, 0);
  CHECK_OK(cloth_grasp_move(scene, id, &far, &err), err);
  CHECK(cloth_step(scene, 0, NULL, &err) == CLOTH_UNSTABLE);
  CHECK(scene_hash(scene) == before);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_step_that_fails_leaves_the_history_too, undone)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(swings_are_of_order_two_and_of_backward_euler_of_order_one);
  RUN(free_fall_is_exact_after_the_first_step);
  RUN(starts_contacts_and_grasps_are_steps_of_backward_euler);
  RUN(history_is_part_of_the_state);
  RUN(a_step_that_fails_leaves_the_history_too);
  return failures > 0;
}
