// Force and stiffness of contact i at the present iterate.
//
// Normal: k (t - d) (t / d)^2 while d < t, with d measured along the contact's plane: a spring that
// becomes a barrier, so that it carries any load before the distance is used up (in the spirit of
// Li et al. 2020, Incremental potential contact). Linearised at the start of the substep, later at
// the last iterate; tangent s n n'. (Scaling a spring by the last (t / d)^2 instead would swing
// from step to step as soon as the load presses d below 2 t / 3.) Friction: lagged Coulomb (Li et
// al. 2020, section 5), the normal force of the last iterate times mu, opposed to the slip u of the
// substep, smoothed below the slip speed so that it is static there; secant tangent. The force on
// vertex a is weight_a * force, the tangent block of (a, b) is weight_a weight_b * tangent.
#pragma once

#include "real.h"

typedef struct cloth_contact_force_args {
  const int *vertex;           // [n x 4]
  const cloth_real *weight;    // [n x 4]
  const cloth_real *normal;    // [n x 3]
  const cloth_real *distance;  // [n] m
  const cloth_real *thickness; // [n] m
  const cloth_real *k;         // [n] N/m
  const cloth_real *mu;        // [n]
  const cloth_real *x_t0, *x;  // [vertices x 3] m
  cloth_real slip_least;       // m, slip in a substep below which friction is static
  int first_iterate;    // 1: x is the prediction, not a solution: the normal force for friction
                        // is that of the start of the substep
  int friction;         // 0: none
  cloth_real *force;    // [n x 3] N, written
  cloth_real *tangent;  // [n x 6] N/m, written
  cloth_real *pressure; // [n] N, normal force, written
} cloth_contact_force_args;

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

CLOTH_FN void cloth_contact_force(int i, const cloth_contact_force_args *a)
{
  cloth_v3 u = cloth_v3_make(0, 0, 0), n = cloth_v3_load(a->normal, i);
  for (int c = 0; c < 4; c++) {
    int v = a->vertex[4 * i + c];
    u = cloth_v3_add_scaled(u, a->weight[4 * i + c],
                            cloth_v3_sub(cloth_v3_load(a->x, v), cloth_v3_load(a->x_t0, v)));
  }
  cloth_real t = a->thickness[i], d0 = a->distance[i], stiffness;
  cloth_real along = cloth_v3_dot(n, u), d = d0 + along;
  // far pairs are springs that begin at t, not barriers linearised out there
  cloth_real at = a->first_iterate ? (d0 < t ? d0 : t) : (d < t ? d : t);
  // what has passed is fetched back from a moderate force: a tangent from inside would say nothing
  if (!(at > 0)) at = t / 2;
  cloth_real load = cloth_contact_barrier(a->k[i], t, at, &stiffness);
  cloth_real pressure = load + stiffness * (at - d);
  int active = pressure > 0;
  pressure = active ? pressure : 0;
  a->pressure[i] = pressure;

  cloth_v3 slip = cloth_v3_add_scaled(u, -along, n), force = cloth_v3_scale(pressure, n);
  cloth_real drag = 0; // N/m, friction per slip
  if (a->friction && active) {
    cloth_real size = cloth_v3_length(slip);
    drag = a->mu[i] * load / (size > a->slip_least ? size : a->slip_least);
    force = cloth_v3_add_scaled(force, -drag, slip);
  }
  cloth_v3_store(a->force, i, force);
  cloth_sym3_store(a->tangent, i, cloth_sym3_axis(drag, (active ? stiffness : 0) - drag, n));
}
