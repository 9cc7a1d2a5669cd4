// Tests of kernels/physics/membrane.h and membrane_stretch.h. The oracle is the energy written out
// in double below and its finite differences. Lengths are of order 1 m and stiffnesses of order 100
// N/m, so `tolerance` is some tens of roundings of quantities of order 1000.
#include "check.h"
#include "derivative.h"
#include "membrane_stretch.h"

static const int triangle[3] = {0, 1, 2}, material[1] = {0};
// corners of the triangle in warp and weft [m]: (0.1, 0), (1.0, 0.2), (0.3, 0.9)
static const double flat[3][2] = {{0.1, 0}, {1.0, 0.2}, {0.3, 0.9}};
static cloth_real rest[5], stiffness[4] = {130, 25, 80, 30}, damping[1];
static const cloth_real *table; // of a measured fabric, or NULL
static const cloth_real *limit; // strain limit, or NULL
static const double tolerance =
    1e4 * 32 * CLOTH_REAL_EPSILON + 1e-7; // differences give 1e-8 or better

static void setup(double damp)
{
  double a = flat[1][0] - flat[0][0], c = flat[1][1] - flat[0][1];
  double b = flat[2][0] - flat[0][0], d = flat[2][1] - flat[0][1], det = a * d - b * c;
  rest[0] = (cloth_real)(d / det), rest[1] = (cloth_real)(-b / det);
  rest[2] = (cloth_real)(-c / det), rest[3] = (cloth_real)(a / det),
  rest[4] = (cloth_real)(det / 2);
  damping[0] = (cloth_real)damp;
}

static void evaluate(const double x[9], const double x_t0[9], double force[9], double full[81])
{
  static const int packed[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  cloth_real xr[9], x0[9], f[9], k[45];
  for (int c = 0; c < 9; c++) xr[c] = (cloth_real)x[c], x0[c] = (cloth_real)x_t0[c];
  cloth_membrane_args a = {triangle, rest, material, stiffness, table, limit,
                           damping,  xr,   x0,       f,         k};
  cloth_membrane(0, &a);
  for (int c = 0; c < 9; c++) force[c] = (double)f[c];
  for (int p = 0; p < 3; p++) {
    int q = (p + 1) % 3;
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++) {
        full[9 * (3 * p + r) + 3 * p + c] = (double)k[6 * p + packed[r][c]];
        // K01 K12 K20
        full[9 * (3 * p + r) + 3 * q + c] = full[9 * (3 * q + c) + 3 * p + r] =
            (double)k[18 + 9 * p + 3 * r + c];
      }
  }
}

// A/2 G : C : G [J], component by component
static double energy(const double *x)
{
  double f[3][2], g[3] = {0, 0, 0};
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 2; c++)
      f[r][c] = (x[3 + r] - x[r]) * (double)rest[c] + (x[6 + r] - x[r]) * (double)rest[2 + c];
  for (int r = 0; r < 3; r++)
    g[0] += f[r][0] * f[r][0] / 2, g[1] += f[r][1] * f[r][1] / 2, g[2] += f[r][0] * f[r][1] / 2;
  g[0] -= 0.5, g[1] -= 0.5;
  const double c[4] = {(double)stiffness[0], (double)stiffness[1], (double)stiffness[2],
                       (double)stiffness[3]};
  double density =
      c[0] * g[0] * g[0] + 2 * c[1] * g[0] * g[1] + c[2] * g[1] * g[1] + 4 * c[3] * g[2] * g[2];
  double limited = 0;
  for (int i = 0; i < 2 && limit; i++) { // w(p), with w'' = 0, a ramp, 1
    double mean = (g[0] + g[1]) / 2, radius = hypot((g[0] - g[1]) / 2, g[2]);
    double over = (i ? mean - radius : mean + radius) - (double)limit[0], ramp = 0.01;
    if (over > ramp)
      limited += over * over / 2 - ramp * over / 2 + ramp * ramp / 6;
    else if (over > 0)
      limited += over * over * over / (6 * ramp);
  }
  return (double)rest[4] / 2 * density + (limit ? (double)(rest[4] * limit[1]) * limited : 0);
}

// the triangle stretched by (warp, weft), sheared, turned and moved, rounded to cloth_real
static void pose(double warp, double weft, double shear, const double turn[3], double x[9])
{
  double r[9];
  test_rotation(turn[0], turn[1], turn[2], r);
  for (int v = 0; v < 3; v++) {
    double w = warp * flat[v][0] + shear * flat[v][1], f = weft * flat[v][1] + shear * flat[v][0];
    for (int c = 0; c < 3; c++)
      x[3 * v + c] = (double)(cloth_real)(r[3 * c] * w + r[3 * c + 1] * f + 0.1);
  }
}

static void random_pose(double x[9])
{
  for (int c = 0; c < 9; c++) x[c] = (double)(cloth_real)test_random();
}

static int force_is_energy_gradient(void)
{
  setup(0);
  for (int p = 0; p < 50; p++) {
    double x[9], f[9], k[81];
    random_pose(x);
    evaluate(x, x, f, k);
    for (int c = 0; c < 9; c++)
      CHECK_NEAR(f[c], -test_derivative(energy, x, 9, c, 1e-2), tolerance);
    cloth_real xr[9];
    for (int c = 0; c < 9; c++) xr[c] = (cloth_real)x[c];
    cloth_real e = cloth_membrane_energy(cloth_v3_load(xr, 0), cloth_v3_load(xr, 1),
                                         cloth_v3_load(xr, 2), rest, stiffness);
    CHECK_NEAR((double)e, energy(x), tolerance);
  }
  return 0;
}

// with tension in every direction nothing is dropped
static int stretched_tangent_is_force_gradient(void)
{
  setup(0);
  for (int p = 0; p < 20; p++) {
    double x[9], f[9], k[81], turn[3] = {3 * test_random(), 3 * test_random(), 3 * test_random()};
    pose(1.3 + 0.2 * test_random(), 1.3 + 0.2 * test_random(), 0.05 * test_random(), turn, x);
    evaluate(x, x, f, k);
    for (int r = 0; r < 9; r++)
      for (int c = 0; c < 9; c++)
        CHECK_NEAR(k[9 * r + c], test_second_derivative(energy, x, 9, r, c, 1e-2), tolerance);
  }
  return 0;
}

// one principal strain beyond the limit, both, none
static int limited_force_and_tangent_are_derivatives(void)
{
  static const cloth_real law[3][2] = {{(cloth_real)0.2, 500}, {(cloth_real)0.05, 500}, {9, 500}};
  static const double stretch[3][2] = {{1.35, 1.1}, {1.35, 1.25}, {1.3, 1.2}}; // 0.41, 0.105; 0.28
  setup(0);
  for (int p = 0; p < 60; p++) {
    double x[9], f[9], k[81], turn[3] = {3 * test_random(), 3 * test_random(), 3 * test_random()};
    limit = law[p % 3];
    pose(stretch[p % 3][0] + 0.03 * test_random(), stretch[p % 3][1] + 0.03 * test_random(),
         0.06 * test_random(), turn, x);
    evaluate(x, x, f, k);
    for (int r = 0; r < 9; r++) {
      CHECK_NEAR(f[r], -test_derivative(energy, x, 9, r, 1e-3), 2 * tolerance);
      for (int c = 0; c < 9; c++)
        CHECK_NEAR(k[9 * r + c], test_second_derivative(energy, x, 9, r, c, 1e-3), 20 * tolerance);
    }
  }
  limit = NULL;
  return 0;
}

static int limit_has_no_step_in_its_stiffness(void)
{
  const double l = 0.25, h = 1e-3;
  double before = 0;
  for (int i = -5; i < 40; i++) {
    cloth_real first[3], second[3];
    for (int k = 0; k < 3; k++)
      cloth_limit_law((cloth_real)(l + (i + (k - 1) / 2.0) * h), (cloth_real)l, &first[k],
                      &second[k]);
    CHECK_NEAR((double)(first[2] - first[0]) / h, (double)second[1], 0.03);
    CHECK((double)second[1] >= before && (double)second[1] - before <= 0.11 && second[1] <= 1);
    before = (double)second[1];
  }
  CHECK_NEAR(before, 1, 0);
  return 0;
}

// compressed, inverted, thrown about, flattened to a line or a point, and with the damping of a
// wild step
static int tangent_is_positive_semidefinite(void)
{
  static const cloth_real law[2] = {(cloth_real)0.1, 1000};
  for (int p = 0; p < 400; p++) {
    double x[9], x_t0[9], f[9], k[81], most = 1;
    setup(p % 3 == 0 ? 2 : 0);
    limit = p % 2 ? law : NULL;
    random_pose(x), random_pose(x_t0);
    double scale = p % 4 == 0 ? 1e-3 : p % 4 == 1 ? 0 : p % 4 == 2 ? 1 : 5;
    for (int c = 0; c < 9; c++) x[c] *= scale;
    if (p % 5 == 0)
      for (int c = 0; c < 3; c++) x[6 + c] = x[3 + c] + 0.3 * (x[3 + c] - x[c]);
    evaluate(x, x_t0, f, k);
    for (int c = 0; c < 81; c++) most = fmax(most, fabs(k[c]));
    CHECK(test_least_eigenvalue(k, 9) >= -64 * (double)CLOTH_REAL_EPSILON * most);
    for (int c = 0; c < 9; c++) CHECK(isfinite(f[c]));
  }
  limit = NULL;
  return 0;
}

// Pulled along the warp: up to a stretch of 3.8 the force is the energy's, which is that of its
// cube; from 20 on it is in proportion, and it never falls on the way.
static int force_of_a_torn_triangle_is_in_proportion(void)
{
  const double none[3] = {0, 0, 0};
  double last = 0;
  setup(0);
  for (double stretch = 1.2; stretch < 1e5; stretch *= 1.1) {
    double x[9], f[9], k[81], far[9], f_far[9], most = 0;
    pose(stretch, 1, 0, none, x), evaluate(x, x, f, k);
    if (stretch < 3.8) CHECK_NEAR(f[3], -test_derivative(energy, x, 9, 3, 1e-2), 20 * tolerance);
    CHECK(f[0] > last && f[3] < 0);
    last = f[0];
    for (int c = 0; c < 81; c++) most = fmax(most, fabs(k[c]));
    CHECK(test_least_eigenvalue(k, 9) >= -64 * (double)CLOTH_REAL_EPSILON * most);
    if (stretch < 20) continue;
    pose(10 * stretch, 1, 0, none, far), evaluate(far, far, f_far, k);
    CHECK_NEAR(f_far[0] / f[0], 10, 0.1);
  }
  return 0;
}

// a rigid motion costs nothing, during the step (x_t0 -> x, with damping) and since rest
static int rigid_motion_has_no_force(void)
{
  setup(3);
  for (int p = 0; p < 20; p++) {
    double x[9], x_t0[9], f[9], k[81];
    double turn[3] = {3 * test_random(), 3 * test_random(), 3 * test_random()}, none[3] = {0, 0, 0};
    pose(1, 1, 0, turn, x), pose(1, 1, 0, none, x_t0);
    evaluate(x, x_t0, f, k);
    for (int c = 0; c < 9; c++) CHECK_NEAR(f[c], 0, 20 * tolerance);
  }
  return 0;
}

static int force_and_torque_sum_to_zero(void)
{
  setup(0.7);
  for (int p = 0; p < 50; p++) {
    double x[9], x_t0[9], f[9], k[81], sum[6] = {0};
    random_pose(x), random_pose(x_t0);
    evaluate(x, x_t0, f, k);
    for (int v = 0; v < 3; v++)
      for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        sum[c] += f[3 * v + c];
        sum[3 + c] += x[3 * v + d] * f[3 * v + e] - x[3 * v + e] * f[3 * v + d];
      }
    for (int c = 0; c < 6; c++) CHECK_NEAR(sum[c], 0, tolerance);
  }
  return 0;
}

// near rest the viscous force is -damping K (x - x_t0) to first order, and the tangent grows by it
static int damping_is_proportional_to_stiffness(void)
{
  double x[9], x_t0[9], f[9], k[81], slow[9], k_slow[81], none[3] = {0, 0, 0};
  pose(1, 1, 0, none, x);
  const double step = 1e-3; // m; the second order is step^2 times 100 N/m over 1 m
  for (int c = 0; c < 9; c++) x_t0[c] = (double)(cloth_real)(x[c] - step * test_random());
  setup(2);
  evaluate(x, x_t0, f, k);
  setup(0);
  evaluate(x, x_t0, slow, k_slow);
  double power = 0;
  for (int r = 0; r < 9; r++) {
    double viscous = 0;
    for (int c = 0; c < 9; c++) viscous -= 2 * k_slow[9 * r + c] * (x[c] - x_t0[c]);
    CHECK_NEAR(f[r] - slow[r], viscous, 2e3 * step * step + tolerance);
    power += (f[r] - slow[r]) * (x[r] - x_t0[r]);
  }
  CHECK(power < 0);
  for (int c = 0; c < 9; c++) x_t0[c] = x[c];
  setup(2);
  evaluate(x, x_t0, f, k);
  for (int c = 0; c < 81; c++) CHECK_NEAR(k[c], 3 * k_slow[c], 3 * tolerance);
  return 0;
}

// diag(a, b) between two turns has the principal stretches a and b
static int stretch_is_largest_singular_value(void)
{
  setup(0);
  const double cases[5][2] = {{1, 1}, {1.1, 0.8}, {0.7, 1.0001}, {0.5, 0.4}, {0, 0}};
  for (int p = 0; p < 5; p++) {
    double a = cases[p][0], b = cases[p][1], q = 0.6, x[9];
    double turn[3] = {0.3 * p, 1, -2};
    double cq = cos(q), sq = sin(q); // the symmetric matrix with eigenvalues a, b
    pose(a * cq * cq + b * sq * sq, a * sq * sq + b * cq * cq, (a - b) * cq * sq, turn, x);
    cloth_real xr[9], stretch;
    for (int c = 0; c < 9; c++) xr[c] = (cloth_real)x[c];
    cloth_membrane_stretch_args args = {triangle, rest, xr, &stretch};
    cloth_membrane_stretch(0, &args);
    // a collapsed triangle: the square root turns eps into its root
    double root = a > 0 ? 64 * (double)CLOTH_REAL_EPSILON : 4 * sqrt((double)CLOTH_REAL_EPSILON);
    CHECK_NEAR((double)stretch, fmax(a, b) - 1, root);
  }
  return 0;
}

// The table's own numbers come back: stretched to 7/6 in its five directions, and near zero strain;
// half way it is half way, beyond it is constant. The oracle is the linear membrane.
static int measured_fabric_has_the_stiffness_of_its_table(void)
{
  static const cloth_real rows[24] = {50,  10, 60,  20, 130, 25, 80,  30, 140, 22, 90,  33,
                                      150, 20, 100, 36, 160, 18, 110, 39, 170, 16, 120, 42};
  setup(0);
  for (int angle = 0; angle < 5; angle++)
    for (int share = 1; share <= 3; share++) {
      double turn = acos(-1) / 8 * angle, x[9], force[2][9], full[81];
      double most = share / 12.0, w = share > 2 ? 1 : share / 2.0; // stretch - 1: 1/12, 1/6, 1/4
      for (int v = 0; v < 3; v++) {
        double along = most * (flat[v][0] * cos(turn) + flat[v][1] * sin(turn));
        x[3 * v] = flat[v][0] + along * cos(turn), x[3 * v + 1] = flat[v][1] + along * sin(turn);
        x[3 * v + 2] = 0;
      }
      table = rows;
      evaluate(x, x, force[0], full);
      cloth_real linear[4];
      memcpy(linear, stiffness, sizeof linear);
      for (int k = 0; k < 4; k++)
        stiffness[k] =
            (cloth_real)(2 * (1 - w)) * rows[k] + (cloth_real)(2 * w) * rows[4 + 4 * angle + k];
      table = NULL;
      evaluate(x, x, force[1], full);
      memcpy(stiffness, linear, sizeof linear);
      for (int c = 0; c < 9; c++)
        CHECK_NEAR(force[0][c], force[1][c], 100 * tolerance); // the angle's rounding
    }
  return 0;
}

static int measured_fabric_in_compression_is_that_of_zero_strain(void)
{
  static const cloth_real rows[24] = {130, 25, 80, 30};
  double x[9] = {0.1, 0, 0, 0.8, 0.2, 0, 0.3, 0.7, 0}, force[2][9], full[81];
  cloth_real linear[4], half[24];
  setup(0);
  memcpy(linear, stiffness, sizeof linear);
  for (int k = 0; k < 24; k++) half[k] = k < 4 ? rows[k] / 2 : 1000;
  for (int v = 0; v < 3; v++)
    x[3 * v] = 0.9 * flat[v][0], x[3 * v + 1] = 0.95 * flat[v][1], x[3 * v + 2] = 0;
  table = half;
  evaluate(x, x, force[0], full);
  table = NULL;
  evaluate(x, x, force[1], full);
  for (int c = 0; c < 9; c++) CHECK_NEAR(force[0][c], force[1][c], tolerance);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(force_is_energy_gradient);
  RUN(stretched_tangent_is_force_gradient);
  RUN(limited_force_and_tangent_are_derivatives);
  RUN(limit_has_no_step_in_its_stiffness);
  RUN(tangent_is_positive_semidefinite);
  RUN(force_of_a_torn_triangle_is_in_proportion);
  RUN(rigid_motion_has_no_force);
  RUN(force_and_torque_sum_to_zero);
  RUN(damping_is_proportional_to_stiffness);
  RUN(stretch_is_largest_singular_value);
  RUN(measured_fabric_has_the_stiffness_of_its_table);
  RUN(measured_fabric_in_compression_is_that_of_zero_strain);
  return failures != 0;
}
