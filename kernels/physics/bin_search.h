// The candidates of one particle: all within reach, from the 3 x 3 x 3 cells around it, ascending.
// Every particle has room for the same number; how many did not fit is told, and the caller makes
// room and searches again.
#pragma once

#include "atomic.h"
#include "bin.h"

typedef struct cloth_bin_search_args {
  cloth_bins bins;
  int first;                // particle of row 0
  const cloth_real *x;      // [n x 3] m
  const uint32_t *start;    // [places + 1] where a place begins in `particle`
  const uint32_t *particle; // [n] by place, ascending within one
  uint32_t room;            // candidates of a row
  uint32_t *count;          // [rows] written: candidates of each row
  uint32_t *candidate;      // [rows x room] written
  uint32_t *sums; // [2] candidates of all rows, and rows that have more than room: count up
} cloth_bin_search_args;

CLOTH_FN int cloth_bin_same(cloth_bin a, int x, int y, int z)
{
  return a.x == x && a.y == y && a.z == z;
}

/// Is particle j at q, which lies in the place of cell (x, y, z), a candidate of particle i at p?
CLOTH_FN int cloth_bin_is_near(const cloth_bins *b, int i, cloth_v3 p, int x, int y, int z, int j,
                               cloth_v3 q)
{
  cloth_v3 d = cloth_v3_sub(p, q);
  if (!(cloth_v3_dot(d, d) < b->reach * b->reach) || j == i) return 0;
  return cloth_bin_same(cloth_bin_of(b, q), x, y, z); // not another cell in the same place
}

/// Put j where it belongs in list[0, n), which is ascending; what does not fit is counted only.
CLOTH_FN uint32_t cloth_bin_insert(const cloth_bin_search_args *a, uint32_t j, uint32_t n,
                                   uint32_t *list)
{
  uint32_t at = n;
  if (n >= a->room) return n + 1;
  for (; at > 0 && list[at - 1] > j; at--) list[at] = list[at - 1];
  list[at] = j;
  return n + 1;
}

// adds the candidates in one cell to list[0, n)
CLOTH_FN uint32_t cloth_bin_visit(const cloth_bin_search_args *a, int i, cloth_v3 p, int x, int y,
                                  int z, uint32_t n, uint32_t *list)
{
  uint32_t place = cloth_bin_place(&a->bins, x, y, z);
  for (uint32_t e = a->start[place]; e < a->start[place + 1]; e++) {
    int j = (int)a->particle[e];
    if (cloth_bin_is_near(&a->bins, i, p, x, y, z, j, cloth_v3_load(a->x, j)))
      n = cloth_bin_insert(a, (uint32_t)j, n, list);
  }
  return n;
}

CLOTH_FN void cloth_bin_search(int row, const cloth_bin_search_args *a)
{
  int i = a->first + row;
  uint32_t n = 0, *list = a->candidate + (uint64_t)row * a->room;
  cloth_v3 p = cloth_v3_load(a->x, i);
  cloth_bin c = cloth_bin_of(&a->bins, p);
  for (int z = c.z - 1; z <= c.z + 1; z++)
    for (int y = c.y - 1; y <= c.y + 1; y++)
      for (int x = c.x - 1; x <= c.x + 1; x++) n = cloth_bin_visit(a, i, p, x, y, z, n, list);
  a->count[row] = n < a->room ? n : a->room;
  cloth_atomic_add(a->sums, n);
  if (n > a->room) cloth_atomic_add(a->sums + 1, 1);
}
