// Parts that are cut anew between steps (state/recut.h): the state moves with them to the last bit,
// wherever the cut falls, and the part that has most to do gets less. The cut is judged against all
// cuts there are.
#include "solve/sim.h"
#include "state/cut.h"
#include "state/recut.h"

enum { N = 17, STEPS = 4 };
#ifdef CLOTH_TEST_SHORT
enum { MOST_PARTS = 3, LONG = 25, TRIES = 111 };
#else
enum { MOST_PARTS = 4, LONG = 30, TRIES = 37 };
#endif

static sheet cloth;
static solid table;

static const char *devices_of(int parts, const char *name)
{
  static char text[16 * 5 + 1];
  text[0] = 0;
  for (int i = 0; i < parts; i++) strcat(strcat(text, i ? ", " : ""), name);
  return text;
}

static cloth_def *def_of(int parts, const char *backend)
{
  cloth_def *def = def_new(PRECISION);
  def_set(def, "backend", backend);
  def_set(def, "devices", devices_of(parts, strcmp(backend, "cuda") == 0 ? "0" : "cpu"));
  def_set(def, "threads", "1");
  def_set(def, "rebalance", "0"); // but for the tests that ask for it
  return def;
}

static uint64_t hash_of(cloth_sim *sim)
{
  cloth_error err = {0};
  uint64_t hash = 0;
  must(cloth_sim_hash(sim, &hash, &err), &err);
  return hash;
}

// ---- where to cut -------------------------------------------------------------------------------

static double largest(const double *work, const int *first, int parts)
{
  double most = 0;
  for (int j = 0; j < parts; j++) {
    double sum = 0;
    for (int u = first[j]; u < first[j + 1]; u++) sum += work[u];
    most = fmax(most, sum);
  }
  return most;
}

// the least of all cuts of units [0, units) into parts of one unit or more
static double best_of_all(int units, const double *work, int parts)
{
  if (parts == 1) return largest(work, (int[]){0, units}, 1);
  double best = INFINITY;
  for (int last = parts - 1; last < units; last++)
    best = fmin(best,
                fmax(best_of_all(last, work, parts - 1), largest(work, (int[]){last, units}, 1)));
  return best;
}

static int no_other_cut_has_less_work_in_its_worst_part(void)
{
  uint32_t seed = 3;
  for (int run = 0; run < 300; run++) {
    int units = 1 + (int)(roll(&seed) % 12), parts = 1 + (int)(roll(&seed) % (unsigned)units);
    int first[13];
    double work[12];
    parts = parts > 5 ? 5 : parts;
    for (int u = 0; u < units; u++) work[u] = roll(&seed) % 4 ? roll(&seed) % 1000 : 0;
    double got = cloth_cut_by_work(units, work, parts, first);
    CHECK(first[0] == 0 && first[parts] == units);
    for (int j = 0; j < parts; j++) CHECK(first[j] < first[j + 1]);
    CHECK(got == largest(work, first, parts)); // whole numbers: exact
    CHECK(got == best_of_all(units, work, parts));
  }
  return 0;
}

// ---- the same bits ------------------------------------------------------------------------------

// What a part has of the state: friction's memory, grasps, history of bdf2, cloth that intersects.
typedef enum matter { STACK, STACK_OF_HATS, HUNG, TANGLED, MATTERS } matter;

static cloth_sim *make(matter m, int parts, const char *backend, cloth_def **def)
{
  cloth_def *d = *def = def_of(parts, backend);
  sheet_make(&cloth, 0.2, 0.2, N, N);
  solid_box(&table, 1, 1, 0.1);
  def_set(d, "preconditioner", m == STACK_OF_HATS ? "multilevel" : "two_level");
  if (m == HUNG) def_set(d, "integrator", "bdf2");
  if (m == TANGLED) def_set(d, "untangle", "true");
  def_cloth(d, "lower", &cloth, cloth_material_default(), pose_at(0, 0, 0.004));
  if (m != HUNG)
    def_cloth(d, "upper", &cloth, cloth_material_default(),
              m == TANGLED ? pose_turned(0.05, 0.02, 0.006, 0, 0.1)
                           : pose_turned(0.01, 0.02, 0.008, 2, 1.2));
  if (m != HUNG) def_body(d, "table", &table, 0.4, pose_at(0, 0, -0.05));
  cloth_sim *sim = sim_new(d);
  cloth_error err = {0};
  const int corner[] = {0, 1, N}, other[] = {N * N - 1, N * N - 2};
  cloth_grasp_view rigid = {.cloth = 0,
                            .count = 3,
                            .vertex = corner,
                            .body = -1,
                            .frame = pose_at(0, 0, 0)},
                   soft = {.cloth = 0,
                           .count = 2,
                           .vertex = other,
                           .body = -1,
                           .stiffness = 20,
                           .frame = pose_at(0, 0, 0)};
  cloth_grasp_id id;
  must(cloth_sim_grasp(sim, &rigid, &id, &err), &err);
  must(cloth_sim_grasp(sim, &soft, &id, &err), &err);
  must(cloth_sim_grasp_move(sim, id, (cloth_pose[]){pose_at(0.01, 0, 0.002)}, &err), &err);
  return sim;
}

// at most one part without a unit
static void throw_cut(const cloth_sim *sim, uint32_t *seed, int *cut)
{
  int units = cloth_cut_units(sim), at = 0;
  for (int j = 0; j < sim->part_count; j++) {
    cut[j] = cloth_cut_vertex(sim, at);
    at += (int)(roll(seed) % (unsigned)(units - at - (sim->part_count - j - 1))) + (j > 0);
    at = at > units ? units : at;
  }
  cut[sim->part_count] = sim->vertex_count;
}

// hashes of a run that is never cut anew
static int plain_run(matter m, const char *backend, uint64_t *hash)
{
  cloth_def *def;
  cloth_sim *sim = make(m, 1, backend, &def);
  int contacts = 0, order_two = 0, tangles = 0;
  for (int i = 0; i < STEPS; i++) {
    cloth_step_report r = sim_step(sim, 1);
    hash[i] = hash_of(sim);
    contacts += r.contacts_self, order_two += r.bdf2_substeps, tangles += r.tangles;
  }
  cloth_sim_free(sim), cloth_def_free(def);
  CHECK((m == HUNG ? order_two : contacts) > 0 && (m != TANGLED || tangles > 0));
  return 0;
}

static int cut_anew_before_every_step(matter m, int parts, const char *backend,
                                      const uint64_t *plain)
{
  static uint32_t seed = 7;
  cloth_def *def;
  cloth_sim *sim = make(m, parts, backend, &def);
  for (int i = 0; i < STEPS; i++) {
    int cut[5];
    cloth_error err = {0};
    throw_cut(sim, &seed, cut);
    must(cloth_recut_at(sim, cut, &err), &err);
    CHECK(sim->part[1].v0 == cut[1] && !sim->recut.refused);
    sim_step(sim, 1);
    if (hash_of(sim) != plain[i])
      printf("  matter %d, %d parts, %s: step %d\n", m, parts, backend, i + 1);
    CHECK(hash_of(sim) == plain[i]);
  }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int wherever_and_whenever_parts_are_cut_the_bits_are_the_same(void)
{
  for (matter m = 0; m < MATTERS; m++) {
    uint64_t plain[STEPS];
    CHECK(plain_run(m, "cpu", plain) == 0);
    for (int parts = 2; parts <= MOST_PARTS; parts++)
      CHECK(cut_anew_before_every_step(m, parts, parts == 3 ? "shuffle" : "cpu", plain) == 0);
  }
  return 0;
}

static int so_they_are_on_a_gpu(void)
{
  for (matter m = 0; m < MATTERS; m++) {
    uint64_t plain[STEPS];
    CHECK(plain_run(m, "cuda", plain) == 0);
    CHECK(cut_anew_before_every_step(m, 3, "cuda", plain) == 0);
  }
  return 0;
}

// ---- when ---------------------------------------------------------------------------------------

// one cloth lies in layers, one hangs free: whoever owns the first has all contacts
static cloth_def *heap_def(int parts, const char *backend, const char *rebalance)
{
  cloth_def *def = def_of(parts, backend);
  sheet_make(&cloth, 0.2, 0.2, N, N);
  solid_box(&table, 1, 1, 0.1);
  def_set(def, "rebalance", rebalance);
  const char *name[] = {"under", "over", "apart", "away"};
  for (int i = 0; i < 4; i++)
    def_cloth(def, name[i], &cloth, cloth_material_default(),
              i < 2 ? pose_at(0, 0, 0.003 + 0.003 * i) : pose_at(0.3 * i, 0, 40));
  def_body(def, "table", &table, 0.4, pose_at(0, 0, -0.05));
  return def;
}

typedef struct course {
  uint64_t hash;
  double first, last; // work of the worst part over the mean
  int recuts, step;   // when last
  int v1;             // end of the first part
} course;

static course run(int parts, const char *backend, const char *rebalance, int steps)
{
  cloth_def *def = heap_def(parts, backend, rebalance);
  cloth_sim *sim = sim_new(def);
  course c = {0};
  for (int i = 0; i < steps; i++) {
    cloth_step_report r = sim_step(sim, 1);
    if (i == 2) c.first = r.work_worst;
    c.last = r.work_worst, c.recuts += r.recuts;
    if (r.recuts) c.step = i + 1;
  }
  c.hash = hash_of(sim), c.v1 = sim->part[0].v1;
  cloth_sim_free(sim), cloth_def_free(def);
  return c;
}

static int where_contacts_gather_parts_are_cut_anew(void)
{
  const char *backend = "cpu";
  course one = run(1, backend, "1.1", LONG);
  CHECK(one.recuts == 0 && one.last == 1);
  for (int parts = 2; parts <= MOST_PARTS; parts++) {
    course fixed = run(parts, backend, "0", LONG), moved = run(parts, backend, "1.1", LONG);
    printf("  %d parts: worst %.2f of the mean, then %.2f; cut anew %d times\n", parts, fixed.last,
           moved.last, moved.recuts);
    CHECK(fixed.recuts == 0 && fixed.last > 1.3);
    CHECK(moved.recuts > 0 && moved.recuts < 4);
    CHECK(moved.last - 1 < 0.5 * (fixed.last - 1));
    CHECK(moved.first == fixed.first && moved.v1 < fixed.v1); // the first has contacts
    CHECK(fixed.hash == one.hash && moved.hash == one.hash);
    backend = parts == 2 ? "shuffle" : "cpu";
  }
  return 0;
}

static int they_are_cut_at_the_same_step_every_time(void)
{
  course a = run(3, "cpu", "1.1", LONG), b = run(3, "cpu", "1.1", LONG);
  CHECK(a.recuts > 0 && a.recuts == b.recuts && a.step == b.step && a.v1 == b.v1);
  CHECK(a.last == b.last && a.hash == b.hash);
  course never = run(3, "cpu", "100", LONG); // nobody has a hundred times the mean
  CHECK(never.recuts == 0 && never.hash == a.hash);
  return 0;
}

// ---- no room ------------------------------------------------------------------------------------

static const cloth_backend *below;
static int allowed, refusals; // allocations until one fails; how many fail then

static cloth_status alloc(cloth_device *d, size_t bytes, void **out, cloth_error *err)
{
  if (allowed-- <= 0 && refusals-- > 0) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "the device is full");
  return below->alloc(d, bytes, out, err);
}

// cut anew after two steps with a device that fills up, then three steps
static cloth_status try_cut(int allocations, int failures, bool *fits, uint64_t *hash,
                            uint64_t *end)
{
  cloth_def *def = heap_def(3, "cpu", "0");
  cloth_sim *sim = sim_new(def);
  cloth_error err = {0};
  cloth_backend full = *sim->backend;
  int units = cloth_cut_units(sim);
  int cut[] = {0, cloth_cut_vertex(sim, units / 5), cloth_cut_vertex(sim, units / 2),
               sim->vertex_count};
  sim_step(sim, 2);
  below = sim->backend, allowed = allocations, refusals = failures;
  full.alloc = alloc, sim->backend = &full;
  cloth_status status = cloth_recut_at(sim, cut, &err);
  refusals = 0;
  *fits = !sim->recut.refused && sim->part[1].v0 == cut[1];
  *hash = hash_of(sim);
  if (status == CLOTH_OK) sim_step(sim, 3);
  *end = hash_of(sim);
  sim->backend = below;
  cloth_sim_free(sim), cloth_def_free(def);
  return status;
}

static int a_cut_that_does_not_fit_is_taken_back(void)
{
  bool fits;
  uint64_t hash, end, plain, plain_end;
  CHECK(try_cut(0, 0, &fits, &plain, &plain_end) == CLOTH_OK && fits);
  int refused = 0;
  for (int i = 0; i < 300; i += TRIES) {
    CHECK(try_cut(i, 1, &fits, &hash, &end) == CLOTH_OK);
    CHECK(hash == plain && end == plain_end);
    refused += !fits;
    // full for good: no step any more, but the state is there
    cloth_status status = try_cut(i, 1000, &fits, &hash, &end);
    CHECK(hash == plain && (status == CLOTH_OK ? fits : status == CLOTH_NO_MEMORY));
  }
  CHECK(refused > 1);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  const cloth_backend *cuda = cloth_backend_cuda();
  bool gpu = cuda != NULL && cuda->device_count() > 0;
  RUN(no_other_cut_has_less_work_in_its_worst_part);
  RUN(wherever_and_whenever_parts_are_cut_the_bits_are_the_same);
  RUN_ON(gpu, so_they_are_on_a_gpu);
  RUN(where_contacts_gather_parts_are_cut_anew);
  RUN(they_are_cut_at_the_same_step_every_time);
  RUN(a_cut_that_does_not_fit_is_taken_back);
  return failures > 0;
}
