// The candidates of one particle: all within reach, from the 3 x 3 x 3 cells around it, ascending.
// Run twice: to count, and to write where the counts have been summed to. Lists that do not fit are
// left out; the sum tells, and the caller makes room and searches again.
#pragma once

#include "bin.h"

typedef struct cloth_bin_search_args {
  cloth_bins bins;
  int first;                // particle of row 0
  int count;                // particles
  const cloth_real *x;      // [count x 3] m
  const uint32_t *start;    // [places + 1] where a place begins in `particle`
  const uint32_t *particle; // [count] by place, ascending within one
  uint32_t *row;            // [rows + 1] counting: written; writing: where each row begins
  uint32_t *candidate;      // NULL: count
  uint32_t capacity;        // of candidate
} cloth_bin_search_args;

CLOTH_FN int cloth_bin_same(cloth_bin a, int x, int y, int z)
{
  return a.x == x && a.y == y && a.z == z;
}

// candidates in one cell; written sorted into list[0, n) if there is one
CLOTH_FN uint32_t cloth_bin_visit(const cloth_bin_search_args *a, int i, int x, int y, int z,
                                  uint32_t n, uint32_t *list)
{
  uint32_t place = cloth_bin_place(&a->bins, x, y, z);
  cloth_v3 p = cloth_v3_load(a->x, i);
  for (uint32_t e = a->start[place]; e < a->start[place + 1]; e++) {
    uint32_t j = a->particle[e], at = n;
    cloth_v3 q = cloth_v3_load(a->x, (int)j), d = cloth_v3_sub(p, q);
    if (!(cloth_v3_dot(d, d) < a->bins.reach * a->bins.reach) || (int)j == i) continue;
    if (!cloth_bin_same(cloth_bin_of(&a->bins, q), x, y, z)) continue; // another cell, same place
    n++;
    if (!list) continue;
    for (; at > 0 && list[at - 1] > j; at--) list[at] = list[at - 1];
    list[at] = j;
  }
  return n;
}

CLOTH_FN void cloth_bin_search(int row, const cloth_bin_search_args *a)
{
  int i = a->first + row;
  uint32_t n = 0, *list = a->candidate ? a->candidate + a->row[row] : 0;
  if (list && a->row[row + 1] > a->capacity) return;
  cloth_bin c = cloth_bin_of(&a->bins, cloth_v3_load(a->x, i));
  for (int z = c.z - 1; z <= c.z + 1; z++)
    for (int y = c.y - 1; y <= c.y + 1; y++)
      for (int x = c.x - 1; x <= c.x + 1; x++) n = cloth_bin_visit(a, i, x, y, z, n, list);
  if (!list) a->row[row] = n;
}
