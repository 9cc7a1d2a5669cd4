// Bodies cut a step by how far they move against the cloth near them, not by how far they move;
// layers that would pass through each other in many places cut it too, and holds that jerk.
#include "scene.h"
#include "scene/folder.h"

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

// A tube of soft cloth is wrung by two turns a second, for 0.72 s, and then kept.
static const char wrung[] = "name: wrung\n"
                            "params: {time_step: 0.04, thickness: 0.003, gravity: [0, 0, 0]}\n"
                            "materials:\n"
                            "  soft: {density: 0.15, stretch_warp: 260, stretch_weft: 260}\n"
                            "cloths:\n"
                            "  - name: tube\n"
                            "    tube: {radius: 0.1, length: 0.4, resolution: [20, 14]}\n"
                            "    material: soft\n"
                            "    groups: {lower: {side: bottom}, upper: {side: top}}\n"
                            "    pins:\n"
                            "      - {group: lower, motion: {spin: [0, 0, -6.28], end: 0.72}}\n"
                            "      - {group: upper, motion: {spin: [0, 0, 6.28], end: 0.72}}\n";

static cloth_scene *wring(const char *precision, folder *f)
{
  cloth_def *def;
  cloth_error err = {0};
  must(cloth_def_load(folder_write(f, "wrung.yaml", wrung), &def, &err), &err);
  def_set(def, "precision", precision);
  return scene_new(def);
}

static int cut_where_crowded(const char *precision)
{
  cloth_error err = {0};
  folder f = folder_make();
  cloth_scene *scene = wring(precision, &f), *other = wring(precision, &f);
  int tried_again = 0, begun_so = 0, most = 0;
  for (int i = 0; i < 18; i++) {
    cloth_step_report r = scene_step(scene, 1);
    CHECK(r.impacts_left == 0);
    most = r.substeps > most ? r.substeps : most;
    tried_again += r.step_halvings > 0 && r.substeps > 2;
    if (r.step_halvings > 0 || r.substeps < 4 || begun_so++) continue;
    // it is part of the state: another scene that takes it over goes on so too
    const char *path = folder_path(&f, "state");
    CHECK_OK(cloth_state_save(scene, path, &err), err);
    CHECK_OK(cloth_state_load(other, path, &err), err);
    cloth_step_report on = scene_step(other, 1);
    r = scene_step(scene, 1), i++;
    CHECK(on.substeps == r.substeps && on.step_halvings == r.step_halvings);
    CHECK(scene_hash(other) == scene_hash(scene));
  }
  CHECK(tried_again > 0 && begun_so > 0);
  scene_step(scene, 12);
  int least = most;
  for (int i = 0; i < 4; i++) {
    int substeps = scene_step(scene, 1).substeps;
    least = substeps < least ? substeps : least;
  }
  CHECK(least <= most / 2); // at rest longer ones are tried again
  cloth_scene_free(scene), cloth_scene_free(other);
  folder_remove(&f);
  return 0;
}
BOTH(a_crowded_step_is_cut_and_the_next_begins_so, cut_where_crowded)

enum { LAYERS = 4, SIDE = 5 };

// Sheets lie in a stack on a floor, pressed by their weight. A box flies over them, so that steps
// are cut, and touches none.
static int thrown_where_cut(const char *precision)
{
  cloth_error err = {0};
  static solid floor;
  const double thickness = 0.003;
  sheet_make(&cloth, 0.06, 0.06, SIDE, SIDE);
  solid_box(&floor, 1, 1, 0.1);
  solid_box(&box, 0.02, 0.02, 0.02);
  cloth_def *def = def_new(precision);
  def_body(def, "floor", &floor, 0.5, pose_at(0, 0, -0.05));
  def_body(def, "box", &box, 0.5, pose_at(-0.3, 0, 0.03));
  for (int i = 0; i < LAYERS; i++) {
    char name[16];
    snprintf(name, sizeof name, "layer_%d", i);
    def_cloth(def, name, &cloth, cloth_material_default(), pose_at(0, 0, thickness * (i + 1)));
  }
  cloth_scene *scene = scene_new(def);
  double calm = scene_step(scene, 60).speed_max, fastest = 0;
  int cut = 1;
  for (int i = 1; i <= 6; i++) {
    cloth_pose to = pose_at(-0.3 + 0.1 * i, 0, 0.03);
    CHECK_OK(cloth_body_move(scene, 1, &to, &err), err);
    cloth_step_report r = scene_step(scene, 1);
    cut = r.substeps > cut ? r.substeps : cut;
    fastest = fmax(fastest, r.speed_max);
  }
  CHECK(cut > 8);
  // that of a fall by a thickness a layer; springs stiffer by the square of the cut throw at 7 m/s
  double fall = sqrt(2 * G * thickness * LAYERS);
  CHECK(calm < fall && fastest < fall);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_stack_is_not_thrown_up_when_a_step_is_cut, thrown_where_cut)

// A sheet without weight, one side held, the other pulled at by springs of `stiffness` N/m whose
// ends are `far` m below. *pulled: the most substeps while it swings to rest; *jerked: those of a
// step in which the springs' ends go on by 0.1 m.
static int cut_by_springs(const char *precision, double stiffness, double far, int *pulled,
                          int *jerked)
{
  cloth_error err = {0};
  sheet_make(&cloth, 0.12, 0.12, N, N);
  cloth_def *def = def_new(precision);
  def_set(def, "gravity", "0 0 0");
  def_cloth(def, "sheet", &cloth, cloth_material_default(), pose_at(0, 0, 0));
  cloth_scene *scene = scene_new(def);
  int fixed[N], end[N];
  for (int i = 0; i < N; i++) fixed[i] = i, end[i] = N * (N - 1) + i;
  cloth_grasp_view hold = {.body = -1, .count = N, .vertex = fixed, .frame = pose_at(0, 0, 0)};
  cloth_grasp_id id;
  CHECK_OK(cloth_grasp(scene, &hold, &id, &err), err);
  hold.vertex = end, hold.stiffness = stiffness;
  CHECK_OK(cloth_grasp(scene, &hold, &id, &err), err);
  cloth_pose to = pose_at(0, 0, -far);
  CHECK_OK(cloth_grasp_move(scene, id, &to, &err), err);
  scene_step(scene, 1);
  *pulled = 1;
  for (int i = 0; i < 60; i++) {
    int substeps = scene_step(scene, 1).substeps;
    *pulled = substeps > *pulled ? substeps : *pulled;
  }
  to = pose_at(0, 0, -far - 0.1);
  CHECK_OK(cloth_grasp_move(scene, id, &to, &err), err);
  *jerked = scene_step(scene, 1).substeps;
  cloth_scene_free(scene);
  return 0;
}

static int cut_by_stretched_springs(const char *precision)
{
  int pulled, jerked;
  // 0.1 mN each, whatever the springs are stretched by, and ends that hardly matter
  if (cut_by_springs(precision, 1e-5, 10, &pulled, &jerked)) return 1;
  CHECK(pulled == 1 && jerked == 1);
  // springs that take light vertices along
  if (cut_by_springs(precision, 1e3, 0.001, &pulled, &jerked)) return 1;
  CHECK(pulled == 1 && jerked == 13); // 0.1 m by 8 mm each
  return 0;
}
BOTH(a_stretched_spring_cuts_no_step_and_one_that_jerks_does, cut_by_stretched_springs)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_body_cuts_the_step_by_its_motion_against_the_cloth);
  RUN(a_crowded_step_is_cut_and_the_next_begins_so);
  RUN(a_stack_is_not_thrown_up_when_a_step_is_cut);
  RUN(a_stretched_spring_cuts_no_step_and_one_that_jerks_does);
  return failures > 0;
}
