// The parameter accuracy: what it holds is held against solutions of order two with forty equal
// substeps a step and systems solved to 1e-7, and against free fall.
#include "scene.h"
#include "scene/folder.h"

#include <string.h>

enum { MOST = 400 };
#define FACTOR 3 // that the true error may be of what was asked for (doc/budget.md)

typedef struct study {
  const char *file, *cloth; // of config/accuracy
  int steps, reference_substeps;
} study;

// Up to where the reference is sure: later the towel's folds are decided by less than 1 %.
static const study towel = {"hanging_towel", "towel", 32, 40};
static const study strip = {"cantilever", "strip", 32, 40};
static const study fold = {"fold", "towel", 84, 8};

static double reference[3 * MOST], x[3 * MOST];

// config/accuracy stands two folders above this file
static void path_of(const study *s, char *out, size_t size)
{
  const char *end = strstr(__FILE__, "test/engine/");
  snprintf(out, size, "%.*sconfig/accuracy/%s.yaml", (int)(end - __FILE__), __FILE__, s->file);
}

static cloth_scene *open(const study *s, double resolution, const char *const *set)
{
  char path[512];
  cloth_error err = {0};
  cloth_def *def;
  path_of(s, path, sizeof path);
  cloth_load_options options = {.resolution = resolution};
  must(cloth_def_load_with(path, &options, &def, &err), &err);
  for (; set[0]; set += 2) def_set(def, set[0], set[1]);
  return scene_new(def);
}

static void solve_reference(const study *s, double resolution)
{
  char substeps[16];
  snprintf(substeps, sizeof substeps, "%d", s->reference_substeps);
  const char *set[] = {"integrator",
                       "bdf2",
                       "substeps",
                       substeps,
                       "pcg_tolerance",
                       "1e-7",
                       "newton_tolerance",
                       "1e-4",
                       "newton_iterations_max",
                       "6",
                       NULL};
  cloth_scene *scene = open(s, resolution, set);
  scene_step(scene, s->steps);
  scene_positions(scene, 0, reference);
  cloth_scene_free(scene);
}

typedef struct outcome {
  double error, estimate; // shares of the size a second, of the whole run
  int64_t substeps;
} outcome;

static outcome run(const study *s, double resolution, const char *accuracy, const char *integrator)
{
  const char *set[] = {"accuracy", accuracy, "integrator", integrator, NULL};
  cloth_scene *scene = open(s, resolution, set);
  outcome o = {0};
  int n = cloth_vertex_count(scene, 0);
  double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9}, sum = 0, size_sq = 0;
  for (int i = 0; i < 3 * n; i++) {
    double rest = cloth_rest_positions(scene, 0)[i];
    low[i % 3] = fmin(low[i % 3], rest), high[i % 3] = fmax(high[i % 3], rest);
  }
  for (int k = 0; k < 3; k++) size_sq += (high[k] - low[k]) * (high[k] - low[k]);
  for (int i = 0; i < s->steps; i++) {
    cloth_step_report r = scene_step(scene, 1);
    o.estimate += r.accuracy_estimate / s->steps;
    o.substeps += r.substeps;
  }
  scene_positions(scene, 0, x);
  for (int i = 0; i < 3 * n; i++) sum += (x[i] - reference[i]) * (x[i] - reference[i]);
  o.error = sqrt(sum / n / size_sq) / cloth_time(scene);
  cloth_scene_free(scene);
  return o;
}

// the true error is within a factor of what was asked for, and falls with it
static int holds(const study *s, double resolution, const char *integrator,
                 const char *const *asked, int count)
{
  outcome last = {0};
  for (int i = 0; i < count; i++) {
    outcome o = run(s, resolution, asked[i], integrator);
    double share = atof(asked[i]) / 100;
    printf("     %s, %s: asked %s: %.3g %% a second, estimated %.3g %%, %d substeps\n", s->file,
           integrator, asked[i], 100 * o.error, 100 * o.estimate, (int)o.substeps);
    CHECK(o.error <= FACTOR * share);
    CHECK(o.estimate <= 1.2 * share);
    CHECK(i == 0 || o.error <= 0.7 * last.error);
    CHECK(i == 0 || 2 * o.substeps >= 3 * last.substeps);
    last = o;
  }
  return 0;
}

static const char *const all[] = {"5 %", "1 %", "0.2 %"};

static int a_swinging_towel_is_as_accurate_as_was_asked_for(void)
{
  solve_reference(&towel, 0);
  return holds(&towel, 0, "backward_euler", all, 2) || holds(&towel, 0, "bdf2", all, 3);
}

static int a_whipping_strip_is_as_accurate_as_was_asked_for(void)
{
  solve_reference(&strip, 0);
  return holds(&strip, 0, "backward_euler", all, 2) || holds(&strip, 0, "bdf2", all, 3);
}

static int a_fold_is_as_accurate_as_was_asked_for(void)
{
  solve_reference(&fold, 0.5);
  // where the end lands hangs on contact: no order, but within the bound
  return holds(&fold, 0.5, "backward_euler", all, 1) ||
         holds(&fold, 0.5, "backward_euler", all + 1, 1);
}

// ---- what can be said without a reference -------------------------------------------------------

static sheet cloth;
static solid ball;

static cloth_scene *on_ball(const char *precision, const char *const *set)
{
  cloth_def *def = def_new(precision);
  sheet_make(&cloth, 0.3, 0.3, 9, 9);
  solid_sphere(&ball, 0.1, 12, 7);
  def_set(def, "accuracy", "1 %");
  for (; set && set[0]; set += 2) def_set(def, set[0], set[1]);
  def_cloth(def, "towel", &cloth, cloth_material_default(), pose_at(0, 0, 0.15));
  def_body(def, "ball", &ball, 0.3, pose_at(0, 0, 0));
  return scene_new(def);
}

// x = g t^2 / 2; nothing but gravity acts, so that the step is a pass over the state, and with
// damping a solve
static int falls(const char *precision)
{
  static const char *const how[] = {"0", "0.001"};
  double size = 0.3 * sqrt(2), t = 0.2;
  for (int i = 0; i < 2; i++) {
    cloth_def *def = def_new(precision);
    cloth_material m = cloth_material_default();
    m.damping_stretch = atof(how[i]);
    sheet_make(&cloth, 0.3, 0.3, 9, 9);
    def_set(def, "accuracy", "1 %"), def_set(def, "effects.self_contact", "off");
    if (i == 0) def_set(def, "effects.membrane", "off"), def_set(def, "effects.bending", "off");
    def_cloth(def, "towel", &cloth, m, pose_at(0, 0, 0));
    cloth_scene *scene = scene_new(def);
    cloth_step_report r = scene_step(scene, 12);
    scene_positions(scene, 0, x);
    double off = fabs(x[2] + G * t * t / 2) / size / t, tol = 2e4 * epsilon_of(precision);
    CHECK(off <= 0.01 &&
          off > 0.005); // no more than was asked for, and no more work than that takes
    CHECK_NEAR(r.accuracy_estimate, off, tol);
    CHECK(r.accuracy_missed == 0 && r.substeps == r.accuracy_substeps);
    cloth_scene_free(scene);
  }
  return 0;
}
BOTH(a_fall_is_off_by_what_the_estimate_says_and_no_more_than_asked, falls)

static int same_bits(const char *precision)
{
  static const char *const others[][5] = {{"threads", "2", NULL},
                                          {"devices", "cpu,cpu,cpu", NULL},
                                          {"backend", "shuffle", "devices", "cpu,cpu", NULL}};
  static const char *const integrator[] = {"backward_euler", "bdf2"};
  for (int k = 0; k < 2; k++) {
    const char *plain[] = {"threads", "1", "integrator", integrator[k], NULL};
    cloth_scene *scene = on_ball(precision, plain);
    scene_step(scene, 20);
    uint64_t hash = scene_hash(scene);
    cloth_scene_free(scene);
    for (int i = 0; i < 3; i++) {
      const char *set[8] = {"integrator", integrator[k]};
      for (int j = 0; others[i][j]; j++) set[2 + j] = others[i][j];
      scene = on_ball(precision, set);
      scene_step(scene, 20);
      CHECK(scene_hash(scene) == hash);
      cloth_scene_free(scene);
    }
  }
  return 0;
}
BOTH(held_accuracy_gives_the_same_bits_for_threads_parts_and_order, same_bits)

static int continued(const char *precision)
{
  cloth_error err = {0};
  folder f = folder_make();
  const char *path = folder_path(&f, "state"), *record = folder_path(&f, "record");
  cloth_scene *scene = on_ball(precision, NULL);
  must(cloth_record_start(scene, record, &err), &err);
  scene_step(scene, 9);
  must(cloth_state_save(scene, path, &err), &err);
  scene_step(scene, 6);
  must(cloth_record_stop(scene, &err), &err);
  uint64_t hash = scene_hash(scene);
  cloth_scene_free(scene);
  scene = on_ball(precision, NULL);
  must(cloth_state_load(scene, path, &err), &err);
  scene_step(scene, 6);
  CHECK(scene_hash(scene) == hash);
  cloth_scene_free(scene);
  scene = on_ball(precision, NULL);
  int64_t steps;
  CHECK_OK(cloth_replay(scene, record, &steps, &err), err);
  CHECK(steps == 15 && scene_hash(scene) == hash);
  cloth_scene_free(scene);
  folder_remove(&f);
  return 0;
}
BOTH(a_run_continued_from_a_file_or_a_recording_chooses_the_same, continued)

// what hits makes velocities jump, which no step resolves: substeps stay within their bound, what
// was not held is told, and nothing passes
static int bounded(const char *precision)
{
  const char *set[] = {"accuracy", "0.001 %", NULL};
  cloth_scene *scene = on_ball(precision, set);
  for (int i = 1; i <= 8; i++) {
    cloth_step_report r = scene_step(scene, 1);
    CHECK(r.accuracy_substeps == 100 && r.substeps >= 100);
    CHECK(r.accuracy_estimate > 1e-5 && r.accuracy_missed == i);
    CHECK(r.tangles == 0 && r.impacts_left == 0);
  }
  cloth_scene_free(scene);
  scene = on_ball(precision, NULL);
  int touched = 0;
  for (int i = 0; i < 40; i++) {
    cloth_step_report r = scene_step(scene, 1);
    touched += r.contacts_body > 0;
    CHECK(r.tangles == 0 && r.impacts_left == 0 && r.substeps <= 200);
    CHECK(r.chosen_pcg_tolerance == 1e-3);
  }
  CHECK(touched > 10);
  cloth_scene_free(scene);
  return 0;
}
BOTH(what_cannot_be_held_is_bounded_and_told, bounded)

static int nothing_asked_chooses_nothing(void)
{
  const char *set[] = {"accuracy", "0", NULL};
  cloth_scene *scene = on_ball("double", set);
  cloth_step_report r = scene_step(scene, 3);
  CHECK(r.accuracy_substeps == 0 && r.accuracy_missed == 0 && r.accuracy_repeats == 0);
  CHECK(r.accuracy_estimate > 0 && r.substeps == 1 && r.chosen_pcg_tolerance == 0);
  cloth_scene_free(scene);
  return 0;
}

static int it_excludes_a_budget_and_springs(void)
{
  static const char *const other[][2] = {{"time_budget", "real_time"},
                                         {"integrator", "mass_spring"}};
  static const char *const named[] = {"time_budget = -1", "mass_spring has no estimate"};
  for (int i = 0; i < 2; i++) {
    cloth_error err = {0};
    cloth_scene *scene = NULL;
    cloth_def *def = def_new("double");
    sheet_make(&cloth, 0.3, 0.3, 9, 9);
    def_cloth(def, "towel", &cloth, cloth_material_default(), pose_at(0, 0, 0));
    def_set(def, "accuracy", "2 %"), def_set(def, other[i][0], other[i][1]);
    CHECK(cloth_scene_new(def, &scene, &err) != CLOTH_OK && scene == NULL);
    CHECK(strstr(err.text, "accuracy = 0.02") != NULL && strstr(err.text, named[i]) != NULL);
    cloth_def_free(def);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_swinging_towel_is_as_accurate_as_was_asked_for);
  RUN(a_whipping_strip_is_as_accurate_as_was_asked_for);
  RUN(a_fold_is_as_accurate_as_was_asked_for);
  RUN(a_fall_is_off_by_what_the_estimate_says_and_no_more_than_asked);
  RUN(held_accuracy_gives_the_same_bits_for_threads_parts_and_order);
  RUN(a_run_continued_from_a_file_or_a_recording_chooses_the_same);
  RUN(what_cannot_be_held_is_bounded_and_told);
  RUN(nothing_asked_chooses_nothing);
  RUN(it_excludes_a_budget_and_springs);
  return failures != 0;
}
