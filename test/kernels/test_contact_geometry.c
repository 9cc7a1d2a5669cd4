// Tests of kernels/physics/contact_geometry.h: which way a contact pushes, against normals and
// sides that are known by construction.
#include "check.h"
#include "contact_geometry.h"
#include "derivative.h"

// corners of a floor of 100 m, tilted about x, and a vertex `above` it [m]
static void floor_and_vertex(double tilt, double above, cloth_real x[12])
{
  double at[4][3] = {{0.3, -0.2, above}, {-50, -50, 0}, {50, -50, 0}, {50, 50, 0}};
  at[0][1] += 0.3 * test_random();
  for (int k = 0; k < 4; k++) {
    x[3 * k] = (cloth_real)at[k][0];
    x[3 * k + 1] = (cloth_real)(cos(tilt) * at[k][1] - sin(tilt) * at[k][2]);
    x[3 * k + 2] = (cloth_real)(sin(tilt) * at[k][1] + cos(tilt) * at[k][2]);
  }
}

static const cloth_contact_geometry vertex_face = {.type = CLOTH_VERTEX_FACE,
                                                   .vertex = {0, 1, 2, 3}};

// sine of the angle between the contact's normal and that of the tilted floor; 2: it points down
static double lean(const cloth_contact_geometry *g, double tilt)
{
  double y = -sin(tilt), z = cos(tilt), nx = (double)g->normal.x, ny = (double)g->normal.y,
         nz = (double)g->normal.z;
  if (!(ny * y + nz * z > 0)) return 2;
  return hypot(nx, ny * z - nz * y);
}

// In float the vector between the closest points of a floor of 100 m is rounding within some 20 um.
static int a_large_floor_pushes_along_its_normal(void)
{
  for (int n = 0; n < 1000; n++) {
    double tilt = n % 3 * 0.3, above = 3e-5 * pow(100, fabs(test_random()));
    cloth_real x[12];
    floor_and_vertex(tilt, above, x);
    cloth_contact_geometry g = vertex_face;
    cloth_contact_measure(x, &g);
    CHECK(lean(&g, tilt) < 1e-5);
  }
  return 0;
}

// At the time of impact the vertex may be nearer than rounding can tell.
static int what_came_from_above_is_pushed_up(void)
{
  int down = 0;
  for (int n = 0; n < 1000; n++) {
    double tilt = n % 3 * 0.3;
    cloth_real x_t0[12], x[12];
    floor_and_vertex(tilt, 1e-3, x_t0);
    memcpy(x, x_t0, sizeof x);
    x[1] += (cloth_real)(1.5e-3 * sin(tilt)), x[2] -= (cloth_real)(1.5e-3 * cos(tilt));
    cloth_contact_scene s = {.x_t0 = x_t0, .x = x};
    cloth_contact_geometry g = vertex_face;
    // just before they meet, and just after, as a time that is rounded may be
    cloth_contact_measure_at(&s, (cloth_real)(2.0 / 3 + 4 * CLOTH_REAL_EPSILON * test_random()),
                             &g);
    CHECK(lean(&g, tilt) < 1e-5);
    cloth_contact_measure(x, &g);
    down += lean(&g, tilt) > 1;
  }
  CHECK(down == 1000); // what is beyond is on the other side by itself
  return 0;
}

// A sliver's own normal is poorly known: the vector between the closest points says more.
static int a_sliver_pushes_along_the_closest_points(void)
{
  const double height = 1e-6;
  for (int n = 0; n < 200; n++) {
    double turn = 3 * test_random(), c = cos(turn), s = sin(turn);
    const double at[4][3] = {{0.4, height / 3, 1e-3}, {0, 0, 0}, {1, 0, 0}, {0.3, height, 0}};
    cloth_real x[12];
    for (int k = 0; k < 4; k++) {
      x[3 * k] = (cloth_real)at[k][0];
      x[3 * k + 1] = (cloth_real)(c * at[k][1] - s * at[k][2]);
      x[3 * k + 2] = (cloth_real)(s * at[k][1] + c * at[k][2]);
    }
    cloth_contact_geometry g = vertex_face;
    cloth_contact_measure(x, &g);
    double up = -s * (double)g.normal.y + c * (double)g.normal.z;
    CHECK(up > 1 - 1e-4);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_large_floor_pushes_along_its_normal);
  RUN(what_came_from_above_is_pushed_up);
  RUN(a_sliver_pushes_along_the_closest_points);
  return failures != 0;
}
