// Tests of kernels/physics/bend.h. The oracle takes the angle from the heights of the two faces
// over the edge, in double, and differentiates it. Lengths are of order 1 m, angles of order 1 rad;
// random faces have heights down to 0.1 of the edge, so that gradients are of order 10 1/m and
// their rounding below 1000 eps.
#include "bend.h"
#include "check.h"
#include "derivative.h"

static const int hinge[4] = {0, 1, 2, 3};
static cloth_real stiffness[1] = {3}, rest_angle[1], damping[1];
static const double tolerance = 2000 * CLOTH_REAL_EPSILON + 1e-8; // differences give 1e-9

static double wrap(double angle) { return remainder(angle, 2 * acos(-1)); }

static double angle(const double *x)
{
  double e[3], h[2][3], ee = 0, cosine = 0, triple = 0;
  for (int c = 0; c < 3; c++) e[c] = x[3 + c] - x[c], ee += e[c] * e[c];
  for (int k = 0; k < 2; k++) {
    double along = 0;
    for (int c = 0; c < 3; c++) along += (x[6 + 3 * k + c] - x[c]) * e[c] / ee;
    for (int c = 0; c < 3; c++) h[k][c] = x[6 + 3 * k + c] - x[c] - along * e[c];
  }
  for (int c = 0; c < 3; c++) {
    int d = (c + 1) % 3, f = (c + 2) % 3;
    cosine += h[0][c] * h[1][c];
    triple += e[c] * (h[0][d] * h[1][f] - h[0][f] * h[1][d]);
  }
  return wrap(acos(-1) + atan2(triple / sqrt(ee), cosine));
}

static double energy(const double *x)
{
  double bend = wrap(angle(x) - (double)rest_angle[0]);
  return (double)stiffness[0] / 2 * bend * bend;
}

typedef struct result {
  double force[12], gradient[12], weight;
} result;

static result evaluate(const double x[12], const double x_t0[12])
{
  result r;
  cloth_real xr[12], x0[12], f[12], g[12], w[1];
  for (int c = 0; c < 12; c++) xr[c] = (cloth_real)x[c], x0[c] = (cloth_real)x_t0[c];
  cloth_bend_args a = {hinge, stiffness, rest_angle, damping, xr, x0, NULL, f, g, w};
  cloth_bend(0, &a);
  for (int c = 0; c < 12; c++) r.force[c] = (double)f[c], r.gradient[c] = (double)g[c];
  r.weight = (double)w[0];
  return r;
}

// an edge of length 2 about the x axis and faces of height 0.2 to 1 at any angle, turned, not
// folded flat
static void random_pose(double x[12])
{
  double y[12] = {-1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0}, r[9];
  double a = 3 * test_random(), b = a + acos(-1) + 2.8 * test_random();
  double h2 = 0.6 + 0.4 * test_random(), h3 = 0.6 + 0.4 * test_random();
  y[6] = 2 * test_random(), y[7] = h2 * cos(a), y[8] = h2 * sin(a);
  y[9] = 2 * test_random(), y[10] = h3 * cos(b), y[11] = h3 * sin(b);
  test_rotation(3 * test_random(), 3 * test_random(), 3 * test_random(), r);
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++)
      x[3 * v + c] = (double)(cloth_real)(r[3 * c] * y[3 * v] + r[3 * c + 1] * y[3 * v + 1] +
                                          r[3 * c + 2] * y[3 * v + 2]);
}

static int gradient_is_that_of_the_angle(void)
{
  rest_angle[0] = 0, damping[0] = 0;
  for (int p = 0; p < 100; p++) {
    double x[12];
    random_pose(x);
    result r = evaluate(x, x);
    for (int c = 0; c < 12; c++)
      CHECK_NEAR(r.gradient[c], test_derivative(angle, x, 12, c, 1e-4), tolerance);
  }
  return 0;
}

static int force_is_energy_gradient(void)
{
  damping[0] = 0;
  for (int p = 0; p < 100; p++) {
    double x[12];
    cloth_real xr[12];
    rest_angle[0] = (cloth_real)(0.2 * test_random());
    random_pose(x);
    result r = evaluate(x, x);
    for (int c = 0; c < 12; c++) {
      CHECK_NEAR(r.force[c], -test_derivative(energy, x, 12, c, 1e-4), 10 * tolerance);
      xr[c] = (cloth_real)x[c];
    }
    cloth_real e =
        cloth_bend_energy(cloth_v3_load(xr, 0), cloth_v3_load(xr, 1), cloth_v3_load(xr, 2),
                          cloth_v3_load(xr, 3), stiffness[0], rest_angle[0]);
    CHECK_NEAR((double)e, energy(x), 10 * tolerance);
    CHECK_NEAR(r.weight, 3, 0);
  }
  return 0;
}

static int force_and_torque_sum_to_zero(void)
{
  rest_angle[0] = 1, damping[0] = 0.5;
  for (int p = 0; p < 100; p++) {
    double x[12], x_t0[12], sum[6] = {0};
    random_pose(x), random_pose(x_t0);
    if (p % 4 == 0) // a sliver: reduced, and still balanced
      for (int c = 0; c < 3; c++)
        x[6 + c] = (double)(cloth_real)(x[c] + 0.3 * (x[3 + c] - x[c]) + 1e-5 * test_random());
    result r = evaluate(x, x_t0);
    double most = 1;
    for (int v = 0; v < 4; v++)
      for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        sum[c] += r.force[3 * v + c];
        sum[3 + c] += x[3 * v + d] * r.force[3 * v + e] - x[3 * v + e] * r.force[3 * v + d];
        most = fmax(most, fabs(r.force[3 * v + c]));
      }
    // the normal of a sliver of height 1e-5 has an error of eps / 1e-5 in its direction
    double sliver = p % 4 == 0 ? 1e5 * (double)CLOTH_REAL_EPSILON * most : 0;
    for (int c = 0; c < 6; c++) CHECK_NEAR(sum[c], 0, 10 * tolerance + sliver);
  }
  return 0;
}

// since rest and, with damping, during the step: from any turned place to any other
static int rigid_motion_has_no_force(void)
{
  damping[0] = 4;
  for (int p = 0; p < 30; p++) {
    double x[12], x_t0[12], r[9];
    random_pose(x_t0);
    rest_angle[0] = (cloth_real)angle(x_t0);
    test_rotation(3 * test_random(), 3 * test_random(), 3 * test_random(), r);
    for (int v = 0; v < 4; v++)
      for (int c = 0; c < 3; c++)
        x[3 * v + c] = r[3 * c] * x_t0[3 * v] + r[3 * c + 1] * x_t0[3 * v + 1] +
                       r[3 * c + 2] * x_t0[3 * v + 2] + 0.25;
    result f = evaluate(x, x_t0);
    for (int c = 0; c < 12; c++) CHECK_NEAR(f.force[c], 0, 20 * tolerance);
  }
  return 0;
}

// the viscous moment is damping k (theta - theta_t0), and the tangent's weight knows it
static int damping_resists_the_change_of_angle(void)
{
  for (int p = 0; p < 30; p++) {
    double x[12], x_t0[12];
    random_pose(x);
    rest_angle[0] = (cloth_real)angle(x), damping[0] = 2;
    for (int c = 0; c < 12; c++) x_t0[c] = (double)(cloth_real)(x[c] + 1e-2 * test_random());
    result r = evaluate(x, x_t0);
    double moment = 2 * 3 * wrap(angle(x) - angle(x_t0));
    for (int c = 0; c < 12; c++) CHECK_NEAR(r.force[c], -moment * r.gradient[c], 20 * tolerance);
    CHECK_NEAR(r.weight, 9, 0);
  }
  return 0;
}

// zero area, zero length, folded onto itself, everything in one point
static int degenerate_hinges_are_finite(void)
{
  const double poses[6][12] = {
      {0, 0, 0, 1, 0, 0, 0.5, 0, 0, 0.5, -1, 0},   {0, 0, 0, 1, 0, 0, 2, 0, 0, -1, 0, 0},
      {0, 0, 0, 0, 0, 0, 0.5, 1, 0, 0.5, -1, 0},   {0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, 1, 0},
      {0, 0, 0, 1, 0, 0, 0.5, 1e-7, 0, 0.5, 1, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
  rest_angle[0] = (cloth_real)0.5, damping[0] = 1;
  for (int p = 0; p < 6; p++) {
    for (int q = 0; q < 6; q++) {
      result r = evaluate(poses[p], poses[q]);
      for (int c = 0; c < 12; c++) {
        CHECK(isfinite(r.force[c]));
        CHECK(fabs(r.gradient[c]) <=
              2 * 1 / 1e-3); // no steeper than the least height a face can have
      }
    }
  }
  return 0;
}

// at rest at +3 rad and now at -3 rad, the hinge goes on over pi instead of back through flat
static int angle_differences_take_the_short_way(void)
{
  damping[0] = 0;
  for (int side = -1; side <= 1; side += 2) {
    // one face towards -y, the other 3 rad away from +y
    double x[12] = {-1, 0, 0, 1, 0, 0, 0, cos(3.0), side * sin(3.0), 0, -1, 0};
    double now = angle(x), pi = acos(-1);
    CHECK_NEAR(fabs(now), 3, tolerance);
    rest_angle[0] = (cloth_real)-now;
    result r = evaluate(x, x);
    double moment = 3 * (2 * pi - 6) * (now > 0 ? -1 : 1);
    for (int c = 0; c < 12; c++) CHECK_NEAR(r.force[c], -moment * r.gradient[c], 20 * tolerance);
  }
  return 0;
}

// energy per area of a cylinder of curvature kappa around the direction phi, of the hinges whose
// edges and opposite corners are given in the plane
static double cylinder_energy(int hinges, const double plane[][4][2], double area, double phi,
                              double kappa)
{
  double sum = 0;
  for (int k = 0; k < hinges; k++) {
    cloth_v3 x[4];
    double length_sq = 0;
    for (int v = 0; v < 4; v++) {
      double along = cos(phi) * plane[k][v][0] + sin(phi) * plane[k][v][1];
      double across = cos(phi) * plane[k][v][1] - sin(phi) * plane[k][v][0];
      x[v] =
          cloth_v3_make((cloth_real)(sin(kappa * along) / kappa), (cloth_real)across,
                        (cloth_real)(-2 * sin(kappa * along / 2) * sin(kappa * along / 2) / kappa));
    }
    for (int c = 0; c < 2; c++) length_sq += pow(plane[k][1][c] - plane[k][0][c], 2);
    double face = area / hinges * 3 / 2; // three hinges have two faces
    cloth_real k_hinge = cloth_bend_stiffness((cloth_real)1.7, (cloth_real)sqrt(length_sq),
                                              (cloth_real)face, (cloth_real)face);
    sum += (double)cloth_bend_energy(x[0], x[1], x[2], x[3], k_hinge, 0);
  }
  return sum / area;
}

// D/2 kappa^2 in every direction; chords instead of arcs cost (kappa l)^2 / 12 = 8e-5
static int equilateral_cylinder_has_the_energy_of_the_plate(void)
{
  double h = sqrt(0.75), D = 1.7, kappa = 0.03;
  const double plane[3][4][2] = {{{0, 0}, {1, 0}, {0.5, h}, {0.5, -h}},
                                 {{0, 0}, {0.5, h}, {-0.5, h}, {1, 0}},
                                 {{0, 0}, {-0.5, h}, {-1, 0}, {0.5, h}}};
  for (int p = 0; p < 12; p++) {
    double e = cylinder_energy(3, plane, h, p * 0.26, kappa);
    // an angle of 0.03 rad is known to 30 eps in float
    CHECK_NEAR(e / (D / 2 * kappa * kappa), 1, 1e-3 + 500 * (double)CLOTH_REAL_EPSILON);
  }
  return 0;
}

// With all diagonals one way the same D bends 1 + y + y^2 times as stiffly, y = sin(2 phi): the
// jumps of slope of a quadratic surface over the three edges, by hand. The chords cost as above.
static int grid_cylinder_is_stiffer_across_the_diagonal(void)
{
  const double plane[3][4][2] = {{{0, 0}, {1, 0}, {1, 1}, {0, -1}},
                                 {{0, 0}, {0, 1}, {-1, 0}, {1, 1}},
                                 {{0, 0}, {1, 1}, {0, 1}, {1, 0}}};
  double D = 1.7, kappa = 0.03;
  for (int p = 0; p < 12; p++) {
    double phi = p * 0.26, y = sin(2 * phi), e = cylinder_energy(3, plane, 1, phi, kappa);
    CHECK_NEAR(e / (D / 2 * kappa * kappa), 1 + y + y * y,
               4e-3 + 1500 * (double)CLOTH_REAL_EPSILON);
  }
  return 0;
}

// within two roundings of the angle
static int arc_tangent_agrees_with_the_library(void)
{
  for (int p = 0; p <= 20000; p++) {
    double t = acos(-1) * (p - 10000) / 10000, size = pow(10, p % 13 - 6);
    cloth_real y = (cloth_real)(size * sin(t)), x = (cloth_real)(size * cos(t));
    CHECK_NEAR((double)cloth_bend_atan2(y, x), atan2((double)y, (double)x),
               4 * (double)CLOTH_REAL_EPSILON);
  }
  CHECK_NEAR((double)cloth_bend_atan2(0, 0), 0, 0);
  CHECK_NEAR((double)cloth_bend_atan2(0, -1), acos(-1), 4 * (double)CLOTH_REAL_EPSILON);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(gradient_is_that_of_the_angle);
  RUN(force_is_energy_gradient);
  RUN(force_and_torque_sum_to_zero);
  RUN(rigid_motion_has_no_force);
  RUN(damping_resists_the_change_of_angle);
  RUN(degenerate_hinges_are_finite);
  RUN(angle_differences_take_the_short_way);
  RUN(equilateral_cylinder_has_the_energy_of_the_plate);
  RUN(grid_cylinder_is_stiffer_across_the_diagonal);
  RUN(arc_tangent_agrees_with_the_library);
  return failures != 0;
}
