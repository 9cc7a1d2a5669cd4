// The residual as nodes see it, P' r, and the correction of each node. The first level sums over
// vertices, the others over the first one's nodes: they come in a second launch.
#pragma once

#include "hat.h"
#include "pcg.h"

typedef struct cloth_hat_rest_args {
  cloth_hats hats;        // rest and correction are written
  const cloth_real *r;    // [vertices x 3] N
  const cloth_real *done; // [1] above 0: nothing is left to do; NULL: always
  cloth_real *partial; // [groups x CLOTH_PCG_PARTIALS] this level's share of r'z, field 0 written
} cloth_hat_rest_args;

/// What lane l of `lanes` adds up of node c.
CLOTH_FN cloth_v3 cloth_hat_rest_lane(const cloth_hats *h, const cloth_real *from, int c, int l,
                                      int lanes)
{
  cloth_v3 sum = cloth_v3_make(0, 0, 0);
  CLOTH_UNROLL_MORE
  for (int n = h->first[c] + l; n < h->first[c + 1]; n += lanes)
    sum = cloth_v3_add_scaled(sum, h->child_weight[n], cloth_v3_load(from, h->child[n]));
  return sum;
}

/// Node c from its sum. Returns its share of r'z.
CLOTH_FN cloth_real cloth_hat_rest_set(const cloth_hats *h, int c, cloth_v3 rest)
{
  cloth_v3 y = cloth_sym3_mul(cloth_sym3_load(h->inverse, c), rest);
  cloth_v3_store(h->rest, c, rest);
  cloth_v3_store(h->correction, c, y);
  return cloth_v3_dot(rest, y);
}

// nodes [begin, end) and the sum of their shares; `group` is the next power of two
CLOTH_FN cloth_real cloth_hat_rest_group(const cloth_hats *h, const cloth_real *from, int begin,
                                         int end, int lanes, int group)
{
  cloth_real lane[3][CLOTH_HAT_LANES], share[CLOTH_HAT_FINE_GROUP];
  for (int c = begin; c < begin + group; c++) {
    share[c - begin] = 0;
    if (c >= end) continue;
    for (int l = 0; l < lanes; l++) {
      cloth_v3 s = cloth_hat_rest_lane(h, from, c, l, lanes);
      lane[0][l] = s.x, lane[1][l] = s.y, lane[2][l] = s.z;
    }
    cloth_real x = cloth_lanes_sum(lane[0], lanes), y = cloth_lanes_sum(lane[1], lanes);
    cloth_real z = cloth_lanes_sum(lane[2], lanes);
    share[c - begin] = cloth_hat_rest_set(h, c, cloth_v3_make(x, y, z));
  }
  return cloth_lanes_sum(share, group);
}

CLOTH_FN int cloth_hat_fine_groups(const cloth_hats *h)
{
  return (h->fine + CLOTH_HAT_FINE_GROUP - 1) / CLOTH_HAT_FINE_GROUP;
}

/// Groups of the other levels that are not wide; of all other levels.
CLOTH_FN int cloth_hat_narrow_groups(const cloth_hats *h)
{
  return (h->wide - h->fine + CLOTH_HAT_GROUP - 1) / CLOTH_HAT_GROUP;
}

CLOTH_FN int cloth_hat_groups(const cloth_hats *h)
{
  return cloth_hat_narrow_groups(h) + h->nodes - h->wide;
}

/// Group i of the first level.
CLOTH_FN void cloth_hat_rest(int i, const cloth_hat_rest_args *a)
{
  if (a->done && *a->done > 0) return;
  int begin = i * CLOTH_HAT_FINE_GROUP, end = begin + CLOTH_HAT_FINE_GROUP;
  a->partial[CLOTH_PCG_PARTIALS * i] =
      cloth_hat_rest_group(&a->hats, a->r, begin, end < a->hats.fine ? end : a->hats.fine,
                           CLOTH_HAT_FINE_LANES, CLOTH_HAT_FINE_GROUP);
}
