// Tests of kernels/physics/drag.h. Forces are of order 100 N, their derivative in the positions of
// order 1e4 N/m; tolerances are some tens of roundings of these.
#include "check.h"
#include "derivative.h"
#include "drag.h"

static const int triangle[3] = {0, 1, 2}, material[1] = {1};
static const cloth_real coefficient[4] = {9, 9, (cloth_real)1.25,
                                          (cloth_real)0.125}; // row 1 counts
static const double density = 1.25, step = 0.0078125;         // kg/m^3, s

static double corner[9], wind[3]; // m, m/s

// force on one corner, tangent of one corner: moved by v step since the start
static void evaluate(const double v[3], double force[3], double tangent[6])
{
  cloth_real x[9], x_t0[9], f[3], k[6];
  for (int c = 0; c < 9; c++) {
    x_t0[c] = (cloth_real)corner[c];
    x[c] = (cloth_real)(corner[c] + v[c % 3] * step);
  }
  cloth_drag_args a = {triangle,
                       material,
                       coefficient,
                       (cloth_real)(density / 2),
                       (cloth_real)(1 / step),
                       {(cloth_real)wind[0], (cloth_real)wind[1], (cloth_real)wind[2]},
                       x,
                       x_t0,
                       f,
                       k};
  cloth_drag(0, &a);
  for (int c = 0; c < 3; c++) force[c] = (double)f[c];
  for (int c = 0; c < 6; c++) tangent[c] = (double)k[c];
}

// the face is 2 m x 3 m / 2 in the x-y plane
static void face(void)
{
  const double flat[9] = {0, 0, 0, 2, 0, 0, 0, 3, 0};
  memcpy(corner, flat, sizeof corner);
  memset(wind, 0, sizeof wind);
}

static void random_face(void)
{
  for (int c = 0; c < 9; c++) corner[c] = test_random();
  for (int c = 0; c < 3; c++) wind[c] = 10 * test_random();
}

// F = rho/2 C A v^2 over three corners; the motion v step is known to eps of the corner, over the
// step
static const double tolerance = 3000 * CLOTH_REAL_EPSILON;

static int plate_has_the_textbook_drag(void)
{
  double f[3], k[6];
  face();
  evaluate((double[3]){0, 0, -4}, f, k);
  CHECK_NEAR(f[0], 0, tolerance);
  CHECK_NEAR(f[1], 0, tolerance);
  CHECK_NEAR(f[2], 1.25 / 2 * 1.25 * 3 * 16 / 3, tolerance);
  evaluate((double[3]){4, 0, 0}, f, k);
  CHECK_NEAR(f[0], -1.25 / 2 * 0.125 * 3 * 16 / 3, tolerance);
  CHECK_NEAR(f[1], 0, tolerance);
  CHECK_NEAR(f[2], 0, tolerance);
  return 0;
}

// a face at an angle to the wind is lifted: there is a force across the wind
static int inclined_face_is_lifted(void)
{
  double f[3], k[6];
  face();
  wind[0] = 10, wind[2] = 2;
  evaluate((double[3]){0, 0, 0}, f, k);
  CHECK(f[2] > 0);
  CHECK_NEAR(f[2], 1.25 / 2 * 1.25 * 3 * 4 / 3, tolerance);
  return 0;
}

static int drag_opposes_motion_and_vanishes_with_the_wind(void)
{
  for (int p = 0; p < 200; p++) {
    double f[3], k[6], v[3], power = 0;
    random_face();
    for (int c = 0; c < 3; c++) v[c] = 10 * test_random();
    evaluate(v, f, k);
    for (int c = 0; c < 3; c++) power += f[c] * (v[c] - wind[c]);
    CHECK(power < 0);
    evaluate(wind, f, k);
    for (int c = 0; c < 3; c++) CHECK_NEAR(f[c], 0, tolerance); // squared motion error is far below
  }
  return 0;
}

static double component(const double *v, int c)
{
  // the definition of drag.h, in double, on one corner
  double n[3], e1[3], e2[3], u[3], ut[3], nn = 0, un = 0, slip = 0;
  for (int d = 0; d < 3; d++) e1[d] = corner[3 + d] - corner[d], e2[d] = corner[6 + d] - corner[d];
  for (int d = 0; d < 3; d++)
    n[d] = e1[(d + 1) % 3] * e2[(d + 2) % 3] - e1[(d + 2) % 3] * e2[(d + 1) % 3];
  for (int d = 0; d < 3; d++) nn += n[d] * n[d], u[d] = v[d] - wind[d];
  for (int d = 0; d < 3; d++) n[d] /= sqrt(nn), un += n[d] * u[d];
  for (int d = 0; d < 3; d++) ut[d] = u[d] - un * n[d], slip += ut[d] * ut[d];
  return -density / 2 * sqrt(nn) / 2 / 3 *
         (1.25 * fabs(un) * un * n[c] + 0.125 * sqrt(slip) * ut[c]);
}
static double component_x(const double *v) { return component(v, 0); }
static double component_y(const double *v) { return component(v, 1); }
static double component_z(const double *v) { return component(v, 2); }

// moving the whole face changes the force on a corner by minus its tangent
static int tangent_is_force_gradient_and_positive(void)
{
  static const int packed[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
  test_function *const force[3] = {component_x, component_y, component_z};
  for (int p = 0; p < 100; p++) {
    double f[3], k[6], v[3], full[9];
    random_face();
    for (int c = 0; c < 3; c++) v[c] = 10 * test_random();
    evaluate(v, f, k);
    for (int r = 0; r < 3; r++) {
      CHECK_NEAR(f[r], component(v, r), tolerance);
      for (int c = 0; c < 3; c++) {
        full[3 * r + c] = k[packed[r][c]];
        CHECK_NEAR(full[3 * r + c], -test_derivative(force[r], v, 3, c, 1e-3) / step,
                   tolerance / step + 1e-7);
      }
    }
    CHECK(test_least_eigenvalue(full, 3) >= -tolerance);
  }
  return 0;
}

static int face_without_area_or_motion_is_finite(void)
{
  double f[3], k[6];
  face();
  evaluate((double[3]){0, 0, 0}, f, k);
  for (int c = 0; c < 3; c++) CHECK_NEAR(f[c], 0, 0);
  for (int c = 0; c < 6; c++) CHECK_NEAR(k[c], 0, 0);
  memset(corner, 0, sizeof corner);
  evaluate((double[3]){3, 1, 2}, f, k);
  for (int c = 0; c < 3; c++) CHECK_NEAR(f[c], 0, 0);
  for (int c = 0; c < 6; c++) CHECK_NEAR(k[c], 0, 0);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(plate_has_the_textbook_drag);
  RUN(inclined_face_is_lifted);
  RUN(drag_opposes_motion_and_vanishes_with_the_wind);
  RUN(tangent_is_force_gradient_and_positive);
  RUN(face_without_area_or_motion_is_finite);
  return failures != 0;
}
