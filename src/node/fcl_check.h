// An independent opinion on geometry: the Flexible Collision Library. Nothing of the engine's own
// contact code is used here, and FCL's headers stay in fcl_check.cpp.
//
// Two questions: does the engine's broad phase find every (cloth, body) triangle pair within a
// margin? And do any triangles intersect? The engine's candidates are compared by inclusion, never
// by count: it may offer more than the truth, it may not miss one.
#pragma once

#include "cloth.h"

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace robot_cloth {

/// A pair closer than the margin that the engine did not offer.
struct MissedPair {
  cloth_body_pair pair;
  double distance; // m, by FCL
};

/// The engine's candidates against FCL's truth. (Not CrossCheck: that is the message.)
struct PairComparison {
  double margin = 0;              // m
  int64_t truth = 0;              // pairs closer than margin, by FCL
  int64_t candidates = 0;         // pairs offered by the engine, each counted once
  int64_t missed_count = 0;       // pairs closer than margin - epsilon that were not offered
  std::vector<MissedPair> missed; // the first of them, closest first, at most `missed_max`
  int64_t degenerate = 0;         // triangles without area: no normal, not judged
  double ratio = 0;               // candidates / truth; 0 when there is no truth
  bool contained() const { return missed_count == 0; }
};

/// A pair of triangles that intersect. With body -1 both are cloth: a < b or other cloths.
struct IntersectingPair {
  int cloth_a, triangle_a;
  int body;                // -1: cloth with cloth
  int cloth_b, triangle_b; // cloth_b is -1 when body is not; triangle_b is then the body's
};

/// Intersecting triangles, by FCL.
struct Intersections {
  int64_t cloth_cloth = 0; // pairs that share a vertex are not counted
  int64_t cloth_body = 0;
  std::vector<IntersectingPair> pairs; // the first ones, at most `pairs_max`
};

/// Cloths and bodies as FCL sees them. One thread at a time; different objects are independent, so
/// a snapshot can be checked in a thread of its own.
///
/// Cloths and bodies are numbered from 0 in the order of adding: add them in the engine's order.
/// All functions throw std::invalid_argument on an index out of range or a number that is not
/// finite, with a text that names it; the object stays as it was.
class FclCheck {
public:
  FclCheck();
  ~FclCheck();
  FclCheck(FclCheck &&) noexcept;
  FclCheck &operator=(FclCheck &&) noexcept;

  /// All bodies and cloths of a scene as they are now, in the engine's order.
  /// Reads the state of the scene: call it where cloth_positions() may be called.
  static FclCheck fromScene(cloth_scene *scene);

  /// Take poses and positions from the scene that this was made from. As fromScene().
  void update(cloth_scene *scene);

  /// Add a body; copies. Builds a tree: milliseconds for a link mesh. Empty meshes are allowed.
  int addBody(const cloth_mesh_view &mesh, const Eigen::Isometry3d &pose);
  void moveBody(int body, const Eigen::Isometry3d &pose);

  /// Add a cloth; positions [m] are in the scene frame. Copies.
  int addCloth(const cloth_mesh_view &mesh);
  /// New vertex positions [count x 3] m in the scene frame; the tree is refitted, not rebuilt.
  void moveCloth(int cloth, const double *position, int count);

  int bodyCount() const;
  int clothCount() const;

  /// Compare the engine's pairs with FCL's.
  ///
  /// margin      m, in [0, 0.1]: pairs closer than this are the truth
  /// epsilon     m: a pair in [margin - epsilon, margin) may be missing, since the engine may
  ///             compute in float: take 1e-6 of the size of the scene for float, 1e-12 for double
  /// candidates  [count]; any order, repeated ones count once; ids out of range throw
  PairComparison compare(double margin, double epsilon, const cloth_body_pair *candidates, int count,
                     int missed_max = 16) const;

  /// All intersecting triangle pairs, cloth with itself and other cloths, cloth with bodies.
  /// Touching counts. A cloth that is wholly inside a body, its triangles crossing none of the
  /// body's, is not seen.
  Intersections intersections(int pairs_max = 16) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace robot_cloth
