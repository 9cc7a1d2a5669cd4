// Which cells a part has business with: those of cloth triangles with one of its vertices. Other
// triangles enter the part's hash in these cells only, so that its hash is as large as its share.
// Cells are kept as one bit each in a table that they are thrown into; two in one place cost a few
// entries and change no pair. Coarse cells are marked in the same table, for chunk_near.h.
#pragma once

#include "atomic.h"
#include "grid.h"

typedef struct cloth_cell_marks {
  uint32_t *word; // [2^bits / 32]; NULL: all cells
  int bits;       // from 5 to 31
} cloth_cell_marks;

enum {
  CLOTH_CELLS_MAX = 64,         // a body triangle over more cells is large
  CLOTH_CELLS_MAX_CLOTH = 4096, // a cloth triangle over more cells is vast
  CLOTH_COARSE = 4              // cells along a coarse cell
};

CLOTH_FN uint32_t cloth_cells_count(const cloth_cells *c)
{
  return (uint32_t)(c->hi[0] - c->lo[0] + 1) * (uint32_t)(c->hi[1] - c->lo[1] + 1) *
         (uint32_t)(c->hi[2] - c->lo[2] + 1);
}

CLOTH_FN cloth_cells cloth_cells_coarse(const cloth_cells *c)
{
  cloth_cells coarse;
  for (int k = 0; k < 3; k++)
    coarse.lo[k] = c->lo[k] / CLOTH_COARSE, coarse.hi[k] = c->hi[k] / CLOTH_COARSE;
  return coarse;
}

/// No key of a cell: a grid has at most 1024 cells each way.
CLOTH_FN uint64_t cloth_coarse_key(int x, int y, int z)
{
  return (uint64_t)1 << 60 | (uint64_t)z << 40 | (uint64_t)y << 20 | (uint64_t)x;
}

typedef struct cloth_cell_mark_args {
  cloth_grid grid;
  cloth_real gap;               // m
  int first, last;              // vertices of the part
  const int *triangle;          // [cloth triangles x 3]
  const cloth_real *vertex_box; // [vertices x 6] m
  cloth_cell_marks mark;        // cleared before
} cloth_cell_mark_args;

// multiplicative hashing: Knuth, The Art of Computer Programming 3, section 6.4
CLOTH_FN uint32_t cloth_cell_place(const cloth_cell_marks *m, uint64_t cell)
{
  return (uint32_t)(cell * 0x9e3779b97f4a7c15u >> (64 - m->bits));
}

CLOTH_FN int cloth_cell_is_marked(const cloth_cell_marks *m, uint64_t cell)
{
  if (!m->word) return 1;
  uint32_t at = cloth_cell_place(m, cell);
  return (int)(m->word[at / 32] >> at % 32 & 1);
}

CLOTH_FN void cloth_cell_set(const cloth_cell_marks *m, uint64_t cell)
{
  uint32_t at = cloth_cell_place(m, cell);
  if (!(m->word[at / 32] >> at % 32 & 1)) // seldom asked twice: neighbours share cells
    cloth_atomic_or(m->word + at / 32, 1u << at % 32);
}

CLOTH_FN void cloth_cell_mark(int i, const cloth_cell_mark_args *a)
{
  const int *t = a->triangle + 3 * i;
  int mine = 0;
  for (int k = 0; k < 3; k++) mine |= t[k] >= a->first && t[k] < a->last;
  if (!mine) return;
  cloth_box box =
      cloth_box_union(cloth_box_load(a->vertex_box, t[0]), cloth_box_load(a->vertex_box, t[1]));
  box = cloth_box_union(box, cloth_box_load(a->vertex_box, t[2]));
  cloth_cells c = cloth_grid_cells(&a->grid, box, a->gap), coarse = cloth_cells_coarse(&c);
  if (cloth_cells_count(&c) > CLOTH_CELLS_MAX_CLOTH) return; // counted, and larger cells chosen
  for (int z = c.lo[2]; z <= c.hi[2]; z++)
    for (int y = c.lo[1]; y <= c.hi[1]; y++)
      for (int x = c.lo[0]; x <= c.hi[0]; x++)
        cloth_cell_set(&a->mark, cloth_grid_key(&a->grid, x, y, z));
  for (int z = coarse.lo[2]; z <= coarse.hi[2]; z++)
    for (int y = coarse.lo[1]; y <= coarse.hi[1]; y++)
      for (int x = coarse.lo[0]; x <= coarse.hi[0]; x++)
        cloth_cell_set(&a->mark, cloth_coarse_key(x, y, z));
}
