// How many cells triangle i covers, of those that the part has business with (cell_mark.h); body
// triangles that cover very many are set aside, because one table top would flood the hash, and
// those that miss the cloth's box cover none. A cloth triangle over very many is counted: then the
// cells are too small, as in a solve that has run away.
#pragma once

#include "atomic.h"
#include "cell_mark.h"
#include "chunk.h"
#include "grid.h"

typedef struct cloth_cell_count_args {
  cloth_grid grid;
  cloth_real gap;           // m, half the distance at which a pair counts
  cloth_real cloth_box[6];  // m, of all cloth
  int cloth_triangles;      // elements below are cloth
  const int *body_triangle; // [n - cloth_triangles] triangles of bodies that are near
  const cloth_real *box;    // [triangles x 6] m
  uint32_t *count;          // [n], written
  uint32_t *large;          // list of large triangles
  uint32_t *large_count;    // [1] counts up
  uint32_t *vast_count;     // [1] counts up
  cloth_cell_marks mark;
  const unsigned char *near; // [chunks of cloth triangles] 0: covers none; NULL: all may
} cloth_cell_count_args;

CLOTH_FN int cloth_active_triangle(int i, int cloth_triangles, const int *body_triangle)
{
  return i < cloth_triangles ? i : body_triangle[i - cloth_triangles];
}

CLOTH_FN uint32_t cloth_cells_marked(const cloth_cell_count_args *a, const cloth_cells *c)
{
  uint32_t n = 0;
  for (int z = c->lo[2]; z <= c->hi[2]; z++)
    for (int y = c->lo[1]; y <= c->hi[1]; y++)
      for (int x = c->lo[0]; x <= c->hi[0]; x++)
        n += (uint32_t)cloth_cell_is_marked(&a->mark, cloth_grid_key(&a->grid, x, y, z));
  return n;
}

CLOTH_FN void cloth_cell_count(int i, const cloth_cell_count_args *a)
{
  if (a->near && i < a->cloth_triangles && !a->near[i / CLOTH_CHUNK]) {
    a->count[i] = 0;
    return;
  }
  int t = cloth_active_triangle(i, a->cloth_triangles, a->body_triangle);
  cloth_box box = cloth_box_load(a->box, t);
  cloth_cells c = cloth_grid_cells(&a->grid, box, a->gap);
  uint32_t n = cloth_cells_count(&c);
  if (i >= a->cloth_triangles) {
    cloth_box cloth = cloth_box_load(a->cloth_box, 0);
    if (!cloth_box_near(box, cloth, 2 * a->gap)) {
      n = 0;
    } else if (n > CLOTH_CELLS_MAX) {
      a->large[cloth_atomic_next(a->large_count)] = (uint32_t)t;
      n = 0;
    }
  } else if (n > CLOTH_CELLS_MAX_CLOTH) {
    cloth_atomic_next(a->vast_count);
    n = 0; // so that the sum of all stays in its range
  }
  if (n > 0 && a->mark.word) n = cloth_cells_marked(a, &c);
  a->count[i] = n;
}
