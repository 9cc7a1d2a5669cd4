// Bits stay the same for as long as anybody wants to look: a cloth that is lifted by its middle and
// put down again elsewhere, over and over, crumples anew each time, and four parts have the hash of
// one all the way. On a GPU for 10,000 steps (CLOTH_CRUMPLE_STEPS sets another number).
#include "scene.h"

enum { N = 21, PERIOD = 110, LOOK = 20 }; // steps of one lift; steps between two looks

#ifdef CLOTH_TEST_SHORT
enum { STEPS_CPU = 120 }; // the middle reaches the table at step 70
#else
enum { STEPS_CPU = 330 };
#endif
enum { STEPS_GPU = 10000 };

static sheet cloth;
static solid table;

typedef struct run {
  cloth_scene *scene;
  cloth_grasp_id hand;
} run;

static cloth_pose hand_at(int step)
{
  const double turn = 2 * 3.14159265358979 * step / PERIOD;
  return pose_turned(0.06 * sin(0.37 * turn), 0.05 * sin(0.53 * turn), 0.074 - 0.055 * cos(turn), 2,
                     0.8 * sin(0.29 * turn));
}

static run start(const char *backend, const char *devices)
{
  static const int middle[4] = {N * N / 2, N * N / 2 - 1, N * N / 2 - N, N * N / 2 - N - 1};
  sheet_make(&cloth, 0.3, 0.3, N, N);
  solid_box(&table, 1, 1, 0.1);
  cloth_def *def = def_new("float");
  def_set(def, "backend", backend);
  def_set(def, "devices", devices);
  def_set(def, "threads", "1");
  def_cloth(def, "rag", &cloth, cloth_material_default(), hand_at(0));
  def_body(def, "table", &table, 0.5, pose_at(0, 0, -0.05));
  run r = {.scene = scene_new(def)};
  r.hand = scene_hold(r.scene, 0, middle, 4, hand_at(0));
  return r;
}

static cloth_step_report go_on(const run *r, int step)
{
  cloth_error err = {0};
  cloth_step_report report = {0};
  cloth_pose hand = hand_at(step);
  must(cloth_grasp_move(r->scene, r->hand, &hand, &err), &err);
  must(cloth_step(r->scene, 0, &report, &err), &err);
  return report;
}

// both runs side by side, so that the first difference ends them
static int same_all_the_way(const char *backend, const char *one, const char *four, int steps)
{
  run a = start(backend, one), b = start(backend, four);
  int touching = 0, looks = 0, differs = 0;
  for (int n = 1; n <= steps && !differs; n++) {
    cloth_step_report r = go_on(&a, n);
    go_on(&b, n);
    if (n % LOOK != 0) continue;
    touching += r.contacts_self > 20, looks++;
    if (scene_hash(a.scene) != scene_hash(b.scene)) differs = n;
  }
  cloth_scene_free(a.scene), cloth_scene_free(b.scene);
  if (differs) printf("  devices %s: another state than on %s at step %d\n", four, one, differs);
  CHECK(!differs);
  if (3 * touching < looks) printf("  %d of %d looks saw it crumpled\n", touching, looks);
  CHECK(3 * touching >= looks); // else nothing was tested
  return 0;
}

static int four_parts_of_a_cpu_crumple_as_one(void)
{
  return same_all_the_way("cpu", "cpu", "cpu, cpu, cpu, cpu", STEPS_CPU);
}

static int four_parts_of_a_gpu_crumple_as_one_for_10000_steps(void)
{
  const char *asked = getenv("CLOTH_CRUMPLE_STEPS");
  return same_all_the_way("cuda", "0", "0, 0, 0, 0", asked ? atoi(asked) : STEPS_GPU);
}

int main(int argc, char **argv)
{
  int failures = 0;
  bool gpu = cuda_is_there();
  RUN(four_parts_of_a_cpu_crumple_as_one);
  RUN_ON(gpu, four_parts_of_a_gpu_crumple_as_one_for_10000_steps);
  return failures > 0;
}
