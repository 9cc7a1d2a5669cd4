// Is the square at the list's node i flat? Before a search that is noted; later, squares that were
// noted and are flat no more are counted: their pairs must be searched.
#pragma once

#include "atomic.h"
#include "flat_merge.h"

typedef struct cloth_flat_square_args {
  const int *node;          // [n]; NULL: all
  const int *square;        // [nodes x 3] columns, rows, nodes in a row
  const cloth_real *height; // [nodes] m, least height of a triangle; 0: not a patch
  const cloth_real *range;  // [nodes x CLOTH_FLAT_RANGE]
  cloth_real thickness;     // m
  cloth_real margin;        // 1, on the bound of flat_patch.h
  int check;                // 0: note, 1: count those noted that are flat no more
  unsigned char *flat;      // [nodes]
  uint32_t *lost;           // [1] counts up
} cloth_flat_square_args;

CLOTH_FN void cloth_flat_square(int k, const cloth_flat_square_args *a)
{
  int i = a->node ? a->node[k] : k;
  if (a->check ? !a->flat[i] : !(a->height[i] > 0)) {
    if (!a->check) a->flat[i] = 0;
    return;
  }
  const int *s = a->square + 3 * i;
  cloth_real range[CLOTH_FLAT_RANGE];
  cloth_flat_merge_rect(a->range, i, s[0], s[1], s[2], range);
  int flat = cloth_flat_test(range, cloth_flat_share(a->thickness, a->height[i]) + a->margin);
  if (!a->check)
    a->flat[i] = (unsigned char)flat;
  else if (!flat)
    cloth_atomic_add(a->lost, 1);
}
