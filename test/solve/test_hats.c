// The solver's levels of hat functions: what they are, what their nodes' blocks hold, and what they
// are for.
#define SHEET_SIDE_MAX 132
#include "hat_rest.h"
#include "solve/dense.h"

enum { N = 14, VERTICES = 2 * N * N, DOFS = 3 * VERTICES, STRIP = 160 };

static sheet flat, bent, strip;
static solid table;
static double A[DOFS][DOFS];

static const int held[3] = {0, 1, N};

// a flat sheet over one that is half a cylinder at rest, on a table, a corner of the flat one held
static cloth_sim *sim_of(cloth_def **def)
{
  sheet_make(&flat, 0.2, 0.2, N, N), sheet_make(&bent, 0.2, 0.2, N, N);
  solid_box(&table, 1, 1, 0.1);
  for (int v = 0; v < N * N; v++) {
    double *x = bent.x + 3 * v, turn = x[0] / 0.06;
    x[0] = 0.06 * sin(turn), x[2] = 0.06 * cos(turn);
  }
  *def = def_new(PRECISION);
  def_set(*def, "threads", "1");
  def_set(*def, "preconditioner", "multilevel");
  def_cloth(*def, "bent", &bent, cloth_material_default(), pose_at(0, 0, 0.008));
  def_cloth(*def, "flat", &flat, cloth_material_default(), pose_at(0, 0, 0.0708));
  def_body(*def, "table", &table, 0.4, pose_at(0, 0, -0.05));
  cloth_sim *sim = sim_new(*def);
  cloth_error err = {0};
  cloth_grasp_id id;
  cloth_grasp_view g = {
      .cloth = 1, .count = 3, .vertex = held, .body = -1, .frame = pose_at(0, 0, 0)};
  must(cloth_sim_grasp(sim, &g, &id, &err), &err);
  return sim;
}

// the share of vertex v in each node [nodes], worked out from the first level's and the others'
static void shares_of(const cloth_hats *h, int v, double *share)
{
  memset(share, 0, sizeof *share * (size_t)h->nodes);
  for (int k = 0; k < CLOTH_HAT_CORNERS; k++) {
    int at = CLOTH_HAT_CORNERS * v + k, node = h->corner[at];
    double w = (double)h->weight[at];
    share[node] += w;
    for (int u = h->uppers * node; u < h->uppers * (node + 1); u++)
      share[h->upper[u]] += w * (double)h->upper_weight[u];
  }
}

// the level of a node, from the place of its corner in the list of a first node
static int levels_of(const cloth_hats *h, int *level)
{
  memset(level, 0, sizeof *level * (size_t)h->nodes);
  for (int u = 0; u < h->fine * h->uppers; u++)
    level[h->upper[u]] = 1 + u % h->uppers / CLOTH_HAT_CORNERS;
  return 1 + h->uppers / CLOTH_HAT_CORNERS;
}

// ---- the sentences ------------------------------------------------------------------------------

// on every level a vertex shares in nodes with weights of sum 1, and the mean of their places is
// its own: what is stretched evenly is seen as it is
static int hats_sum_to_one_and_hold_what_is_linear(void)
{
  cloth_def *def;
  cloth_sim *sim = sim_of(&def);
  const cloth_hats *h = &sim->part[0].hats;
  static double share[VERTICES * 2];
  static int level[VERTICES * 2];
  CHECK(h->fine > 20 && h->nodes > h->fine && h->nodes < VERTICES);
  int levels = levels_of(h, level);
  CHECK(levels >= 2);
  for (int v = 0; v < VERTICES; v++) {
    double sum[CLOTH_HAT_LEVELS] = {0}, mean[3] = {0, 0, 0};
    cloth_v3 u = cloth_v3_load(sim->part[0].hat_place, v);
    shares_of(h, v, share);
    for (int c = 0; c < h->nodes; c++) sum[level[c]] += share[c];
    for (int l = 0; l < levels; l++) CHECK_NEAR(sum[l], 1, 1e-5);
    for (int k = 0; k < CLOTH_HAT_CORNERS; k++) {
      cloth_v3 node = cloth_hat_corner(u, k);
      double w = (double)cloth_hat_at(u, node);
      CHECK(w >= 0);
      mean[0] += w * (double)node.x, mean[1] += w * (double)node.y, mean[2] += w * (double)node.z;
    }
    CHECK_NEAR(mean[0], u.x, 1e-5 * (1 + fabs((double)u.x)));
    CHECK_NEAR(mean[1], u.y, 1e-5 * (1 + fabs((double)u.y)));
    CHECK_NEAR(mean[2], u.z, 1e-5 * (1 + fabs((double)u.z)));
  }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// a node's children and their weights are the shares that vertices have in it
static int lists_of_nodes_turn_the_shares_around(void)
{
  cloth_def *def;
  cloth_sim *sim = sim_of(&def);
  const cloth_hats *h = &sim->part[0].hats;
  static double share[VERTICES * 2], rest[VERTICES * 2], expected[VERTICES * 2];
  uint32_t seed = 5;
  memset(expected, 0, sizeof expected);
  memset(rest, 0, sizeof rest);
  for (int v = 0; v < VERTICES; v++) {
    double r = roll_real(&seed);
    shares_of(h, v, share);
    for (int c = 0; c < h->nodes; c++) expected[c] += share[c] * r;
    sim->part[0].r[3 * v] = (cloth_real)r;
  }
  for (int c = 0; c < h->nodes; c++)
    for (int n = h->first[c]; n < h->first[c + 1]; n++)
      rest[c] += (double)h->child_weight[n] *
                 (c < h->fine ? (double)sim->part[0].r[3 * h->child[n]] : rest[h->child[n]]);
  for (int c = 0; c < h->nodes; c++) CHECK_NEAR(rest[c], expected[c], 1e-4);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// in a mesh with a wide level every node beyond the first has the sum of what its children have,
// and its entry in the sums of r'z
static int large_nodes_sum_over_all_their_children(void)
{
  sheet_make(&strip, 1, 1, SHEET_SIDE_MAX, SHEET_SIDE_MAX);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "threads", "1");
  def_set(def, "preconditioner", "multilevel");
  def_set(def, "newton_iterations_max", "1");
  def_set(def, "pcg_iterations_max", "3");
  def_set(def, "wind", "0.5 1 0");
  def_set(def, "air_density", "1.2");
  def_cloth(def, "sheet", &strip, cloth_material_default(), pose_at(0, 0, 1));
  cloth_sim *sim = sim_new(def);
  sim_step(sim, 1);
  const cloth_hats *h = &sim->part[0].hats;
  const cloth_real *rz =
      sim->part[0].partial + CLOTH_PCG_PARTIALS * (sim->chunks + cloth_hat_fine_groups(h));
  double sum_of_rz = 0, sum_of_entries = 0;
  int most = 0;
  CHECK(h->wide > h->fine && h->wide < h->nodes);
  for (int c = h->fine; c < h->nodes; c++) {
    double rest[3] = {0, 0, 0}, size = 0;
    for (int n = h->first[c]; n < h->first[c + 1]; n++)
      for (int k = 0; k < 3; k++) {
        double of = (double)h->child_weight[n] * (double)h->rest[3 * h->child[n] + k];
        rest[k] += of, size += fabs(of);
      }
    for (int k = 0; k < 3; k++) {
      CHECK(size > 0 && fabs((double)h->rest[3 * c + k] - rest[k]) < 1e-5 * size);
      sum_of_rz += (double)h->rest[3 * c + k] * (double)h->correction[3 * c + k];
    }
    if (h->first[c + 1] - h->first[c] > most) most = h->first[c + 1] - h->first[c];
  }
  for (int i = 0; i < cloth_hat_groups(h); i++)
    sum_of_entries += (double)rz[CLOTH_PCG_PARTIALS * i];
  CHECK(most > 2 * CLOTH_HAT_WIDE_LANES);
  CHECK_NEAR(sum_of_entries, sum_of_rz, 1e-4 * fabs(sum_of_rz));
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// the block of node c by the dense matrix: the sum over both sides of share A share
static void block_of(const cloth_sim *sim, int c, double block[3][3])
{
  static double w[VERTICES];
  const cloth_part *p = &sim->part[0];
  memset(w, 0, sizeof w), memset(block, 0, 9 * sizeof(double));
  for (int v = 0; v < VERTICES; v++)
    for (int k = CLOTH_HAT_CORNERS * v; k < CLOTH_HAT_CORNERS * (v + 1); k++)
      if (p->hats.corner[k] == c) w[v] += (double)p->hats.weight[k] * (double)p->free[v];
  for (int i = 0; i < DOFS; i++)
    for (int j = 0; j < DOFS; j++) block[i % 3][j % 3] += w[i / 3] * A[i][j] * w[j / 3];
}

static int blocks_of_the_first_level_are_those_of_the_dense_matrix(void)
{
  cloth_def *def;
  cloth_sim *sim = sim_of(&def);
  cloth_step_report report;
  sim_step(sim, 4);
  solve_one(sim, &report);
  CHECK(dense_system(sim, A[0], NULL) > 100);
  const cloth_hats *h = &sim->part[0].hats;
  for (int c = 0; c < h->nodes; c++) {
    cloth_sym3 s = cloth_sym3_load(h->inverse, c);
    CHECK(s.xx > 0 && s.yy > 0 && s.zz > 0);
    if (c >= h->fine) continue;
    double m[3][3], inverse[3][3] = {{(double)s.xx, (double)s.xy, (double)s.zx},
                                     {(double)s.xy, (double)s.yy, (double)s.yz},
                                     {(double)s.zx, (double)s.yz, (double)s.zz}};
    block_of(sim, c, m);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) { // their product is 1, as far as a float inverse goes
        double sum = 0;
        for (int k = 0; k < 3; k++) sum += m[i][k] * inverse[k][j];
        CHECK_NEAR(sum, i == j, PRECISION[0] == 'f' ? 2e-2 : 1e-9);
      }
  }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int iterations_of(const char *preconditioner, int length)
{
  sheet_make(&strip, 0.08, 0.01 * length, 9, length);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "threads", "1");
  def_set(def, "preconditioner", preconditioner);
  def_set(def, "pcg_iterations_max", "5000");
  def_cloth(def, "strip", &strip, cloth_material_default(), pose_at(0, 0, 1));
  cloth_sim *sim = sim_new(def);
  cloth_error err = {0};
  cloth_grasp_id id;
  cloth_grasp_view g = {.count = 3, .vertex = held, .body = -1, .frame = pose_at(0, 0, 0)};
  must(cloth_sim_grasp(sim, &g, &id, &err), &err);
  cloth_step_report report = sim_step(sim, 20);
  solve_one(sim, &report);
  int n = report.pcg_iterations;
  CHECK(report.pcg_unconverged == 0);
  cloth_sim_free(sim), cloth_def_free(def);
  return n;
}

static int levels_spare_iterations_the_more_the_longer_the_cloth(void)
{
  int jacobi = iterations_of("block_jacobi", STRIP);
  int shorter = iterations_of("multilevel", STRIP / 4), longer = iterations_of("multilevel", STRIP);
  printf("  block Jacobi %d iterations; levels %d, and %d on a quarter of the strip\n", jacobi,
         longer, shorter);
  CHECK(3 * longer < jacobi);
  CHECK(longer < 2 * shorter);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(hats_sum_to_one_and_hold_what_is_linear);
  RUN(lists_of_nodes_turn_the_shares_around);
  RUN(large_nodes_sum_over_all_their_children);
  RUN(blocks_of_the_first_level_are_those_of_the_dense_matrix);
  RUN(levels_spare_iterations_the_more_the_longer_the_cloth);
  return failures > 0;
}
