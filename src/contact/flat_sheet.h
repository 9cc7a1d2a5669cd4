// One cloth that is flat at rest, cut into tiles.
#pragma once

#include "state/sim.h"

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
} cloth_sheet;

/// CLOTH_NO_MEMORY; free in any case.
cloth_status cloth_sheet_make(const cloth_sim *sim, int cloth, cloth_sheet *out, cloth_error *err);
void cloth_sheet_free(cloth_sheet *sheet);

/// Least height of the triangles that reach into the square at a tile of a level [m]; 0 where the
/// square is not a convex region of one layer.
double cloth_sheet_square_height(const cloth_sheet *sheet, int level, int x, int y);
