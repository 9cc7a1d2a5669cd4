// One cloth that is flat at rest, cut into tiles.
#pragma once

#include "state/sim.h"

// relative to the tile; a mesh in a plane by its file's digits is in a plane
#define CLOTH_SHEET_TOLERANCE 1e-4

/// What lies in a tile, or in a square of 2^level tiles: the pyramid that makes squares quick to
/// judge.
typedef struct cloth_sheet_node {
  double lo[2], hi[2]; // in tiles, box around the triangles that are listed; empty: lo above hi
  double height;       // m, least of them
  int borders;         // border edges that are listed
} cloth_sheet_node;

typedef struct cloth_sheet {
  bool flat;        // false: this cloth is not flat at rest, and nothing below is known
  int first, end;   // triangles
  double mean_edge; // m
  double tile;      // m, edge of a tile
  int size[2];      // tiles
  double *corner;   // [triangles x 6] in the plane, in tiles
  double *height;   // [triangles] m, the least of the three
  int *place;       // [triangles x 4] least and largest tile: x y x y
  int *tile_first;  // [tiles + 1]
  int *tile_list; // [tile_first[tiles]] triangles, counted from `first`, whose boxes meet the tile
  double *border; // [border_count x 4] edges with one triangle, which is on their left
  int border_count;
  int *border_first, *border_list;           // [tiles + 1], border edges whose boxes meet the tile
  cloth_sheet_node *node[CLOTH_FLAT_LEVELS]; // [nodes of the level, row by row]
} cloth_sheet;

/// Nodes along an axis of a sheet on a level.
static inline int cloth_sheet_level_size(const cloth_sheet *s, int level, int axis)
{
  return (s->size[axis] - 1 + (1 << level)) >> level;
}

/// CLOTH_NO_MEMORY; free in any case.
cloth_status cloth_sheet_make(const cloth_sim *sim, int cloth, cloth_sheet *out, cloth_error *err);
void cloth_sheet_free(cloth_sheet *sheet);

/// The sheet's nodes, once its tiles are listed (contact/flat_convex.c). CLOTH_NO_MEMORY.
cloth_status cloth_sheet_pyramid(cloth_sheet *sheet, cloth_error *err);

/// Least height of the triangles that reach into the square at a tile of a level [m]; 0 where the
/// square is not a convex region of one layer.
double cloth_sheet_square_height(const cloth_sheet *sheet, int level, int x, int y);
