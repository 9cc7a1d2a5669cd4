// The grid of the spatial hash. It spans the cloth's box, so cells are numbered without collisions.
#pragma once

#include "box.h"

typedef struct cloth_grid {
  cloth_real origin[3]; // m
  cloth_real inverse;   // 1/m, one over the edge of a cell
  int size[3];          // cells in x, y, z
} cloth_grid;

typedef struct cloth_cells {
  int lo[3], hi[3]; // inclusive; empty when hi < lo
} cloth_cells;

// cell coordinate of a position, clamped to the grid; monotone, so boxes that overlap share cells
CLOTH_FN int cloth_grid_cell(const cloth_grid *g, int axis, cloth_real x)
{
  cloth_real c = (x - g->origin[axis]) * g->inverse;
  if (!(c > 0)) return 0;
  return c < (cloth_real)g->size[axis] ? (int)c : g->size[axis] - 1;
}

CLOTH_FN cloth_cells cloth_grid_cells(const cloth_grid *g, cloth_box b, cloth_real gap)
{
  cloth_cells c;
  cloth_real lo[3], hi[3];
  lo[0] = b.lo.x, lo[1] = b.lo.y, lo[2] = b.lo.z;
  hi[0] = b.hi.x, hi[1] = b.hi.y, hi[2] = b.hi.z;
  for (int k = 0; k < 3; k++) {
    c.lo[k] = cloth_grid_cell(g, k, lo[k] - gap);
    c.hi[k] = cloth_grid_cell(g, k, hi[k] + gap);
  }
  return c;
}

CLOTH_FN uint64_t cloth_grid_key(const cloth_grid *g, int x, int y, int z)
{
  return ((uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y) * (uint64_t)g->size[0] + (uint64_t)x;
}
