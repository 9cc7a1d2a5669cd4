// Bad input at the public interface: refused with a message that names value and range, and the
// running state is, bit for bit, what it was.
#include "scene.h"
#include "scene/folder.h"

enum { N = 9 };

static sheet cloth, other;
static solid body;

static cloth_scene *scene_of(const char *precision, const sheet *s)
{
  sheet_make(&cloth, 0.3, 0.3, N, N);
  solid_box(&body, 0.5, 0.5, 0.1);
  cloth_def *def = def_new(precision);
  def_body(def, "table", &body, 0.5, pose_at(0, 0, -0.06));
  def_cloth(def, "towel", s, cloth_material_default(), pose_at(0, 0, 0));
  return scene_new(def);
}

// the call was refused, its message holds every one of the words, and nothing changed
static int refused(cloth_scene *scene, uint64_t before, cloth_status expected, cloth_status got,
                   const cloth_error *err, const char *const words[4])
{
  if (got != expected) printf("  status %d instead of %d: %s\n", got, expected, err->text);
  CHECK(got == expected && err->status == expected);
  for (int i = 0; i < 4 && words[i]; i++) {
    if (!strstr(err->text, words[i])) printf("  '%s' is not in '%s'\n", words[i], err->text);
    CHECK(strstr(err->text, words[i]));
  }
  CHECK(scene_hash(scene) == before);
  return 0;
}

// clang-format off
#define WORDS(...) ((const char *const[4]){__VA_ARGS__})
// clang-format on
#define REFUSED(status, call, ...)                                                                 \
  do {                                                                                             \
    cloth_error err = {0};                                                                         \
    cloth_status got_ = (call);                                                                    \
    if (refused(scene, before, status, got_, &err, WORDS(__VA_ARGS__))) {                          \
      printf("%s:%d: %s\n", __FILE__, __LINE__, #call);                                            \
      return 1;                                                                                    \
    }                                                                                              \
  } while (0)

static int arguments(const char *precision)
{
  cloth_scene *scene = scene_of(precision, &cloth);
  scene_step(scene, 5);
  uint64_t before = scene_hash(scene);
  static double buffer[3 * N * N];
  scene_positions(scene, 0, buffer);
  cloth_pose bad = pose_at(0, NAN, 0), zero = {{0, 0, 0}, {0, 0, 0, 0}};
  cloth_pose nan_turn = {{0, 0, 0}, {0, NAN, 0, 1}}, good = cloth_pose_identity();
  cloth_effect_info info;
  int count;

  REFUSED(CLOTH_BAD_ARGUMENT, cloth_step(scene, 1e-6, NULL, &err), "1e-06", "s", "[1e-05, 0.1]");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_step(scene, 0.2, NULL, &err), "0.2", "[1e-05, 0.1]");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_step(scene, NAN, NULL, &err), "nan", "[1e-05, 0.1]");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_step(scene, -1, NULL, &err), "-1", "[1e-05, 0.1]");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_positions(scene, 1, buffer, N * N, &err), "cloth 1", "[0, 1)");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_positions(scene, 0, buffer, 80, &err), "81", "80");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_velocities(scene, -1, buffer, N * N, &err), "-1", "[0, 1)");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_positions(scene, 0, NULL, N * N, &err), "81");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_body_move(scene, 3, &good, &err), "body 3", "[0, 1)");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_body_move(scene, 0, &bad, &err), "nan", "[-1e6, 1e6]");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_body_move(scene, 0, NULL, &err), "pose");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_body_place(scene, 0, &zero, &err), "quaternion");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_body_place(scene, 0, &nan_turn, &err), "quaternion", "nan");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_body_pairs(scene, 0.2, NULL, 0, &count, &err), "0.2",
          "[0, 0.1]");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_body_pairs(scene, NAN, NULL, 0, &count, &err), "nan");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_effect_describe(scene, 99, &info, &err), "99");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_state_set(scene, 0, NULL, NULL, N * N, &err), "81");

  buffer[3 * 7 + 1] = NAN;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_state_set(scene, 0, buffer, NULL, N * N, &err), "vertex 7",
          "nan");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_state_set(scene, 0, NULL, buffer, N * N, &err), "vertex 7",
          "nan");
  buffer[3 * 7 + 1] = 200; // bounds: 100 m
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_state_set(scene, 0, buffer, NULL, N * N, &err), "vertex 7",
          "200", "[-100, 100]");
  // the scene goes on as if nothing had been
  cloth_scene *twin = scene_of(precision, &cloth);
  scene_step(twin, 8), scene_step(scene, 3);
  CHECK(scene_hash(twin) == scene_hash(scene));
  cloth_scene_free(twin), cloth_scene_free(scene);
  return 0;
}
BOTH(an_argument_out_of_range_is_refused_with_value_and_range, arguments)

static int grasps(const char *precision)
{
  cloth_scene *scene = scene_of(precision, &cloth);
  scene_step(scene, 2);
  uint64_t before = scene_hash(scene);
  static const int corner[2] = {0, 1}, twice[2] = {5, 5}, beyond[2] = {5, 81}, below[1] = {-1};
  static const int no_body[1] = {4};
  cloth_grasp_id id, held;
  cloth_grasp_view good = {.count = 2, .vertex = corner, .body = -1, .frame = pose_at(0, 0, 0)};
  cloth_error none = {0};
  CHECK_OK(cloth_grasp(scene, &good, &held, &none), none);

  cloth_grasp_view g = good;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "vertex 0", "held already");
  CHECK(id.index1 == 0);
  g = good, g.vertex = twice;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "vertex 5", "twice");
  g = good, g.vertex = beyond;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "81", "[0, 81)");
  g = good, g.vertex = below, g.count = 1;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "-1", "[0, 81)");
  g = good, g.count = 0;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "no vertices");
  g = good, g.vertex = beyond, g.count = 1, g.cloth = 2;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "cloth 2", "[0, 1)");
  g = good, g.vertex = beyond, g.count = 1, g.body = 1;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "body 1", "[0, 1)");
  g = good, g.vertex = beyond, g.count = 1, g.stiffness = -1;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "-1", "N/m");
  g = good, g.vertex = beyond, g.count = 1, g.break_force = NAN;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "nan", "N");
  g = good, g.vertex = beyond, g.count = 1, g.frame.position[2] = INFINITY;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "inf");
  g = good, g.vertex = beyond, g.count = 1, g.ignore_count = 1, g.ignore_body = no_body;
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp(scene, &g, &id, &err), "body 4");

  // a handle outlives its grasp and never names another
  double force[3], torque[3];
  cloth_pose pose = cloth_pose_identity();
  CHECK(cloth_grasp_alive(scene, held));
  CHECK_OK(cloth_grasp_release(scene, held, &none), none);
  CHECK(!cloth_grasp_alive(scene, held));
  CHECK_OK(cloth_grasp(scene, &good, &id, &none), none);
  CHECK(!cloth_grasp_alive(scene, held) && cloth_grasp_alive(scene, id));
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp_release(scene, held, &err), "does not hold");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp_move(scene, held, &pose, &err), "does not hold");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp_wrench(scene, held, force, torque, &err),
          "does not hold");
  cloth_grasp_id nothing = {0, 0}, wild = {1000, 1};
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp_release(scene, nothing, &err), "does not hold");
  REFUSED(CLOTH_BAD_ARGUMENT, cloth_grasp_release(scene, wild, &err), "does not hold");
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_bad_grasp_is_refused_and_names_its_fault, grasps)

// a triangle with edges of `edge` [m] among larger ones, `far` [m] from the origin
static cloth_status new_with_edge(const char *precision, double edge, double far, cloth_error *err)
{
  const double x[] = {-0.05, -0.05, 0, 0.05, -0.05, 0, edge, 0, 0, 0, edge, 0, 0, 0, 0};
  const int t[] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 0, 4, 3};
  cloth_scene *scene = NULL;
  cloth_def *def = def_new(precision);
  def_set(def, "bounds", "10000");
  cloth_cloth_view v = {.name = "towel",
                        .mesh = {5, 4, x, t, NULL},
                        .material = cloth_material_default(),
                        .pose = pose_at(far, 0, 0)};
  must(cloth_def_add_cloth(def, &v, NULL, err), err);
  cloth_status status = cloth_scene_new(def, &scene, err);
  cloth_scene_free(scene);
  cloth_def_free(def);
  return status;
}

static int short_edges(const char *precision)
{
  bool is_float = strcmp(precision, "float") == 0;
  static const struct {
    double edge, far;
    bool is_float, is_double; // taken
  } at[] = {{1e-6, 1, 1, 1}, {1e-7, 1, 0, 1}, {1e-8, 1, 0, 1}, {1e-9, 1, 0, 0}, {1e-4, 1000, 0, 1}};
  for (int i = 0; i < 5; i++) {
    cloth_error err = {0};
    bool taken = new_with_edge(precision, at[i].edge, at[i].far, &err) == CLOTH_OK;
    CHECK(taken == (is_float ? at[i].is_float : at[i].is_double));
    if (taken) continue;
    CHECK(strstr(err.text, "'towel': the edge of vertices"));
    CHECK(strstr(err.text, precision) && strstr(err.text, " m from the origin"));
    CHECK((strstr(err.text, "precision: double holds it") != NULL) == at[i].is_double);
  }
  return 0;
}
BOTH(edges_below_what_the_precision_holds_are_refused, short_edges)

static int descriptions(const char *precision)
{
  cloth_error err = {0};
  cloth_scene *scene = NULL;
  cloth_def *def = def_new(precision);
  CHECK(cloth_scene_new(def, &scene, &err) == CLOTH_BAD_SCENE && scene == NULL);
  CHECK(strstr(err.text, "no cloth"));
  sheet_make(&cloth, 0.3, 0.3, N, N);
  def_cloth(def, "towel", &cloth, cloth_material_default(), pose_at(0, 0, 0));

  err = (cloth_error){0};
  cloth_def_params(def)->thickness = 7;
  CHECK(cloth_scene_new(def, &scene, &err) == CLOTH_BAD_ARGUMENT && scene == NULL);
  CHECK(strstr(err.text, "thickness = 7 [m] is not in [1e-05, 0.05]"));
  cloth_def_params(def)->thickness = 3e-3;

  // an effect that is not known, and one that has nothing to act on
  err = (cloth_error){0};
  cloth_status status = cloth_def_set(def, "effects.gravitiy", "on", &err);
  if (status == CLOTH_OK) status = cloth_scene_new(def, &scene, &err);
  CHECK(status > 0 && scene == NULL);
  CHECK(strstr(err.text, "gravitiy") && strstr(err.text, "gravity"));
  cloth_def_free(def);

  def = def_new(precision);
  def_cloth(def, "towel", &cloth, cloth_material_default(), pose_at(0, 0, 0));
  def_set(def, "effects.air", "on"); // but air_density is 0
  err = (cloth_error){0};
  CHECK(cloth_scene_new(def, &scene, &err) == CLOTH_BAD_SCENE && scene == NULL);
  CHECK(strstr(err.text, "air") && strstr(err.text, "air_density = 0"));
  cloth_def_free(def);
  return 0;
}
BOTH(a_description_that_cannot_be_built_says_why, descriptions)

static int write_cut(const char *from, const char *to, long cut, int flip)
{
  static unsigned char data[200000];
  FILE *f = fopen(from, "rb");
  CHECK(f != NULL);
  size_t n = fread(data, 1, sizeof data, f);
  fclose(f);
  CHECK(n > 100 && n < sizeof data);
  size_t keep = cut < 0 ? n - (size_t)(-cut) : (size_t)cut;
  if (cut == 0) keep = n;
  if (flip >= 0) data[(size_t)flip % n] ^= 1;
  f = fopen(to, "wb");
  CHECK(f != NULL && fwrite(data, 1, keep, f) == keep);
  fclose(f);
  return 0;
}

static int states(const char *precision)
{
  folder f = folder_make();
  const char *good = folder_path(&f, "good"), *bad = folder_path(&f, "bad");
  const char *missing = folder_path(&f, "missing"), *strange = folder_path(&f, "strange");
  cloth_error none = {0};
  cloth_scene *scene = scene_of(precision, &cloth);
  static const int corner[2] = {0, 1};
  scene_step(scene, 3);
  scene_hold(scene, 0, corner, 2, cloth_pose_identity());
  must(cloth_state_save(scene, good, &none), &none);
  scene_step(scene, 4);
  uint64_t before = scene_hash(scene);

  static const long cuts[] = {1, 7, 50, 100, 1000, -1, -8, -200};
  for (int i = 0; i < 8; i++) {
    if (write_cut(good, bad, cuts[i], -1)) return 1;
    REFUSED(CLOTH_BAD_STATE, cloth_state_load(scene, bad, &err), bad);
  }
  for (int at = 0; at < 20000; at += 997) { // one bit is wrong
    if (write_cut(good, bad, 0, at)) return 1;
    REFUSED(CLOTH_BAD_STATE, cloth_state_load(scene, bad, &err), bad);
  }
  folder_write(&f, "strange", "");
  REFUSED(CLOTH_BAD_STATE, cloth_state_load(scene, strange, &err), strange);
  folder_write(&f, "strange", "steps: 100\nthis is no state file, it is a text of some length\n");
  REFUSED(CLOTH_BAD_STATE, cloth_state_load(scene, strange, &err), strange);
  REFUSED(CLOTH_IO, cloth_state_load(scene, missing, &err), missing);
  REFUSED(CLOTH_IO, cloth_state_save(scene, "/no/such/folder/state", &err),
          "/no/such/folder/state");

  // of another precision, and of another mesh with as many vertices
  const char *opposite = precision[0] == 'f' ? "double" : "float";
  cloth_scene *strange_scene = scene_of(opposite, &cloth);
  must(cloth_state_save(strange_scene, bad, &none), &none);
  cloth_scene_free(strange_scene);
  REFUSED(CLOTH_BAD_STATE, cloth_state_load(scene, bad, &err), "float", "double");
  sheet_make(&other, 0.3, 0.31, N, N);
  strange_scene = scene_of(precision, &other);
  must(cloth_state_save(strange_scene, bad, &none), &none);
  cloth_scene_free(strange_scene);
  REFUSED(CLOTH_BAD_STATE, cloth_state_load(scene, bad, &err), "another");

  // and after all that it goes on like a twin to which nothing was done
  cloth_scene *twin = scene_of(precision, &cloth);
  scene_step(twin, 3);
  scene_hold(twin, 0, corner, 2, cloth_pose_identity());
  scene_step(twin, 10), scene_step(scene, 6);
  CHECK(scene_hash(twin) == scene_hash(scene));
  cloth_scene_free(twin), cloth_scene_free(scene);
  folder_remove(&f);
  return 0;
}
BOTH(a_state_file_that_does_not_belong_is_refused_and_the_scene_goes_on, states)

static int explosion(const char *precision)
{
  static double v[3 * N * N];
  cloth_scene *scene = scene_of(precision, &cloth);
  cloth_error none = {0};
  scene_step(scene, 2);
  scene_velocities(scene, 0, v);
  for (int i = 0; i < N * N; i++) v[3 * i + 2] = 9999; // leaves the bounds of 100 m within a step
  must(cloth_state_set(scene, 0, NULL, v, N * N, &none), &none);
  uint64_t before = scene_hash(scene);
  double time = cloth_time(scene);
  REFUSED(CLOTH_UNSTABLE, cloth_step(scene, 0.1, NULL, &err), "100 m");
  REFUSED(CLOTH_UNSTABLE, cloth_step(scene, 0.1, NULL, &err), "100 m"); // and again the same
  CHECK(cloth_time(scene) == time);
  // brought back, it steps again
  memset(v, 0, sizeof v);
  must(cloth_state_set(scene, 0, NULL, v, N * N, &none), &none);
  cloth_step_report r = scene_step(scene, 5);
  CHECK(r.speed_max < 10);
  cloth_scene_free(scene);
  return 0;
}
BOTH(an_explosion_is_reported_and_the_state_is_that_of_before, explosion)

int main(int argc, char **argv)
{
  int failures = 0;
  sheet_make(&cloth, 0.3, 0.3, N, N);
  RUN(an_argument_out_of_range_is_refused_with_value_and_range);
  RUN(a_bad_grasp_is_refused_and_names_its_fault);
  RUN(edges_below_what_the_precision_holds_are_refused);
  RUN(a_description_that_cannot_be_built_says_why);
  RUN(a_state_file_that_does_not_belong_is_refused_and_the_scene_goes_on);
  RUN(an_explosion_is_reported_and_the_state_is_that_of_before);
  return failures > 0;
}
