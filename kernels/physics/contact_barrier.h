// The normal force of a contact as a function of its distance; contact_force.h says why.
#pragma once

#include "real.h"

#define CLOTH_BARRIER_LEAST ((cloth_real)0.05) // of the thickness; from there on along the tangent

// force [N] and stiffness [N/m] of the barrier at distance d [m]
CLOTH_FN cloth_real cloth_contact_barrier(cloth_real k, cloth_real t, cloth_real d,
                                          cloth_real *stiffness)
{
  cloth_real least = t * CLOTH_BARRIER_LEAST, close = d > least ? d : least;
  if (!(d < t)) {
    *stiffness = k;
    return 0;
  }
  cloth_real ratio_sq = (t / close) * (t / close);
  *stiffness = k * ratio_sq * (1 + 2 * (t - close) / close);
  return k * ratio_sq * (t - close) + *stiffness * (close - d);
}

#define CLOTH_CONTACT_OPENS ((cloth_real)0.75) // of its depth, in the time of a whole step

// What the barrier is less by in a substep that begins at d, where it is stiffer because a step is
// cut to the `share` [1] of its length [N]. Without it each contact would let go of 1 / share^2
// times the energy that pressed it, and a stack would fly apart. With it the springs answer motion
// as stiffly, but begin the substep with a force that opens them no faster than CLOTH_CONTACT_OPENS
// says, or with that of a step which is not cut, if that is more. (That alone would let narrow gaps
// stay so, in which layers meet.)
CLOTH_FN cloth_real cloth_contact_relief(cloth_real k, cloth_real t, cloth_real d, cloth_real share)
{
  if (!(share < 1) || !(d > 0) || !(d < t)) return 0;
  cloth_real stiffness, load = cloth_contact_barrier(k, t, d, &stiffness);
  cloth_real opens = CLOTH_CONTACT_OPENS * share * (t - d) * stiffness;
  cloth_real most = share * share * load;
  most = most < opens ? opens : most;
  return most < load ? load - most : 0;
}
