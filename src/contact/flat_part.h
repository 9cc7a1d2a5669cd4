// Which squares a part judges: those in which one of its triangles may lie, for a pair of others is
// not its own. Their ranges, and the gradients that these are made of, follow; so what a part does
// and holds of flat patches shrinks with its share, up to a margin of the largest square.
#pragma once

#include "contact/flat_sheet.h"

/// What a search needs to know of all sheets, on the host (contact/flat.c). Nodes go level by
/// level, sheet by sheet; those of level 0 are the tiles.
typedef struct cloth_flat_tables {
  cloth_sheet *sheet; // [count]
  int count;
  int listed, *tile_first, *tile_list;
  int *source, *square; // [nodes x 4], [nodes x 3]
  double *height;       // [nodes] m, least height of a triangle in the square; 0: not a patch
  int *place;           // [triangles x 5]
  int *level;           // [count x CLOTH_FLAT_LEVELS x 2] first node or -1, nodes in a row
  double *rest;         // [triangles x 4]
} cloth_flat_tables;

/// A part's share, and the tables of its tiles and triangles, on the host.
typedef struct cloth_flat_lists {
  cloth_flat_part share;
  int *tile_first, *tile_list; // [nodes[0] + 1], places in share.triangle
  double *rest;                // [triangles x 4]
} cloth_flat_lists;

/// CLOTH_NO_MEMORY; free in any case.
cloth_status cloth_flat_part_make(const cloth_sim *sim, const cloth_part *part,
                                  const cloth_flat_tables *t, cloth_flat_lists *out,
                                  cloth_error *err);
void cloth_flat_part_free(cloth_flat_lists *lists);
