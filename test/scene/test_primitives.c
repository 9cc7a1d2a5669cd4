// Tests of src/scene/primitives.c.
#include "check.h"
#include "shape.h"

static const double PI = 3.14159265358979323846;

static int check_closed(const cloth_mesh *m)
{
  shape_edges e = shape_count_edges(m);
  CHECK(e.manifold);
  CHECK(e.borders == 0);
  CHECK(shape_euler(m) == 2);
  CHECK(shape_volume(m) > 0); // outward
  return 0;
}

static int box_is_closed_with_exact_volume(void)
{
  const double size[3] = {0.5, 2, 0.25};
  cloth_mesh m;
  cloth_error err = {0};
  CHECK_OK(cloth_mesh_box(size, &m, &err), err);
  CHECK(check_closed(&m) == 0);
  CHECK(shape_volume(&m) == 0.25); // powers of two: no rounding
  for (int v = 0; v < 8; v++)
    for (int i = 0; i < 3; i++) CHECK(fabs(m.position[3 * v + i]) == size[i] / 2);
  cloth_mesh_free(&m);
  return 0;
}

// the inscribed polyhedron approaches the sphere from inside with the square of the segments
static int sphere_volume_converges(void)
{
  double last = 1;
  for (int segments = 8; segments <= 64; segments *= 2) {
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_sphere(0.3, segments, &m, &err), err);
    if (segments <= 32) CHECK(check_closed(&m) == 0);
    for (int v = 0; v < m.vertex_count; v++) {
      const double *x = m.position + 3 * v;
      CHECK_NEAR(sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]), 0.3, 1e-15);
    }
    double missing = 1 - shape_volume(&m) / (4 * PI / 3 * 0.027);
    CHECK(missing > 0);
    if (segments > 8) CHECK(last / missing > 3.6 && last / missing < 4.4);
    last = missing;
    cloth_mesh_free(&m);
  }
  CHECK(last < 0.005);
  return 0;
}

// a prism over a regular polygon: its volume is known exactly
static int cylinder_is_a_closed_prism(void)
{
  for (int segments = 3; segments <= 24; segments++) {
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_cylinder(0.2, 1.5, segments, &m, &err), err);
    CHECK(check_closed(&m) == 0);
    double polygon = 0.5 * segments * 0.04 * sin(2 * PI / segments);
    CHECK_NEAR(shape_volume(&m), 1.5 * polygon, 1e-15);
    cloth_mesh_free(&m);
  }
  return 0;
}

// a frustum over a regular polygon, or a pyramid: A (1 + q + q^2) L / 3, q the ratio of the radii
static int cone_is_a_closed_frustum(void)
{
  static const double radius[][2] = {{0.2, 0.1}, {0.2, 0}, {0, 0.2}, {0.05, 0.2}};
  for (int segments = 3; segments <= 12; segments++)
    for (int i = 0; i < 4; i++) {
      cloth_mesh m;
      cloth_error err = {0};
      const double a = radius[i][0], b = radius[i][1];
      CHECK_OK(cloth_mesh_cone(radius[i], 1.5, segments, &m, &err), err);
      CHECK(check_closed(&m) == 0);
      double polygon = 0.5 * segments * sin(2 * PI / segments);
      CHECK_NEAR(shape_volume(&m), 1.5 / 3 * polygon * (a * a + a * b + b * b), 1e-15);
      int tips = 0;
      for (int v = 0; v < m.vertex_count; v++) {
        const double *x = m.position + 3 * v;
        CHECK(fabs(x[2]) == 0.75);
        double r = sqrt(x[0] * x[0] + x[1] * x[1]), wanted = x[2] > 0 ? b : a;
        if (r > 0) CHECK_NEAR(r, wanted, 1e-15);
        tips += r == 0 && wanted == 0;
      }
      CHECK(tips == (a * b == 0));
      cloth_mesh_free(&m);
    }
  return 0;
}

static int square_faces_up(void)
{
  cloth_mesh m;
  cloth_error err = {0};
  double least;
  CHECK_OK(cloth_mesh_square(3, &m, &err), err);
  CHECK(shape_area(&m, &least) == 9 && least == 4.5);
  cloth_mesh_free(&m);
  return 0;
}

static int few_segments_are_closed_too(void)
{
  for (int segments = 3; segments < 8; segments++) {
    cloth_mesh m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_sphere(1, segments, &m, &err), err);
    CHECK(check_closed(&m) == 0);
    cloth_mesh_free(&m);
  }
  return 0;
}

static int nonsense_is_refused_with_its_range(void)
{
  const double lengths[] = {0, -1, NAN, INFINITY, 1e-9, 1e9};
  cloth_mesh m;
  for (int i = 0; i < 6; i++) {
    const double size[3] = {1, lengths[i], 1};
    cloth_error err[5] = {{0}};
    CHECK(cloth_mesh_box(size, &m, &err[0]) == CLOTH_BAD_SCENE);
    CHECK(cloth_mesh_sphere(lengths[i], 8, &m, &err[1]) == CLOTH_BAD_SCENE);
    CHECK(cloth_mesh_cylinder(lengths[i], 1, 8, &m, &err[2]) == CLOTH_BAD_SCENE);
    CHECK(cloth_mesh_cylinder(1, lengths[i], 8, &m, &err[3]) == CLOTH_BAD_SCENE);
    CHECK(cloth_mesh_square(lengths[i], &m, &err[4]) == CLOTH_BAD_SCENE);
    static const char *const what[] = {
        "size y = ", "radius = ", "radius = ", "length = ", "size = "};
    for (int k = 0; k < 5; k++)
      CHECK(strstr(err[k].text, what[k]) && strstr(err[k].text, "[m] is not in [1e-06, 10000]"));
  }
  const double tips[][2] = {{0, 0}, {-1, 0}, {0.1, NAN}};
  static const char *const wrong[] = {"radius = (0, 0) [m]: a cone has one tip",
                                      "radius = -1 [m] is not in", "radius = nan [m] is not in"};
  for (int i = 0; i < 3; i++) {
    cloth_error err = {0};
    CHECK(cloth_mesh_cone(tips[i], 1, 8, &m, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, wrong[i]) != NULL);
  }
  cloth_error err = {0};
  CHECK(cloth_mesh_sphere(1, 2, &m, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "segments = 2 [1] is not in [3, 1000]") != NULL);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(box_is_closed_with_exact_volume);
  RUN(sphere_volume_converges);
  RUN(cylinder_is_a_closed_prism);
  RUN(cone_is_a_closed_frustum);
  RUN(square_faces_up);
  RUN(few_segments_are_closed_too);
  RUN(nonsense_is_refused_with_its_range);
  return failures != 0;
}
