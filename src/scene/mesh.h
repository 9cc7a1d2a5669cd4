// Meshes on the host: made from numbers (grids, primitives), read from files, checked, written.
#pragma once

#include "scene/def.h"

/// An empty mesh of these sizes, to be filled. CLOTH_NO_MEMORY.
cloth_status cloth_mesh_new(int vertex_count, int triangle_count, bool with_material,
                            cloth_mesh *out, cloth_error *err);

/// A copy of what a caller owns; counts and pointers are checked, the numbers are not.
/// CLOTH_BAD_SCENE: no vertices or triangles, too many, or a pointer is NULL.
cloth_status cloth_mesh_copy(const cloth_mesh_view *view, cloth_mesh *out, cloth_error *err);

/// The arrays, not the struct. A zeroed mesh is allowed.
void cloth_mesh_free(cloth_mesh *mesh);

/// Is the mesh fit to be simulated? (mesh_check.c)
///
/// Always refused: vertices or material coordinates that are not finite, indices out of range.
/// A body's mesh may be open and non-manifold; its triangles without area, its repeated triangles
/// and its unused vertices are dropped and counted. A cloth's defects (cloth_mesh_repairs) are
/// refused, or repaired and counted if `repair`; a cloth that no turning of triangles can orient is
/// always refused.
///
/// name      of the cloth or body, for the message
/// mesh      in: as read; out: repaired. Unspecified (but to be freed) after a failure
/// kept      [vertex_count before], out: index of each vertex after the repair, or -1
/// CLOTH_BAD_SCENE with the first offender; CLOTH_NO_MEMORY.
cloth_status cloth_mesh_check(const char *name, bool is_cloth, bool repair, cloth_mesh *mesh,
                              int *kept, cloth_mesh_repairs *repairs, cloth_error *err);

/// Are the edges long enough for the precision, where the cloth lies? (mesh_edges.c)
/// position  [vertex_count x 3] m, scene frame
/// CLOTH_BAD_SCENE with the shortest edge and the bound.
cloth_status cloth_mesh_check_edges(const char *name, bool is_float, const cloth_mesh *mesh,
                                    const double *position, cloth_error *err);

// ---- made from numbers --------------------------------------------------------------------------

typedef enum cloth_grid_pattern {
  CLOTH_GRID_ALTERNATING,  // diagonals change from cell to cell
  CLOTH_GRID_LEFT,         // all diagonals from lower right to upper left
  CLOTH_GRID_RIGHT,        // all diagonals from lower left to upper right
  CLOTH_GRID_UNSTRUCTURED, // rows offset by half a cell, vertices jittered: no preferred direction
} cloth_grid_pattern;

/// A sheet in the plane z = 0, centred at the origin; x along the width (warp), y along the height.
/// Material coordinates are the plane's. Vertices row by row from y = -height / 2, each row from
/// x = -width / 2; normals point to +z. Odd rows of the unstructured pattern have one vertex more.
///
/// size        [2] m, width and height, above 0
/// resolution  [2] vertices along the width and height, each at least 2
/// CLOTH_BAD_SCENE, CLOTH_NO_MEMORY.
cloth_status cloth_mesh_grid(const double size[2], const int resolution[2],
                             cloth_grid_pattern pattern, cloth_mesh *out, cloth_error *err);

/// A sheet sewn to a tube about the z axis, centred at the origin, open at both ends, its outside
/// outside. Vertices ring by ring from the bottom, each ring from the x axis (odd rings from half a
/// spacing on) counter-clockwise seen from above. Every triangle is flat in the material, without
/// strain at rest; warp is around, weft along the tube.
///
/// radius      m, of the vertices
/// length      m
/// resolution  [2] vertices around, at least 3, and along, at least 2
/// CLOTH_BAD_SCENE, CLOTH_NO_MEMORY.
cloth_status cloth_mesh_tube(double radius, double length, const int resolution[2], cloth_mesh *out,
                             cloth_error *err);

/// Closed, outward oriented, centred at the origin. size [3] m: edge lengths, above 0.
cloth_status cloth_mesh_box(const double size[3], cloth_mesh *out, cloth_error *err);

/// A sphere of meridians and parallels, its vertices at `radius` [m]. segments: around, in [3,
/// 1000].
cloth_status cloth_mesh_sphere(double radius, int segments, cloth_mesh *out, cloth_error *err);

/// Axis z, vertices of the side at `radius` [m], `length` [m] between the caps. segments in [3,
/// 1000].
cloth_status cloth_mesh_cylinder(double radius, double length, int segments, cloth_mesh *out,
                                 cloth_error *err);

/// A cylinder that tapers: radius [2] m at the bottom and at the top, one of them may be 0: a tip.
/// Three segments make a pyramid over a triangle.
cloth_status cloth_mesh_cone(const double radius[2], double length, int segments, cloth_mesh *out,
                             cloth_error *err);

/// A square in the plane z = 0, normal +z. size [m]: edge length, above 0.
cloth_status cloth_mesh_square(double size, cloth_mesh *out, cloth_error *err);

// ---- files --------------------------------------------------------------------------------------

/// What a mesh file holds.
typedef struct cloth_mesh_file {
  cloth_mesh mesh; // material: if every corner has texture coordinates
  int group_count;
  cloth_group_def *group; // OBJ: `g` and `o`
  int material_missing;   // line of the first face without texture coordinates though others have
                          // them (OBJ); 0: none
} cloth_mesh_file;

/// Read an OBJ or PLY file, by the end of its name. CLOTH_BAD_SCENE: cannot be read, not a mesh,
/// with path and line; CLOTH_NO_MEMORY. Nothing is left behind on failure.
cloth_status cloth_mesh_file_read(const char *path, cloth_mesh_file *out, cloth_error *err);

/// What is inside, not the struct.
void cloth_mesh_file_free(cloth_mesh_file *file);

/// Write positions [vertex_count x 3] and triangles [triangle_count x 3] as OBJ. Positions are
/// exact: reading them back gives the same bits. The file appears whole or not at all. CLOTH_IO.
cloth_status cloth_obj_write(const char *path, int vertex_count, const double *position,
                             int triangle_count, const int *triangle, cloth_error *err);
