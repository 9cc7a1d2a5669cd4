// One equal share of the workload table. A cell's work may be split over shares, so over threads,
// blocks and devices. A pair that meets in several cells is reported in the first of them only.
#pragma once

#include "grid.h"
#include "pair_emit.h"

enum { CLOTH_SHARE = 256 }; // pair tests

typedef struct cloth_pair_share_args {
  cloth_pair_mesh mesh;
  cloth_grid grid;
  cloth_real cell_gap; // m, the gap with which cells were filled
  int entries;
  const uint64_t *cell;     // [entries] sorted
  const uint32_t *triangle; // [entries]
  const uint32_t *work;     // [entries + 1] scanned workload
} cloth_pair_share_args;

// the entry that holds unit of work w: the last with work[entry] <= w
CLOTH_FN int cloth_work_find(const uint32_t *work, int entries, uint32_t w)
{
  int lo = 0, hi = entries;
  while (hi - lo > 1) {
    int mid = lo + (hi - lo) / 2;
    if (work[mid] <= w)
      lo = mid;
    else
      hi = mid;
  }
  return lo;
}

// Are the triangles of a unit of work of entry e near, and is this the first cell of both? Cell
// numbers are monotone, so that is the cell of the larger corner. Not if a flat square holds both.
CLOTH_FN int cloth_pair_meets(const cloth_pair_share_args *a, int e, int ta, int tb)
{
  const cloth_pair_mesh *m = &a->mesh;
  int self = tb < m->cloth_triangles;
  if (self && !m->self) return 0;
  cloth_box box_a = cloth_box_load(m->box, ta), box_b = cloth_box_load(m->box, tb);
  if (!cloth_box_near(box_a, box_b, cloth_pair_gap(m, ta, tb))) return 0;
  cloth_v3 lo = cloth_v3_max(box_a.lo, box_b.lo);
  int x = cloth_grid_cell(&a->grid, 0, lo.x - a->cell_gap);
  int y = cloth_grid_cell(&a->grid, 1, lo.y - a->cell_gap);
  int z = cloth_grid_cell(&a->grid, 2, lo.z - a->cell_gap);
  if (cloth_grid_key(&a->grid, x, y, z) != a->cell[e]) return 0;
  return !(self && m->flat.flat &&
           cloth_flat_holds(&m->flat, cloth_flat_union(cloth_flat_place_of(&m->flat, ta),
                                                       cloth_flat_place_of(&m->flat, tb))));
}

CLOTH_FN void cloth_pair_share(int i, const cloth_pair_share_args *a)
{
  uint32_t total = a->work[a->entries], w = (uint32_t)i * CLOTH_SHARE;
  uint32_t end = w + CLOTH_SHARE < total ? w + CLOTH_SHARE : total;
  if (w >= end) return;

  for (int e = cloth_work_find(a->work, a->entries, w); w < end; e++) {
    int ta = (int)a->triangle[e];
    for (; w < end && w < a->work[e + 1]; w++) {
      int tb = (int)a->triangle[e + 1 + (int)(w - a->work[e])];
      if (cloth_pair_meets(a, e, ta, tb)) cloth_pair_emit(&a->mesh, ta, tb);
    }
  }
}
