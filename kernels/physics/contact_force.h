// Force and stiffness of contact i at the present iterate.
//
// Normal: k (t - d) (t / d)^2 while d < t, with d measured along the contact's plane: a spring that
// becomes a barrier, so that it carries any load before the distance is used up (in the spirit of
// Li et al. 2020, Incremental potential contact). Linearised at the start of the substep, later at
// the last iterate; tangent s n n'. (Scaling a spring by the last (t / d)^2 instead would swing
// from step to step as soon as the load presses d below 2 t / 3.) The force on vertex a is
// weight_a * force, the tangent block of (a, b) is weight_a weight_b * tangent.
//
// In a substep that is cut it is less by what contact_barrier.h calls relief, and never below zero.
//
// Friction: a spring that yields at mu N (friction_law.h), N that of the last iterate. While it
// sticks the tangent is the spring's. Once it slides the force does not grow with the slip, so the
// tangent is that of the radial return, across the slip alone: a secant along it (mu N / |slip|)
// acts as a mass, and slow cloth takes seconds to let go. Without it a solve can turn a slow slip
// round, and friction would drive. So a contact that turned round sticks in the next iterate
// (friction_check.h asks for one), a solve starts from sticking near rest, and the secant is there
// for what the force grew by since the last iterate, less inertia.
#pragma once

#include "contact_barrier.h"
#include "friction_law.h"

#define CLOTH_FRICTION_TRY 4 // limits of elastic slip up to which a solve starts from sticking

typedef struct cloth_contact_force_args {
  const int *vertex;           // [n x 4]
  const cloth_real *weight;    // [n x 4]
  const cloth_real *normal;    // [n x 3]
  const cloth_real *distance;  // [n] m
  const cloth_real *thickness; // [n] m
  const cloth_real *k;         // [n] N/m
  const cloth_real *inertia;   // [n] N/m, mass / step^2 of what the contact moves
  const cloth_real *relief;    // [n] N, contact_barrier.h
  const cloth_real *mu;        // [n]
  const cloth_real *x_t0, *x;  // [vertices x 3] m
  int first_iterate;           // 1: x is the prediction, not a solution: the normal force for
                               // friction is that of the start of the substep
  const cloth_real *elastic;   // [n x 3] m, elastic slip at the start; NULL: no friction
  cloth_real *trial;           // [n x 3] m, at the last iterate; brought up to date
  unsigned char *state;        // [n] CLOTH_FRICTION_... at the last iterate; brought up to date
  cloth_real *bound;           // [n] mu N at the last iterate; brought up to date
  cloth_real *secant;          // [n] N/m, stiffness along the slip there; brought up to date
  cloth_real limit;            // m, elastic slip that a contact can bear
  cloth_real *force;           // [n x 3] N, written
  cloth_real *tangent;         // [n x 6] N/m, written
  cloth_real *pressure;        // [n] N, normal force, written
} cloth_contact_force_args;

// What the last solve took friction on contact i to be at its end, where the slip is now `slip`
// [N]. With a secant less than the bound: counting on all of it would leave the next iterate
// without one, and a normal force that an iterate of an impact shot up to would throw the cloth
// sideways.
CLOTH_FN cloth_real cloth_contact_carried(int i, const cloth_contact_force_args *a, cloth_v3 slip)
{
  cloth_v3 before = cloth_v3_load(a->trial, i);
  cloth_real size = cloth_v3_length(before);
  if (a->state[i] == CLOTH_FRICTION_STICKS) return a->bound[i] * cloth_v3_length(slip) / a->limit;
  if (!(a->secant[i] > 0 && size > 0)) return a->bound[i];
  cloth_real carried = a->bound[i] - a->secant[i] * (size - cloth_v3_dot(before, slip) / size);
  return carried > 0 ? carried : 0;
}

// friction on contact i under `load` [N] after the motion u, and its tangent
CLOTH_FN cloth_v3 cloth_contact_friction(int i, const cloth_contact_force_args *a, cloth_real load,
                                         cloth_v3 u, cloth_sym3 *tangent)
{
  cloth_v3 n = cloth_v3_load(a->normal, i), before = cloth_v3_load(a->trial, i);
  cloth_v3 slip = cloth_v3_add(cloth_v3_load(a->elastic, i), cloth_friction_tangential(u, n));
  cloth_real size = cloth_v3_length(slip), bound = a->mu[i] * load;
  cloth_real inertia = a->inertia[i], carried = 0; // N/m; N in the last solve
  int state = a->state[i], slides = size > CLOTH_FRICTION_STATIC * a->limit;
  if (a->first_iterate) {
    // near rest: does it stick? A slide is taken as it is unless friction could throw it about
    slides = size > CLOTH_FRICTION_TRY * a->limit;
    if (bound < inertia * (size > a->thickness[i] ? size : a->thickness[i])) carried = bound;
  } else if (state != CLOTH_FRICTION_NONE) {
    slides = slides && !(cloth_v3_dot(slip, before) < 0);
  }
  if (state != CLOTH_FRICTION_NONE) carried = cloth_contact_carried(i, a, slip);
  cloth_v3_store(a->trial, i, slip);
  a->state[i] = slides ? CLOTH_FRICTION_SLIDES : CLOTH_FRICTION_STICKS;
  a->bound[i] = bound;
  a->secant[i] = 0;
  if (!slides) {
    *tangent = cloth_sym3_axis(bound / a->limit, -bound / a->limit, n);
    return cloth_v3_scale(-bound / a->limit, slip);
  }
  bound *= CLOTH_FRICTION_KINETIC;
  cloth_v3 along = cloth_v3_scale(1 / size, slip);
  // what is new of the force must not turn the slip round by itself
  cloth_real secant = (bound - carried) / size - inertia, across = bound / size;
  secant = secant > 0 && carried < bound ? secant : 0;
  a->secant[i] = secant;
  *tangent = cloth_sym3_add(cloth_sym3_axis(0, secant, along),
                            cloth_sym3_axis(0, across, cloth_v3_cross(n, along)));
  return cloth_v3_scale(-bound, along);
}

CLOTH_FN void cloth_contact_force(int i, const cloth_contact_force_args *a)
{
  cloth_v3 n = cloth_v3_load(a->normal, i);
  cloth_v3 u = cloth_friction_motion(i, a->vertex, a->weight, a->x_t0, a->x);
  cloth_real t = a->thickness[i], d0 = a->distance[i], stiffness;
  cloth_real d = d0 + cloth_v3_dot(n, u);
  // far pairs are springs that begin at t, not barriers linearised out there
  cloth_real at = a->first_iterate ? (d0 < t ? d0 : t) : (d < t ? d : t);
  // what has passed is fetched back from a moderate force: a tangent from inside would say nothing
  if (!(at > 0)) at = (a->relief[i] > 0 ? d0 : t) / 2;
  cloth_real load = cloth_contact_barrier(a->k[i], t, at, &stiffness) - a->relief[i];
  cloth_real pressure = load + stiffness * (at - d);
  int active = pressure > 0;
  pressure = active ? pressure : 0;
  a->pressure[i] = pressure;

  cloth_v3 force = cloth_v3_scale(pressure, n);
  cloth_sym3 tangent = cloth_sym3_axis(0, active ? stiffness : 0, n);
  if (a->elastic) {
    cloth_sym3 more;
    if (active && load > 0) {
      force = cloth_v3_add(force, cloth_contact_friction(i, a, load, u, &more));
      tangent = cloth_sym3_add(tangent, more);
    } else {
      a->state[i] = CLOTH_FRICTION_NONE;
    }
  }
  cloth_v3_store(a->force, i, force);
  cloth_sym3_store(a->tangent, i, tangent);
}
