// Bodies cut a step by how far they move against the cloth near them, not by how far they move.
#include "scene.h"

enum { N = 13, STEPS = 19 };
static const double travel = 0.03; // m a step, against 8 mm that are allowed a substep

static sheet cloth;
static solid box;

// A sheet falls sideways beside a box that stands, and in the step in which the box moves it falls
// by `share` of that. cut: into how many substeps that step is cut.
static int cut_of(const char *precision, double share, double gap, double turn, int *cut)
{
  cloth_error err = {0};
  const double a = share * travel / (STEPS + 1), fallen = a * STEPS * (STEPS + 1) / 2; // m
  char fall[64];
  sheet_make(&cloth, 0.12, 0.12, N, N);
  solid_box(&box, 0.1, 0.1, 0.02);
  cloth_def *def = def_new(precision);
  snprintf(fall, sizeof fall, "%.17g 0 0", a * 60 * 60);
  def_set(def, "gravity", fall);
  def_cloth(def, "sheet", &cloth, cloth_material_default(), pose_at(-fallen, 0, 0));
  def_body(def, "box", &box, 0.5, pose_at(0, 0, -0.01 - gap));
  cloth_scene *scene = scene_new(def);
  scene_step(scene, STEPS);
  cloth_pose to = pose_turned(travel, 0, -0.01 - gap, 2, turn);
  CHECK_OK(cloth_body_move(scene, 0, &to, &err), err);
  *cut = scene_step(scene, 1).substeps;
  cloth_scene_free(scene);
  return 0;
}

static int cut_by_relative_motion(const char *precision)
{
  int cut;
  if (cut_of(precision, 0, 0.01, 0, &cut)) return 1;
  CHECK(cut == 4); // 30 mm against cloth that stands: 8 mm each
  if (cut_of(precision, 1, 0.01, 0, &cut)) return 1;
  CHECK(cut == 1); // carried along
  if (cut_of(precision, 0.5, 0.01, 0, &cut)) return 1;
  CHECK(cut == 2); // 15 mm
  if (cut_of(precision, -1, 0.01, 0, &cut)) return 1;
  CHECK(cut == 4); // cloth that comes towards it cuts no further
  if (cut_of(precision, 1, 0.01, 0.5, &cut)) return 1;
  CHECK(cut == 5); // carried along, but turned: 0.5 rad at 72 mm
  if (cut_of(precision, 0, 0.1, 0, &cut)) return 1;
  CHECK(cut == 1); // far away
  return 0;
}
BOTH(a_body_cuts_the_step_by_its_motion_against_the_cloth, cut_by_relative_motion)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_body_cuts_the_step_by_its_motion_against_the_cloth);
  return failures > 0;
}
