// The block of node i of the first level: P' A P, summed over the vertices that share in it. For
// the other levels it is kept in two parts, what holds it in space and what holds it against its
// neighbours. What the vertices' rows add is read where it lies, on other parts too.
#pragma once

#include "halo_contact.h"
#include "hat.h"

typedef struct cloth_hat_matrix_args {
  cloth_hats hats;                           // inverse is written
  int first;                                 // node 0 of this launch
  int parts;                                 // whose blocks are read
  int cut[CLOTH_HALO_PARTS + 1];             // vertices [cut[j], cut[j + 1]) are in block[j]
  const cloth_real *block[CLOTH_HALO_PARTS]; // [vertices x 5 x 6] N/m, hat_row.h
  cloth_real *part;                          // [fine x 2 x 6] N/m: neighbours, space; written
} cloth_hat_matrix_args;

enum { CLOTH_HAT_MATRIX_SUMS = 18 }; // all [6], neighbours [6], space [6]

/// What lane l adds up of node i: vertices l, l + LANES, ... of its list. sum is zero at first.
CLOTH_FN void cloth_hat_matrix_lane(const cloth_hat_matrix_args *a, int i, int l, cloth_real *sum)
{
  const cloth_hats *h = &a->hats;
  for (int n = h->first[i] + l; n < h->first[i + 1]; n += CLOTH_HAT_LANES) {
    int v = h->child[n], k = CLOTH_HAT_CORNERS - 1;
    for (int c = k - 1; c >= 0; c--)
      if (h->corner[CLOTH_HAT_CORNERS * v + c] == i) k = c;
    const cloth_real *block =
        a->block[cloth_part_of(a->cut, a->parts, v)] + (int64_t)v * 6 * (CLOTH_HAT_CORNERS + 1);
    cloth_real w = h->child_weight[n];
    for (int e = 0; e < 6; e++) {
      cloth_real all = block[6 * k + e], held = block[6 * CLOTH_HAT_CORNERS + e];
      sum[e] += all, sum[6 + e] += all - w * w * held, sum[12 + e] += w * held;
    }
  }
}

CLOTH_FN void cloth_hat_matrix_set(const cloth_hat_matrix_args *a, int i, const cloth_real *sum)
{
  for (int e = 0; e < 12; e++) a->part[12 * i + e] = sum[6 + e];
  cloth_sym3_store(a->hats.inverse, i, cloth_hat_inverse(cloth_sym3_load(sum, 0)));
}

CLOTH_FN void cloth_hat_matrix(int node, const cloth_hat_matrix_args *a)
{
  cloth_real lane[CLOTH_HAT_MATRIX_SUMS][CLOTH_HAT_LANES], sum[CLOTH_HAT_MATRIX_SUMS];
  for (int l = 0; l < CLOTH_HAT_LANES; l++) {
    cloth_real s[CLOTH_HAT_MATRIX_SUMS] = {0};
    cloth_hat_matrix_lane(a, a->first + node, l, s);
    for (int f = 0; f < CLOTH_HAT_MATRIX_SUMS; f++) lane[f][l] = s[f];
  }
  for (int f = 0; f < CLOTH_HAT_MATRIX_SUMS; f++)
    sum[f] = cloth_lanes_sum(lane[f], CLOTH_HAT_LANES);
  cloth_hat_matrix_set(a, a->first + node, sum);
}
