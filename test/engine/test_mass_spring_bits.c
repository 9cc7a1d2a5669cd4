// The mass-spring cloth gives the same bits for any number of threads and parts, in random order,
// with bins and with all pairs, after save and load, after reset and from a recording. Each run is
// held against the plainest one.
#include "scene.h"
#include "scene/folder.h"

#ifdef CLOTH_TEST_SHORT
enum { STEPS = 12, HALF = 5, N = 19 };
#else
enum { STEPS = 24, HALF = 11, N = 19 };
#endif

static sheet cloth;
static solid solids;

typedef struct how {
  const char *precision, *backend, *devices, *threads, *search;
} how;

static void add_shape(cloth_def *def, const char *name, cloth_shape shape, double a, double b,
                      double c, cloth_pose pose)
{
  cloth_error err = {0};
  solid_box(&solids, 0.1, 0.1, 0.1);
  cloth_body_view view = {.name = name,
                          .mesh = solid_view(&solids),
                          .pose = pose,
                          .friction = 0.4,
                          .shape = shape,
                          .size = {a, b, c}};
  must(cloth_def_add_body(def, &view, NULL, &err), &err);
}

// a net that falls over a moving ball, a box and a floor in gusts, held at two places for a while
static cloth_scene *scene_of(const how *h)
{
  sheet_make(&cloth, 0.36, 0.36, N, N);
  cloth_def *def = def_new(h->precision);
  def_set(def, "integrator", "mass_spring");
  def_set(def, "backend", h->backend);
  def_set(def, "devices", h->devices);
  def_set(def, "threads", h->threads);
  def_set(def, "particle_search", h->search);
  def_set(def, "time_step", "0.0333333");
  def_set(def, "air_density", "1.2");
  def_set(def, "wind", "0.5 1 0");
  def_set(def, "gust", "0.5");
  cloth_material m = cloth_material_default();
  m.density = 1, m.stretch_warp = m.stretch_weft = 50, m.shear = 10;
  m.bend_warp = m.bend_weft = 1e-6, m.damping_stretch = m.damping_bend = 2e-4;
  m.damping_mass = 0.1;
  def_cloth(def, "net", &cloth, m, pose_turned(0, 0, 0.2, 2, 0.1));
  add_shape(def, "floor", CLOTH_SHAPE_PLANE, 0, 0, 0, cloth_pose_identity());
  add_shape(def, "ball", CLOTH_SHAPE_SPHERE, 0.06, 0, 0, pose_at(0.05, 0, 0.07));
  add_shape(def, "box", CLOTH_SHAPE_BOX, 0.1, 0.1, 0.1, pose_at(-0.1, 0.05, 0.05));
  add_shape(def, "rod", CLOTH_SHAPE_CYLINDER, 0.02, 0.3, 0, pose_turned(0, -0.1, 0.1, 0, 1.5));
  return scene_new(def);
}

typedef struct script {
  cloth_grasp_id lift, pull;
  int step;
} script;

static cloth_step_report act(cloth_scene *scene, script *s)
{
  cloth_error err = {0};
  static const int first[3] = {0, 1, N}, second[2] = {N - 1, N - 2};
  int n = s->step++;
  if (n == 2) {
    cloth_grasp_view g = {.count = 3, .vertex = first, .body = -1, .frame = pose_at(-0.2, -0.2, 0)};
    must(cloth_grasp(scene, &g, &s->lift, &err), &err);
  }
  if (n == 3) {
    cloth_grasp_view g = {
        .count = 2, .vertex = second, .body = 1, .stiffness = 20, .break_force = 5};
    must(cloth_grasp(scene, &g, &s->pull, &err), &err);
  }
  if (n >= 2 && n < 18) {
    double t = (n - 2) / 16.0;
    cloth_pose p = pose_turned(-0.2 + 0.3 * t, -0.2 + 0.3 * t, 0.3 * t * (1 - t), 2, t);
    must(cloth_grasp_move(scene, s->lift, &p, &err), &err);
  }
  if (n == 18) must(cloth_grasp_release(scene, s->lift, &err), &err);
  cloth_pose ball = pose_at(0.05 + 0.003 * n, 0, 0.07 + 0.002 * n);
  must(cloth_body_move(scene, 1, &ball, &err), &err);
  cloth_step_report r = {0};
  must(cloth_step(scene, 0, &r, &err), &err);
  return r;
}

static void run_steps(cloth_scene *scene, script *s, int from, int to, uint64_t *hash, int *seen)
{
  cloth_scene_hash_steps(scene, true);
  for (int n = from; n < to; n++) {
    cloth_step_report r = act(scene, s);
    hash[n] = r.state_hash;
    if (seen) seen[0] += r.contacts_self, seen[1] += r.contacts_body, seen[2] += r.pair_searches;
  }
}

static void run(const how *h, uint64_t hash[STEPS], int *seen)
{
  cloth_scene *scene = scene_of(h);
  script s = {0};
  run_steps(scene, &s, 0, STEPS, hash, seen);
  cloth_scene_free(scene);
}

static how plain(const char *precision)
{
  how h = {precision, "cpu", "cpu", "1", "bins"};
  return h;
}

static const uint64_t *reference(const char *precision, int *seen)
{
  static uint64_t hash[2][STEPS];
  static int contacts[2][3];
  static bool done[2];
  int p = precision[0] == 'f';
  how h = plain(precision);
  if (!done[p]) run(&h, hash[p], contacts[p]);
  done[p] = true;
  if (seen) memcpy(seen, contacts[p], sizeof contacts[p]);
  return hash[p];
}

static int compare(const how *h)
{
  uint64_t hash[STEPS];
  char what[128];
  run(h, hash, NULL);
  snprintf(what, sizeof what, "backend %s, devices %s, threads %s, %s", h->backend, h->devices,
           h->threads, h->search);
  return same_hashes(STEPS, what, reference(h->precision, NULL), hash);
}

// ---- the sentences ------------------------------------------------------------------------------

static int rich(const char *precision)
{
  int seen[3];
  const uint64_t *hash = reference(precision, seen);
  printf("  contacts: %d of particles, %d with bodies; %d searches\n", seen[0], seen[1], seen[2]);
  CHECK(STEPS < 24 || (seen[0] > 100 && seen[1] > 100 && seen[2] > STEPS));
  for (int n = 1; n < STEPS; n++) CHECK(hash[n] != hash[n - 1]);
  return 0;
}
BOTH(the_scene_has_contact_of_both_kinds_and_blocks_that_were_cut, rich)

static int threads(const char *precision)
{
  static const char *const counts[] = {"1", "2", "3"};
  for (int i = 0; i < 3; i++) {
    how h = plain(precision);
    h.threads = counts[i];
    if (compare(&h)) return 1;
  }
  return 0;
}
BOTH(any_number_of_threads_gives_the_same_bits, threads)

static int parts(const char *precision)
{
  static const char *const devices[] = {"cpu,cpu", "cpu,cpu,cpu", "cpu,cpu,cpu,cpu,cpu,cpu,cpu"};
  for (int i = 0; i < 3; i++) { // the last has more parts than chunks
    how h = plain(precision);
    h.devices = devices[i];
    if (compare(&h)) return 1;
  }
  return 0;
}
BOTH(any_number_of_parts_gives_the_same_bits, parts)

static int shuffled(const char *precision)
{
  static const char *const devices[] = {"cpu", "cpu,cpu", "cpu,cpu,cpu,cpu"};
  for (int i = 0; i < 3; i++) {
    how h = plain(precision);
    h.backend = "shuffle", h.devices = devices[i];
    if (compare(&h)) return 1;
  }
  return 0;
}
BOTH(work_in_random_order_gives_the_same_bits, shuffled)

static int on_gpu(const char *precision)
{
  static const char *const devices[] = {"0", "0,0,0"}, *const searches[] = {"bins", "all_pairs"};
  for (int i = 0; i < 4; i++) {
    how h = plain(precision);
    h.backend = "cuda", h.devices = devices[i % 2], h.search = searches[i / 2];
    if (compare(&h)) return 1;
  }
  return 0;
}
BOTH(a_gpu_gives_the_bits_of_a_cpu, on_gpu)

static int pairs(const char *precision)
{
  how h = plain(precision);
  h.search = "all_pairs";
  return compare(&h);
}
BOTH(bins_and_all_pairs_give_the_same_bits, pairs)

// two nets fly into each other so fast that who will meet is not near at the start of the frame
static uint64_t clash(const char *precision, const char *search, const char *contact)
{
  sheet_make(&cloth, 0.14, 0.14, 15, 15);
  cloth_def *def = def_new(precision);
  def_set(def, "integrator", "mass_spring");
  def_set(def, "particle_search", search);
  def_set(def, "effects.self_contact", contact);
  def_set(def, "time_step", "0.0333333");
  def_set(def, "gravity", "0 0 0");
  cloth_material m = cloth_material_default();
  m.density = 1, m.stretch_warp = m.stretch_weft = 20, m.shear = 4;
  m.bend_warp = m.bend_weft = 1e-7, m.damping_stretch = m.damping_bend = 1e-4;
  def_cloth(def, "one", &cloth, m, pose_at(0, 0, 0));
  def_cloth(def, "two", &cloth, m, pose_turned(0.01, 0.02, 0.07, 2, 0.3));
  cloth_scene *scene = scene_new(def);
  cloth_error err = {0};
  for (int c = 0; c < 2; c++) {
    double v[3 * 225] = {0};
    for (int i = 0; i < 225; i++) v[3 * i + 2] = c ? -2 : 2;
    must(cloth_state_set(scene, c, NULL, v, 225, &err), &err);
  }
  scene_step(scene, 4);
  uint64_t hash = scene_hash(scene);
  cloth_scene_free(scene);
  return hash;
}

static int missed(const char *precision)
{
  uint64_t bins = clash(precision, "bins", "auto");
  CHECK(bins == clash(precision, "all_pairs", "auto"));
  CHECK(bins != clash(precision, "bins", "off")); // they do meet
  return 0;
}
BOTH(particles_that_fly_into_each_other_are_not_missed, missed)

// a net that strays again and again falls on a ball that rests: bodies do not depend on the cut
static uint64_t fall(const char *precision, const char *search)
{
  sheet_make(&cloth, 0.14, 0.14, 15, 15);
  cloth_def *def = def_new(precision);
  def_set(def, "integrator", "mass_spring");
  def_set(def, "backend", "cpu");
  def_set(def, "particle_search", search);
  def_set(def, "time_step", "0.0333333");
  cloth_material m = cloth_material_default();
  m.density = 1, m.stretch_warp = m.stretch_weft = 20, m.shear = 4;
  m.bend_warp = m.bend_weft = 1e-7, m.damping_stretch = m.damping_bend = 1e-4;
  def_cloth(def, "net", &cloth, m, pose_turned(0, 0, 0.1, 1, 0.3));
  add_shape(def, "ball", CLOTH_SHAPE_SPHERE, 0.05, 0, 0, pose_turned(0.01, 0.02, 0, 2, 0.7));
  cloth_scene *scene = scene_new(def);
  cloth_error err = {0};
  double v[3 * 225] = {0};
  for (int i = 0; i < 225; i++) v[3 * i + 2] = -1.5 - 0.01 * i;
  must(cloth_state_set(scene, 0, NULL, v, 225, &err), &err);
  scene_step(scene, 4);
  uint64_t hash = scene_hash(scene);
  cloth_scene_free(scene);
  return hash;
}

static int resting(const char *precision)
{
  CHECK(fall(precision, "bins") == fall(precision, "all_pairs"));
  return 0;
}
BOTH(a_body_that_rests_gives_the_same_bits_for_any_cut, resting)

static int reset(const char *precision)
{
  uint64_t hash[STEPS];
  how h = plain(precision);
  cloth_scene *scene = scene_of(&h);
  cloth_error err = {0};
  script s = {0};
  run_steps(scene, &s, 0, HALF, hash, NULL);
  CHECK_OK(cloth_reset(scene, &err), err);
  s = (script){0};
  run_steps(scene, &s, 0, STEPS, hash, NULL);
  cloth_scene_free(scene);
  return same_hashes(STEPS, "after a reset", reference(precision, NULL), hash);
}
BOTH(a_run_after_a_reset_gives_the_bits_of_the_first, reset)

static int saved(const char *precision)
{
  uint64_t hash[STEPS];
  how h = plain(precision), other = plain(precision);
  other.devices = "cpu,cpu";
  folder f = folder_make();
  const char *path = folder_path(&f, "state");
  cloth_error err = {0};
  script s = {0};
  cloth_scene *scene = scene_of(&h);
  run_steps(scene, &s, 0, HALF, hash, NULL);
  must(cloth_state_save(scene, path, &err), &err);
  cloth_scene_free(scene);
  int failed = 0;
  for (int used = 0; used < 2 && !failed; used++) {
    scene = scene_of(&other);
    script elsewhere = {0}, on = s;
    uint64_t dump[STEPS];
    if (used) run_steps(scene, &elsewhere, 0, STEPS - 2, dump, NULL);
    must(cloth_state_load(scene, path, &err), &err);
    failed = scene_hash(scene) != hash[HALF - 1];
    run_steps(scene, &on, HALF, STEPS, hash, NULL);
    failed |= same_hashes(STEPS, used ? "loaded into a used scene" : "loaded",
                          reference(precision, NULL), hash);
    cloth_scene_free(scene);
  }
  folder_remove(&f);
  return failed;
}
BOTH(a_run_continued_from_a_file_gives_the_same_bits, saved)

static int replayed(const char *precision)
{
  how h = plain(precision), other = plain(precision);
  other.devices = "cpu,cpu,cpu";
  folder f = folder_make();
  const char *path = folder_path(&f, "recording");
  cloth_error err = {0};
  script s = {0};
  uint64_t hash[STEPS];
  cloth_scene *scene = scene_of(&h);
  must(cloth_record_start(scene, path, &err), &err);
  run_steps(scene, &s, 0, STEPS, hash, NULL);
  must(cloth_record_stop(scene, &err), &err);
  cloth_scene_free(scene);
  int64_t steps = 0;
  scene = scene_of(&other);
  cloth_status status = cloth_replay(scene, path, &steps, &err);
  if (status != CLOTH_OK) printf("  replay: %s\n", err.text);
  int failed = status != CLOTH_OK || steps != STEPS || scene_hash(scene) != hash[STEPS - 1];
  cloth_scene_free(scene);
  folder_remove(&f);
  return failed;
}
BOTH(a_recording_replays_bit_for_bit, replayed)

// once buffers are warm a step allocates nothing; what the scene does not call for is not there
static int memory(const char *precision)
{
  how h = plain(precision);
  cloth_scene *scene = scene_of(&h);
  script s = {0};
  int late = 0;
  for (int n = 0; n < STEPS; n++) {
    cloth_step_report r = act(scene, &s);
    if (n > STEPS - 4) late += r.allocations;
  }
  CHECK(late == 0);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_warm_step_allocates_nothing, memory)

int main(int argc, char **argv)
{
  int failures = 0;
  bool gpu = cuda_is_there();
  RUN(the_scene_has_contact_of_both_kinds_and_blocks_that_were_cut);
  RUN(any_number_of_threads_gives_the_same_bits);
  RUN(any_number_of_parts_gives_the_same_bits);
  RUN(work_in_random_order_gives_the_same_bits);
  RUN_ON(gpu, a_gpu_gives_the_bits_of_a_cpu);
  RUN(bins_and_all_pairs_give_the_same_bits);
  RUN(particles_that_fly_into_each_other_are_not_missed);
  RUN(a_body_that_rests_gives_the_same_bits_for_any_cut);
  RUN(a_run_after_a_reset_gives_the_bits_of_the_first);
  RUN(a_run_continued_from_a_file_gives_the_same_bits);
  RUN(a_recording_replays_bit_for_bit);
  RUN(a_warm_step_allocates_nothing);
  return failures > 0;
}
