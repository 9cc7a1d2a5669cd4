// Parts that solve together (kernels/physics/pcg_part.h): what they send is what others read, no
// order in which they run shows in a number, and who waits for a part that is gone is told so. The
// backend under test is the CPU's with another solve_parts, which spoils what must not be read and
// throws the order of the parts.
#include "contact_geometry.h"
#include "solve/sim.h"
#include "solve_parts.h"

enum { N = 21, VERTICES = 2 * N * N, STEPS = 4 };

static sheet cloth;
static solid table;

static const char *devices_of(int parts)
{
  static char text[16 * 5 + 1];
  text[0] = 0;
  for (int i = 0; i < parts; i++) strcat(text, i ? ", cpu" : "cpu");
  return text;
}

static double upper_z = 0.0055; // m

// two layers on a table, turned against each other: contacts join almost any two parts
static cloth_def *def_of(int parts, const char *exchange, const char *overlap)
{
  sheet_make(&cloth, 0.2, 0.2, N, N);
  solid_box(&table, 1, 1, 0.1);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", devices_of(parts));
  def_set(def, "threads", "1");
  def_set(def, "preconditioner", "multilevel");
  def_set(def, "exchange", exchange);
  def_set(def, "overlap", overlap);
  def_cloth(def, "lower", &cloth, cloth_material_default(), pose_at(0, 0, 0.003));
  def_cloth(def, "upper", &cloth, cloth_material_default(),
            pose_turned(0.01, 0.02, upper_z, 2, 1.2));
  def_body(def, "table", &table, 0.4, pose_at(0, 0, -0.05));
  return def;
}

// ---- a backend that throws dice -----------------------------------------------------------------

static struct {
  unsigned seed;
  int stopped; // part that never runs; -1: none
  int solves, inner, outer_contacts, sent, needed;
} dice;

// what others own is not there before it is sent
static void spoil(int parts, const cloth_pcg_part_args *a)
{
  for (int i = 0; i < parts; i++) {
    const cloth_pcg_vectors *v = &a[i].solve.v;
    for (int k = 0; k < 3 * VERTICES; k++) a[i].peer[i].p[k] = (cloth_real)NAN;
    for (int k = 0; k < v->chunks; k++) a[i].peer[i].pq[k] = (cloth_real)NAN;
    for (int k = 0; k < v->chunks * CLOTH_PCG_PARTIALS; k++) v->partial[k] = (cloth_real)NAN;
  }
}

static void count_sent(int parts, const cloth_pcg_part_args *a)
{
  for (int i = 0; i < parts; i++) {
    const cloth_pcg_vectors *v = &a[i].solve.v;
    if (!(v->scalar[CLOTH_PCG_ITERATIONS] > 0)) continue; // solved before a direction was needed
    dice.inner += (v->count + CLOTH_CHUNK - 1) / CLOTH_CHUNK - (int)a[i].outer[0];
    dice.outer_contacts += (int)a[i].outer[1];
    for (int k = 0; k < VERTICES; k++)
      dice.sent += (k < v->first || k >= v->first + v->count) && v->p[3 * k] == v->p[3 * k];
    for (int row = 0; row < v->count; row++)
      for (int j = 0; j < parts; j++) dice.needed += (int)(a[i].reader[row] >> j & 1);
  }
}

static cloth_status solve_thrown(int parts, cloth_device *const *device,
                                 const cloth_pcg_part_args *a, cloth_error *err)
{
  (void)device;
  spoil(parts, a);
  dice.solves++;
  CLOTH_TRY(cloth_cpu_solve_parts(parts, a, 1, dice.seed++, dice.stopped, err));
  count_sent(parts, a);
  return CLOTH_OK;
}

static cloth_backend thrown;

// the state after STEPS steps; 0 parts thrown: the backend as it is
static uint64_t run(int parts, const char *exchange, const char *overlap, unsigned seed)
{
  cloth_error err = {0};
  cloth_def *def = def_of(parts, exchange, overlap);
  cloth_sim *sim = sim_new(def);
  uint64_t hash = 0;
  memset(&dice, 0, sizeof dice);
  dice.seed = seed, dice.stopped = -1;
  thrown = *sim->backend, thrown.solve_parts = solve_thrown;
  if (seed > 0) sim->backend = &thrown;
  sim_step(sim, STEPS);
  must(cloth_sim_hash(sim, &hash, &err), &err);
  cloth_sim_free(sim);
  cloth_def_free(def);
  return hash;
}

// ---- sentences ----------------------------------------------------------------------------------

static int any_number_of_parts(void)
{
  uint64_t one = run(1, "halo", "on", 0);
  for (int parts = 2; parts <= 16; parts++) {
    CHECK(run(parts, "halo", parts % 2 ? "on" : "off", (unsigned)parts) == one);
    CHECK(dice.solves >= STEPS && dice.outer_contacts > 0 && dice.sent == dice.needed);
  }
  return 0;
}

static int any_order_of_the_parts(void)
{
  uint64_t one = run(1, "halo", "on", 0);
  for (unsigned seed = 1; seed < 6; seed++) {
    CHECK(run(5, "halo", "on", 77 * seed) == one);
    CHECK(run(4, "whole", "on", 1000 * seed) == one);
  }
  CHECK(run(3, "whole", "off", 5) == one);
  CHECK(dice.sent == 2 * VERTICES * dice.solves);
  CHECK(run(3, "launches", "on", 0) == one);
  return 0;
}

static int rows_that_need_nobody_go_first(void)
{
  upper_z = 0.1; // the layers do not touch: most rows are inner ones
  uint64_t one = run(1, "halo", "on", 0);
  for (unsigned seed = 1; seed < 4; seed++) {
    CHECK(run(2, "halo", "on", 77 * seed) == one);
    CHECK(dice.inner >= dice.solves && dice.sent == dice.needed);
  }
  upper_z = 0.0055;
  return 0;
}

// the sets of columns and corners that a part reads, against who is said to read each row
static int readers_are_those_who_read(void)
{
  static bool reads[16][VERTICES];
  cloth_def *def = def_of(7, "halo", "on");
  cloth_sim *sim = sim_new(def);
  sim_step(sim, STEPS);
  memset(reads, 0, sizeof reads);
  for (int j = 0; j < 7; j++) {
    const cloth_part *p = &sim->part[j];
    int groups = (p->v1 - p->v0 + CLOTH_ROW_GROUP - 1) / CLOTH_ROW_GROUP;
    for (int s = 0; s < p->row_first[groups] * CLOTH_ROW_GROUP; s++) reads[j][p->row_col[s]] = true;
    for (int c = 0; c < 4 * p->contact_count; c++)
      if (p->contact_vertex[c] < VERTICES) reads[j][p->contact_vertex[c]] = true;
  }
  for (int i = 0; i < 7; i++)
    for (int v = sim->part[i].v0; v < sim->part[i].v1; v++)
      for (int j = 0; j < 7; j++)
        if (i != j) CHECK(reads[j][v] == (sim->part[i].reader[v - sim->part[i].v0] >> j & 1));
  cloth_sim_free(sim);
  cloth_def_free(def);
  return 0;
}

static int order_has_inner_chunks_first(void)
{
  cloth_def *def = def_of(3, "halo", "on");
  cloth_sim *sim = sim_new(def);
  sim_step(sim, STEPS);
  for (int i = 0; i < 3; i++) {
    const cloth_part *p = &sim->part[i];
    int chunks = cloth_part_chunks(p), seen[64] = {0};
    for (int k = 0; k < chunks; k++) {
      uint32_t c = p->halo_order[k];
      CHECK((int)c < chunks && seen[c]++ == 0);
      CHECK((p->chunk_reader[c] != 0) == (k >= chunks - (int)p->halo_outer[0]));
    }
  }
  cloth_sim_free(sim);
  cloth_def_free(def);
  return 0;
}

static int a_part_that_is_gone(void)
{
  for (int gone = 0; gone < 3; gone++) {
    cloth_def *def = def_of(3, "halo", "on");
    cloth_sim *sim = sim_new(def);
    cloth_error err = {0};
    cloth_step_report report = {0};
    sim_step(sim, 1);
    memset(&dice, 0, sizeof dice);
    dice.stopped = gone;
    thrown = *sim->backend, thrown.solve_parts = solve_thrown;
    sim->backend = &thrown;
    CHECK(cloth_sim_step(sim, 1.0 / 60, &report, &err) == CLOTH_DEVICE_LOST);
    CHECK(strstr(err.text, "wait for each other") != NULL);
    cloth_sim_free(sim);
    cloth_def_free(def);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(any_number_of_parts);
  RUN(any_order_of_the_parts);
  RUN(rows_that_need_nobody_go_first);
  RUN(readers_are_those_who_read);
  RUN(order_has_inner_chunks_first);
  RUN(a_part_that_is_gone);
  return failures > 0;
}
