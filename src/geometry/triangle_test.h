// Do two triangles intersect? Exact for the coordinates as given, degenerate ones included.
#pragma once

#include <stdbool.h>

/// A triangle of a mesh: where its corners are, and which vertices they are.
typedef struct cloth_corners {
  const double *x[3]; // each [3] m
  int vertex[3];
} cloth_corners;

/// A triangle is the smallest convex set that holds its corners: it includes its border, and
/// without area it is the segment or the point that it covers. Two triangles intersect if they
/// share a point (touching counts) beyond what they share by being neighbours:
///
/// - no common vertex: any common point counts;
/// - one common vertex: any common point but that vertex;
/// - two: any common point off the segment between these two, which takes two triangles in one
/// plane
///   on one side of their edge (or without area on one line);
/// - three: it is the same triangle twice, and counts.
///
/// Common vertices have the same index in one mesh (`same_mesh`); two vertices at one place are
/// two, and the triangles around them touch.
bool cloth_triangles_intersect(const cloth_corners *a, const cloth_corners *b, bool same_mesh);
