// The workload table: entry i is tested against the later entries of its cell (P-Cloth
// section 4.2). Cloth triangles come first in a cell, because the sort is stable; two body
// triangles are no work, nor are two cloth triangles without self-contact, nor a cell all of whose
// triangles lie in one flat square. The first entry of a cell answers for all of them.
#pragma once

#include "flat_patch.h"

typedef struct cloth_entry_work_args {
  int count;                // entries
  const uint64_t *cell;     // [count] sorted
  const uint32_t *triangle; // [count]
  int cloth_triangles;
  int self; // 1: cloth against cloth too
  cloth_flat_map flat;
  uint32_t *work; // [count], written: pair tests
} cloth_entry_work_args;

// do the entries from `begin` to `end`, all of cloth, lie in one flat square?
CLOTH_FN int cloth_cell_is_flat(const cloth_entry_work_args *a, int begin, int end)
{
  if (!a->flat.flat) return 0;
  cloth_flat_place place = cloth_flat_place_of(&a->flat, (int)a->triangle[begin]);
  for (int i = begin + 1; i < end && place.sheet >= 0; i++)
    place = cloth_flat_union(place, cloth_flat_place_of(&a->flat, (int)a->triangle[i]));
  return cloth_flat_holds(&a->flat, place);
}

CLOTH_FN void cloth_entry_work(int i, const cloth_entry_work_args *a)
{
  uint64_t cell = a->cell[i];
  if (i > 0 && a->cell[i - 1] == cell) return;
  int end = i, cloth = i; // of the cell, of its cloth triangles
  for (; end < a->count && a->cell[end] == cell; end++)
    if ((int)a->triangle[end] < a->cloth_triangles) cloth = end + 1;
  int idle = end == cloth && (!a->self || cloth_cell_is_flat(a, i, end));
  for (int k = i; k < end; k++) a->work[k] = k < cloth && !idle ? (uint32_t)(end - k - 1) : 0;
}
