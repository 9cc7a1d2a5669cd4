// What would pass through does not, and moves no more than it must: random motions of stacked
// sheets and a ball, judged by edges that pierce faces at any time of the motion (worked out here,
// in double), by momentum, and by the closed form of a single impact.
#include "ccd/impacts.h"
#include "ccd/pierce.h"
#include "solve/sim.h"

enum { N = 9, SHEETS = 3, TIMES = 16 };

static sheet cloth;
static solid ball;

static cloth_def *def_of(const char *devices, int sheets, bool with_ball)
{
  static const char *const name[] = {"one", "two", "three"};
  sheet_make(&cloth, 0.2, 0.2, N, N);
  solid_sphere(&ball, 0.04, 12, 6);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", devices);
  for (int i = 0; i < sheets; i++)
    def_cloth(def, name[i], &cloth, cloth_material_default(),
              pose_turned(0, 0, 0.01 * i, 2, 0.2 * i));
  if (with_ball) def_body(def, "ball", &ball, 0.5, pose_at(0, 0, -0.05));
  return def;
}

// every vertex goes up to `motion` [m], neighbours not alike; the ball goes up by `lift`
static void move(cloth_sim *sim, double motion, double lift, uint32_t seed)
{
  cloth_error err = {0};
  static cloth_step_report report;
  memset(&report, 0, sizeof report);
  sim->report = &report;
  must(cloth_freeze_bodies(sim, &err), &err);
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    uint32_t s = seed;
    for (int i = 0; i < 3 * sim->vertex_count; i++)
      part->x[i] = part->x_t0[i] + (cloth_real)(motion * roll_real(&s)), part->v[i] = 0;
    for (int v = sim->vertex_count; v < sim->all_vertices; v++)
      part->x[3 * v + 2] = part->x_t0[3 * v + 2] + (cloth_real)lift;
  }
  sim->pairs_valid = false;
  must(cloth_pairs_search(sim, &err), &err);
}

// ---- sentences ----------------------------------------------------------------------------------

static int random_motions_pass_nothing_through(void)
{
  cloth_error err = {0};
  int zones = 0, held_back = 0, would = 0;
  for (uint32_t seed = 1; seed <= 12; seed++) {
    cloth_def *def = def_of("cpu", SHEETS, true);
    cloth_sim *sim = sim_new(def);
    double motion = 0.004 * (1 + seed % 4);
    move(sim, motion, 0.02, seed);
    would += piercings(sim, 1);
    int impacts, left;
    must(cloth_ccd_detect(sim, &impacts, &err), &err);
    must(cloth_ccd_resolve(sim, &left, &err), &err);
    CHECK(left == 0);
    for (int k = 1; k <= TIMES; k++) CHECK(piercings(sim, (double)k / TIMES) == 0);
    zones += sim->report->zones, held_back += sim->report->held_back;
    cloth_sim_free(sim), cloth_def_free(def);
  }
  printf("  %d piercings to come; %d zones, %d pairs held back\n", would, zones, held_back);
  CHECK(would > 1000 && zones > 12);
  return 0;
}

static int zones_alone_are_enough_for_moderate_motion(void)
{
  cloth_error err = {0};
  for (uint32_t seed = 1; seed <= 8; seed++) {
    cloth_def *def = def_of("cpu", 2, false);
    cloth_sim *sim = sim_new(def);
    move(sim, 0.008, 0, seed);
    int impacts, left, would = piercings(sim, 1);
    must(cloth_ccd_detect(sim, &impacts, &err), &err);
    must(cloth_ccd_resolve(sim, &left, &err), &err);
    CHECK(would > 0 && sim->report->zones > 0 && sim->report->held_back == 0);
    CHECK(piercings(sim, 1) == 0);
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return 0;
}

static int zones_keep_momentum(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu", 2, false);
  cloth_sim *sim = sim_new(def);
  move(sim, 0.008, 0, 5);
  int impacts, left, n = 3 * sim->vertex_count;
  double *before = malloc(sizeof *before * (size_t)n), sum[3] = {0, 0, 0}, size = 0;
  for (int i = 0; i < n; i++) before[i] = (double)sim->part[0].x[i];
  must(cloth_ccd_detect(sim, &impacts, &err), &err);
  must(cloth_ccd_resolve(sim, &left, &err), &err);
  for (int i = 0; i < n; i++) {
    double impulse = sim->mass[i / 3] * ((double)sim->part[0].x[i] - before[i]);
    sum[i % 3] += impulse, size += fabs(impulse);
  }
  free(before);
  CHECK(size > 0 && sim->report->held_back == 0);
  double tolerance = sizeof(cloth_real) == 4 ? 2e-5 : 1e-13; // rounding of positions
  for (int k = 0; k < 3; k++) CHECK_NEAR(sum[k] / size, 0, tolerance);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// weights of the point x in face f, seen from above
static void weights(const cloth_sim *sim, const int *f, const double x[3], double bary[3])
{
  double c[3][3];
  for (int k = 0; k < 3; k++) at(sim, f[k], 0, c[k]);
  double area =
      (c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) - (c[2][0] - c[0][0]) * (c[1][1] - c[0][1]);
  for (int k = 0; k < 3; k++) {
    const double *a = c[(k + 1) % 3], *b = c[(k + 2) % 3];
    bary[k] = ((a[0] - x[0]) * (b[1] - x[1]) - (b[0] - x[0]) * (a[1] - x[1])) / area;
  }
}

// a vertex of the upper sheet well inside a face of the lower one
static int above(const cloth_sim *sim, const int **face, double bary[3])
{
  for (int v = sim->cloth_first[1]; v < sim->cloth_first[2]; v++)
    for (int t = sim->triangle_first[0]; t < sim->triangle_first[1]; t++) {
      double x[3];
      at(sim, v, 0, x);
      *face = sim->triangle + 3 * t;
      weights(sim, *face, x, bary);
      if (bary[0] > 0.25 && bary[1] > 0.25 && bary[2] > 0.25) return v;
    }
  return -1;
}

// one vertex of the upper sheet would just pass through the lower one
static int one_impact_is_its_closed_form(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu", 2, false);
  cloth_sim *sim = sim_new(def);
  move(sim, 0, 0, 1);
  const int *f;
  double bary[3], depth = 0.0005;
  int v = above(sim, &f, bary), impacts, left;
  CHECK(v >= 0);
  cloth_real *x = sim->part[0].x;
  x[3 * v + 2] = (cloth_real)-depth;
  sim->pairs_valid = false;
  must(cloth_pairs_search(sim, &err), &err);
  must(cloth_ccd_detect(sim, &impacts, &err), &err);
  must(cloth_ccd_resolve(sim, &left, &err), &err);
  CHECK(left == 0 && sim->report->impacts == 1 && sim->report->zones == 1);
  CHECK(sim->report->zone_rounds == 1 && sim->report->zone_largest == 4);
  // sum w^2 / m dp = what closes it; each vertex gets its share of the impulse over its mass
  double compliance = 1 / sim->mass[v], apart = (double)x[3 * v + 2];
  for (int k = 0; k < 3; k++) {
    compliance += bary[k] * bary[k] / sim->mass[f[k]];
    apart -= bary[k] * (double)x[3 * f[k] + 2];
  }
  double gap = cloth_impact_gap(sim), impulse = (apart + depth) / compliance;
  CHECK_NEAR(apart, 2 * gap, 0.2 * gap);
  double tolerance = 1e-6; // m; the direction is that of the closest points, not exactly upright
  CHECK_NEAR((double)x[3 * v + 2] + depth, impulse / sim->mass[v], tolerance);
  for (int k = 0; k < 3; k++)
    CHECK_NEAR((double)x[3 * f[k] + 2], -bary[k] * impulse / sim->mass[f[k]], tolerance);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// however often two features are pressed together, they do not come nearer step by step
static int what_is_nearer_than_an_impact_opens_again(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu", 2, false);
  cloth_sim *sim = sim_new(def);
  move(sim, 0, 0, 1);
  const int *f;
  double bary[3], distance = 0.2 * cloth_impact_gap(sim);
  int v = above(sim, &f, bary), impacts, left;
  CHECK(v >= 0);
  cloth_part *p = &sim->part[0];
  for (int substep = 0; substep < 12; substep++) {
    double before = (double)p->x_t0[3 * v + 2], after = 0;
    if (substep == 0) before = distance, p->x_t0[3 * v + 2] = (cloth_real)distance;
    p->x[3 * v + 2] = (cloth_real)(before - 0.0005);
    sim->pairs_valid = false;
    must(cloth_pairs_search(sim, &err), &err);
    must(cloth_ccd_detect(sim, &impacts, &err), &err);
    CHECK(impacts > 0);
    must(cloth_ccd_resolve(sim, &left, &err), &err);
    CHECK(left == 0 && sim->report->held_back == 0);
    after = (double)p->x[3 * v + 2];
    for (int k = 0; k < 3; k++) after -= bary[k] * (double)p->x[3 * f[k] + 2];
    CHECK(after > 1.1 * distance || after > 0.8 * cloth_impact_gap(sim));
    distance = after;
    memcpy(p->x_t0, p->x, sizeof *p->x * 3 * (size_t)sim->vertex_count);
  }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// so that threads may close the constraints of one colour side by side
static int constraints_of_a_colour_share_no_moving_vertex(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu", SHEETS, true);
  cloth_sim *sim = sim_new(def);
  move(sim, 0.016, 0.02, 3);
  int impacts, left, most = 0, last = -1;
  must(cloth_ccd_detect(sim, &impacts, &err), &err);
  must(cloth_ccd_resolve(sim, &left, &err), &err);
  const cloth_zones *z = &sim->zones;
  CHECK(z->zones > 0 && z->count > 1);
  for (int i = 0; i < z->zones; i++, last = -1)
    for (int m = z->first[i]; m < z->first[i + 1]; m++) {
      CHECK(z->colour[m] >= last && z->colour[m] <= last + 1 && z->colour[m] < 63);
      last = z->colour[m];
      if (last > most) most = last;
      for (int n = m + 1; n < z->first[i + 1] && z->colour[n] == last; n++)
        for (int k = 0; k < 16; k++)
          CHECK(z->local[4 * m + k % 4] < 0 || z->local[4 * m + k % 4] != z->local[4 * n + k / 4]);
    }
  printf("  %d constraints in %d zones, %d colours\n", z->count, z->zones, most + 1);
  CHECK(most > 0);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int what_meets_nothing_is_not_touched(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu", 2, true);
  cloth_sim *sim = sim_new(def);
  move(sim, 0.001, 0.001, 3);
  int impacts, left, n = 3 * sim->vertex_count;
  cloth_real *before = malloc(sizeof *before * (size_t)n);
  memcpy(before, sim->part[0].x, sizeof *before * (size_t)n);
  must(cloth_ccd_detect(sim, &impacts, &err), &err);
  must(cloth_ccd_resolve(sim, &left, &err), &err);
  int same = memcmp(before, sim->part[0].x, sizeof *before * (size_t)n) == 0;
  free(before);
  CHECK(same && sim->report->impacts == 0 && sim->report->zones == 0);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int parts_solve_zones_to_the_same_bits(void)
{
  static const char *const devices[] = {"cpu", "cpu,cpu", "cpu,cpu,cpu", "cpu,cpu,cpu,cpu"};
  static cloth_real first[3 * 3 * N * N];
  cloth_error err = {0};
  for (int d = 0; d < 4; d++) {
    cloth_def *def = def_of(devices[d], SHEETS, true);
    cloth_sim *sim = sim_new(def);
    move(sim, 0.012, 0.02, 9);
    int impacts, left;
    must(cloth_ccd_detect(sim, &impacts, &err), &err);
    must(cloth_ccd_resolve(sim, &left, &err), &err);
    CHECK(sim->report->zones > 0);
    CHECK(same_positions(sim, first, d == 0));
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(random_motions_pass_nothing_through);
  RUN(zones_alone_are_enough_for_moderate_motion);
  RUN(zones_keep_momentum);
  RUN(one_impact_is_its_closed_form);
  RUN(what_is_nearer_than_an_impact_opens_again);
  RUN(constraints_of_a_colour_share_no_moving_vertex);
  RUN(what_meets_nothing_is_not_touched);
  RUN(parts_solve_zones_to_the_same_bits);
  return failures > 0;
}
