// Write triangle i into the cells that it covers, of those that the part has business with.
#pragma once

#include "cell_count.h"

typedef struct cloth_cell_fill_args {
  cloth_grid grid;
  cloth_real gap; // m
  int cloth_triangles;
  const int *body_triangle; // [n - cloth_triangles]
  const cloth_real *box;    // [triangles x 6] m
  const uint32_t *first;    // [n + 1] scanned cell counts
  uint64_t *cell;           // [entries], written
  uint32_t *triangle;       // [entries], written
  cloth_cell_marks mark;
} cloth_cell_fill_args;

CLOTH_FN void cloth_cell_fill(int i, const cloth_cell_fill_args *a)
{
  uint32_t to = a->first[i];
  if (a->first[i + 1] == to) return;
  int t = cloth_active_triangle(i, a->cloth_triangles, a->body_triangle);
  cloth_cells c = cloth_grid_cells(&a->grid, cloth_box_load(a->box, t), a->gap);
  for (int z = c.lo[2]; z <= c.hi[2]; z++)
    for (int y = c.lo[1]; y <= c.hi[1]; y++)
      for (int x = c.lo[0]; x <= c.hi[0]; x++) {
        uint64_t cell = cloth_grid_key(&a->grid, x, y, z);
        if (!cloth_cell_is_marked(&a->mark, cell)) continue;
        a->cell[to] = cell;
        a->triangle[to++] = (uint32_t)t;
      }
}
