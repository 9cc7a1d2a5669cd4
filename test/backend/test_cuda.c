// The CUDA backend against the CPU: sort, scan, copies and events by themselves; then whole steps,
// after which every buffer of the scene, the output of every kernel among them, holds the same
// bits. Only lists that threads append to are compared as sets. Skipped where there is no GPU.
#include "along.h"
#include "solve/sim.h"

enum { MOST = 300000, SMALL_MOST = 4096 }; // rows of a system that one cluster of blocks solves

static uint64_t key[MOST], key_spare[MOST], key_back[MOST];
static uint32_t value[MOST + 1], value_spare[MOST + 1], value_back[MOST + 1];

static const cloth_backend *cuda, *cpu;

static void *upload(cloth_device *d, const void *host, size_t bytes)
{
  cloth_error err = {0};
  void *data = NULL;
  must(cuda->alloc(d, bytes, &data, &err), &err);
  if (host != NULL) must(cuda->write(d, data, host, bytes, &err), &err);
  return data;
}

static int sort_gives_what_the_cpu_gives(void)
{
  static const int counts[] = {0, 1, 2, 33, 5000, MOST}, bits[] = {1, 8, 27, 40, 64};
  uint32_t seed = 3;
  cloth_error err = {0};
  cloth_device *d, *host;
  must(cuda->open(0, 1, &d, &err), &err), must(cpu->open(0, 1, &host, &err), &err);
  void *dk = upload(d, NULL, sizeof key), *dks = upload(d, NULL, sizeof key);
  void *dv = upload(d, NULL, sizeof value), *dvs = upload(d, NULL, sizeof value);
  for (int run = 0; run < 2 * 6 * 5; run++) {
    int n = counts[run % 6], b = bits[run / 6 % 5];
    bool with_values = run / 30 == 0;
    uint64_t mask = b == 64 ? ~(uint64_t)0 : ((uint64_t)1 << b) - 1;
    for (int i = 0; i < n; i++) {
      key[i] = ((uint64_t)roll(&seed) << 40 ^ (uint64_t)roll(&seed) << 20 ^ roll(&seed)) & mask;
      if (b >= 17) key[i] &= ~(uint64_t)0xfff0; // many equal keys: order among them is kept
      value[i] = (uint32_t)i;
    }
    must(cuda->write(d, dk, key, sizeof *key * (size_t)n, &err), &err);
    must(cuda->write(d, dv, value, sizeof *value * (size_t)n, &err), &err);
    must(cuda->sort(d, n, b, dk, with_values ? dv : NULL, dks, with_values ? dvs : NULL, &err),
         &err);
    must(cuda->read(d, key_back, dk, sizeof *key * (size_t)n, &err), &err);
    must(cuda->read(d, value_back, dv, sizeof *value * (size_t)n, &err), &err);
    must(cpu->sort(host, n, b, key, with_values ? value : NULL, key_spare,
                   with_values ? value_spare : NULL, &err),
         &err);
    CHECK(memcmp(key, key_back, sizeof *key * (size_t)n) == 0);
    CHECK(memcmp(value, value_back, sizeof *value * (size_t)n) == 0);
  }
  cuda->release(d, dk), cuda->release(d, dks), cuda->release(d, dv), cuda->release(d, dvs);
  cuda->close(d), cpu->close(host);
  return 0;
}

static int scan_gives_what_the_cpu_gives(void)
{
  uint32_t seed = 9;
  cloth_error err = {0};
  cloth_device *d, *host;
  must(cuda->open(0, 1, &d, &err), &err), must(cpu->open(0, 1, &host, &err), &err);
  void *data = upload(d, NULL, sizeof value);
  for (int n = 0; n <= MOST; n = 3 * n + 1) {
    for (int i = 0; i <= n; i++) value[i] = roll(&seed) % 1000; // the last is not looked at
    must(cuda->write(d, data, value, sizeof *value * ((size_t)n + 1), &err), &err);
    must(cuda->scan(d, n, data, &err), &err);
    must(cuda->read(d, value_back, data, sizeof *value * ((size_t)n + 1), &err), &err);
    must(cpu->scan(host, n, value, &err), &err);
    CHECK(memcmp(value, value_back, sizeof *value * ((size_t)n + 1)) == 0);
  }
  cuda->release(d, data), cuda->close(d), cpu->close(host);
  return 0;
}

// few bytes come by a kernel, many by copies, and what is not words too
static int reads_of_any_size_and_place_are_whole(void)
{
  enum { BYTES = 20000 };
  static const size_t sizes[] = {1, 3, 4, 256, 8188, 8192, 8196, BYTES - 8},
                      places[] = {0, 1, 4, 6};
  static unsigned char sent[BYTES], got[BYTES];
  uint32_t seed = 5;
  cloth_error err = {0};
  cloth_device *d;
  must(cuda->open(0, 1, &d, &err), &err);
  unsigned char *a = upload(d, NULL, BYTES), *b = upload(d, NULL, BYTES);
  for (int run = 0; run < 8 * 4; run++) {
    size_t size = sizes[run % 8], at = places[run / 8];
    for (int i = 0; i < BYTES; i++) sent[i] = (unsigned char)roll(&seed);
    memset(got, 0, BYTES);
    must(cuda->write(d, a, sent, BYTES, &err), &err);
    must(cuda->move(d, b, a, BYTES, &err), &err);
    must(cuda->read(d, got, b + at, size, &err), &err);
    CHECK(memcmp(got, sent + at, size) == 0 && got[size] == 0);
  }
  cuda->release(d, a), cuda->release(d, b), cuda->close(d);
  return 0;
}

static int reads_along_come_with_the_next_read(void)
{
  return what_is_read_along_comes_with_the_next_read(cuda);
}

// two devices of one GPU pass a number to and fro; without the events the copies would overtake
static int events_order_what_copies_carry(void)
{
  enum { BYTES = 1 << 20, PASSES = 100 };
  static unsigned char got[BYTES];
  cloth_error err = {0};
  cloth_device *d[2];
  cloth_event *made, *sent;
  for (int i = 0; i < 2; i++) must(cuda->open(0, 1, &d[i], &err), &err);
  must(cuda->event_new(d[0], &made, &err), &err), must(cuda->event_new(d[0], &sent, &err), &err);
  void *a = upload(d[0], NULL, BYTES), *b = upload(d[1], NULL, BYTES);
  for (int pass = 1; pass <= PASSES; pass++) {
    must(cuda->fill(d[0], a, pass, BYTES, &err), &err);
    must(cuda->record(d[0], CLOTH_COMPUTE, made, &err), &err);
    must(cuda->wait(d[0], CLOTH_COPY, made, &err), &err);
    must(cuda->copy(d[0], d[1], b, a, BYTES, &err), &err);
    must(cuda->record(d[0], CLOTH_COPY, sent, &err), &err);
    must(cuda->wait(d[1], CLOTH_COMPUTE, sent, &err), &err);
    must(cuda->read(d[1], got, b, BYTES, &err), &err);
    for (int i = 0; i < BYTES; i += 4095) CHECK(got[i] == pass);
    must(cuda->wait(d[0], CLOTH_COMPUTE, sent, &err), &err);
  }
  double ms = -1;
  must(cuda->record(d[0], CLOTH_COMPUTE, sent, &err), &err);
  must(cuda->elapsed(made, sent, &ms, &err), &err);
  CHECK(ms >= 0 && ms < 1e4);
  cuda->release(d[0], a), cuda->release(d[1], b);
  cuda->event_free(made), cuda->event_free(sent);
  cuda->close(d[0]), cuda->close(d[1]);
  return 0;
}

static int what_does_not_fit_is_refused_and_the_device_lives(void)
{
  cloth_error err = {0}, none = {0};
  cloth_device *d;
  void *data = NULL;
  must(cuda->open(0, 1, &d, &none), &none);
  CHECK(cuda->alloc(d, (size_t)1 << 50, &data, &err) == CLOTH_NO_MEMORY);
  CHECK(strstr(err.text, "bytes wanted") != NULL);
  err = (cloth_error){0};
  CHECK(cuda->open(999, 1, &d, &err) != CLOTH_OK && err.text[0] != 0);
  must(cuda->open(0, 1, &d, &none), &none);
  must(cuda->alloc(d, 1000, &data, &none), &none);
  cuda->release(d, data), cuda->close(d);
  return 0;
}

// ---- whole steps --------------------------------------------------------------------------------

static cloth_def *def_of(const char *backend, const char *preconditioner)
{
  static sheet towel, patch;
  static solid table, ball;
  sheet_make(&towel, 0.3, 0.3, 23, 23);
  sheet_make(&patch, 0.1, 0.1, 8, 8);
  solid_box(&table, 1, 1, 0.1);
  solid_sphere(&ball, 0.05, 16, 9);
  cloth_material m = cloth_material_default();
  m.damping_mass = 0.1;
  cloth_def *def = def_new(PRECISION);
  def_set(def, "backend", backend);
  def_set(def, "preconditioner", preconditioner);
  def_set(def, "air_density", "1.2");
  def_set(def, "wind", "0.5 1 0");
  def_cloth(def, "towel", &towel, m, pose_turned(0, 0, 0.03, 1, 0.3));
  def_cloth(def, "patch", &patch, m, pose_turned(0, 0, 0.1, 0, 0.2));
  def_body(def, "table", &table, 0.5, pose_at(0, 0, -0.05));
  def_body(def, "ball", &ball, 0.3, pose_at(0.08, 0, 0.03));
  return def;
}

// More rows than the kernel for small systems takes: three layers on a ball and a table.
static cloth_def *large_def_of(const char *backend, const char *preconditioner)
{
  static sheet layer;
  static solid table, ball;
  sheet_make(&layer, 0.4, 0.4, 41, 41);
  solid_box(&table, 1, 1, 0.1);
  solid_sphere(&ball, 0.05, 16, 9);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "backend", backend);
  def_set(def, "preconditioner", preconditioner);
  cloth_material m = cloth_material_default();
  def_cloth(def, "below", &layer, m, pose_turned(0, 0, 0.085, 1, 0.02));
  def_cloth(def, "between", &layer, m, pose_turned(0, 0, 0.095, 0, 0.02));
  def_cloth(def, "above", &layer, m, pose_turned(0, 0, 0.105, 1, 0.04));
  def_body(def, "table", &table, 0.5, pose_at(0, 0, -0.05));
  def_body(def, "ball", &ball, 0.3, pose_at(0, 0, 0.03));
  return def;
}

// what is only work space, or a list in the order in which threads came
static bool is_compared(const char *name)
{
  static const char *const not [] = {"row_first",
                                     "row_col",
                                     "row_val", // laid out otherwise
                                     "pair",
                                     "close",
                                     "watch",
                                     "counter",    // asked for earlier: another word
                                     "contact_q",  // large solves leave other things in its holes
                                     "tangle_key", // both lists of the first look
                                     "tangle_how",
                                     "large",
                                     "contact_spare",
                                     "cell_key_spare",
                                     "cell_triangle_spare",
                                     "contact_row_spare",
                                     "contact_entry_spare",
                                     "partial", // large solves have "terms" instead (pcg.h)
                                     "terms",
                                     "coarse_rest", // each CPU thread has its own
                                     "impact_key",
                                     "impact_toi",
                                     "contact_toi_spare"};
  for (size_t i = 0; i < sizeof not / sizeof *not ; i++)
    if (strcmp(name, not [i]) == 0) return false;
  return true;
}

static int compare_keys(const void *a, const void *b)
{
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

static int same_pairs(const cloth_sim *a, const cloth_sim *b)
{
  const cloth_part *p = &a->part[0], *q = &b->part[0];
  size_t n = (size_t)p->pair_count;
  cloth_error err = {0};
  CHECK(p->pair_count == q->pair_count && n > 0 && n <= MOST);
  memcpy(key, p->pair, sizeof *key * n);
  must(cuda->read(q->device, key_back, q->pair, sizeof *key * n, &err), &err);
  qsort(key, n, sizeof *key, compare_keys), qsort(key_back, n, sizeof *key, compare_keys);
  CHECK(memcmp(key, key_back, sizeof *key * n) == 0);
  return 0;
}

static int same_blocks(const cloth_sim *a, const cloth_sim *b, int step)
{
  const cloth_part *p = &a->part[0], *q = &b->part[0];
  cloth_error err = {0};
  int different = 0;
  CHECK(p->block_count == q->block_count && p->contact_count == q->contact_count);
  for (int i = 0; i < p->block_count; i++) {
    const cloth_block *host = &p->block[i], *device = &q->block[i];
    CHECK(strcmp(host->name, device->name) == 0);
    if (!is_compared(host->name)) continue;
    CHECK(host->bytes == device->bytes);
    unsigned char *copy = malloc(host->bytes + 1);
    must(cuda->read(q->device, copy, device->data, device->bytes, &err), &err);
    bool same = memcmp(copy, host->data, host->bytes) == 0;
    size_t at = 0;
    while (!same && copy[at] == ((const unsigned char *)host->data)[at]) at++;
    free(copy);
    if (!same)
      printf("  step %d: %s differs at byte %zu of %zu\n", step, host->name, at, host->bytes);
    different += !same;
  }
  CHECK(different == 0);
  return same_pairs(a, b);
}

static int steps_alike(cloth_def *host_def, cloth_def *device_def, int steps, int least)
{
  cloth_sim *host = sim_new(host_def), *device = sim_new(device_def);
  CHECK(strcmp(device->backend->name, "cuda") == 0 && device->vertex_count > least);
  int self = 0, body = 0, failed = 0;
  for (int step = 1; step <= steps && !failed; step++) {
    cloth_step_report r = sim_step(host, 1), s = sim_step(device, 1);
    CHECK(r.pcg_iterations == s.pcg_iterations && r.impacts == s.impacts);
    self += r.contacts_self, body += r.contacts_body;
    failed = same_blocks(host, device, step);
  }
  CHECK(!failed && self > 0 && body > 0);
  cloth_sim_free(host), cloth_sim_free(device);
  cloth_def_free(host_def), cloth_def_free(device_def);
  return 0;
}

static int every_buffer_of_a_step_holds_the_bits_of_the_cpu(void)
{
  const char *const preconditioner[] = {"two_level", "block_jacobi", "multilevel"};
  int failed = 0;
  for (int i = 0; i < 3; i++)
    failed +=
        steps_alike(def_of("cpu", preconditioner[i]), def_of("cuda", preconditioner[i]), 24, 0);
  return failed;
}

static int a_large_solve_holds_the_bits_of_the_cpu(void)
{
  const char *const preconditioner[] = {"two_level", "block_jacobi", "multilevel"};
  int failed = 0;
  for (int i = 0; i < 3; i++)
    failed += steps_alike(large_def_of("cpu", preconditioner[i]),
                          large_def_of("cuda", preconditioner[i]), 8, SMALL_MOST);
  return failed;
}

// What falls too fast for contacts goes to impact zones.
static int impact_zones_hold_the_bits_of_the_cpu(void)
{
  cloth_def *def[2] = {def_of("cpu", "two_level"), def_of("cuda", "two_level")};
  cloth_sim *sim[2];
  int zones = 0, largest = 0, failed = 0;
  for (int i = 0; i < 2; i++) {
    def_set(def[i], "gravity", "0 0 -150");
    def_set(def[i], "contact_rounds_max", "0");
    sim[i] = sim_new(def[i]);
  }
  for (int step = 1; step <= 8 && !failed; step++) {
    cloth_step_report r = sim_step(sim[0], 1), s = sim_step(sim[1], 1);
    CHECK(r.zones == s.zones && r.held_back == s.held_back);
    zones += r.zones;
    if (r.zone_largest > largest) largest = r.zone_largest;
    failed = same_blocks(sim[0], sim[1], step);
  }
  printf("  %d zones of at most %d vertices\n", zones, largest);
  CHECK(!failed && zones > 10 && largest > 20);
  for (int i = 0; i < 2; i++) cloth_sim_free(sim[i]), cloth_def_free(def[i]);
  return 0;
}

// 1 s of a calm scene in float against the CPU in double (PRECISION double: the same bits, see
// above)
static int a_calm_second_stays_near_the_cpu_in_double(void)
{
  static sheet towel;
  static double x[2][3 * SHEET_MAX];
  sheet_make(&towel, 0.3, 0.3, 21, 21);
  int top[21];
  for (int i = 0; i < 21; i++) top[i] = 20 * 21 + i;
  for (int which = 0; which < 2; which++) {
    cloth_def *def = def_new(which ? PRECISION : "double");
    def_set(def, "backend", which ? "cuda" : "cpu");
    def_set(def, "pcg_tolerance", "1e-3");
    cloth_material m = cloth_material_default();
    m.damping_mass = 2;
    def_cloth(def, "towel", &towel, m, pose_turned(0, 0, 1, 0, acos(0)));
    cloth_scene *scene = scene_new(def);
    scene_hold(scene, 0, top, 21, pose_at(0, 0, 1));
    scene_step(scene, 60);
    scene_positions(scene, 0, x[which]);
    cloth_scene_free(scene);
  }
  double worst = 0;
  for (int i = 0; i < 3 * 21 * 21; i++) worst = fmax(worst, fabs(x[0][i] - x[1][i]));
  printf("  largest difference %.3g of the cloth's size\n", worst / 0.3);
  CHECK_NEAR(worst / 0.3, 0, 1e-4);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  cpu = cloth_backend_cpu(), cuda = cloth_backend_cuda();
  bool gpu = cuda != NULL && cuda->device_count() > 0;
  RUN_ON(gpu, sort_gives_what_the_cpu_gives);
  RUN_ON(gpu, scan_gives_what_the_cpu_gives);
  RUN_ON(gpu, reads_of_any_size_and_place_are_whole);
  RUN_ON(gpu, reads_along_come_with_the_next_read);
  RUN_ON(gpu, events_order_what_copies_carry);
  RUN_ON(gpu, what_does_not_fit_is_refused_and_the_device_lives);
  RUN_ON(gpu, every_buffer_of_a_step_holds_the_bits_of_the_cpu);
  RUN_ON(gpu, a_large_solve_holds_the_bits_of_the_cpu);
  RUN_ON(gpu, impact_zones_hold_the_bits_of_the_cpu);
  RUN_ON(gpu, a_calm_second_stays_near_the_cpu_in_double);
  return failures > 0;
}
