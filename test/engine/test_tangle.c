// Starts that intersect, bodies that leave no room, teleports: what is kept, worked out, named and
// reported. Whether the meshes are right is judged by CGAL in test_tangle.cpp; here the engine is
// held to its own word: the same bits whatever way it runs, and the numbers of the report.
#include "scene.h"

#include <unistd.h>

static sheet one, two;
static solid body;
static double x[3 * SHEET_MAX];

static cloth_def *crossing(const char *precision, const char *untangle)
{
  sheet_make(&one, 0.2, 0.2, 15, 15);
  sheet_make(&two, 0.2, 0.1, 15, 8);
  cloth_def *def = def_new(precision);
  def_set(def, "gravity", "0 0 0");
  def_set(def, "untangle", untangle);
  def_cloth(def, "one", &one, cloth_material_default(), pose_at(0, 0, 0));
  def_cloth(def, "two", &two, cloth_material_default(), pose_turned(0.013, 0.004, 0.03, 0, 1.3));
  return def;
}

// a box in the middle of a towel, 2 cm from coming out
static cloth_def *around_a_box(const char *precision, const char *untangle)
{
  sheet_make(&one, 0.2, 0.2, 15, 15);
  solid_box(&body, 0.06, 0.06, 0.06);
  cloth_def *def = def_new(precision);
  def_set(def, "gravity", "0 0 0");
  def_set(def, "untangle", untangle);
  def_cloth(def, "towel", &one, cloth_material_default(), pose_at(0, 0, 0));
  def_body(def, "box", &body, 0.5, pose_at(0.011, 0.007, 0.01));
  return def;
}

static int tangles_of(cloth_scene *scene)
{
  cloth_tangle_view first;
  cloth_error err = {0};
  int count = 0;
  must(cloth_tangles(scene, &first, 1, &count, &err), &err);
  return count;
}

// ---- the same bits ------------------------------------------------------------------------------

static uint64_t hash_after(cloth_def *def, int steps, int *tangles)
{
  cloth_scene *scene = scene_new(def);
  cloth_step_report r = scene_step(scene, steps);
  uint64_t hash = scene_hash(scene);
  *tangles = r.tangles;
  cloth_scene_free(scene);
  return hash;
}

typedef cloth_def *made(const char *precision, const char *untangle);

static int same_bits_of(made *make, const char *precision)
{
  static const char *const settings[][2] = {
      {"threads", "1"}, {"threads", "3"}, {"devices", "cpu,cpu,cpu"}, {"backend", "shuffle"}};
  int tangles, other;
  uint64_t hash = hash_after(make(precision, "true"), 8, &tangles);
  CHECK(tangles > 0); // in the middle of it
  for (int i = 0; i < 4; i++) {
    cloth_def *def = make(precision, "true");
    def_set(def, settings[i][0], settings[i][1]);
    CHECK(hash_after(def, 8, &other) == hash && other == tangles);
  }
  return 0;
}

static int same_bits(const char *precision)
{
  return same_bits_of(crossing, precision) || same_bits_of(around_a_box, precision);
}
BOTH(working_out_gives_the_same_bits_for_threads_parts_and_order, same_bits)

static int continued(const char *precision)
{
  cloth_error err = {0};
  char path[] = "/tmp/test_tangle_XXXXXX";
  int fd = mkstemp(path);
  CHECK(fd >= 0);
  close(fd);
  cloth_scene *scene = scene_new(crossing(precision, "true"));
  cloth_scene *other = scene_new(crossing(precision, "true"));
  scene_step(scene, 4);
  must(cloth_state_save(scene, path, &err), &err);
  must(cloth_state_load(other, path, &err), &err);
  remove(path);
  for (int n = 0; n < 6; n++) {
    tangles_of(other); // looking on changes nothing
    CHECK(scene_step(scene, 1).tangles == scene_step(other, 1).tangles);
    CHECK(scene_hash(scene) == scene_hash(other));
  }
  cloth_scene_free(scene), cloth_scene_free(other);
  return 0;
}
BOTH(a_run_continued_in_the_middle_of_it_gives_the_same_bits, continued)

static int comes_off(const char *precision)
{
  cloth_scene *scene = scene_new(around_a_box(precision, "true"));
  int before = tangles_of(scene);
  cloth_step_report r = {0};
  for (int n = 0; n < 30; n++) {
    r = scene_step(scene, 1);
    CHECK(r.stretch_max < 0.05); // it comes off as a whole, by its nearest side
  }
  scene_positions(scene, 0, x);
  for (int v = 0; v < 15 * 15; v++) {
    double *p = x + 3 * v;
    CHECK(fabs(p[0] - 0.011) > 0.03 || fabs(p[1] - 0.007) > 0.03 || p[2] < -0.02);
  }
  CHECK(before > 0 && r.tangles == 0);
  cloth_scene_free(scene);
  return 0;
}
BOTH(cloth_in_which_a_box_appeared_comes_off_by_the_nearest_side, comes_off)

// ---- bodies that leave no room
// -------------------------------------------------------------------

static int fingers(const char *precision)
{
  sheet_make(&one, 0.1, 0.1, 13, 13);
  solid_box(&body, 0.02, 0.03, 0.03);
  cloth_def *def = def_new(precision);
  def_cloth(def, "towel", &one, cloth_material_default(), pose_turned(0, 0, 0, 1, acos(-1) / 2));
  def_set(def, "gravity", "0 0 0"); // it must not fall out first
  def_body(def, "left", &body, 0.5, pose_at(-0.02, 0.001, 0.001));
  def_body(def, "far", &body, 0.5, pose_at(0, 0.2, 0));
  def_body(def, "right", &body, 0.5, pose_at(0.02, 0, 0));
  cloth_scene *scene = scene_new(def);
  cloth_error err = {0};
  int named[3] = {0, 0, 0}, usual = 0, worst = 0;
  for (int n = 1; n <= 25; n++) { // 10 mm of room close to nothing, then they stay
    double at = 0.01 + 0.01 * fmax(0, 1 - n / 10.0);
    cloth_pose left = pose_at(-at, 0.001, 0.001), right = pose_at(at, 0, 0);
    must(cloth_body_move(scene, 0, &left, &err), &err);
    must(cloth_body_move(scene, 2, &right, &err), &err);
    cloth_step_report r = scene_step(scene, 1);
    int list[3], count;
    must(cloth_blocking_bodies(scene, list, 3, &count, &err), &err);
    CHECK(count == r.bodies_blocking && (count > 0) == (r.impacts_left > 0));
    for (int i = 0; i < count; i++) named[list[i]] = 1;
    int systems = r.newton_iterations;
    if (n < 10) usual = systems > usual ? systems : usual;
    worst = systems > worst ? systems : worst;
    CHECK(isfinite(r.stretch_max) && isfinite(r.speed_max));
    scene_positions(scene, 0, x);
    for (int i = 0; i < 3 * 13 * 13; i++) CHECK(fabs(x[i]) < 10);
  }
  CHECK(named[0] && named[2] && !named[1]);
  CHECK(worst <= 5 * usual); // no stall: linear systems are what a step costs
  cloth_scene_free(scene);
  return 0;
}
BOTH(fingers_that_close_to_nothing_are_both_named_and_nothing_breaks, fingers)

static int press(const char *precision)
{
  solid table;
  sheet_make(&one, 0.1, 0.1, 9, 9);
  solid_box(&body, 0.05, 0.05, 0.02);
  solid_box(&table, 0.3, 0.3, 0.02);
  cloth_def *def = def_new(precision);
  def_cloth(def, "towel", &one, cloth_material_default(), pose_at(0, 0, 0.003));
  def_body(def, "table", &table, 0.5, pose_at(0.001, 0.002, -0.01));
  def_body(def, "press", &body, 0.5, pose_at(0.003, 0.001, 0.018));
  cloth_scene *scene = scene_new(def);
  cloth_error err = {0};
  int named[2] = {0, 0};
  for (int n = 1; n <= 10; n++) { // the table stands still: only the press runs through
    cloth_pose down = pose_at(0.003, 0.001, 0.01 + 0.008 * fmax(0, 1 - n / 5.0));
    must(cloth_body_move(scene, 1, &down, &err), &err);
    int list[2], count;
    CHECK(isfinite(scene_step(scene, 1).speed_max));
    must(cloth_blocking_bodies(scene, list, 2, &count, &err), &err);
    for (int i = 0; i < count; i++) named[list[i]] = 1;
  }
  CHECK(named[0] && named[1]);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_press_names_the_table_under_it_too, press)

static int room(const char *precision)
{
  cloth_scene *scene;
  cloth_error err = {0};
  int list[1], count = 1;
  sheet_make(&one, 0.1, 0.1, 9, 9);
  solid_box(&body, 0.3, 0.3, 0.02);
  cloth_def *def = def_new(precision);
  def_cloth(def, "towel", &one, cloth_material_default(), pose_at(0, 0, 0.005));
  def_body(def, "table", &body, 0.5, pose_at(0, 0, -0.01));
  scene = scene_new(def);
  cloth_step_report r = scene_step(scene, 20);
  must(cloth_blocking_bodies(scene, list, 1, &count, &err), &err);
  CHECK(r.contacts_body > 0 && count == 0 && r.bodies_blocking == 0 && r.tangles == 0);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_table_that_leaves_room_is_not_named, room)

// ---- teleports ----------------------------------------------------------------------------------

// the ball `below` the towel [m]
static cloth_scene *teleport_scene(const char *precision, double below)
{
  sheet_make(&one, 0.3, 0.3, 19, 19);
  solid_sphere(&body, 0.04, 16, 9);
  cloth_def *def = def_new(precision);
  def_cloth(def, "towel", &one, cloth_material_default(), pose_turned(0, 0, 0, 0, 0.2));
  def_body(def, "ball", &body, 0.5, pose_at(0, 0, -below));
  def_set(def, "gravity", "0 0 0");
  return scene_new(def);
}

static int teleport(const char *precision)
{
  cloth_error err = {0};
  cloth_scene *told = teleport_scene(precision, 1), *placed = teleport_scene(precision, 1);
  char path[] = "/tmp/test_tangle_XXXXXX";
  int fd = mkstemp(path);
  CHECK(fd >= 0);
  close(fd);
  cloth_pose into = pose_at(0.01, 0.005, 0.012);
  CHECK(scene_step(told, 2).teleports == 0);
  scene_step(placed, 2);
  must(cloth_body_move(told, 0, &into, &err), &err);
  must(cloth_body_place(placed, 0, &into, &err), &err);
  cloth_step_report r = scene_step(told, 1);
  scene_step(placed, 1);
  // not swept: the cloth through which the way led is not taken along, nor the step cut for it
  CHECK(r.teleports == 1 && r.substeps == 1 && r.tangles > 20 && r.speed_max < 2);
  CHECK(scene_hash(told) == scene_hash(placed));
  cloth_scene *loaded = teleport_scene(precision, 1); // goes on where the other one was
  must(cloth_state_save(told, path, &err), &err);
  must(cloth_state_load(loaded, path, &err), &err);
  remove(path);
  for (int n = 0; n < 200 && r.tangles > 0; n++) {
    r = scene_step(told, 1);
    if (n < 20) CHECK(scene_step(loaded, 1).tangles == r.tangles);
    if (n == 19) CHECK(scene_hash(loaded) == scene_hash(told));
  }
  cloth_scene_free(loaded);
  CHECK(r.tangles == 0 && tangles_of(told) == 0 && r.speed_max < 1);
  cloth_scene_free(told), cloth_scene_free(placed);
  return 0;
}
BOTH(a_teleport_into_cloth_is_placed_and_settled_not_swept, teleport)

static int sweep(const char *precision)
{
  cloth_error err = {0};
  cloth_scene *scene = teleport_scene(precision, 0.58);
  cloth_pose near = pose_at(0, 0, -0.0801);
  must(cloth_body_move(scene, 0, &near, &err), &err);
  cloth_step_report r = scene_step(scene, 1);
  CHECK(r.teleports == 0 && r.substeps > 1);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_motion_short_of_the_teleport_distance_is_swept, sweep)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(working_out_gives_the_same_bits_for_threads_parts_and_order);
  RUN(a_run_continued_in_the_middle_of_it_gives_the_same_bits);
  RUN(cloth_in_which_a_box_appeared_comes_off_by_the_nearest_side);
  RUN(fingers_that_close_to_nothing_are_both_named_and_nothing_breaks);
  RUN(a_press_names_the_table_under_it_too);
  RUN(a_table_that_leaves_room_is_not_named);
  RUN(a_teleport_into_cloth_is_placed_and_settled_not_swept);
  RUN(a_motion_short_of_the_teleport_distance_is_swept);
  return failures > 0;
}
