// A spring with a dashpot along it, as one of its two ends feels it.
//
// Force along the spring: stiffness (l - l0) + damping dl/dt, towards the other end. The two ends
// compute the same bits with opposite sign, so springs neither add momentum nor angular momentum.
//
// Source: X. Provot, Deformation constraints in a mass-spring model to describe rigid cloth
// behavior, 1995 (structural, shear and flexion springs).
#pragma once

#include "real.h"

enum {
  CLOTH_SPRING_LAW = 3,  // numbers of a spring: rest length m, stiffness N/m, damping N s/m
  CLOTH_SPRING_LANES = 4 // threads of a GPU that share a particle; sums follow them everywhere
};

/// The springs of a run of particles as rows: those of row i are first[i] to first[i + 1].
typedef struct cloth_spring_rows {
  const uint32_t *first; // [rows + 1]
  const int *to;         // [entries] the particle at the other end
  const cloth_real *law; // [entries x CLOTH_SPRING_LAW]
} cloth_spring_rows;

// d, w: position [m] and velocity [m/s] of the other end against this one
CLOTH_FN cloth_v3 cloth_spring_force(cloth_v3 d, cloth_v3 w, const cloth_real *law)
{
  cloth_real l = cloth_v3_length(d);
  cloth_v3 n = cloth_v3_scale(l > 0 ? 1 / l : 0, d); // ends that meet have no direction
  return cloth_v3_scale(law[1] * (l - law[0]) + law[2] * cloth_v3_dot(w, n), n);
}

/// Force [N] of every LANES-th spring of a row, from `lane` on, on its particle i.
CLOTH_FN cloth_v3 cloth_spring_share(const cloth_spring_rows *r, int row, int lane, int i,
                                     const cloth_real *x, const cloth_real *v)
{
  cloth_v3 xi = cloth_v3_load(x, i), vi = cloth_v3_load(v, i), f = cloth_v3_make(0, 0, 0);
  for (uint32_t e = r->first[row] + (uint32_t)lane; e < r->first[row + 1];
       e += CLOTH_SPRING_LANES) {
    int j = r->to[e];
    f = cloth_v3_add(f, cloth_spring_force(cloth_v3_sub(cloth_v3_load(x, j), xi),
                                           cloth_v3_sub(cloth_v3_load(v, j), vi),
                                           r->law + CLOTH_SPRING_LAW * e));
  }
  return f;
}
