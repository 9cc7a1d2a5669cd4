// The corrections of all levels, gathered at node i of the first level.
#pragma once

#include "hat.h"

typedef struct cloth_hat_spread_args {
  cloth_hats hats;        // correction of the first level is changed
  const cloth_real *done; // [1] above 0: nothing is left to do
} cloth_hat_spread_args;

CLOTH_FN void cloth_hat_spread_node(int i, const cloth_hats *h)
{
  cloth_v3 y = cloth_v3_load(h->correction, i);
  CLOTH_UNROLL_MORE
  for (int k = h->uppers * i; k < h->uppers * (i + 1); k++)
    y = cloth_v3_add_scaled(y, h->upper_weight[k], cloth_v3_load(h->correction, h->upper[k]));
  cloth_v3_store(h->correction, i, y);
}

CLOTH_FN void cloth_hat_spread(int i, const cloth_hat_spread_args *a)
{
  if (*a->done > 0) return;
  cloth_hat_spread_node(i, &a->hats);
}
