// Collision of two particles: an elastic push along the line between them while they are closer
// than they may be, and Coulomb friction across it.
//
// They may be as close as they are at rest, and two radii are enough: neighbours of a fine cloth
// do not push each other. Stiffness is in units of the reduced mass over the sub-step squared, so
// what it adds to the step limit does not depend on the mesh (cloth_spring_limit() of src/spring/).
// The two compute the same bits with opposite sign.
//
// Source: S. Green, Particle simulation using CUDA, 2010 (spring between spheres, bins); the rest
// distance as a bound: M. Mueller et al., Position based dynamics, 2007, section 4.3.
#pragma once

#include "real.h"

#define CLOTH_PARTICLE_PUSH ((cloth_real)0.1)  // stiffness, reduced mass / sub-step^2
#define CLOTH_PARTICLE_RUB  ((cloth_real)0.05) // static friction's damping, reduced mass / sub-step

/// The particles that may meet particle i: a list of candidates, or all.
typedef struct cloth_particles {
  const uint32_t *listed;    // [rows] candidates of each row; NULL: every particle is one
  const uint32_t *candidate; // [rows x room] ascending in each row
  uint32_t room;
  int count;                // particles
  cloth_real diameter;      // m, two radii
  cloth_real inverse_step;  // 1/s, of a whole sub-step
  cloth_real friction;      // 1, Coulomb coefficient; 0: none
  const cloth_real *x_rest; // [count x 3] m
  const cloth_real *mass;   // [count] kg
} cloth_particles;

/// Distance [m] below which particles i and j push each other.
CLOTH_FN cloth_real cloth_particle_apart(const cloth_particles *p, int i, int j)
{
  cloth_real rest =
      cloth_v3_length(cloth_v3_sub(cloth_v3_load(p->x_rest, i), cloth_v3_load(p->x_rest, j)));
  return rest < p->diameter ? rest : p->diameter;
}

/// Are particles nearer than `most`, with d from one to the other? At no distance they have no
/// direction to push.
CLOTH_FN int cloth_particle_nearer(cloth_v3 d, cloth_real most)
{
  cloth_real d_sq = cloth_v3_dot(d, d);
  return d_sq < most * most && d_sq > 0;
}

/// Distance [m] below which particles i and j push each other, with d from j to i; 0 where they do
/// not touch.
CLOTH_FN cloth_real cloth_particle_touch(const cloth_particles *p, int i, int j, cloth_v3 d)
{
  if (!cloth_particle_nearer(d, p->diameter)) return 0; // most are not: nothing else is read
  cloth_real most = cloth_particle_apart(p, i, j);
  return cloth_particle_nearer(d, most) ? most : 0;
}

/// Force [N] of particle j on particle i that touch; w: velocity of i against j.
CLOTH_FN cloth_v3 cloth_particle_force(const cloth_particles *p, int i, int j, cloth_real most,
                                       cloth_v3 d, cloth_v3 w)
{
  cloth_real l = cloth_v3_length(d);
  cloth_real m = p->mass[i] * p->mass[j] / (p->mass[i] + p->mass[j]);
  cloth_real rate = m * p->inverse_step;
  cloth_v3 n = cloth_v3_scale(1 / l, d);
  cloth_real push = CLOTH_PARTICLE_PUSH * rate * p->inverse_step * (most - l);
  cloth_v3 f = cloth_v3_scale(push, n);
  if (!(p->friction > 0)) return f;
  w = cloth_v3_add_scaled(w, -cloth_v3_dot(w, n), n);
  cloth_real slip = cloth_v3_length(w), hold = CLOTH_PARTICLE_RUB * rate * slip;
  cloth_real rub = p->friction * push < hold ? p->friction * push : hold;
  return cloth_v3_add_scaled(f, slip > 0 ? -rub / slip : 0, w);
}

/// Force [N] of all that touch particle i, in ascending order: the same sum from any list that has
/// them all. row: its row of candidates; *touch counts up.
CLOTH_FN cloth_v3 cloth_particle_sum(const cloth_particles *p, int row, int i, const cloth_real *x,
                                     const cloth_real *v, int *touch)
{
  cloth_v3 xi = cloth_v3_load(x, i), vi = cloth_v3_load(v, i), f = cloth_v3_make(0, 0, 0);
  const uint32_t *list = p->listed ? p->candidate + (uint64_t)row * p->room : 0;
  uint32_t end = p->listed ? p->listed[row] : (uint32_t)p->count;
  for (uint32_t e = 0; e < end; e++) {
    int j = p->listed ? (int)list[e] : (int)e;
    if (j == i) continue;
    cloth_v3 d = cloth_v3_sub(xi, cloth_v3_load(x, j));
    cloth_real most = cloth_particle_touch(p, i, j, d);
    if (!(most > 0)) continue;
    ++*touch;
    f = cloth_v3_add(f,
                     cloth_particle_force(p, i, j, most, d, cloth_v3_sub(vi, cloth_v3_load(v, j))));
  }
  return f;
}
