// Range of the list's tile i from those of the triangles that reach into it.
#pragma once

#include "flat_patch.h"

typedef struct cloth_flat_tile_args {
  const int *node;            // [n] tiles; NULL: all
  const int *first;           // [n + 1]
  const int *list;            // [first[n]] places in `triangle`
  const cloth_real *triangle; // [triangles x CLOTH_FLAT_RANGE]
  cloth_real *range;          // [nodes x CLOTH_FLAT_RANGE], those of tiles written
} cloth_flat_tile_args;

CLOTH_FN void cloth_flat_tile(int i, const cloth_flat_tile_args *a)
{
  cloth_real range[CLOTH_FLAT_RANGE];
  cloth_flat_range_clear(range);
  for (int n = a->first[i]; n < a->first[i + 1]; n++)
    cloth_flat_range_add(range, a->triangle + CLOTH_FLAT_RANGE * a->list[n]);
  cloth_flat_range_store(a->range + CLOTH_FLAT_RANGE * (a->node ? a->node[i] : i), range);
}
