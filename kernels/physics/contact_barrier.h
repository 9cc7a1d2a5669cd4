// The normal force of a contact as a function of its distance; contact_force.h says why.
#pragma once

#include "real.h"

// force [N] and stiffness [N/m] of the barrier at distance d [m]
CLOTH_FN cloth_real cloth_contact_barrier(cloth_real k, cloth_real t, cloth_real d,
                                          cloth_real *stiffness)
{
  cloth_real least = t * (cloth_real)0.05, close = d > least ? d : least;
  if (!(d < t)) {
    *stiffness = k;
    return 0;
  }
  cloth_real ratio_sq = (t / close) * (t / close);
  *stiffness = k * ratio_sq * (1 + 2 * (t - close) / close);
  return k * ratio_sq * (t - close) + *stiffness * (close - d);
}
