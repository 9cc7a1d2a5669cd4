// The CPU backends: sort and scan against the plain way, and that the shuffle backend makes a
// missing wait visible and never punishes a correct program. Data change between passes, or a stale
// read would read the right value.
#include "along.h"
#include "solve/sim.h"

enum { MOST = 5000, PASSES = 20 };

static uint64_t key[MOST], key_spare[MOST], expected_key[MOST];
static uint32_t value[MOST], value_spare[MOST], expected_value[MOST];

static const cloth_backend *backend_of(int which)
{
  return which ? cloth_backend_shuffle(5) : cloth_backend_cpu();
}

static int sort_is_stable_and_in_order(void)
{
  static const int counts[] = {0, 1, 2, 255, 256, 257, 1000, MOST}, bits[] = {1, 7, 8, 17, 33, 64};
  uint32_t seed = 3;
  for (int run = 0; run < 2 * 4 * 8 * 6; run++) {
    const cloth_backend *be = backend_of(run % 2);
    int threads = 1 + run / 2 % 4, n = counts[run / 8 % 8], b = bits[run / 64 % 6];
    cloth_error err = {0};
    cloth_device *device;
    must(be->open(0, threads, &device, &err), &err);
    uint64_t mask = b == 64 ? ~(uint64_t)0 : ((uint64_t)1 << b) - 1;
    for (int i = 0; i < n; i++) {
      key[i] = ((uint64_t)roll(&seed) << 40 ^ (uint64_t)roll(&seed) << 20 ^ roll(&seed)) & mask;
      if (b >= 17) key[i] &= ~(uint64_t)0xfff0; // many equal keys
      value[i] = (uint32_t)i;
      expected_key[i] = key[i], expected_value[i] = value[i];
    }
    for (int i = 1; i < n; i++) // insertion: stable
      for (int k = i; k > 0 && expected_key[k] < expected_key[k - 1]; k--) {
        uint64_t q = expected_key[k];
        uint32_t v = expected_value[k];
        expected_key[k] = expected_key[k - 1], expected_key[k - 1] = q;
        expected_value[k] = expected_value[k - 1], expected_value[k - 1] = v;
      }
    must(be->sort(device, n, b, key, value, key_spare, value_spare, &err), &err);
    must(be->finish(device, &err), &err);
    CHECK(memcmp(key, expected_key, sizeof *key * (size_t)n) == 0);
    CHECK(memcmp(value, expected_value, sizeof *value * (size_t)n) == 0);
    be->close(device);
  }
  return 0;
}

static int scan_is_the_sum_of_what_came_before(void)
{
  uint32_t seed = 9;
  for (int n = 0; n < 2000; n = 2 * n + 1)
    for (int which = 0; which < 2; which++) {
      const cloth_backend *be = backend_of(which);
      cloth_error err = {0};
      cloth_device *device;
      must(be->open(0, 2, &device, &err), &err);
      uint32_t sum = 0;
      for (int i = 0; i < n; i++) {
        value[i] = roll(&seed) % 1000;
        expected_value[i] = sum, sum += value[i];
      }
      expected_value[n] = sum, value[n] = 12345; // whatever was there
      must(be->scan(device, n, value, &err), &err);
      must(be->finish(device, &err), &err);
      CHECK(memcmp(value, expected_value, sizeof *value * ((size_t)n + 1)) == 0);
      be->close(device);
    }
  return 0;
}

// Device 0 makes a number (fill), sends it to device 1 (copy), which adds to its own queue. With
// every wait the answer is right for any seed; returns how many passes of a seed were wrong.
static int wrong_passes(unsigned seed, bool wait_before_copy, bool wait_after_copy)
{
  const cloth_backend *be = cloth_backend_shuffle(seed);
  cloth_error err = {0};
  cloth_device *d[2];
  cloth_event *made, *sent, *used;
  void *a, *b, *c;
  int wrong = 0;
  for (int i = 0; i < 2; i++) must(be->open(0, 1, &d[i], &err), &err);
  must(be->event_new(d[0], &made, &err), &err), must(be->event_new(d[0], &sent, &err), &err);
  must(be->event_new(d[1], &used, &err), &err);
  must(be->alloc(d[0], 16, &a, &err), &err), must(be->alloc(d[1], 16, &b, &err), &err);
  must(be->alloc(d[1], 16, &c, &err), &err);
  for (int pass = 1; pass <= PASSES; pass++) {
    must(be->fill(d[0], a, pass, 16, &err), &err);
    must(be->record(d[0], CLOTH_COMPUTE, made, &err), &err);
    if (wait_before_copy) must(be->wait(d[0], CLOTH_COPY, made, &err), &err);
    must(be->copy(d[0], d[1], b, a, 16, &err), &err);
    must(be->record(d[0], CLOTH_COPY, sent, &err), &err);
    if (wait_after_copy) must(be->wait(d[1], CLOTH_COPY, sent, &err), &err);
    must(be->copy(d[1], d[1], c, b, 16, &err), &err);
    must(be->record(d[1], CLOTH_COPY, used, &err), &err);
    must(be->finish(d[1], &err), &err);
    must(be->finish(d[0], &err), &err);
    unsigned char got[16];
    must(be->read(d[1], got, c, 16, &err), &err);
    wrong += got[0] != pass || got[15] != pass;
  }
  be->release(d[0], a), be->release(d[1], b), be->release(d[1], c);
  be->event_free(made), be->event_free(sent), be->event_free(used);
  be->close(d[0]), be->close(d[1]);
  return wrong;
}

static int shuffle_shows_a_missing_wait_and_spares_a_correct_program(void)
{
  int before = 0, after = 0;
  for (unsigned seed = 1; seed <= 10; seed++) {
    CHECK(wrong_passes(seed, true, true) == 0);
    before += wrong_passes(seed, false, true) > 0;
    after += wrong_passes(seed, true, false) > 0;
  }
  CHECK(before == 10 && after == 10); // in 20 passes, a wait that is missing is met at least once
  return 0;
}

// on one queue, so no event is needed
static int moves_come_behind_what_was_queued_before(void)
{
  for (unsigned seed = 1; seed <= 20; seed++) {
    const cloth_backend *be = cloth_backend_shuffle(seed);
    cloth_error err = {0};
    cloth_device *d;
    void *a, *b;
    unsigned char got[16];
    must(be->open(0, 1, &d, &err), &err);
    must(be->alloc(d, 16, &a, &err), &err), must(be->alloc(d, 16, &b, &err), &err);
    for (int pass = 1; pass <= 10; pass++) {
      must(be->fill(d, a, pass, 16, &err), &err);
      must(be->move(d, b, a, 16, &err), &err);
      must(be->fill(d, a, 0, 16, &err), &err);
      must(be->read(d, got, b, 16, &err), &err);
      CHECK(got[0] == pass && got[15] == pass);
    }
    be->release(d, a), be->release(d, b), be->close(d);
  }
  return 0;
}

static int shuffled_reads_along_come_with_the_next_read(void)
{
  return what_is_read_along_comes_with_the_next_read(cloth_backend_shuffle(3));
}

static int shuffled_memory_is_not_zero_by_luck(void)
{
  const cloth_backend *be = cloth_backend_shuffle(1);
  cloth_error err = {0};
  cloth_device *device;
  void *memory;
  must(be->open(0, 1, &device, &err), &err);
  must(be->alloc(device, sizeof(cloth_real) * 8, &memory, &err), &err);
  for (int i = 0; i < 8; i++) CHECK(isnan(((const cloth_real *)memory)[i]));
  be->release(device, memory), be->close(device);
  return 0;
}

// what a report counts, of the parts together
static bool same_report(const cloth_step_report *a, const cloth_step_report *b)
{
  return a->contacts_self == b->contacts_self && a->contacts_body == b->contacts_body &&
         a->stretch_max == b->stretch_max && a->impacts == b->impacts &&
         a->newton_iterations == b->newton_iterations && a->substeps == b->substeps &&
         a->pcg_iterations == b->pcg_iterations && a->pair_searches == b->pair_searches;
}

typedef struct fall {       // a scene of one sheet above a table, or two
  double height, turn, gap; // m, rad, m between the sheets; 0: there is one
  const char *gravity, *wind, *newton_tolerance, *pair_slack;
} fall;

enum { FALL_STEPS = 40 };

static cloth_sim *fall_make(const fall *f, cloth_def **def, const char *backend,
                            const char *devices)
{
  static sheet cloth;
  static solid table;
  cloth_material calm = cloth_material_default();
  sheet_make(&cloth, 0.2, 0.2, 15, 15);
  solid_box(&table, 1, 1, 0.1);
  *def = def_new(PRECISION);
  def_set(*def, "backend", backend), def_set(*def, "devices", devices);
  def_set(*def, "threads", "1"), def_set(*def, "gravity", f->gravity);
  def_set(*def, "air_density", "1.2"), def_set(*def, "wind", f->wind);
  def_set(*def, "contact_rounds_max", "0"), def_set(*def, "pair_slack", f->pair_slack);
  def_set(*def, "newton_tolerance", f->newton_tolerance);
  def_cloth(*def, "towel", &cloth, cloth_material_default(),
            pose_turned(0, 0, f->height, 0, f->turn));
  calm.drag = calm.skin_drag = 0;
  if (f->gap > 0) def_cloth(*def, "calm", &cloth, calm, pose_at(0.01, 0, f->height + f->gap));
  def_body(*def, "table", &table, 0.4, pose_at(0, 0, -0.05));
  return sim_new(*def);
}

// The whole engine on three parts, and on one that reads along, whatever order the dice give.
static int every_seed_gives_the_same_steps_of(const fall *f, int *self, int *met)
{
  static cloth_step_report first[FALL_STEPS];
  uint64_t first_hash = 0;
  for (unsigned seed = 0; seed < 5; seed++) { // 0: the plain backend on one part
    cloth_def *def;
    cloth_sim *sim = fall_make(f, &def, seed > 0 ? "shuffle" : "cpu",
                               seed > 0 && seed < 3 ? "cpu,cpu,cpu" : "cpu");
    if (seed > 0) cloth_backend_shuffle(seed); // throws the dice anew
    for (int n = 0; n < FALL_STEPS; n++) {
      cloth_step_report r = sim_step(sim, 1);
      if (seed == 0)
        first[n] = r, *self += r.contacts_self > 0, *met += r.impacts + r.step_halvings > 0;
      CHECK(same_report(&r, &first[n]));
    }
    uint64_t hash;
    cloth_error err = {0};
    must(cloth_sim_hash(sim, &hash, &err), &err);
    if (seed == 0) first_hash = hash;
    CHECK(hash == first_hash);
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return 0;
}

// it touches itself, comes to impacts, and settles by friction
static int every_seed_gives_the_same_steps_of_a_bundle(void)
{
  int self = 0, met = 0;
  fall f = {.height = 0.25,
            .turn = 1.4,
            .gravity = "0 0 -9.81",
            .wind = "0 0 0",
            .newton_tolerance = "1",
            .pair_slack = "0.01"};
  CHECK(every_seed_gives_the_same_steps_of(&f, &self, &met) == 0);
  CHECK(self > 0 && met > 0);
  return 0;
}

// A gust drives one sheet into the other farther than either was expected to go, so that they are
// no pair before the linear system is solved.
static int every_seed_gives_the_same_steps_of_two_sheets_in_a_gust(void)
{
  int self = 0, met = 0;
  fall f = {.height = 0.3,
            .gap = 0.01,
            .gravity = "0 0 0",
            .wind = "0 0 6",
            .newton_tolerance = "0.05",
            .pair_slack = "0.001"};
  CHECK(every_seed_gives_the_same_steps_of(&f, &self, &met) == 0);
  CHECK(self > 0 && met > 0);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(sort_is_stable_and_in_order);
  RUN(scan_is_the_sum_of_what_came_before);
  RUN(shuffle_shows_a_missing_wait_and_spares_a_correct_program);
  RUN(moves_come_behind_what_was_queued_before);
  RUN(shuffled_reads_along_come_with_the_next_read);
  RUN(shuffled_memory_is_not_zero_by_luck);
  RUN(every_seed_gives_the_same_steps_of_a_bundle);
  RUN(every_seed_gives_the_same_steps_of_two_sheets_in_a_gust);
  return failures > 0;
}
