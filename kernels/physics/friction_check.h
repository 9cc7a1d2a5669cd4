// Did the solve leave contact i where its linear model was made? It did not if a contact that was
// taken to stick carries more than it can, if one that was taken to slide turned round, or if the
// normal force changed by so much that friction would move it by more than it gives way.
#pragma once

#include "atomic.h"
#include "contact_barrier.h"
#include "friction_law.h"

typedef struct cloth_friction_check_args {
  const int *vertex;           // [n x 4]
  const cloth_real *weight;    // [n x 4]
  const cloth_real *normal;    // [n x 3]
  const cloth_real *elastic;   // [n x 3] m
  const cloth_real *trial;     // [n x 3] m, at the last iterate
  const unsigned char *state;  // [n] how the solve took it
  const cloth_real *bound;     // [n] mu N, as the solve took it
  const cloth_real *distance;  // [n] m, at the start of the substep
  const cloth_real *thickness; // [n] m
  const cloth_real *k;         // [n] N/m
  const cloth_real *inertia;   // [n] N/m, mass / step^2 of what the contact moves
  const cloth_real *relief;    // [n] N, contact_barrier.h
  const cloth_real *mu;        // [n]
  const cloth_real *x_t0, *x;  // [vertices x 3] m
  cloth_real limit;            // m
  uint32_t *count;             // [1] counts up
} cloth_friction_check_args;

CLOTH_FN void cloth_friction_check(int i, const cloth_friction_check_args *a)
{
  if (a->state[i] == CLOTH_FRICTION_NONE) return;
  cloth_v3 n = cloth_v3_load(a->normal, i);
  cloth_v3 u = cloth_friction_motion(i, a->vertex, a->weight, a->x_t0, a->x);
  cloth_v3 now = cloth_v3_add(cloth_v3_load(a->elastic, i), cloth_friction_tangential(u, n));
  cloth_real size = cloth_v3_length(now), slope;
  cloth_real d = a->distance[i] + cloth_v3_dot(u, n), slack = a->limit * a->inertia[i];
  cloth_real load = cloth_contact_barrier(a->k[i], a->thickness[i], d, &slope) - a->relief[i];
  cloth_real bound = load > 0 ? a->mu[i] * load : 0;
  int wrong;
  if (a->state[i] == CLOTH_FRICTION_STICKS)
    wrong = size > CLOTH_FRICTION_STATIC * a->limit ||
            a->bound[i] * size / a->limit > CLOTH_FRICTION_STATIC * bound + slack;
  else
    wrong = cloth_v3_dot(now, cloth_v3_load(a->trial, i)) < 0 ||
            cloth_fabs(a->bound[i] - bound) > slack;
  if (wrong) cloth_atomic_add(a->count, 1);
}
