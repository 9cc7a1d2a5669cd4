// The same input gives the same bits: for any number of threads and parts, on a backend that runs
// queued work in random order, after save and load, after reset, from a recording, and with
// somebody looking on. Nothing is compared with stored numbers; each run is held against the
// plainest one.
#include "scene.h"
#include "scene/folder.h"

#ifdef CLOTH_TEST_SHORT
enum { STEPS = 24, HALF = 11, N = 21 };
#else
enum { STEPS = 60, HALF = 31, N = 21 };
#endif

static sheet cloth;
static solid table, ball, finger;

typedef struct how {
  const char *precision, *backend, *devices, *threads;
  bool look;         // ask for everything that can be asked between steps
  bool no_cull;      // flat patches are searched like the rest
  bool close;        // close pairs are listed, however few candidates there are
  const char *slack; // pair_slack, m; NULL: the default
} how;

// a towel that is lifted by one corner, pulled by a finger at another, hit by a ball, in the wind,
// over a table on which it folds: every effect is active
static cloth_scene *scene_of(const how *h)
{
  sheet_make(&cloth, 0.4, 0.4, N, N);
  solid_box(&table, 1, 1, 0.1);
  solid_sphere(&ball, 0.06, 16, 9);
  solid_box(&finger, 0.02, 0.02, 0.06);
  cloth_def *def = def_new(h->precision);
  def_set(def, "backend", h->backend);
  def_set(def, "devices", h->devices);
  def_set(def, "threads", h->threads);
  if (h->slack) def_set(def, "pair_slack", h->slack);
  if (h->no_cull) def_set(def, "flat_culling", "off");
  if (h->close) def_set(def, "close_pairs_from", "1");
  def_set(def, "air_density", "1.2");
  def_set(def, "wind", "0.5 1 0");
  def_set(def, "gust", "0.5");
  def_set(def, "body_motion_max", "0.004"); // so that the finger and the ball cut steps
  cloth_material m = cloth_material_default();
  m.damping_mass = 0.1;
  def_cloth(def, "towel", &cloth, m, pose_turned(0, 0, 0.02, 2, 0.1));
  def_body(def, "table", &table, 0.5, pose_at(0, 0, -0.05));
  def_body(def, "ball", &ball, 0.3, pose_at(0.1, 0, 0.4));
  def_body(def, "finger", &finger, 0.8, pose_at(-0.18, -0.21, 0.06));
  return scene_new(def);
}

typedef struct script {
  cloth_grasp_id lift, pull;
  int64_t step;
} script;

static void look(cloth_scene *scene)
{
  static double x[3 * N * N];
  static cloth_body_pair pairs[5000];
  static cloth_contact_view contacts[5000];
  cloth_error err = {0};
  int count;
  scene_positions(scene, 0, x);
  scene_velocities(scene, 0, x);
  must(cloth_body_pairs(scene, 0.03, pairs, 5000, &count, &err), &err);
  must(cloth_contacts(scene, contacts, 5000, &count, &err), &err);
}

// one step of the script: what a robot does at that step
static cloth_step_report act(cloth_scene *scene, script *s, bool looking)
{
  cloth_error err = {0};
  static const int first[3] = {0, 1, N}, second[2] = {N - 1, N - 2};
  int n = (int)s->step++;
  if (n == 5) {
    cloth_grasp_view g = {.count = 3, .vertex = first, .body = -1, .frame = pose_at(-0.2, -0.2, 0)};
    must(cloth_grasp(scene, &g, &s->lift, &err), &err);
  }
  if (n == 10) {
    static const int ignore[1] = {2};
    cloth_grasp_view g = {.count = 2,
                          .vertex = second,
                          .body = 2,
                          .stiffness = 200,
                          .break_force = 50,
                          .ignore_count = 1,
                          .ignore_body = ignore};
    must(cloth_grasp(scene, &g, &s->pull, &err), &err);
  }
  if (n >= 5 && n < 45) {
    double t = (n - 5) / 40.0;
    cloth_pose p = pose_turned(-0.2 + 0.35 * t, -0.2 + 0.35 * t, 0.6 * t * (1 - t), 2, t);
    must(cloth_grasp_move(scene, s->lift, &p, &err), &err);
  }
  if (n == 45) must(cloth_grasp_release(scene, s->lift, &err), &err);
  cloth_pose b = pose_at(0.1 - 0.005 * n, 0, 0.4 - 0.006 * n);
  must(cloth_body_move(scene, 1, &b, &err), &err);
  cloth_pose f = pose_turned(-0.18 + 0.002 * n, -0.21, 0.06 + 0.001 * n, 0, 0.01 * n);
  must(cloth_body_move(scene, 2, &f, &err), &err);
  cloth_step_report r = {0};
  must(cloth_step(scene, 0, &r, &err), &err);
  if (looking) look(scene);
  return r;
}

// hashes after each step; the number of contacts of both kinds that were seen goes to *seen
static void run_steps(cloth_scene *scene, script *s, int from, int to, bool looking, uint64_t *hash,
                      int *seen)
{
  cloth_scene_hash_steps(scene, true);
  for (int n = from; n < to; n++) {
    cloth_step_report r = act(scene, s, looking);
    hash[n] = r.state_hash;
    if (seen) seen[0] += r.contacts_self, seen[1] += r.contacts_body, seen[2] += r.substeps > 1;
  }
}

static void run(const how *h, uint64_t hash[STEPS], int *seen)
{
  cloth_scene *scene = scene_of(h);
  script s = {0};
  run_steps(scene, &s, 0, STEPS, h->look, hash, seen);
  cloth_scene_free(scene);
}

// the plain run of a precision, computed once
static const uint64_t *reference(const char *precision, int *seen)
{
  static uint64_t hash[2][STEPS];
  static int contacts[2][3];
  static bool done[2];
  int p = precision[0] == 'f';
  how plain = {precision, "cpu", "cpu", "1", .look = false};
  if (!done[p]) run(&plain, hash[p], contacts[p]);
  done[p] = true;
  if (seen) memcpy(seen, contacts[p], sizeof contacts[p]);
  return hash[p];
}

static int compare(const char *precision, const how *h)
{
  uint64_t hash[STEPS];
  char what[128];
  run(h, hash, NULL);
  snprintf(what, sizeof what, "backend %s, devices %s, threads %s%s%s%s", h->backend, h->devices,
           h->threads, h->look ? ", looked at" : "", h->no_cull ? ", not culled" : "",
           h->close ? ", close pairs" : "");
  return same_hashes(STEPS, what, reference(precision, NULL), hash);
}

// ---- the sentences ------------------------------------------------------------------------------

static int scene_is_rich(const char *precision)
{
  int seen[3];
  const uint64_t *hash = reference(precision, seen);
  if (STEPS < 60) return 0;
  printf("  contacts: %d self, %d body; %d steps cut\n", seen[0], seen[1], seen[2]);
  CHECK(seen[0] > 0 && seen[1] > 1000 && seen[2] > 0); // self, body, steps that were cut
  for (int n = 1; n < STEPS; n++) CHECK(hash[n] != hash[n - 1]);
  return 0;
}
BOTH(the_scene_has_contact_of_both_kinds_and_cut_steps, scene_is_rich)

static int two_runs(const char *precision)
{
  how plain = {precision, "cpu", "cpu", "1", .look = false};
  return compare(precision, &plain);
}
BOTH(two_runs_give_the_same_bits, two_runs)

static int threads(const char *precision)
{
  static const char *const counts[] = {"2", "3", "4"};
  for (int i = 0; i < 3; i++) {
    how h = {precision, "cpu", "cpu", counts[i], .look = false};
    if (compare(precision, &h)) return 1;
  }
  return 0;
}
BOTH(any_number_of_threads_gives_the_same_bits, threads)

static int parts(const char *precision)
{
  static const char *const devices[] = {"cpu,cpu", "cpu,cpu,cpu", "cpu,cpu,cpu,cpu",
                                        "cpu,cpu,cpu,cpu,cpu,cpu,cpu,cpu,cpu"}; // more than chunks
  for (int i = 0; i < 4; i++) {
    how h = {precision, "cpu", devices[i], i == 2 ? "2" : "1", .look = false};
    if (compare(precision, &h)) return 1;
  }
  return 0;
}
BOTH(any_number_of_parts_gives_the_same_bits, parts)

static int shuffled(const char *precision)
{
  static const char *const devices[] = {"cpu", "cpu,cpu", "cpu,cpu,cpu", "cpu,cpu,cpu,cpu"};
  for (int i = 0; i < 4; i++) {
    how h = {precision, "shuffle", devices[i], "1", .look = false};
    if (compare(precision, &h)) return 1;
  }
  return 0;
}
BOTH(work_in_random_order_gives_the_same_bits, shuffled)

static int looking(const char *precision)
{
  how h = {precision, "cpu", "cpu,cpu", "1", .look = true};
  return compare(precision, &h);
}
BOTH(looking_at_the_scene_changes_no_bit, looking)

static int not_culled(const char *precision)
{
  how h = {precision, "cpu", "cpu", "1", .no_cull = true};
  return compare(precision, &h);
}
BOTH(culling_of_flat_patches_changes_no_bit, not_culled)

static int searched(const char *precision)
{
  static const char *const slack[] = {"0", "0.004"}; // the first: at every step
  for (int i = 0; i < 2; i++) {
    how h = {precision, "cpu", "cpu", "1", .slack = slack[i]};
    if (compare(precision, &h)) return 1;
  }
  return 0;
}
BOTH(when_pairs_are_searched_changes_no_bit, searched)

static int close_pairs(const char *precision)
{
  static const char *const devices[] = {"cpu", "cpu,cpu", "cpu,cpu,cpu"};
  for (int i = 0; i < 3; i++) {
    how h = {precision, i == 1 ? "shuffle" : "cpu", devices[i], i == 2 ? "2" : "1", .close = true};
    if (compare(precision, &h)) return 1;
  }
  return 0;
}
BOTH(lists_of_close_pairs_change_no_bit, close_pairs)

static int reset(const char *precision)
{
  uint64_t hash[STEPS];
  how plain = {precision, "cpu", "cpu", "1", .look = false};
  cloth_scene *scene = scene_of(&plain);
  cloth_error err = {0};
  script s = {0};
  run_steps(scene, &s, 0, HALF, false, hash, NULL);
  CHECK_OK(cloth_reset(scene, &err), err);
  s = (script){0};
  run_steps(scene, &s, 0, STEPS, false, hash, NULL);
  cloth_scene_free(scene);
  return same_hashes(STEPS, "after a reset", reference(precision, NULL), hash);
}
BOTH(a_run_after_a_reset_gives_the_bits_of_the_first, reset)

// save at half time; go on in another scene that was just built, and in one that was elsewhere
static int saved(const char *precision)
{
  uint64_t hash[STEPS];
  how plain = {precision, "cpu", "cpu", "1", .look = false},
      other = {precision, "cpu", "cpu,cpu", "2", .look = false};
  folder f = folder_make();
  const char *path = folder_path(&f, "state");
  cloth_error err = {0};
  script s = {0};
  cloth_scene *scene = scene_of(&plain);
  run_steps(scene, &s, 0, HALF, false, hash, NULL);
  must(cloth_state_save(scene, path, &err), &err);
  cloth_scene_free(scene);

  int failed = 0;
  for (int used = 0; used < 2 && !failed; used++) {
    scene = scene_of(&other);
    script elsewhere = {0}, on = s;
    uint64_t dump[STEPS];
    if (used) run_steps(scene, &elsewhere, 0, STEPS - 5, false, dump, NULL);
    must(cloth_state_load(scene, path, &err), &err);
    failed = scene_hash(scene) != hash[HALF - 1];
    run_steps(scene, &on, HALF, STEPS, false, hash, NULL);
    failed |= same_hashes(STEPS, used ? "loaded into a used scene" : "loaded",
                          reference(precision, NULL), hash);
    cloth_scene_free(scene);
  }
  folder_remove(&f);
  return failed;
}
BOTH(a_run_continued_from_a_file_gives_the_same_bits, saved)

// recorded on one part with one thread, replayed on others
static int replayed(const char *precision)
{
  how plain = {precision, "cpu", "cpu", "1", .look = false},
      other = {precision, "cpu", "cpu,cpu,cpu", "2", .look = false};
  folder f = folder_make();
  const char *path = folder_path(&f, "recording");
  cloth_error err = {0};
  script s = {0};
  uint64_t hash[STEPS];
  cloth_scene *scene = scene_of(&plain);
  must(cloth_record_start(scene, path, &err), &err);
  run_steps(scene, &s, 0, STEPS, false, hash, NULL);
  must(cloth_record_stop(scene, &err), &err);
  cloth_scene_free(scene);
  int failed = same_hashes(STEPS, "while recording", reference(precision, NULL), hash);

  int64_t steps = 0;
  scene = scene_of(&other);
  cloth_status status = cloth_replay(scene, path, &steps, &err);
  if (status != CLOTH_OK) printf("  replay: %s\n", err.text);
  failed |= status != CLOTH_OK || steps != STEPS || scene_hash(scene) != hash[STEPS - 1];
  cloth_scene_free(scene);
  folder_remove(&f);
  return failed;
}
BOTH(a_recording_replays_bit_for_bit, replayed)

// a GPU, its parts, and what they share with a CPU
static int on_gpu(const char *precision)
{
  static const char *const devices[] = {"0", "0,0", "0,0,0,0"};
  for (int i = 0; i < 3; i++) {
    how h = {precision, "cuda", devices[i], "1", .look = i == 1, .close = i > 0};
    if (compare(precision, &h)) return 1;
  }
  return 0;
}
BOTH(a_gpu_gives_the_bits_of_a_cpu_in_any_number_of_parts, on_gpu)

static int gpu_twice(const char *precision)
{
  uint64_t first[STEPS], second[STEPS];
  how h = {precision, "cuda", "0", "1", .look = false};
  run(&h, first, NULL), run(&h, second, NULL);
  return same_hashes(STEPS, "the second run", first, second);
}
BOTH(two_runs_on_a_gpu_give_the_same_bits, gpu_twice)

int main(int argc, char **argv)
{
  int failures = 0;
  bool gpu = cuda_is_there();
  RUN(the_scene_has_contact_of_both_kinds_and_cut_steps);
  RUN(two_runs_give_the_same_bits);
  RUN(any_number_of_threads_gives_the_same_bits);
  RUN(any_number_of_parts_gives_the_same_bits);
  RUN(work_in_random_order_gives_the_same_bits);
  RUN(looking_at_the_scene_changes_no_bit);
  RUN(culling_of_flat_patches_changes_no_bit);
  RUN(when_pairs_are_searched_changes_no_bit);
  RUN(lists_of_close_pairs_change_no_bit);
  RUN(a_run_after_a_reset_gives_the_bits_of_the_first);
  RUN(a_run_continued_from_a_file_gives_the_same_bits);
  RUN(a_recording_replays_bit_for_bit);
  RUN_ON(gpu, two_runs_on_a_gpu_give_the_same_bits);
  RUN_ON(gpu, a_gpu_gives_the_bits_of_a_cpu_in_any_number_of_parts);
  return failures > 0;
}
