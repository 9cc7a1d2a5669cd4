// All intersecting triangles of a set of meshes, each against itself and against the others.
#pragma once

#include "cloth.h"

/// Two triangles that intersect, the one of the lower mesh (then of the lower index) first.
typedef struct cloth_triangle_pair {
  int mesh[2], triangle[2];
} cloth_triangle_pair;

/// Find every pair that cloth_triangles_intersect() (triangle_test.h) finds. Meshes may be open,
/// not manifold, and have triangles without area. Coordinates are finite, indices in range;
/// `material` is not read.
///
/// out  [*count], ascending; to be freed; NULL when there is none
/// CLOTH_BAD_ARGUMENT: more triangles than an int counts; CLOTH_NO_MEMORY.
cloth_status cloth_intersections_find(int mesh_count, const cloth_mesh_view *mesh,
                                      cloth_triangle_pair **out, int64_t *count, cloth_error *err);
