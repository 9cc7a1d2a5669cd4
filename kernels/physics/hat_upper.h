// The block of node fine + i, of the other levels. What holds it in space adds up over the first
// nodes that share in it. What holds it against its neighbours does not: stretching a sheet by a
// hat costs as much whatever the hat's width, so the first nodes' mean will do. (Beside P' A P: the
// same iterations, within one.)
#pragma once

#include "hat.h"

typedef struct cloth_hat_upper_args {
  cloth_hats hats;        // inverse is written
  const cloth_real *part; // [fine x 2 x 6] N/m, hat_matrix.h
} cloth_hat_upper_args;

enum { CLOTH_HAT_UPPER_SUMS = 13 }; // neighbours [6], space [6], weight

/// What lane l adds up of node c: children l, l + LANES, ... of its list. sum is zero at first.
CLOTH_FN void cloth_hat_upper_lane(const cloth_hat_upper_args *a, int c, int l, cloth_real *sum)
{
  const cloth_hats *h = &a->hats;
  for (int n = h->first[c] + l; n < h->first[c + 1]; n += CLOTH_HAT_LANES) {
    const cloth_real *part = a->part + 12 * h->child[n];
    cloth_real w = h->child_weight[n];
    for (int e = 0; e < 6; e++) sum[e] += w * part[e], sum[6 + e] += w * w * part[6 + e];
    sum[12] += w;
  }
}

CLOTH_FN void cloth_hat_upper_set(const cloth_hat_upper_args *a, int c, const cloth_real *sum)
{
  cloth_real block[6];
  for (int e = 0; e < 6; e++) block[e] = sum[6 + e] + (sum[12] > 0 ? sum[e] / sum[12] : 0);
  cloth_sym3_store(a->hats.inverse, c, cloth_hat_inverse(cloth_sym3_load(block, 0)));
}

CLOTH_FN void cloth_hat_upper(int i, const cloth_hat_upper_args *a)
{
  cloth_real lane[CLOTH_HAT_UPPER_SUMS][CLOTH_HAT_LANES], sum[CLOTH_HAT_UPPER_SUMS];
  for (int l = 0; l < CLOTH_HAT_LANES; l++) {
    cloth_real s[CLOTH_HAT_UPPER_SUMS] = {0};
    cloth_hat_upper_lane(a, a->hats.fine + i, l, s);
    for (int f = 0; f < CLOTH_HAT_UPPER_SUMS; f++) lane[f][l] = s[f];
  }
  for (int f = 0; f < CLOTH_HAT_UPPER_SUMS; f++) sum[f] = cloth_lanes_sum(lane[f], CLOTH_HAT_LANES);
  cloth_hat_upper_set(a, a->hats.fine + i, sum);
}
