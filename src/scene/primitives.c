// Boxes, spheres, cylinders and squares as triangles, counter-clockwise seen from outside.
#include "scene/mesh.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static cloth_status check_length(const char *what, double value, cloth_error *err)
{
  if (!(value >= 1e-6 && value <= 1e4))
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s = %g [m] is not in [1e-06, 10000]", what, value);
  return CLOTH_OK;
}

static cloth_status check_segments(int segments, cloth_error *err)
{
  if (segments < 3 || segments > 1000)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "segments = %d [1] is not in [3, 1000]", segments);
  return CLOTH_OK;
}

static void put_vertex(cloth_mesh *m, int *count, double x, double y, double z)
{
  double *p = m->position + 3 * (size_t)*count;
  p[0] = x, p[1] = y, p[2] = z;
  ++*count;
}

static void put_triangle(cloth_mesh *m, int *count, int a, int b, int c)
{
  int *t = m->triangle + 3 * (size_t)*count;
  t[0] = a, t[1] = b, t[2] = c;
  ++*count;
}

cloth_status cloth_mesh_box(const double size[3], cloth_mesh *out, cloth_error *err)
{
  // bit 0, 1, 2 of a corner's index: right, back, top
  static const int triangle[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                      {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                      {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  *out = (cloth_mesh){0};
  static const char *const name[] = {"size x", "size y", "size z"};
  for (int i = 0; i < 3; i++) CLOTH_TRY(check_length(name[i], size[i], err));
  CLOTH_TRY(cloth_mesh_new(8, 12, false, out, err));
  int n = 0;
  for (int i = 0; i < 8; i++)
    put_vertex(out, &n, size[0] * ((i & 1) - 0.5), size[1] * ((i >> 1 & 1) - 0.5),
               size[2] * ((i >> 2 & 1) - 0.5));
  memcpy(out->triangle, triangle, sizeof triangle);
  return CLOTH_OK;
}

// A band of triangles between two rings of vertices, the second one above the first.
static void put_band(cloth_mesh *m, int *count, int lower, int upper, int segments)
{
  for (int i = 0; i < segments; i++) {
    int j = (i + 1) % segments;
    put_triangle(m, count, lower + i, lower + j, upper + j);
    put_triangle(m, count, lower + i, upper + j, upper + i);
  }
}

// A fan from a ring to a vertex on its axis, seen from above or from below.
static void put_fan(cloth_mesh *m, int *count, int ring, int centre, int segments, bool from_above)
{
  for (int i = 0; i < segments; i++) {
    int j = (i + 1) % segments;
    put_triangle(m, count, centre, ring + (from_above ? i : j), ring + (from_above ? j : i));
  }
}

static void put_ring(cloth_mesh *m, int *count, double radius, double z, int segments)
{
  for (int i = 0; i < segments; i++) {
    double angle = 2 * PI * i / segments;
    put_vertex(m, count, radius * cos(angle), radius * sin(angle), z);
  }
}

cloth_status cloth_mesh_sphere(double radius, int segments, cloth_mesh *out, cloth_error *err)
{
  *out = (cloth_mesh){0};
  CLOTH_TRY(check_length("radius", radius, err));
  CLOTH_TRY(check_segments(segments, err));
  int bands = segments < 4 ? 2 : segments / 2, rings = bands - 1;
  CLOTH_TRY(cloth_mesh_new(rings * segments + 2, 2 * rings * segments, false, out, err));
  int vertices = 0, triangles = 0;
  for (int ring = 0; ring < rings; ring++) {
    double angle = PI * (ring + 1) / bands; // from the south pole
    put_ring(out, &vertices, radius * sin(angle), -radius * cos(angle), segments);
  }
  int south = vertices, north = vertices + 1;
  put_vertex(out, &vertices, 0, 0, -radius);
  put_vertex(out, &vertices, 0, 0, radius);
  put_fan(out, &triangles, 0, south, segments, false);
  for (int ring = 0; ring + 1 < rings; ring++)
    put_band(out, &triangles, ring * segments, (ring + 1) * segments, segments);
  put_fan(out, &triangles, (rings - 1) * segments, north, segments, true);
  return CLOTH_OK;
}

cloth_status cloth_mesh_cone(const double radius[2], double length, int segments, cloth_mesh *out,
                             cloth_error *err)
{
  *out = (cloth_mesh){0};
  int rings = 0, vertices = 0, triangles = 0;
  for (int end = 0; end < 2; end++) { // 0: a tip, the others are lengths
    if (radius[end] == 0) continue;
    CLOTH_TRY(check_length("radius", radius[end], err));
    rings++;
  }
  if (rings == 0) CLOTH_FAIL(err, CLOTH_BAD_SCENE, "radius = (0, 0) [m]: a cone has one tip");
  CLOTH_TRY(check_length("length", length, err));
  CLOTH_TRY(check_segments(segments, err));
  CLOTH_TRY(cloth_mesh_new(rings * segments + 2, 2 * rings * segments, false, out, err));
  for (int end = 0; end < 2; end++)
    if (radius[end] > 0) put_ring(out, &vertices, radius[end], length * (end - 0.5), segments);
  int south = vertices, north = vertices + 1, upper = (rings - 1) * segments;
  put_vertex(out, &vertices, 0, 0, -length / 2);
  put_vertex(out, &vertices, 0, 0, length / 2);
  put_fan(out, &triangles, 0, south, segments, false);
  if (rings == 2) put_band(out, &triangles, 0, segments, segments);
  put_fan(out, &triangles, upper, north, segments, true);
  return CLOTH_OK;
}

cloth_status cloth_mesh_cylinder(double radius, double length, int segments, cloth_mesh *out,
                                 cloth_error *err)
{
  const double both[2] = {radius, radius};
  *out = (cloth_mesh){0};
  CLOTH_TRY(check_length("radius", radius, err));
  return cloth_mesh_cone(both, length, segments, out, err);
}

cloth_status cloth_mesh_square(double size, cloth_mesh *out, cloth_error *err)
{
  *out = (cloth_mesh){0};
  CLOTH_TRY(check_length("size", size, err));
  CLOTH_TRY(cloth_mesh_new(4, 2, false, out, err));
  int vertices = 0, triangles = 0;
  for (int i = 0; i < 4; i++)
    put_vertex(out, &vertices, size * (i == 1 || i == 2 ? 0.5 : -0.5), size * (i >= 2 ? 0.5 : -0.5),
               0);
  put_triangle(out, &triangles, 0, 1, 2);
  put_triangle(out, &triangles, 0, 2, 3);
  return CLOTH_OK;
}
