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
static const char *levels = "multilevel";

// two layers on a table, turned against each other: contacts join almost any two parts
static cloth_def *def_of(int parts, const char *exchange, const char *overlap)
{
  sheet_make(&cloth, 0.2, 0.2, N, N);
  solid_box(&table, 1, 1, 0.1);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", devices_of(parts));
  def_set(def, "threads", "1");
  def_set(def, "preconditioner", levels);
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
  int stopped;                                            // part that never runs; -1: none
  int solves, moved, inner, outer_contacts, sent, needed; // moved: solves with an iteration
} dice;

static void spoil_hats(const cloth_pcg_part_args *a)
{
  const cloth_pcg_vectors *v = &a->solve.v;
  for (int k = 0; k < 3 * VERTICES; k++) v->r[k] = v->q[k] = (cloth_real)NAN;
  for (int k = 0; k < 3 * v->hats.nodes; k++)
    v->hats.rest[k] = v->hats.correction[k] = (cloth_real)NAN;
  for (int k = 0; k < cloth_hat_fine_groups(&v->hats) + cloth_hat_groups(&v->hats); k++)
    a->solve.hats.partial[CLOTH_PCG_PARTIALS * k] = (cloth_real)NAN;
}

// what others own is not there before it is sent
static void spoil(int parts, const cloth_pcg_part_args *a)
{
  for (int i = 0; i < parts; i++) {
    const cloth_pcg_vectors *v = &a[i].solve.v;
    for (int k = 0; k < 3 * VERTICES; k++) a[i].peer[i].p[k] = (cloth_real)NAN;
    int terms = 3 * cloth_chunk_groups(v->chunks) + a[i].solve.beta.more;
    for (int k = 0; k < terms; k++) a[i].solve.terms.pq[k] = (cloth_real)NAN;
    for (int k = 0; k < v->chunks * CLOTH_PCG_PARTIALS; k++) v->partial[k] = (cloth_real)NAN;
    if (v->hats.nodes > 0) spoil_hats(&a[i]);
  }
}

static void count_sent(int parts, const cloth_pcg_part_args *a)
{
  dice.moved += a[0].solve.v.scalar[CLOTH_PCG_ITERATIONS] > 0;
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

static int any_number_of_parts_with_each_preconditioner(void)
{
  static const char *const name[] = {"two_level", "block_jacobi"};
  for (int i = 0; i < 2; i++) {
    levels = name[i];
    uint64_t one = run(1, "halo", "on", 0);
    for (int parts = 2; parts <= 14; parts += 4)
      CHECK(run(parts, "halo", parts % 4 ? "on" : "off", (unsigned)parts) == one);
    CHECK(run(3, "launches", "on", 0) == one);
  }
  levels = "multilevel";
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
  CHECK(dice.moved >= STEPS && dice.sent == 2 * VERTICES * dice.moved);
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

// every node of the hats' first level has one owner, who has r of all vertices that share in it,
// and tells all parts whose vertices do
static int nodes_belong_to_one_part_each(void)
{
  cloth_def *def = def_of(5, "halo", "on"), *def_one = def_of(1, "halo", "on");
  cloth_sim *sim = sim_new(def), *one = sim_new(def_one);
  const cloth_hats *h = &one->part[0].hats;
  int next = 0, strangers = 0, entries = 0;
  CHECK(h->fine > 64);
  for (int i = 0; i < 5; i++) {
    const cloth_part *p = &sim->part[i];
    const cloth_hat_share *s = &p->hat_share;
    CHECK(s->begin == next && (s->end % CLOTH_HAT_FINE_GROUP == 0 || s->end == h->fine));
    next = s->end;
    for (int c = 0; c < h->fine; c++) {
      bool own = c >= s->begin && c < s->end;
      int count = p->hats.first[c + 1] - p->hats.first[c];
      CHECK(count == (own ? h->first[c + 1] - h->first[c] : 0));
      entries += count;
    }
    for (int v = 0; v < VERTICES; v++) {
      int at = 0, needed = 0, listed = 0;
      while (v >= sim->part[at].v1) at++;
      for (int k = 4 * v; k < 4 * v + 4; k++) {
        needed |= at != i && h->weight[k] > 0 && h->corner[k] >= s->begin && h->corner[k] < s->end;
        CHECK(p->hat_share.node_reader[h->corner[k]] >> at & 1);
      }
      for (int k = 0; k < s->other_count; k++) listed += s->others[k] == v;
      CHECK(listed == needed);
      strangers += needed;
      if (at != i)
        CHECK((sim->part[at].hat_share.row_reader[v - sim->part[at].v0] >> i & 1) ==
              (unsigned)needed);
    }
  }
  CHECK(next == h->fine && entries == h->first[h->fine]);
  CHECK(strangers > 0 && strangers < VERTICES);
  cloth_sim_free(sim), cloth_sim_free(one);
  cloth_def_free(def), cloth_def_free(def_one);
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
  RUN(any_number_of_parts_with_each_preconditioner);
  RUN(any_order_of_the_parts);
  RUN(nodes_belong_to_one_part_each);
  RUN(rows_that_need_nobody_go_first);
  RUN(readers_are_those_who_read);
  RUN(order_has_inner_chunks_first);
  RUN(a_part_that_is_gone);
  return failures > 0;
}
