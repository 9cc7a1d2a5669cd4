// Range of the list's node i of a level from the nodes of the level below.
#pragma once

#include "flat_patch.h"

typedef struct cloth_flat_merge_args {
  const int *node; // [n]; NULL: all from `first` on
  int first;
  const int
      *source; // [nodes x 4] first node, columns, rows and nodes in a row of what it is made of
  cloth_real *range; // [nodes x CLOTH_FLAT_RANGE], those of this level written
} cloth_flat_merge_args;

CLOTH_FN void cloth_flat_merge_rect(const cloth_real *range, int first, int columns, int rows,
                                    int stride, cloth_real *out)
{
  cloth_flat_range_clear(out);
  for (int y = 0; y < rows; y++)
    for (int x = 0; x < columns; x++)
      cloth_flat_range_add(out, range + CLOTH_FLAT_RANGE * (first + y * stride + x));
}

CLOTH_FN void cloth_flat_merge(int i, const cloth_flat_merge_args *a)
{
  int node = a->node ? a->node[i] : a->first + i;
  const int *s = a->source + 4 * node;
  cloth_real range[CLOTH_FLAT_RANGE];
  cloth_flat_merge_rect(a->range, s[0], s[1], s[2], s[3], range);
  cloth_flat_range_store(a->range + CLOTH_FLAT_RANGE * node, range);
}
