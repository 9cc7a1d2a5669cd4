// Recordings of every kind of call, played against fresh scenes. The oracle is the state hash that
// the recorded scene itself wrote after each step.
#include "check.h"
#include "cloth.h"

#include <errno.h>
#include <locale.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIDE = 6, VERTICES = SIDE * SIDE, TRIANGLES = 2 * (SIDE - 1) * (SIDE - 1) };

static char folder[64] = "cloth_test_record_XXXXXX"; // in the working directory

static const char *path_of(const char *name)
{
  static char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

// a napkin of 10 cm over a triangle that a body carries
static cloth_scene *scene_new(const char *precision, const char *thickness)
{
  double x[3 * VERTICES];
  int t[3 * TRIANGLES], n = 0;
  for (int j = 0; j < SIDE; j++)
    for (int i = 0; i < SIDE; i++) {
      double *p = x + 3 * (j * SIDE + i);
      p[0] = 0.02 * i, p[1] = 0.02 * j, p[2] = 0;
    }
  for (int j = 0; j + 1 < SIDE; j++)
    for (int i = 0; i + 1 < SIDE; i++) {
      int v = j * SIDE + i, corner[6] = {v, v + 1, v + SIDE + 1, v, v + SIDE + 1, v + SIDE};
      for (int k = 0; k < 6; k++) t[n++] = corner[k];
    }
  static const double body_x[9] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0};
  static const int body_t[3] = {0, 1, 2};
  cloth_cloth_view cloth = {.name = "napkin",
                            .mesh = {VERTICES, TRIANGLES, x, t, NULL},
                            .material = cloth_material_default(),
                            .pose = cloth_pose_identity()};
  cloth_body_view body = {.name = "hand",
                          .mesh = {3, 1, body_x, body_t, NULL},
                          .pose = cloth_pose_identity(),
                          .friction = 0.3};
  body.pose.position[2] = -0.05;

  cloth_def *def = NULL;
  cloth_scene *scene = NULL;
  cloth_error err = {0};
  if (cloth_def_new(&def, &err) != CLOTH_OK ||
      cloth_def_set(def, "precision", precision, &err) != CLOTH_OK ||
      cloth_def_set(def, "thickness", thickness, &err) != CLOTH_OK ||
      cloth_def_add_cloth(def, &cloth, NULL, &err) != CLOTH_OK ||
      cloth_def_add_body(def, &body, NULL, &err) != CLOTH_OK ||
      cloth_scene_new(def, &scene, &err) != CLOTH_OK) {
    printf("  no scene: %s\n", err.text);
    exit(1);
  }
  cloth_def_free(def);
  return scene;
}

static int steps(cloth_scene *scene, int count)
{
  cloth_error err = {0};
  for (int i = 0; i < count; i++) CHECK_OK(cloth_step(scene, 0, NULL, &err), err);
  return 0;
}

static void normalise(const double q[4], double out[4])
{
  double norm = 0;
  for (int k = 0; k < 4; k++) norm += q[k] * q[k];
  for (int k = 0; k < 4; k++) out[k] = q[k] / sqrt(norm);
}

// A quaternion that changes when it is normalised a second time: a recording that held what the
// engine made of it would play something else.
static cloth_pose delicate_pose(void)
{
  cloth_pose pose = {{0.001, 1.0 / 3, -0.05}, {0.1, 0.2, 0.3, 0.7}};
  for (int i = 0; i < 1000; i++) {
    double once[4], twice[4];
    pose.rotation[0] = 0.1 + 0.001 * i;
    normalise(pose.rotation, once);
    normalise(once, twice);
    if (memcmp(once, twice, sizeof once) != 0) return pose;
  }
  printf("  no delicate quaternion found\n");
  exit(1);
}

// every call that changes a scene, once at least
static int do_everything(cloth_scene *scene)
{
  cloth_error err = {0};
  cloth_pose pose = delicate_pose();
  CHECK_OK(cloth_body_place(scene, 0, &pose, &err), err);
  if (steps(scene, 1)) return 1;
  pose.position[0] += 1e-3 / 3;
  CHECK_OK(cloth_body_move(scene, 0, &pose, &err), err);
  if (steps(scene, 1)) return 1;

  int corner[2] = {0, 1}, ignore[1] = {0};
  cloth_grasp_view grasp = {.cloth = 0, .count = 2, .vertex = corner, .body = -1, .frame = pose};
  cloth_grasp_view on_body = {.cloth = 0,
                              .count = 1,
                              .vertex = corner + 1,
                              .body = 0,
                              .stiffness = 100,
                              .break_force = 50,
                              .ignore_count = 1,
                              .ignore_body = ignore};
  grasp.count = 1;
  cloth_grasp_id id, id_body;
  CHECK_OK(cloth_grasp(scene, &grasp, &id, &err), err);
  CHECK_OK(cloth_grasp(scene, &on_body, &id_body, &err), err);
  pose.rotation[1] += 0.01 / 3;
  CHECK_OK(cloth_grasp_move(scene, id, &pose, &err), err);
  if (steps(scene, 2)) return 1;
  CHECK_OK(cloth_grasp_release(scene, id, &err), err);
  CHECK(cloth_grasp_release(scene, id, &err) == CLOTH_BAD_ARGUMENT); // refused: not recorded
  err.status = CLOTH_OK;
  CHECK_OK(cloth_step(scene, 0.01, NULL, &err), err);

  double x[3 * VERTICES], v[3 * VERTICES];
  CHECK_OK(cloth_positions(scene, 0, x, VERTICES, &err), err);
  for (int i = 0; i < 3 * VERTICES; i++) x[i] += 1e-4 / (i + 3), v[i] = 0.1 / (i + 7);
  CHECK_OK(cloth_state_set(scene, 0, x, v, VERTICES, &err), err);
  if (steps(scene, 1)) return 1;
  CHECK_OK(cloth_state_set(scene, 0, NULL, v, VERTICES, &err), err);
  return steps(scene, 1);
}

static int every_call_is_replayed_bit_for_bit(void)
{
  static const char *const precision[2] = {"double", "float"};
  for (int k = 0; k < 2; k++) {
    cloth_error err = {0};
    int64_t matched;
    cloth_scene *scene = scene_new(precision[k], "0.003");
    CHECK_OK(cloth_record_start(scene, path_of("all.txt"), &err), err);
    CHECK(cloth_record_start(scene, path_of("b.txt"), &err) == CLOTH_BAD_ARGUMENT); // one at a time
    err.status = CLOTH_OK;
    if (do_everything(scene)) return 1;
    CHECK_OK(cloth_reset(scene, &err), err);
    if (do_everything(scene)) return 1;
    CHECK_OK(cloth_record_stop(scene, &err), err);
    cloth_scene_free(scene);

    scene = scene_new(precision[k], "0.003");
    CHECK_OK(cloth_replay(scene, path_of("all.txt"), &matched, &err), err);
    CHECK(matched == 14);
    cloth_scene_free(scene);
  }
  return 0;
}

static int a_recording_from_the_middle_brings_its_state(void)
{
  cloth_error err = {0};
  int64_t matched;
  cloth_scene *scene = scene_new("double", "0.003");
  if (do_everything(scene)) return 1;
  CHECK_OK(cloth_record_start(scene, path_of("middle.txt"), &err), err);
  if (steps(scene, 3)) return 1;
  CHECK_OK(cloth_state_save(scene, path_of("saved"), &err), err);
  if (steps(scene, 1)) return 1;
  CHECK_OK(cloth_state_load(scene, path_of("saved"), &err), err);
  if (steps(scene, 2)) return 1;
  CHECK_OK(cloth_record_stop(scene, &err), err);
  cloth_scene_free(scene);
  remove(path_of("saved")); // the recording has its own copy

  scene = scene_new("double", "0.003");
  CHECK_OK(cloth_replay(scene, path_of("middle.txt"), &matched, &err), err);
  CHECK(matched == 6);
  cloth_scene_free(scene);
  return 0;
}

// handles of a scene that was reset count on; those of a fresh scene begin anew
static int a_recording_after_a_reset_finds_its_grasps(void)
{
  cloth_error err = {0};
  int64_t matched;
  cloth_scene *scene = scene_new("double", "0.003");
  if (do_everything(scene)) return 1;
  CHECK_OK(cloth_reset(scene, &err), err);
  CHECK_OK(cloth_record_start(scene, path_of("reset.txt"), &err), err);
  if (do_everything(scene)) return 1;
  CHECK_OK(cloth_record_stop(scene, &err), err);
  cloth_scene_free(scene);

  scene = scene_new("double", "0.003");
  CHECK_OK(cloth_replay(scene, path_of("reset.txt"), &matched, &err), err);
  CHECK(matched == 7);
  cloth_scene_free(scene);
  return 0;
}

static int a_recording_of_another_scene_is_refused_and_says_why(void)
{
  cloth_error err = {0};
  int64_t matched;
  cloth_scene *scene = scene_new("double", "0.003");
  CHECK_OK(cloth_record_start(scene, path_of("one.txt"), &err), err);
  if (steps(scene, 2)) return 1;
  CHECK_OK(cloth_record_stop(scene, &err), err);

  // not fresh any more
  CHECK(cloth_replay(scene, path_of("one.txt"), &matched, &err) == CLOTH_BAD_STATE);
  CHECK(strstr(err.text, "fresh") && matched == 0);
  cloth_scene_free(scene);

  err.status = CLOTH_OK;
  scene = scene_new("float", "0.003");
  CHECK(cloth_replay(scene, path_of("one.txt"), &matched, &err) == CLOTH_BAD_STATE);
  CHECK(strstr(err.text, "precision") && strstr(err.text, "float"));
  cloth_scene_free(scene);

  err.status = CLOTH_OK;
  scene = scene_new("double", "0.004");
  CHECK(cloth_replay(scene, path_of("one.txt"), NULL, &err) == CLOTH_BAD_STATE);
  CHECK(strstr(err.text, "thickness") && strstr(err.text, "0.003 m") &&
        strstr(err.text, "0.004 m"));
  cloth_scene_free(scene);
  return 0;
}

static int a_recording_that_cannot_be_written_leaves_nothing(void)
{
  cloth_error err = {0};
  cloth_scene *scene = scene_new("double", "0.003");
  CHECK(cloth_record_start(scene, path_of("none/r.txt"), &err) == CLOTH_IO);
  CHECK(strstr(err.text, "none/r.txt"));
  CHECK(access(path_of("none"), F_OK) != 0);
  err.status = CLOTH_OK;
  CHECK_OK(cloth_record_stop(scene, &err), err); // nothing to stop is no error
  cloth_scene_free(scene);
  return 0;
}

static int a_decimal_comma_changes_nothing(void)
{
  static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "C", NULL};
  cloth_error err = {0};
  int64_t matched;
  for (int i = 0; names[i] && !setlocale(LC_ALL, names[i]); i++) continue;
  if (strcmp(localeconv()->decimal_point, ",") != 0)
    printf("  no locale with a decimal comma is installed; tested with a point\n");
  cloth_scene *scene = scene_new("double", "0.003");
  CHECK_OK(cloth_record_start(scene, path_of("comma.txt"), &err), err);
  if (do_everything(scene)) return 1;
  CHECK_OK(cloth_record_stop(scene, &err), err);
  cloth_scene_free(scene);
  setlocale(LC_ALL, "C");

  scene = scene_new("double", "0.003");
  CHECK_OK(cloth_replay(scene, path_of("comma.txt"), &matched, &err), err);
  CHECK(matched == 7);
  cloth_scene_free(scene);
  return 0;
}

int main(int argc, char **argv)
{
  static const char *const made[] = {
      "all.txt",   "middle.txt", "middle.txt.state", "middle.txt.state.1",
      "reset.txt", "one.txt",    "comma.txt",        "saved",
      NULL};
  int failures = 0;
  if (!mkdtemp(folder)) {
    printf("cannot make a folder for the recordings: %s\n", strerror(errno));
    return 1;
  }
  RUN(every_call_is_replayed_bit_for_bit);
  RUN(a_recording_from_the_middle_brings_its_state);
  RUN(a_recording_after_a_reset_finds_its_grasps);
  RUN(a_recording_of_another_scene_is_refused_and_says_why);
  RUN(a_recording_that_cannot_be_written_leaves_nothing);
  RUN(a_decimal_comma_changes_nothing);
  for (int i = 0; made[i]; i++) remove(path_of(made[i]));
  rmdir(folder);
  return failures;
}
