// Tests of kernels/physics/bend_shape.h and bend_quadratic.h. The oracle takes angles from face
// normals in double, and the stiffness of a patch from the formula of the header, written out here.
#include "bend_quadratic.h"
#include "bend_shape.h"
#include "check.h"
#include "derivative.h"

static const int patch[6] = {0, 1, 2, 3, 4, 5};
static cloth_real stiffness[6], rest_angle[3], damping[1];
static const double tolerance = 4000 * CLOTH_REAL_EPSILON + 1e-8;

static double angle(const double *a, const double *b, const double *c, const double *d)
{
  double e[3], u[3], w[3], m[3], n[3], length = 0, mn = 0, triple = 0;
  for (int k = 0; k < 3; k++) e[k] = b[k] - a[k], u[k] = c[k] - a[k], w[k] = d[k] - a[k];
  for (int k = 0; k < 3; k++) {
    int p = (k + 1) % 3, q = (k + 2) % 3;
    m[k] = e[p] * u[q] - e[q] * u[p], n[k] = w[p] * e[q] - w[q] * e[p];
    length += e[k] * e[k];
  }
  for (int k = 0; k < 3; k++) {
    int p = (k + 1) % 3, q = (k + 2) % 3;
    mn += m[k] * n[k], triple += (m[p] * n[q] - m[q] * n[p]) * e[k];
  }
  return atan2(triple, mn * sqrt(length));
}

static double angles(const double *x, int i)
{
  return angle(x + 3 * ((i + 1) % 3), x + 3 * ((i + 2) % 3), x + 3 * i, x + 9 + 3 * i);
}

static double full(const cloth_real *w, int i, int j)
{
  static const int at[9] = {0, 5, 4, 5, 1, 3, 4, 3, 2};
  return (double)w[at[3 * i + j]];
}

static double energy(const double *x)
{
  double sum = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      sum += full(stiffness, i, j) * (angles(x, i) - (double)rest_angle[i]) *
             (angles(x, j) - (double)rest_angle[j]) / 2;
  return sum;
}

typedef struct outcome {
  cloth_real force[18], gradient[36], weight[6];
} outcome;

static outcome evaluate(const double x[18], const double x_t0[18], const cloth_real *held,
                        const int *corners)
{
  outcome r;
  cloth_real xr[18], x0[18];
  for (int c = 0; c < 18; c++) xr[c] = (cloth_real)x[c], x0[c] = (cloth_real)x_t0[c];
  cloth_bend_shape_args a = {corners, stiffness, rest_angle, damping, NULL,       NULL,    NULL,
                             xr,      x0,        held,       r.force, r.gradient, r.weight};
  cloth_bend_shape(0, &a);
  return r;
}

// a flat patch, corners 3 to 5 across the edges, with a bump of some tenths, turned
static void random_patch(double x[18])
{
  static const double flat[18] = {0,   0,   0, 1,    0.1, 0, 0.4, 0.9,  0,
                                  1.3, 1.1, 0, -0.6, 0.7, 0, 0.5, -0.8, 0};
  double r[9], y[18];
  for (int c = 0; c < 18; c++) y[c] = flat[c] + (c % 3 == 2 ? 0.3 : 0.05) * test_random();
  test_rotation(3 * test_random(), 3 * test_random(), 3 * test_random(), r);
  for (int v = 0; v < 6; v++)
    for (int c = 0; c < 3; c++)
      x[3 * v + c] = (double)(cloth_real)(r[3 * c] * y[3 * v] + r[3 * c + 1] * y[3 * v + 1] +
                                          r[3 * c + 2] * y[3 * v + 2]);
}

static void random_stiffness(void)
{
  double a[3][3]; // W = a a', as curvatures give it
  for (int i = 0; i < 9; i++) a[i / 3][i % 3] = test_random();
  static const int row[6] = {0, 1, 2, 1, 2, 0}, col[6] = {0, 1, 2, 2, 0, 1};
  for (int k = 0; k < 6; k++) {
    double sum = 0;
    for (int c = 0; c < 3; c++) sum += a[row[k]][c] * a[col[k]][c];
    stiffness[k] = (cloth_real)sum;
  }
}

static int force_is_energy_gradient(void)
{
  damping[0] = 0;
  for (int p = 0; p < 50; p++) {
    double x[18];
    random_patch(x), random_stiffness();
    for (int i = 0; i < 3; i++) rest_angle[i] = (cloth_real)(0.2 * test_random());
    outcome r = evaluate(x, x, NULL, patch);
    for (int c = 0; c < 18; c++)
      CHECK_NEAR((double)r.force[c], -test_derivative(energy, x, 18, c, 1e-4), 20 * tolerance);
  }
  return 0;
}

// K_ab = W_ij g_ia g_jb' is all of the tangent where the angles are those of rest
static int force_row;
static double force_at(const double *x)
{
  return (double)evaluate(x, x, NULL, patch).force[force_row];
}

static int tangent_is_force_gradient_at_rest(void)
{
  if (CLOTH_REAL_EPSILON > 1e-10) return 0; // differences of a kernel in float say nothing
  damping[0] = 0;
  for (int p = 0; p < 10; p++) {
    double x[18];
    random_patch(x), random_stiffness();
    for (int i = 0; i < 3; i++) rest_angle[i] = (cloth_real)angles(x, i);
    outcome r = evaluate(x, x, NULL, patch);
    double g[3][18] = {{0}};
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
          g[i][3 * cloth_bend_shape_corner(i, k) + c] = (double)r.gradient[12 * i + 3 * k + c];
    for (force_row = 0; force_row < 18; force_row++)
      for (int c = 0; c < 18; c++) {
        double k = 0;
        for (int i = 0; i < 3; i++)
          for (int j = 0; j < 3; j++) k += full(r.weight, i, j) * g[i][force_row] * g[j][c];
        CHECK_NEAR(k, -test_derivative(force_at, x, 18, c, 1e-5), 1e-5);
      }
  }
  return 0;
}

static int force_and_torque_sum_to_zero(void)
{
  damping[0] = 0.5;
  for (int p = 0; p < 50; p++) {
    double x[18], x_t0[18], sum[6] = {0};
    random_patch(x), random_patch(x_t0), random_stiffness();
    outcome r = evaluate(x, x_t0, NULL, patch);
    for (int v = 0; v < 6; v++)
      for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        sum[c] += (double)r.force[3 * v + c];
        sum[3 + c] +=
            x[3 * v + d] * (double)r.force[3 * v + e] - x[3 * v + e] * (double)r.force[3 * v + d];
      }
    for (int c = 0; c < 6; c++) CHECK_NEAR(sum[c], 0, 100 * tolerance);
  }
  return 0;
}

static int a_missing_edge_has_no_force(void)
{
  const int border[6] = {0, 1, 2, 0, 4, 5}; // nothing across edge 0
  damping[0] = 0;
  for (int i = 0; i < 3; i++) rest_angle[i] = 0;
  for (int p = 0; p < 10; p++) {
    double x[18];
    random_patch(x), random_stiffness();
    outcome r = evaluate(x, x, NULL, border);
    for (int c = 0; c < 3; c++) CHECK((double)r.force[9 + c] == 0);
    for (int c = 0; c < 12; c++) CHECK((double)r.gradient[c] == 0);
    double t1 = angles(x, 1), t2 = angles(x, 2),
           m1 = full(stiffness, 1, 1) * t1 + full(stiffness, 1, 2) * t2;
    double size = 0, expected = 0;
    for (int c = 0; c < 3; c++) {
      double f = (double)r.force[12 + c], g = (double)r.gradient[12 + 9 + c];
      size += f * f, expected += m1 * m1 * g * g;
    }
    CHECK_NEAR(sqrt(size), sqrt(expected), 20 * tolerance);
  }
  return 0;
}

// a held face does not bend; across its edge the angle counts twice for its neighbour
static int a_held_face_leaves_its_bending_to_the_neighbour(void)
{
  const cloth_real all[6] = {0, 0, 0, 1, 1, 1}, next[6] = {1, 0, 0, 0, 1, 1};
  damping[0] = 0;
  double x[18];
  random_patch(x), random_stiffness();
  outcome r = evaluate(x, x, all, patch);
  for (int c = 0; c < 18; c++) CHECK((double)r.force[c] == 0);
  outcome twice = evaluate(x, x, next, patch), once = evaluate(x, x, NULL, patch);
  for (int c = 0; c < 12; c++)
    CHECK_NEAR((double)twice.gradient[c], 2 * (double)once.gradient[c], tolerance);
  for (int c = 12; c < 36; c++) CHECK((double)twice.gradient[c] == (double)once.gradient[c]);
  return 0;
}

// ---- measured -----------------------------------------------------------------------------------

// a cylinder of curvature kappa whose curved direction is `turn` from the warp, on three edges
static double rigidity_at(const cloth_real *table, double turn, double kappa)
{
  const double n[6] = {3, 0.5, -1, 2.5, -2, -3};
  double k[3] = {kappa * cos(turn) * cos(turn), kappa * sin(turn) * sin(turn),
                 kappa * cos(turn) * sin(turn)};
  double m[3][4], bend[3];
  for (int r = 0; r < 3; r++) { // sum_e bend_e n_e n_e' = k
    for (int e = 0; e < 3; e++) {
      double a = n[2 * e], b = n[2 * e + 1];
      m[r][e] = r == 0 ? a * a : r == 1 ? b * b : a * b;
    }
    m[r][3] = k[r];
  }
  for (int p = 0; p < 3; p++) // no pivot is zero for these edges
    for (int r = 0; r < 3; r++) {
      double f = r == p ? 0 : m[r][p] / m[p][p];
      for (int c = 0; c < 4; c++) m[r][c] -= f * m[p][c];
    }
  cloth_real bent[3], normal[6];
  for (int e = 0; e < 3; e++) bend[e] = m[e][3] / m[e][e], bent[e] = (cloth_real)bend[e];
  for (int c = 0; c < 6; c++) normal[c] = (cloth_real)n[c];
  double root = sqrt((double)table[10]) * cos(turn) * cos(turn) +
                sqrt((double)table[0]) * sin(turn) * sin(turn);
  return (double)cloth_bend_measured(bent, normal, table) * root * root;
}

static int measured_bending_has_the_numbers_of_its_table(void)
{
  static const cloth_real table[15] = {6, 5, 4, 3, 2, 8, 9, 10, 11, 12, 20, 18, 16, 14, 13};
  const double pi = acos(-1), near = 1e4 * CLOTH_REAL_EPSILON + 1e-9;
  for (int row = 0; row < 3; row++)
    for (int column = 1; column < 5; column++)
      for (int sign = -1; sign < 2; sign += 2) {
        double turn = pi / 2 - row * pi / 4; // the edge lies across the curvature
        CHECK_NEAR(rigidity_at(table, turn, sign * 5.0 * column), (double)table[5 * row + column],
                   20 * near);
      }
  CHECK_NEAR(rigidity_at(table, 0, 7.5), 17, 20 * near);
  CHECK_NEAR(rigidity_at(table, pi / 8, 10), 13, 20 * near);
  CHECK_NEAR(rigidity_at(table, -pi / 8, 10), 13, 20 * near);
  CHECK_NEAR(rigidity_at(table, 0, 300), 13, 20 * near);
  CHECK_NEAR(rigidity_at(table, pi / 2, 1e-3), 6, 1e-3);
  return 0;
}

// ---- quadratic ----------------------------------------------------------------------------------

static const cloth_real hinge_weight[4] = {(cloth_real)1.5, (cloth_real)0.75, -1,
                                           (cloth_real)-1.25};
static double quadratic_energy(const double *x)
{
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double l = 0;
    for (int v = 0; v < 4; v++) l += (double)hinge_weight[v] * x[3 * v + c];
    sum += 3 * l * l / 2;
  }
  return sum;
}

static int quadratic_force_is_energy_gradient(void)
{
  const cloth_real k[1] = {3};
  for (int p = 0; p < 20; p++) {
    double x[12];
    cloth_real xr[12], f[12], factor[1];
    damping[0] = 0;
    for (int c = 0; c < 12; c++) x[c] = (double)(xr[c] = (cloth_real)test_random());
    cloth_bend_quadratic_args a = {patch, k, hinge_weight, damping, xr, xr, NULL, f, factor};
    cloth_bend_quadratic(0, &a);
    for (int c = 0; c < 12; c++)
      CHECK_NEAR((double)f[c], -test_derivative(quadratic_energy, x, 12, c, 1e-4), 20 * tolerance);
    CHECK_NEAR((double)factor[0], 3, 0);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(force_is_energy_gradient);
  RUN(tangent_is_force_gradient_at_rest);
  RUN(force_and_torque_sum_to_zero);
  RUN(a_missing_edge_has_no_force);
  RUN(a_held_face_leaves_its_bending_to_the_neighbour);
  RUN(measured_bending_has_the_numbers_of_its_table);
  RUN(quadratic_force_is_energy_gradient);
  return failures != 0;
}
