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

CLOTH_FN void cloth_pair_share(int i, const cloth_pair_share_args *a)
{
  uint32_t total = a->work[a->entries], w = (uint32_t)i * CLOTH_SHARE;
  uint32_t end = w + CLOTH_SHARE < total ? w + CLOTH_SHARE : total;
  if (w >= end) return;
  const cloth_pair_mesh *m = &a->mesh;

  for (int e = cloth_work_find(a->work, a->entries, w); w < end; e++) {
    int ta = (int)a->triangle[e];
    cloth_box box_a = cloth_box_load(m->box, ta);
    for (; w < end && w < a->work[e + 1]; w++) {
      int tb = (int)a->triangle[e + 1 + (int)(w - a->work[e])];
      if (tb < m->cloth_triangles && !m->self) continue;
      cloth_box box_b = cloth_box_load(m->box, tb);
      if (!cloth_box_near(box_a, box_b, m->gap)) continue;
      // the first cell of both: cell numbers are monotone, so it is that of the larger corner
      cloth_v3 lo = cloth_v3_max(box_a.lo, box_b.lo);
      int x = cloth_grid_cell(&a->grid, 0, lo.x - a->cell_gap);
      int y = cloth_grid_cell(&a->grid, 1, lo.y - a->cell_gap);
      int z = cloth_grid_cell(&a->grid, 2, lo.z - a->cell_gap);
      if (cloth_grid_key(&a->grid, x, y, z) == a->cell[e]) cloth_pair_emit(m, ta, tb);
    }
  }
}
