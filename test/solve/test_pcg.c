// The linear system as the engine holds it, against a dense one, which is solved by Cholesky here
// and compared with what the solver left.
#include "solve/dense.h"

enum { N = 12, VERTICES = 2 * N * N, DOFS = 3 * VERTICES };

static sheet cloth;
static solid table;
static double A[DOFS][DOFS], b[DOFS], expected[DOFS];

static const int held[3] = {0, 1, N};

// two layers on a table, a corner of the upper one held and moving: every kind of block is there
static cloth_def *def_of(const char *devices, const char *tolerance, const char *preconditioner)
{
  sheet_make(&cloth, 0.2, 0.2, N, N);
  solid_box(&table, 1, 1, 0.1);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", devices);
  def_set(def, "threads", "1");
  def_set(def, "pcg_tolerance", tolerance);
  def_set(def, "preconditioner", preconditioner);
  def_set(def, "air_density", "1.2");
  def_cloth(def, "lower", &cloth, cloth_material_default(), pose_at(0, 0, 0.003));
  def_cloth(def, "upper", &cloth, cloth_material_default(),
            pose_turned(0.01, 0.02, 0.0055, 2, 0.2));
  def_body(def, "table", &table, 0.4, pose_at(0, 0, -0.05));
  return def;
}

static cloth_step_report report;

static cloth_sim *sim_of(const cloth_def *def)
{
  cloth_sim *sim = sim_new(def);
  cloth_error err = {0};
  cloth_grasp_id id;
  cloth_grasp_view g = {
      .cloth = 1, .count = 3, .vertex = held, .body = -1, .frame = pose_at(0, 0, 0)};
  must(cloth_sim_grasp(sim, &g, &id, &err), &err);
  for (int n = 0; n < 5; n++) {
    cloth_pose p = pose_at(0.001 * n, 0, 0.002 * n);
    must(cloth_sim_grasp_move(sim, id, &p, &err), &err);
    sim_step(sim, 1);
  }
  solve_one(sim, &report);
  return sim;
}

// ---- the dense twin -----------------------------------------------------------------------------

static bool is_free(const cloth_sim *sim, int dof) { return sim->part[0].free[dof / 3] > 0; }

// A over the free rows = L L', then forward and back; 1 if a pivot is not positive
static int cholesky(const cloth_sim *sim)
{
  static double L[DOFS][DOFS];
  for (int i = 0; i < DOFS; i++)
    for (int j = 0; j <= i; j++) {
      bool off = !is_free(sim, i) || !is_free(sim, j);
      double sum = off ? i == j : A[i][j];
      for (int k = 0; k < j; k++) sum -= L[i][k] * L[j][k];
      if (i == j && !(sum > 0)) return 1;
      L[i][j] = i == j ? sqrt(sum) : sum / L[j][j];
    }
  for (int i = 0; i < DOFS; i++) {
    double sum = is_free(sim, i) ? b[i] : 0;
    for (int k = 0; k < i; k++) sum -= L[i][k] * expected[k];
    expected[i] = sum / L[i][i];
  }
  for (int i = DOFS - 1; i >= 0; i--) {
    double sum = expected[i];
    for (int k = i + 1; k < DOFS; k++) sum -= L[k][i] * expected[k];
    expected[i] = sum / L[i][i];
  }
  return 0;
}

// ---- the sentences ------------------------------------------------------------------------------

static int solution(const char *devices, const char *preconditioner)
{
  cloth_def *def = def_of(devices, PRECISION[0] == 'f' ? "1e-6" : "1e-11", preconditioner);
  cloth_sim *sim = sim_of(def);
  CHECK(sim->vertex_count == VERTICES);
  CHECK((sim->hat_groups > 0) == (strcmp(preconditioner, "multilevel") == 0));
  CHECK((sim->aggregates > 0) == (strcmp(preconditioner, "two_level") == 0));
  CHECK(dense_system(sim, A[0], b) > 100 && report.pcg_unconverged == 0);
  double largest = 0, skew = 0;
  for (int i = 0; i < DOFS; i++)
    for (int j = 0; j < DOFS; j++) {
      largest = fmax(largest, fabs(A[i][j]));
      skew = fmax(skew, fabs(A[i][j] - A[j][i]));
    }
  CHECK_NEAR(skew / largest, 0, 20 * (double)CLOTH_REAL_EPSILON); // a few additions per block
  CHECK(cholesky(sim) == 0);                                      // positive definite
  double size = 0, error = 0;
  for (int i = 0; i < DOFS; i++) {
    const cloth_part *p = &sim->part[0]; // dx is complete on every part
    double dx = (double)p->dx[i];
    if (!is_free(sim, i)) CHECK(dx == 0); // held rows are exact
    size = fmax(size, fabs(expected[i]));
    error = fmax(error, fabs(dx - expected[i]));
  }
  CHECK(size > 1e-6);
  // the residual is below the tolerance; the solution is off by at most the condition, here 1e4
  CHECK_NEAR(error / size, 0, PRECISION[0] == 'f' ? 1e-2 : 1e-6);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int pcg_solves_what_a_dense_cholesky_solves(void)
{
  return solution("cpu", "block_jacobi") || solution("cpu", "two_level") ||
         solution("cpu", "multilevel") || solution("cpu,cpu,cpu", "multilevel");
}

// the residual that the report names, worked out with the dense matrix
static int reported_residual_is_that_of_the_solution(void)
{
  cloth_def *def = def_of("cpu", "1e-2", "block_jacobi");
  cloth_sim *sim = sim_of(def);
  dense_system(sim, A[0], b);
  double rr = 0, bb = 0;
  for (int i = 0; i < DOFS; i++) {
    if (!is_free(sim, i)) continue;
    double r = b[i];
    for (int j = 0; j < DOFS; j++) r -= A[i][j] * (double)sim->part[0].dx[j];
    rr += r * r, bb += b[i] * b[i];
  }
  CHECK(report.pcg_residual > 0 && report.pcg_residual <= 1e-2 * (1 + 1e-3));
  CHECK_NEAR(report.pcg_residual, sqrt(rr / bb), 1e-4); // float sums of 500 squares
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// Newton goes on: what is left of b, which is a thousandth
static int next(cloth_sim *sim, int first, double *residual)
{
  cloth_error err = {0};
  double correction;
  cloth_part *p = &sim->part[0];
  for (int i = 0; i < DOFS; i++) p->b[i] = (cloth_real)(1e-3 * b[i]);
  sim->iteration = 1, sim->iteration_first = first;
  int before = report.pcg_iterations;
  CHECK_OK(cloth_pcg(sim, &correction, &err), err);
  double rr = 0, bb = 0;
  for (int i = 0; i < DOFS; i++) {
    if (!is_free(sim, i)) continue;
    rr += (double)p->r[i] * (double)p->r[i], bb += (double)p->b[i] * (double)p->b[i];
  }
  *residual = sqrt(rr / bb);
  CHECK((report.pcg_iterations > before) == (first > 0));
  return 0;
}

// A thousandth of the first right-hand side is nothing to a later Newton iteration, and all there
// is to a round of impacts.
static int a_solve_is_measured_against_the_first_of_its_kind(void)
{
  cloth_def *def = def_of("cpu", "1e-2", "block_jacobi");
  cloth_sim *sim = sim_of(def);
  double residual;
  dense_system(sim, A[0], b);
  if (next(sim, 0, &residual)) return 1;
  CHECK(residual == 1);
  if (next(sim, 1, &residual)) return 1;
  CHECK(residual <= 1e-2 * (1 + 1e-3));
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// A matrix that is not positive definite, as rounding may leave it, breaks the iteration down: it
// ends, but not because it is done.
static int a_solve_that_breaks_down_says_so(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu", "1e-2", "block_jacobi");
  cloth_sim *sim = sim_of(def);
  cloth_part *p = &sim->part[0];
  double correction;
  CHECK(!sim->solve_failed && report.pcg_unconverged == 0);
  for (int i = 0; i < 9 * CLOTH_ROW_GROUP * (int)p->row_slots; i++) p->row_val[i] = -p->row_val[i];
  CHECK_OK(cloth_pcg(sim, &correction, &err), err);
  CHECK(sim->solve_failed && report.pcg_unconverged == 1);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// A sheet of 10,000 times the density lies under a light one. The right-hand side is A times a
// known way: all heavy vertices are moved at random by 10 thicknesses at most, one light vertex by
// 100. A residual of 10 % of such forces may leave it many thicknesses from its place. `most`
// iterations are few enough to give up.
static int brought_to_place(const char *devices, const char *most, cloth_real *way)
{
  cloth_error err = {0};
  cloth_def *def = def_of(devices, "1e-1", "block_jacobi");
  def_set(def, "pcg_iterations_max", most);
  def->cloth[0].material.density *= 1e4;
  cloth_sim *sim = sim_of(def);
  const double t = sim->params.thickness;
  const int light = sim->cloth_first[1] + (sim->cloth_first[2] - sim->cloth_first[1]) / 2;
  uint32_t seed = 1;
  static double e[DOFS];
  dense_system(sim, A[0], b);
  for (int i = 0; i < DOFS; i++)
    e[i] = i / 3 < sim->cloth_first[1] ? 10 * t * roll_real(&seed)
           : i == 3 * light + 2        ? 100 * t
                                       : 0;
  for (int i = 0; i < DOFS; i++) {
    double sum = 0;
    for (int j = 0; j < DOFS; j++) sum += is_free(sim, j) ? A[i][j] * e[j] : 0;
    for (int k = 0; k < sim->part_count; k++) // each its own rows
      if (i / 3 >= sim->part[k].v0 && i / 3 < sim->part[k].v1) sim->part[k].b[i] = (cloth_real)sum;
  }
  double correction, before[3];
  cloth_part *p = &sim->part[0];
  CHECK(is_free(sim, 3 * light));
  for (int k = 0; k < 3; k++) before[k] = (double)p->x[3 * light + k];
  CHECK_OK(cloth_pcg(sim, &correction, &err), err);
  double off = 0;
  for (int k = 0; k < 3; k++) {
    double d = (double)p->x[3 * light + k] - before[k] - e[3 * light + k];
    off += d * d;
  }
  CHECK(sqrt(off) < 0.5 * t); // a quarter by its own row, and its neighbours are off by as much
  CHECK((report.pcg_unconverged > 0) == (atoi(most) < 10));
  memcpy(way, p->x, sizeof(cloth_real) * DOFS);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int no_light_vertex_is_left_far_from_its_place(void)
{
  static cloth_real one[DOFS], three[DOFS];
  if (brought_to_place("cpu", "500", one) || brought_to_place("cpu,cpu,cpu", "500", three))
    return 1;
  CHECK(memcmp(one, three, sizeof one) == 0);
  return brought_to_place("cpu", "2", one);
}

static int parts_solve_to_the_same_bits(void)
{
  static const char *const devices[] = {"cpu", "cpu,cpu", "cpu,cpu,cpu", "cpu,cpu,cpu,cpu"};
  static cloth_real first[DOFS];
  for (int i = 0; i < 4; i++) {
    cloth_def *def = def_of(devices[i], "1e-2", "multilevel");
    cloth_sim *sim = sim_of(def);
    if (i == 0) memcpy(first, sim->part[0].dx, sizeof first);
    for (int p = 0; p < sim->part_count; p++)
      CHECK(memcmp(first, sim->part[p].dx, sizeof first) == 0);
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(pcg_solves_what_a_dense_cholesky_solves);
  RUN(reported_residual_is_that_of_the_solution);
  RUN(a_solve_is_measured_against_the_first_of_its_kind);
  RUN(a_solve_that_breaks_down_says_so);
  RUN(no_light_vertex_is_left_far_from_its_place);
  RUN(parts_solve_to_the_same_bits);
  return failures > 0;
}
