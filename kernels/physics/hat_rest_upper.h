// The residual and the correction of group i of the nodes beyond the first level: see hat_rest.h.
#pragma once

#include "hat_rest.h"

typedef cloth_hat_rest_args cloth_hat_rest_upper_args; // r is not read

/// Node c of a wide level, which is a group. Returns its share of r'z.
CLOTH_FN cloth_real cloth_hat_rest_wide(const cloth_hats *h, int c)
{
  cloth_real lane[3][CLOTH_HAT_WIDE_LANES] = {{0}};
  for (int n = h->first[c], l = 0; n < h->first[c + 1]; n++, l = (l + 1) % CLOTH_HAT_WIDE_LANES) {
    cloth_v3 s = cloth_v3_make(lane[0][l], lane[1][l], lane[2][l]);
    s = cloth_v3_add_scaled(s, h->child_weight[n], cloth_v3_load(h->rest, h->child[n]));
    lane[0][l] = s.x, lane[1][l] = s.y, lane[2][l] = s.z;
  }
  cloth_v3 rest;
  rest.x = cloth_lanes_sum(lane[0], CLOTH_HAT_WIDE_LANES);
  rest.y = cloth_lanes_sum(lane[1], CLOTH_HAT_WIDE_LANES);
  rest.z = cloth_lanes_sum(lane[2], CLOTH_HAT_WIDE_LANES);
  return cloth_hat_rest_set(h, c, rest);
}

CLOTH_FN void cloth_hat_rest_upper(int i, const cloth_hat_rest_upper_args *a)
{
  if (a->done && *a->done > 0) return;
  const cloth_hats *h = &a->hats;
  cloth_real *partial = a->partial + CLOTH_PCG_PARTIALS * (cloth_hat_fine_groups(h) + i);
  int narrow = cloth_hat_narrow_groups(h);
  int begin = h->fine + i * CLOTH_HAT_GROUP, end = begin + CLOTH_HAT_GROUP;
  if (i < narrow)
    *partial = cloth_hat_rest_group(h, h->rest, begin, end < h->wide ? end : h->wide,
                                    CLOTH_HAT_LANES, CLOTH_HAT_GROUP);
  else
    *partial = cloth_hat_rest_wide(h, h->wide + i - narrow);
}
