// Bins: cells of an unbounded uniform grid, hashed into a table, so that no box of the cloth has to
// be known. Cells that share a place in the table are told apart by their coordinates.
//
// Source: M. Teschner et al., Optimized spatial hashing for collision detection of deformable
// objects, 2003 (the hash); S. Green, Particle simulation using CUDA, 2010 (sorted bins).
#pragma once

#include "real.h"

typedef struct cloth_bins {
  cloth_real inverse; // 1/m, one over the edge of a cell
  cloth_real reach;   // m, at most the edge of a cell: pairs closer than this are candidates
  uint32_t mask;      // places of the table minus 1; a power of two minus 1
} cloth_bins;

typedef struct cloth_bin {
  int x, y, z;
} cloth_bin;

CLOTH_FN int cloth_bin_coordinate(cloth_real c)
{
  if (!(c > (cloth_real)-1e9 && c < (cloth_real)1e9)) return 0; // lost: it is no candidate anyway
  int whole = (int)c;
  return whole > c ? whole - 1 : whole;
}

CLOTH_FN cloth_bin cloth_bin_of(const cloth_bins *b, cloth_v3 p)
{
  cloth_bin c;
  c.x = cloth_bin_coordinate(p.x * b->inverse);
  c.y = cloth_bin_coordinate(p.y * b->inverse);
  c.z = cloth_bin_coordinate(p.z * b->inverse);
  return c;
}

/// Cells side by side along x have places side by side.
CLOTH_FN uint32_t cloth_bin_place(const cloth_bins *b, int x, int y, int z)
{
  return ((uint32_t)x + ((uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u)) & b->mask;
}
