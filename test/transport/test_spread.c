// What one process of several does with the backend's table: its own part's work is done, another's
// is not, numbers that the host reads are the owner's, and an error of one is everybody's. The
// other process is played by a transport with a script.
#include "solve/sim.h"
#include "transport/spread.h"

static struct {
  int shared, agreed, from; // calls; who spoke last
  int failed;               // status that the other process tells
  uint32_t number;          // what it has read
} other;

static cloth_status share(const cloth_transport *t, int from, void *host, size_t bytes,
                          cloth_error *err)
{
  (void)err;
  other.shared++, other.from = from;
  if (from == t->rank) return CLOTH_OK;
  if (bytes == sizeof other.failed) memcpy(host, &other.failed, bytes);
  if (bytes == 2 * sizeof other.number)
    memcpy(host, (uint32_t[2]){other.number, other.number}, bytes);
  return CLOTH_OK;
}

static cloth_status agree(const cloth_transport *t, cloth_status mine, cloth_error *err)
{
  (void)t;
  other.agreed++;
  if (other.failed == CLOTH_OK || mine != CLOTH_OK) return mine;
  return cloth_fail(err, (cloth_status)other.failed, "there", 7, "no room there");
}

static cloth_transport transport = {
    .name = "script", .rank = 1, .ranks = 2, .share = share, .agree = agree};

static cloth_backend inner; // the CPU's, counted, and refusing
static int launches;
static cloth_status refuse;

static cloth_status counted(cloth_device *d, cloth_kernel k, int n, const void *args,
                            cloth_error *err)
{
  (void)d, (void)k, (void)n, (void)args;
  launches++;
  if (refuse != CLOTH_OK) return cloth_fail(err, refuse, "here", 3, "lost in a launch");
  return CLOTH_OK;
}

static const cloth_backend *open_both(cloth_device *device[2], cloth_error *err)
{
  memset(&other, 0, sizeof other);
  inner = *cloth_backend_cpu();
  inner.launch = counted, refuse = CLOTH_OK, launches = 0;
  const cloth_backend *be = cloth_backend_spread(&inner, &transport);
  for (int i = 0; i < 2; i++) must(be->open(i, 1, &device[i], err), err);
  return be;
}

static void close_both(const cloth_backend *be, cloth_device *device[2])
{
  for (int i = 0; i < 2; i++) be->close(device[i]);
}

static int only_its_own_part_is_worked_on(void)
{
  cloth_error err = {0};
  cloth_device *device[2];
  const cloth_backend *be = open_both(device, &err);
  CHECK(be->device_count() == 2);
  CHECK_OK(be->launch(device[0], (cloth_kernel)0, 5, NULL, &err), err);
  CHECK(launches == 0);
  CHECK_OK(be->launch(device[1], (cloth_kernel)0, 5, NULL, &err), err);
  CHECK(launches == 1);
  void *theirs[2];
  for (int i = 0; i < 2; i++) CHECK_OK(be->alloc(device[0], 4000, &theirs[i], &err), err);
  CHECK(theirs[0] != NULL && theirs[1] != NULL && theirs[0] != theirs[1]); // told apart by address
  // nothing is behind them: these would write past the end
  CHECK_OK(be->fill(device[0], theirs[0], 7, 4000, &err), err);
  CHECK_OK(be->write(device[0], theirs[0], "12345678", 8, &err), err);
  for (int i = 0; i < 2; i++) be->release(device[0], theirs[i]);
  close_both(be, device);
  return 0;
}

static int the_host_reads_what_the_owner_has(void)
{
  cloth_error err = {0};
  cloth_device *device[2];
  const cloth_backend *be = open_both(device, &err);
  uint32_t mine[2] = {5, 6}, got[2] = {0, 0};
  void *memory[2];
  for (int i = 0; i < 2; i++) CHECK_OK(be->alloc(device[i], sizeof mine, &memory[i], &err), err);
  other.number = 77;
  CHECK_OK(be->write(device[1], memory[1], mine, sizeof mine, &err), err);
  CHECK_OK(be->read(device[1], got, memory[1], sizeof got, &err), err);
  CHECK(got[0] == 5 && got[1] == 6 && other.from == 1);
  CHECK_OK(be->read(device[0], got, memory[0], sizeof got, &err), err);
  CHECK(got[0] == 77 && got[1] == 77 && other.from == 0);
  for (int i = 0; i < 2; i++) be->release(device[i], memory[i]);
  close_both(be, device);
  return 0;
}

static int an_error_waits_until_all_listen(void)
{
  cloth_error err = {0};
  cloth_device *device[2];
  const cloth_backend *be = open_both(device, &err);
  uint32_t got[2];
  void *memory;
  CHECK_OK(be->alloc(device[1], sizeof got, &memory, &err), err);
  refuse = CLOTH_DEVICE_LOST;
  CHECK_OK(be->launch(device[1], (cloth_kernel)0, 5, NULL, &err),
           err); // alone it must not turn back
  CHECK_OK(be->launch(device[1], (cloth_kernel)0, 5, NULL, &err), err);
  CHECK(launches == 1); // nothing more on a lost device
  int before = other.agreed;
  CHECK(be->read(device[1], got, memory, sizeof got, &err) == CLOTH_DEVICE_LOST);
  CHECK(other.agreed == before + 1);
  CHECK(strstr(err.text, "process 1: lost in a launch") != NULL);
  be->release(device[1], memory);
  close_both(be, device);
  return 0;
}

static int a_full_device_of_another_is_everybodys(void)
{
  cloth_error err = {0};
  cloth_device *device[2];
  const cloth_backend *be = open_both(device, &err);
  void *memory = &err;
  other.failed = CLOTH_NO_MEMORY;
  CHECK(be->alloc(device[0], 64, &memory, &err) == CLOTH_NO_MEMORY);
  CHECK(memory == NULL && strcmp(err.text, "no room there") == 0 && err.line == 7);
  close_both(be, device);
  return 0;
}

// the clock of process 0, which all must take for theirs
static cloth_status share_time(const cloth_transport *t, int from, void *host, size_t bytes,
                               cloth_error *err)
{
  (void)t, (void)err;
  if (from == 0 && bytes == sizeof(cloth_step_report)) ((cloth_step_report *)host)->wall_ms = 1234;
  return CLOTH_OK;
}

static cloth_status connect(cloth_transport *t, const cloth_backend *be, cloth_device *here,
                            cloth_error *err)
{
  (void)t, (void)be, (void)err;
  return here != NULL ? CLOTH_OK : CLOTH_INTERNAL;
}

static int times_are_those_of_process_0(void)
{
  cloth_transport one = transport;
  one.rank = 0, one.ranks = 1, one.share = share_time, one.connect = connect;
  memset(&other, 0, sizeof other);
  cloth_error err = {0};
  cloth_def *def = def_new(PRECISION);
  static sheet s;
  sheet_make(&s, 0.2, 0.2, 9, 9);
  def_cloth(def, "sheet", &s, cloth_material_default(), pose_at(0, 0, 0));
  def_set(def, "devices", "mpi");
  def_set(def, "backend", "cpu");
  void *sim;
  cloth_step_report report;
  CHECK_OK(cloth_sim_new(def, &one, &sim, &err), err);
  CHECK_OK(cloth_sim_step(sim, 0.01, &report, &err), err);
  CHECK(report.wall_ms == 1234 && report.step == 1);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(only_its_own_part_is_worked_on);
  RUN(the_host_reads_what_the_owner_has);
  RUN(an_error_waits_until_all_listen);
  RUN(a_full_device_of_another_is_everybodys);
  RUN(times_are_those_of_process_0);
  return failures > 0;
}
