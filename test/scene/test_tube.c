// Tests of src/scene/tube.c.
#include "check.h"
#include "shape.h"

static const double PI = 3.14159265358979323846;
static const int resolutions[][2] = {{3, 2}, {4, 3}, {5, 4}, {12, 7}};

// closed around, open at both ends: Euler characteristic 0, two rings of border edges, and every
// side shared by neighbours that agree on the outside
static int a_tube_has_one_seamless_side_and_two_open_ends(void)
{
  for (int i = 0; i < 4; i++) {
    const int *n = resolutions[i];
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_tube(0.3, 1.2, n, &m, &err), err);
    CHECK(m.vertex_count == n[0] * n[1] && m.triangle_count == 2 * n[0] * (n[1] - 1));
    shape_edges e = shape_count_edges(&m);
    CHECK(e.manifold && e.borders == 2 * n[0] && shape_euler(&m) == 0);
    for (int v = 0; v < m.vertex_count; v++) {
      const double *x = m.position + 3 * v;
      CHECK_NEAR(sqrt(x[0] * x[0] + x[1] * x[1]), 0.3, 1e-15);
      CHECK(fabs(x[2]) <= 0.6);
      if (v < n[0]) CHECK(x[2] == -0.6);
      if (v >= m.vertex_count - n[0]) CHECK(x[2] == 0.6);
    }
    cloth_mesh_free(&m);
  }
  return 0;
}

static int its_triangles_face_away_from_the_axis(void)
{
  for (int i = 0; i < 4; i++) {
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_tube(0.3, 1.2, resolutions[i], &m, &err), err);
    for (int t = 0; t < m.triangle_count; t++) {
      const double *a = shape_corner(&m, t, 0), *b = shape_corner(&m, t, 1),
                   *c = shape_corner(&m, t, 2);
      double u[2] = {b[0] - a[0], b[1] - a[1]}, v[2] = {c[0] - a[0], c[1] - a[1]};
      double nx = u[1] * (c[2] - a[2]) - (b[2] - a[2]) * v[1],
             ny = (b[2] - a[2]) * v[0] - u[0] * (c[2] - a[2]);
      CHECK(nx * (a[0] + b[0] + c[0]) + ny * (a[1] + b[1] + c[1]) > 0);
    }
    cloth_mesh_free(&m);
  }
  return 0;
}

static double side(const double *a, const double *b, int n)
{
  double sum = 0;
  for (int i = 0; i < n; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

// each triangle in the material is congruent to that in space, the same way round, and its first
// side lies along the warp
static int it_is_without_strain_at_rest(void)
{
  for (int i = 0; i < 4; i++) {
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_tube(0.3, 1.2, resolutions[i], &m, &err), err);
    for (int t = 0; t < m.triangle_count; t++) {
      const double *w = m.material + 6 * t;
      for (int k = 0; k < 3; k++)
        CHECK_NEAR(side(w + 2 * k, w + 2 * ((k + 1) % 3), 2),
                   side(shape_corner(&m, t, k), shape_corner(&m, t, (k + 1) % 3), 3),
                   1e-14); // rounding
      CHECK((w[2] - w[0]) * (w[5] - w[1]) - (w[3] - w[1]) * (w[4] - w[0]) > 0);
      CHECK(w[1] == w[3]);
    }
    cloth_mesh_free(&m);
  }
  return 0;
}

// the area of the tube, up to the polygon's chords
static int its_area_converges_to_that_of_a_cylinder(void)
{
  double last = 0;
  for (int n = 8; n <= 32; n *= 2) {
    const int resolution[2] = {n, n};
    cloth_mesh m;
    cloth_error err = {0};
    double area = 0;
    CHECK_OK(cloth_mesh_tube(0.25, 1, resolution, &m, &err), err);
    for (int t = 0; t < m.triangle_count; t++) {
      const double *w = m.material + 6 * t;
      area += 0.5 * ((w[2] - w[0]) * (w[5] - w[1]) - (w[3] - w[1]) * (w[4] - w[0]));
    }
    double missing = fabs(1 - area / (2 * PI * 0.25));
    if (n > 8) CHECK(last / missing > 3.5);
    last = missing;
    cloth_mesh_free(&m);
  }
  CHECK(last < 0.01);
  return 0;
}

static int nonsense_is_refused_with_its_range(void)
{
  const double bad[] = {0, -1, NAN, INFINITY};
  const int good[2] = {3, 2}, few[][2] = {{2, 2}, {3, 1}, {20000, 2}, {10000, 10000}};
  cloth_mesh m;
  for (int i = 0; i < 4; i++) {
    cloth_error err = {0};
    CHECK(cloth_mesh_tube(bad[i], 1, good, &m, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "radius = ") && strstr(err.text, "[m] is not in [1e-06, 10000]"));
    err = (cloth_error){0};
    CHECK(cloth_mesh_tube(1, bad[i], good, &m, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "length = ") != NULL);
    err = (cloth_error){0};
    CHECK(cloth_mesh_tube(1, 1, few[i], &m, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "resolution = ") != NULL);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_tube_has_one_seamless_side_and_two_open_ends);
  RUN(its_triangles_face_away_from_the_axis);
  RUN(it_is_without_strain_at_rest);
  RUN(its_area_converges_to_that_of_a_cylinder);
  RUN(nonsense_is_refused_with_its_range);
  return failures != 0;
}
