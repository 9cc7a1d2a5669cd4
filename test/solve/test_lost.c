// A device that fills up or is lost in a step: the status says so, and the last state can still be
// read, saved and gone on from. The backend under test is the CPU's with a device that fails from a
// call on that the test chooses.
#include "scene/folder.h"
#include "solve/sim.h"

enum { N = 13, BEFORE = 4, AFTER = 4 };

static sheet cloth;
static solid table;

static cloth_def *def_of(const char *devices)
{
  sheet_make(&cloth, 0.15, 0.15, N, N);
  solid_box(&table, 1, 1, 0.1);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", devices);
  def_set(def, "threads", "1");
  def_set(def, "substeps", "3"); // so that a step may fail half-way
  def_cloth(def, "lower", &cloth, cloth_material_default(), pose_at(0, 0, 0.004));
  def_cloth(def, "upper", &cloth, cloth_material_default(), pose_turned(0, 0, 0.012, 2, 0.5));
  def_body(def, "table", &table, 0.4, pose_at(0, 0, -0.05));
  return def;
}

// ---- a backend that fails -----------------------------------------------------------------------

static struct {
  const cloth_backend *below;
  const cloth_device *device; // that is lost; NULL: none
  int calls;                  // launches that it still does
  int allocations;            // that still succeed; below 0: all
} failing;

static bool is_gone(const cloth_device *d) { return d == failing.device && failing.calls <= 0; }

static cloth_status gone(cloth_error *err)
{
  CLOTH_FAIL(err, CLOTH_DEVICE_LOST, "the device fell off");
}

static cloth_status launch(cloth_device *d, cloth_kernel k, int n, const void *args,
                           cloth_error *err)
{
  if (d == failing.device) failing.calls--;
  return is_gone(d) ? gone(err) : failing.below->launch(d, k, n, args, err);
}

static cloth_status copy_between(cloth_device *from, cloth_device *to, void *dst, const void *src,
                                 size_t bytes, cloth_error *err)
{
  if (is_gone(from) || is_gone(to)) return gone(err);
  return failing.below->copy(from, to, dst, src, bytes, err);
}

static cloth_status read_from(cloth_device *d, void *host, const void *src, size_t bytes,
                              cloth_error *err)
{
  return is_gone(d) ? gone(err) : failing.below->read(d, host, src, bytes, err);
}

static cloth_status finish(cloth_device *d, cloth_error *err)
{
  return is_gone(d) ? gone(err) : failing.below->finish(d, err);
}

static cloth_status alloc(cloth_device *d, size_t bytes, void **out, cloth_error *err)
{
  if (failing.allocations == 0) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "the device is full");
  failing.allocations--;
  return failing.below->alloc(d, bytes, out, err);
}

static cloth_backend faulty;

static void may_fail(cloth_sim *sim)
{
  failing.below = sim->backend, failing.device = NULL, failing.calls = 0, failing.allocations = -1;
  faulty = *sim->backend;
  faulty.launch = launch, faulty.copy = copy_between, faulty.read = read_from;
  faulty.finish = finish, faulty.alloc = alloc;
  sim->backend = &faulty;
}

// ---- sentences ----------------------------------------------------------------------------------

static uint64_t hash_of(cloth_sim *sim)
{
  cloth_error err = {0};
  uint64_t hash = 0;
  must(cloth_sim_hash(sim, &hash, &err), &err);
  return hash;
}

// states of the run that nothing happens to, after `step` steps
static uint64_t undisturbed(int step)
{
  static uint64_t hash[BEFORE + AFTER + 1];
  if (hash[0] == 0) {
    cloth_def *def = def_of("cpu, cpu, cpu");
    cloth_sim *sim = sim_new(def);
    for (int i = 0; i <= BEFORE + AFTER; i++) {
      hash[i] = hash_of(sim);
      sim_step(sim, 1);
    }
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return hash[step];
}

// saved by one, gone on from by another that is sound
static uint64_t hash_after_loading(cloth_sim *sim, int steps)
{
  cloth_error err = {0};
  folder f = folder_make();
  const char *path = folder_path(&f, "last");
  must(cloth_sim_save(sim, path, &err), &err);
  cloth_def *def = def_of("cpu");
  cloth_sim *sound = sim_new(def);
  must(cloth_sim_load(sound, path, &err), &err);
  sim_step(sound, steps);
  uint64_t hash = hash_of(sound);
  cloth_sim_free(sound), cloth_def_free(def);
  folder_remove(&f);
  return hash;
}

static int a_full_device_leaves_the_state_before_the_step(void)
{
  int refused = 0, midway = 0;
  for (int allowed = 0; allowed < 60; allowed += 4) {
    cloth_def *def = def_of("cpu, cpu, cpu");
    cloth_sim *sim = sim_new(def);
    cloth_error err = {0};
    cloth_step_report report = {0};
    may_fail(sim);
    failing.allocations = allowed;
    int done = 0;
    while (done < BEFORE && cloth_sim_step(sim, 1.0 / 60, &report, &err) == CLOTH_OK) done++;
    failing.allocations = -1;
    if (done < BEFORE) {
      CHECK(strstr(err.text, "the device is full") != NULL);
      CHECK(hash_of(sim) == undisturbed(done));
      CHECK(hash_after_loading(sim, AFTER) == undisturbed(done + AFTER));
      refused++, midway += report.substeps > 0;
    }
    cloth_sim_free(sim), cloth_def_free(def);
  }
  if (midway == 0) printf("  %d refused, none of them half-way\n", refused);
  CHECK(refused > 1 && midway > 0);
  return 0;
}

static int what_a_lost_device_knew_is_read_from_another(void)
{
  for (int lost = 0; lost < 3; lost++)
    for (int calls = 1; calls < 400; calls += 80) {
      cloth_def *def = def_of("cpu, cpu, cpu");
      cloth_sim *sim = sim_new(def);
      cloth_error err = {0};
      cloth_step_report report = {0};
      double x[3 * N * N];
      may_fail(sim);
      sim_step(sim, BEFORE);
      failing.device = sim->part[lost].device, failing.calls = calls;
      int done = BEFORE;
      cloth_status status;
      while ((status = cloth_sim_step(sim, 1.0 / 60, &report, &err)) == CLOTH_OK) done++;
      CHECK(status == CLOTH_DEVICE_LOST && done < BEFORE + AFTER);
      CHECK(strstr(err.text, "the device fell off") != NULL);
      CHECK(report.substeps > 0 || hash_of(sim) == undisturbed(done));
      CHECK_OK(cloth_sim_positions(sim, 1, x, &err), err);
      for (int i = 0; i < 3 * N * N; i++) CHECK(fabs(x[i]) < 1);
      hash_after_loading(sim, 1); // without what friction remembered: it goes on, a little else
      failing.device = NULL;
      cloth_sim_free(sim), cloth_def_free(def);
    }
  return 0;
}

static int with_no_device_left_that_is_said(void)
{
  cloth_def *def = def_of("cpu");
  cloth_sim *sim = sim_new(def);
  cloth_error err = {0};
  cloth_step_report report = {0};
  uint64_t hash;
  may_fail(sim);
  sim_step(sim, 1);
  failing.device = sim->part[0].device;
  CHECK(cloth_sim_step(sim, 1.0 / 60, &report, &err) == CLOTH_DEVICE_LOST);
  CHECK(cloth_sim_hash(sim, &hash, &err) == CLOTH_DEVICE_LOST);
  CHECK(cloth_sim_save(sim, "nowhere", &err) == CLOTH_DEVICE_LOST);
  failing.device = NULL;
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_full_device_leaves_the_state_before_the_step);
  RUN(what_a_lost_device_knew_is_read_from_another);
  RUN(with_no_device_left_that_is_said);
  return failures > 0;
}
