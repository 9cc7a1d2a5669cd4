// The solver's levels between single vertices and the whole cloth: nodes of ever coarser grids over
// the cloth as it lies at rest, each with a hat function that vertices around it share in. A
// level's correction is continuous, so it stretches nothing where two nodes' vertices meet; that is
// what runs of vertices that move together (coarse_chunk.h) cost. All levels correct at once, each
// by the 3x3 blocks of its nodes: the additive multilevel preconditioner of Bramble, Pasciak and Xu
// 1990.
//
// A vertex has a place [3] on the grid, in cells of the first level; each level's cells are RATIO
// times as wide as the last one's. On cloth that is flat at rest the third number is below 0 and
// hats are bilinear; else they are linear on the six tetrahedra of a cell (Freudenthal 1942). Both
// ways a place has four nodes, and a coarse hat is a sum of finer ones.
#pragma once

#include "chunk.h"

enum {
  CLOTH_HAT_CORNERS = 4,
  CLOTH_HAT_RATIO = 4,
  CLOTH_HAT_LEVELS = 3,
  CLOTH_HAT_FINE_LANES = 8,  // share the sum of a node of the first level
  CLOTH_HAT_FINE_GROUP = 32, // such nodes that are one entry of `partial`
  CLOTH_HAT_LANES = 32,      // the same for the other levels
  CLOTH_HAT_GROUP = 8,
  CLOTH_HAT_WIDE_LANES = 256,   // the same for wide levels, of which each node is an entry
  CLOTH_HAT_WIDE_FINE = 1024,   // a level is wide if the first has so many nodes, and its own nodes
  CLOTH_HAT_WIDE_CHILDREN = 256 // so many children, in the mean
};

// In a large mesh a node of the third level has up to 961 children in the first, one of the second
// up to 49. (Coarse hats are sums of finer ones, so the third level could add up 49 of the second
// instead: the same numbers but for rounding. But then it would wait for the second, a barrier more
// in every iteration; so it has four numbers for each of 256 lanes.)

typedef struct cloth_hats {
  int fine, nodes;                // nodes of the first level, of all; those of the first come first
  int wide;                       // first node of the wide levels, which come last
  int uppers;                     // corners of a first node on all other levels: 4 (levels - 1)
  const int *corner;              // [vertices x 4] nodes of the first level
  const cloth_real *weight;       // [vertices x 4], of the part's own alone
  const int *upper;               // [fine x uppers] nodes of the other levels
  const cloth_real *upper_weight; // [fine x uppers]
  const int *first;               // [nodes + 1] a node's place in the lists:
  const int *child;               // vertices, or nodes of the first level, that share in the node
  const cloth_real *child_weight;
  cloth_real *inverse;    // [nodes x 6] m/N
  cloth_real *rest;       // [nodes x 3] N: the residual, as the node sees it
  cloth_real *correction; // [nodes x 3] m
} cloth_hats;

CLOTH_FN cloth_real cloth_hat_floor(cloth_real x)
{
  cloth_real t = (cloth_real)(int)x;
  return t > x ? t - 1 : t;
}

/// The node of corner k around a place.
CLOTH_FN cloth_v3 cloth_hat_corner(cloth_v3 u, int k)
{
  cloth_v3 c = cloth_v3_make(cloth_hat_floor(u.x), cloth_hat_floor(u.y), -1);
  if (u.z < 0) return cloth_v3_make(c.x + (cloth_real)(k & 1), c.y + (cloth_real)(k >> 1), -1);
  c.z = cloth_hat_floor(u.z); // along the axes, the one with the largest remainder first
  cloth_real x = u.x - c.x, y = u.y - c.y, z = u.z - c.z;
  int rank_x = (y > x) + (z > x), rank_y = (x >= y) + (z > y), rank_z = (x >= z) + (y >= z);
  return cloth_v3_make(c.x + (cloth_real)(rank_x < k), c.y + (cloth_real)(rank_y < k),
                       c.z + (cloth_real)(rank_z < k));
}

/// The hat of `node` at a place.
CLOTH_FN cloth_real cloth_hat_at(cloth_v3 u, cloth_v3 node)
{
  cloth_v3 d = cloth_v3_sub(u, node);
  if (node.z < 0) {
    cloth_real x = 1 - cloth_fabs(d.x), y = 1 - cloth_fabs(d.y);
    return x > 0 && y > 0 ? x * y : 0;
  }
  cloth_real zero = 0, most = cloth_fmax(cloth_fmax(zero, d.x), cloth_fmax(d.y, d.z));
  cloth_real least = cloth_fmin(cloth_fmin(zero, d.x), cloth_fmin(d.y, d.z));
  return cloth_fmax(zero, 1 - most + least);
}

/// Are two places near enough for contacts or elements between them to turn with the cloth? On
/// other cloths they are not: every cloth has a range of its own.
CLOTH_FN int cloth_hat_near(cloth_v3 a, cloth_v3 b)
{
  cloth_v3 d = cloth_v3_sub(a, b);
  return cloth_fabs(d.x) < 2 && cloth_fabs(d.y) < 2 && cloth_fabs(d.z) < 2;
}

/// The inverse of a node's block, of which half may be empty: all that it moves is held.
CLOTH_FN cloth_sym3 cloth_hat_inverse(cloth_sym3 s)
{
  if (s.xx > 0 && s.yy > 0 && s.zz > 0) return cloth_sym3_inverse(s);
  return cloth_sym3_axis(0, 0, cloth_v3_make(0, 0, 0));
}

/// The correction of vertex v by all levels.
CLOTH_FN cloth_v3 cloth_hat_of(const cloth_hats *h, int v)
{
  cloth_v3 z = cloth_v3_make(0, 0, 0);
  for (int k = CLOTH_HAT_CORNERS * v; k < CLOTH_HAT_CORNERS * (v + 1); k++)
    z = cloth_v3_add_scaled(z, h->weight[k], cloth_v3_load(h->correction, h->corner[k]));
  return z;
}
