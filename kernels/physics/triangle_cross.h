// Do two triangles intersect, and how: which edges of one pierce the other, and on which side of
// its plane the corners lie. In double whatever the engine's precision; a sign that rounding could
// have made is 0 (static filter of J. Shewchuk, Adaptive precision floating-point arithmetic and
// fast robust geometric predicates, 1997), and touching counts as intersecting. Neighbours in one
// flat sheet must not: where the space around a plane cannot tell, its projection does.
#pragma once

#include "real.h"

/// What cloth_triangles_cross() found. Sides are 1 in front of the other's plane (it is
/// counter-clockwise from there), 2 behind, 0 on it.
enum {
  CLOTH_CROSS_EDGE_A = 0,         // bits 0..2: edges of a that pierce b; edge k joins k and k + 1
  CLOTH_CROSS_EDGE_B = 3,         // bits 3..5: edges of b that pierce a
  CLOTH_CROSS_SIDE_A = 6,         // 2 bits each: corners of a at the plane of b
  CLOTH_CROSS_SIDE_B = 12,        // 2 bits each: corners of b at the plane of a
  CLOTH_CROSS_FLAT = 1 << 18,     // they overlap in one plane
  CLOTH_CROSS_OPPOSITE = 1 << 19, // their normals point to opposite sides
  CLOTH_CROSS_ANY = 1 << 20
};

#define CLOTH_CROSS_EPSILON 1.2e-15 // bounds the error of a sign, as a share of its summed products

CLOTH_FN int cloth_sign_of(double value, double summed)
{
  double bound = CLOTH_CROSS_EPSILON * summed;
  return value > bound ? 1 : value < -bound ? -1 : 0;
}

/// 1: d is in front of the plane through a, b, c; -1: behind; 0: too close to say.
CLOTH_FN int cloth_side_of_plane(const double *a, const double *b, const double *c, const double *d)
{
  double u[3], v[3], w[3];
  for (int k = 0; k < 3; k++) u[k] = a[k] - d[k], v[k] = b[k] - d[k], w[k] = c[k] - d[k];
  double det = 0, summed = 0;
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double one = v[i] * w[j], two = v[j] * w[i];
    det += u[k] * (one - two);
    summed += fabs(u[k]) * (fabs(one) + fabs(two));
  }
  return -cloth_sign_of(det, summed);
}

// the same in the projection along `axis`: is d left of the line from a to b?
CLOTH_FN int cloth_side_of_line(const double *a, const double *b, const double *d, int axis)
{
  int i = (axis + 1) % 3, j = (axis + 2) % 3;
  double one = (a[i] - d[i]) * (b[j] - d[j]), two = (a[j] - d[j]) * (b[i] - d[i]);
  return cloth_sign_of(one - two, fabs(one) + fabs(two));
}

// the axis along which a triangle shows most of its area
CLOTH_FN int cloth_flattest_axis(const double (*t)[3])
{
  double most = -1;
  int axis = 0;
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double area =
        fabs((t[1][i] - t[0][i]) * (t[2][j] - t[0][j]) - (t[1][j] - t[0][j]) * (t[2][i] - t[0][i]));
    if (area > most) most = area, axis = k;
  }
  return axis;
}

// Is the segment p q apart from triangle t in the projection? For certain, and by an edge of either
// (the separating axes of two convex figures).
CLOTH_FN int cloth_projections_apart(const double *p, const double *q, const double (*t)[3],
                                     int axis)
{
  int turn = cloth_side_of_line(t[0], t[1], t[2], axis);
  for (int k = 0; k < 3 && turn; k++) {
    const double *a = t[k], *b = t[(k + 1) % 3];
    if (cloth_side_of_line(a, b, p, axis) == -turn && cloth_side_of_line(a, b, q, axis) == -turn)
      return 1;
  }
  int side = cloth_side_of_line(p, q, t[0], axis);
  return side && cloth_side_of_line(p, q, t[1], axis) == side &&
         cloth_side_of_line(p, q, t[2], axis) == side;
}

// Does the segment p q, whose ends are on sides sp and sq of t's plane, pierce t?
CLOTH_FN int cloth_edge_pierces(const double *p, const double *q, const double (*t)[3], int sp,
                                int sq, int axis)
{
  if (sp * sq > 0 || (sp == 0 && sq == 0)) return 0;
  int least = 0, most = 0;
  for (int k = 0; k < 3; k++) {
    int s = cloth_side_of_plane(p, q, t[k], t[(k + 1) % 3]);
    least = s < least ? s : least, most = s > most ? s : most;
  }
  return least * most == 0 && least != most && !cloth_projections_apart(p, q, t, axis);
}

/// CLOTH_CROSS_ANY and how, or 0. a, b: corners. shared_a, shared_b: the corner that both have, or
/// -1; triangles with two common corners are neighbours and not asked.
CLOTH_FN int cloth_triangles_cross(const double (*a)[3], const double (*b)[3], int shared_a,
                                   int shared_b)
{
  int side_a[3], side_b[3], how = 0, level = 1;
  for (int k = 0; k < 3; k++) {
    side_a[k] = k == shared_a ? 0 : cloth_side_of_plane(b[0], b[1], b[2], a[k]);
    side_b[k] = k == shared_b ? 0 : cloth_side_of_plane(a[0], a[1], a[2], b[k]);
    level = level && side_a[k] == 0 && side_b[k] == 0;
  }
  int axis_a = cloth_flattest_axis(a), axis_b = cloth_flattest_axis(b);
  for (int k = 0; k < 3; k++) {
    int n = (k + 1) % 3, alone_a = shared_a < 0 || k == (shared_a + 1) % 3,
        alone_b = shared_b < 0 || k == (shared_b + 1) % 3; // an edge without the common corner
    if (level && shared_a < 0) {
      if (!cloth_projections_apart(a[k], a[n], b, axis_b) ||
          !cloth_projections_apart(b[k], b[n], a, axis_a))
        how |= CLOTH_CROSS_FLAT | CLOTH_CROSS_ANY;
      continue;
    }
    if (alone_a && cloth_edge_pierces(a[k], a[n], b, side_a[k], side_a[n], axis_b))
      how |= CLOTH_CROSS_ANY | 1 << (CLOTH_CROSS_EDGE_A + k);
    if (alone_b && cloth_edge_pierces(b[k], b[n], a, side_b[k], side_b[n], axis_a))
      how |= CLOTH_CROSS_ANY | 1 << (CLOTH_CROSS_EDGE_B + k);
  }
  if (!how) return 0;
  for (int k = 0; k < 3; k++) {
    how |= (side_a[k] < 0 ? 2 : side_a[k]) << (CLOTH_CROSS_SIDE_A + 2 * k);
    how |= (side_b[k] < 0 ? 2 : side_b[k]) << (CLOTH_CROSS_SIDE_B + 2 * k);
  }
  if (how & CLOTH_CROSS_FLAT) {
    double dot = 0;
    for (int k = 0; k < 3; k++) {
      int i = (k + 1) % 3, j = (k + 2) % 3;
      dot +=
          ((a[1][i] - a[0][i]) * (a[2][j] - a[0][j]) - (a[1][j] - a[0][j]) * (a[2][i] - a[0][i])) *
          ((b[1][i] - b[0][i]) * (b[2][j] - b[0][j]) - (b[1][j] - b[0][j]) * (b[2][i] - b[0][i]));
    }
    if (dot < 0) how |= CLOTH_CROSS_OPPOSITE;
  }
  return how;
}
