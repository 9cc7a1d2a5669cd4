// Everything that touches while the vertices of a mesh move in straight lines: candidates by boxes,
// then the time of impact of each.
#pragma once

#include "cloth.h"
#include "geometry/impact.h"

/// Counts of pairs; [0] edge-edge, [1] vertex-face.
typedef struct cloth_mesh_impacts {
  int edges;              // different ones; one from a vertex to itself is none
  int unreferenced;       // vertices of no triangle; they count as vertices all the same
  int64_t candidates[2];  // pairs whose boxes overlap
  int64_t colliding[2];   // of these, pairs that touch in [0, 1], or are too close to tell
  double first[2];        // earliest time of impact, 2 where there is none
  int first_vertex[2][4]; // of the pair with it: both edges, or vertex and face
  double seconds[2];      // broad phase, narrow phase
} cloth_mesh_impacts;

/// Count the pairs of features that share no vertex.
///
/// Edges are those of the triangles, each once; every vertex and every triangle of the mesh counts.
/// The box of a feature is the smallest one around its corners at the start and at the end, made
/// larger by `inflate` on all sides: min - inflate, max + inflate, in double. Two features are a
/// candidate when their boxes overlap or touch. `inflate` has no part in whether they collide.
///
/// mesh       at the start; material is not read. Not manifold, without area, repeated: all allowed
/// position1  [vertex_count x 3] m, at the end
/// inflate    m, at least 0
/// CLOTH_BAD_ARGUMENT: more edges than an int counts; CLOTH_NO_MEMORY.
cloth_status cloth_mesh_impacts_find(const cloth_mesh_view *mesh, const double *position1,
                                     double inflate, cloth_impact_precision precision,
                                     cloth_mesh_impacts *out, cloth_error *err);
