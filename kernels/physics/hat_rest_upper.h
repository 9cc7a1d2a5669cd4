// The residual and the correction of group i of the nodes beyond the first level: see hat_rest.h.
#pragma once

#include "hat_rest.h"

typedef cloth_hat_rest_args cloth_hat_rest_upper_args; // r is not read

CLOTH_FN void cloth_hat_rest_upper(int i, const cloth_hat_rest_upper_args *a)
{
  if (a->done && *a->done > 0) return;
  const cloth_hats *h = &a->hats;
  int begin = h->fine + i * CLOTH_HAT_GROUP, end = begin + CLOTH_HAT_GROUP;
  a->partial[CLOTH_PCG_PARTIALS * (cloth_hat_fine_groups(h) + i)] = cloth_hat_rest_group(
      h, h->rest, begin, end < h->nodes ? end : h->nodes, CLOTH_HAT_LANES, CLOTH_HAT_GROUP);
}
