// The workload table: entry i is tested against the later entries of its cell (P-Cloth
// section 4.2). Cloth triangles come first in a cell, because the sort is stable; two body
// triangles are no work.
#pragma once

#include "real.h"

typedef struct cloth_entry_work_args {
  int count;                // entries
  const uint64_t *cell;     // [count] sorted
  const uint32_t *triangle; // [count]
  int cloth_triangles;
  uint32_t *work; // [count], written: pair tests
} cloth_entry_work_args;

CLOTH_FN void cloth_entry_work(int i, const cloth_entry_work_args *a)
{
  if ((int)a->triangle[i] >= a->cloth_triangles) {
    a->work[i] = 0;
    return;
  }
  // the end of this cell's run: gallop, then bisect
  int lo = i, step = 1;
  while (lo + step < a->count && a->cell[lo + step] == a->cell[i]) lo += step, step *= 2;
  int hi = lo + step < a->count ? lo + step : a->count;
  while (hi - lo > 1) {
    int mid = lo + (hi - lo) / 2;
    if (a->cell[mid] == a->cell[i])
      lo = mid;
    else
      hi = mid;
  }
  a->work[i] = (uint32_t)(hi - i - 1);
}
