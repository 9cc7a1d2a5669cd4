// Which triangles of a set of meshes intersect? The independent check of the engine's contact:
// exact predicates of CGAL on written vertices, none of the engine's own code.
#pragma once

#include <string>
#include <vector>

namespace check_meshes {

struct Mesh {
  std::string name;
  std::vector<double> position; // [vertices x 3] m
  std::vector<int> triangle;    // [triangles x 3]
};

/// A pair of triangles that intersect: mesh and triangle of each.
struct Hit {
  int mesh0, triangle0;
  int mesh1, triangle1;
};

struct Result {
  std::vector<Hit> cloth_cloth, cloth_body;
  // a whole connected piece of a cloth inside a closed body cuts none of its triangles
  std::vector<std::pair<int, int>> cloth_in_body; // (cloth, body)
};

/// Read an OBJ file: v and f lines (polygons are cut into fans). Throws std::runtime_error with
/// file and line.
Mesh read_obj(const std::string &path);

/// Every pair of cloth triangles, of one cloth or two, that intersect, and every pair of a cloth
/// and a body triangle. Two triangles of one mesh that share a corner intersect when they do so
/// away from it; two that share an edge when one is folded flat onto the other. Touching counts.
Result intersections(const std::vector<Mesh> &cloths, const std::vector<Mesh> &bodies);

} // namespace check_meshes
