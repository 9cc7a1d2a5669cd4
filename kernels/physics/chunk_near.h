// Ghosts: may a triangle of chunk i lie in a cell that the part has business with (cell_mark.h)?
// The box around its vertices' chunks is looked up in cells of CLOTH_COARSE each way; chunks that
// are not near stay out of all that a search does with triangles.
#pragma once

#include "cell_mark.h"

enum {
  CLOTH_NEAR_CELLS = 64
}; // a chunk over more coarse cells is near without a look: it is that
   // of any vast triangle

typedef struct cloth_chunk_near_args {
  cloth_grid grid;
  cloth_real gap;        // m
  const int *first;      // [n + 1]
  const int *list;       // [first[n]] chunks of vertices that the chunk's triangles have
  const cloth_real *box; // [chunks of vertices x 6] m
  cloth_cell_marks mark;
  unsigned char *near; // [n], written
} cloth_chunk_near_args;

CLOTH_FN int cloth_cells_near(const cloth_chunk_near_args *a, const cloth_cells *c)
{
  int near = 0;
  for (int z = c->lo[2]; z <= c->hi[2]; z++)
    for (int y = c->lo[1]; y <= c->hi[1]; y++)
      for (int x = c->lo[0]; x <= c->hi[0]; x++)
        near |= cloth_cell_is_marked(&a->mark, cloth_coarse_key(x, y, z));
  return near;
}

CLOTH_FN void cloth_chunk_near(int i, const cloth_chunk_near_args *a)
{
  cloth_box box = cloth_box_load(a->box, a->list[a->first[i]]);
  for (int k = a->first[i] + 1; k < a->first[i + 1]; k++)
    box = cloth_box_union(box, cloth_box_load(a->box, a->list[k]));
  cloth_cells c = cloth_grid_cells(&a->grid, box, a->gap);
  c = cloth_cells_coarse(&c);
  a->near[i] = (unsigned char)(cloth_cells_count(&c) > CLOTH_NEAR_CELLS || cloth_cells_near(a, &c));
}
