// Measures of a triangle mesh, written for the tests alone.
#pragma once

#include "scene/mesh.h"

#include <math.h>
#include <stdlib.h>

static inline const double *shape_corner(const cloth_mesh *m, int t, int k)
{
  return m->position + 3 * m->triangle[3 * t + k];
}

/// Six times the volume of the tetrahedra from the origin, over 6: the volume of a closed mesh,
/// positive if its normals point outward (divergence theorem).
static inline double shape_volume(const cloth_mesh *m)
{
  double sum = 0;
  for (int t = 0; t < m->triangle_count; t++) {
    const double *a = shape_corner(m, t, 0), *b = shape_corner(m, t, 1), *c = shape_corner(m, t, 2);
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

/// Signed area of a mesh in the plane z = 0; the smallest signed triangle area goes to *least.
static inline double shape_area(const cloth_mesh *m, double *least)
{
  double sum = 0;
  *least = INFINITY;
  for (int t = 0; t < m->triangle_count; t++) {
    const double *a = shape_corner(m, t, 0), *b = shape_corner(m, t, 1), *c = shape_corner(m, t, 2);
    double area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    sum += area;
    if (area < *least) *least = area;
  }
  return sum;
}

/// Smallest angle of any triangle [degrees].
static inline double shape_angle_min(const cloth_mesh *m)
{
  double least = 180;
  for (int t = 0; t < m->triangle_count; t++)
    for (int k = 0; k < 3; k++) {
      const double *o = shape_corner(m, t, k), *a = shape_corner(m, t, (k + 1) % 3),
                   *b = shape_corner(m, t, (k + 2) % 3);
      double dot = 0, aa = 0, bb = 0;
      for (int i = 0; i < 3; i++) {
        dot += (a[i] - o[i]) * (b[i] - o[i]);
        aa += (a[i] - o[i]) * (a[i] - o[i]);
        bb += (b[i] - o[i]) * (b[i] - o[i]);
      }
      double angle = acos(dot / sqrt(aa * bb)) * 180 / 3.14159265358979323846;
      if (angle < least) least = angle;
    }
  return least;
}

/// How often a directed side a -> b occurs.
static inline int shape_side_count(const cloth_mesh *m, int a, int b)
{
  int n = 0;
  for (int i = 0; i < 3 * m->triangle_count; i++)
    n += m->triangle[i] == a && m->triangle[i / 3 * 3 + (i + 1) % 3] == b;
  return n;
}

typedef struct shape_edges {
  int edges, borders; // borders: edges with one triangle
  bool manifold;      // every directed side occurs once
} shape_edges;

/// Count edges the slow and certain way: every side against every side.
static inline shape_edges shape_count_edges(const cloth_mesh *m)
{
  shape_edges out = {0, 0, true};
  for (int t = 0; t < m->triangle_count; t++)
    for (int k = 0; k < 3; k++) {
      int a = m->triangle[3 * t + k], b = m->triangle[3 * t + (k + 1) % 3];
      int back = shape_side_count(m, b, a);
      if (shape_side_count(m, a, b) != 1 || back > 1) out.manifold = false;
      if (back == 0) out.borders++;
      if (back == 0 || a < b) out.edges++;
    }
  return out;
}

/// Vertices - edges + triangles: 1 for a sheet, 2 for a sphere.
static inline int shape_euler(const cloth_mesh *m)
{
  return m->vertex_count - shape_count_edges(m).edges + m->triangle_count;
}
