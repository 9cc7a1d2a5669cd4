// Collision geometry as triangles: primitives tessellated, mesh files read through
// resource_retriever (package://, file://, http://) and assimp (STL, DAE, OBJ and what else assimp
// knows).
//
// All lengths are in metres after loading. Every function here may be called from any thread.
#pragma once

#include "cloth.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <stdexcept>
#include <string>
#include <vector>

namespace robot_cloth {

/// A triangle mesh that owns its numbers.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;  // [n] m
  std::vector<Eigen::Vector3i> triangles; // [m] vertex indices, counter-clockwise seen from outside

  bool empty() const { return triangles.empty(); }

  /// The same mesh for libcloth; borrows, valid until the mesh changes or goes.
  cloth_mesh_view view() const;

  /// Axis-aligned box around all vertices [m]; an empty box for an empty mesh.
  Eigen::AlignedBox3d bounds() const;

  /// Append another mesh, placed at `pose` in this mesh's frame.
  void append(const TriangleMesh &other, const Eigen::Isometry3d &pose);
};

/// How geometry becomes triangles.
struct MeshOptions {
  /// Segments round a cylinder or sphere, in [3, 512]. Vertices lie on the true surface
  /// (inscribed): flats are inside it by at most radius (1 - cos(pi / segments)), .5 % of the
  /// radius for 32.
  int segments = 32;
  /// Honour <asset><unit meter=...> of Collada files, as RViz does (MoveIt does not).
  bool collada_unit = true;
  /// Honour <asset><up_axis> of Collada files. RViz does not: it takes coordinates as they stand.
  bool collada_up_axis = false;
  /// One mesh file with more triangles than this is reported as a warning.
  int triangles_warn = 100000;
  /// ... and with more than this is refused.
  int triangles_max = 5000000;
};

/// What happened while a mesh file was read.
struct MeshReport {
  int meshes = 0;              // mesh instances in the node tree of the file
  int zero_area_triangles = 0; // dropped
  int duplicate_triangles = 0; // dropped: the same three vertices again
  int not_triangles = 0;       // points and lines, dropped
  double unit = 1;             // m per unit of the file, as applied
  bool flipped = false;        // winding reversed because the scale or a node mirrors
  std::vector<std::string> warnings;
};

/// A mesh that cannot be used; what() names the URI and what is wrong with it.
class MeshError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// A box of full edge lengths `size` [m], centred at the origin: 8 vertices, 12 triangles.
TriangleMesh boxMesh(const Eigen::Vector3d &size);

/// A closed cylinder along z, centred at the origin. `length`, `radius` [m]; vertices on the
/// surface.
TriangleMesh cylinderMesh(double radius, double length, int segments);

/// A closed sphere at the origin, `segments` round the equator and half as many pole to pole.
TriangleMesh sphereMesh(double radius, int segments);

/// Read a mesh file, weld equal vertices, drop degenerate triangles.
///
/// uri     package://..., file:///..., http://...; a package may also be a bare folder of its name
/// on
///         ROS_PACKAGE_PATH, without package.xml (reported as a warning)
/// scale   per axis, each finite and not 0; a mirroring scale keeps the outside outside
/// report  nullable
///
/// Blocks for the file or the network. Throws MeshError: not a URI, package not found, file
/// missing, empty or a directory, not a mesh, no triangles, vertices that are not finite, too many
/// triangles.
TriangleMesh loadMesh(const std::string &uri, const Eigen::Vector3d &scale,
                      const MeshOptions &options = MeshOptions(), MeshReport *report = nullptr);

} // namespace robot_cloth
