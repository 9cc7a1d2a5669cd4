// One sub-step of the mass-spring cloth for particle i: forces of springs, gravity, air, other
// particles and holds at the start, then symplectic Euler, v' = v + h f / m, x' = x + h v', then
// bodies. State goes from one pair of buffers to the other, so no particle sees another half done.
//
// A rigidly held particle goes where it is aimed at; the hold's force is what that takes. Sources:
// spring.h, particle.h, drag.h, shape_contact.h; symplectic Euler: E. Hairer, C. Lubich, G. Wanner,
// Geometric numerical integration, 2006, section I.1.2.
#pragma once

#include "atomic.h"
#include "drag.h"
#include "particle.h"
#include "shape_contact.h"
#include "spring.h"

typedef struct cloth_spring_air {
  const uint32_t *first;   // [rows + 1] triangles at each particle; NULL: no air
  const int *triangle;     // [entries x 3] their corners
  const cloth_real *drag;  // [rows x 2] pressure and skin coefficient
  cloth_real half_density; // kg/m^3
  cloth_real wind[3];      // m/s
} cloth_spring_air;

typedef struct cloth_spring_holds {
  const int *slot;             // [n] place in the list of held particles, -1: free; NULL: no holds
  const cloth_real *aim;       // [held x 3] m, where the hold wants it at the end of the sub-step
  const cloth_real *free;      // [n] 0: held rigidly
  const cloth_real *stiffness; // [n] N/m of holds that are not rigid; NULL: all are
  cloth_real *impulse;         // [held x 3] N s, of the hold on the particle, added to
} cloth_spring_holds;

typedef struct cloth_spring_step_args {
  int first;                   // particle of row 0
  cloth_real h;                // s
  const cloth_real *x, *v;     // [n x 3] m, m/s at the start
  cloth_real *x_next, *v_next; // [n x 3] at the end, written
  const cloth_real *mass;      // [n] kg
  const cloth_real *mass_drag; // [n] 1/s or NULL
  cloth_real gravity[3];       // m/s^2
  cloth_spring_rows springs;   // first NULL: none
  cloth_spring_air air;
  cloth_particles particles; // count 0: they do not meet
  cloth_shapes shapes;
  cloth_spring_holds holds;
  // candidates are complete while no particle strays farther than this from where all went on
  // average
  const cloth_real *x_ref; // [n x 3] m, when they were found; NULL: not watched
  cloth_real drift[3];     // m, how far all went since on average
  cloth_real stray;        // m
  uint32_t *strayed;       // [2] 1 when a particle did, when one went half as far
  uint32_t *touch; // [n x 2] contacts with particles, with bodies, written; NULL: not wanted
} cloth_spring_step_args;

// What does not change about a particle.
typedef struct cloth_spring_particle {
  int i, slot;           // slot: place among the held ones, -1: free
  cloth_real mass, drag; // kg, 1/s
} cloth_spring_particle;

CLOTH_FN cloth_spring_particle cloth_spring_particle_of(const cloth_spring_step_args *a, int i)
{
  cloth_spring_particle p;
  p.i = i, p.slot = a->holds.slot ? a->holds.slot[i] : -1;
  p.mass = a->mass[i], p.drag = a->mass_drag ? a->mass_drag[i] : 0;
  return p;
}

/// Drag of a triangle [N] on one of its corners. x, v: of the corners [m, m/s].
CLOTH_FN cloth_v3 cloth_spring_air_force(const cloth_spring_air *a, const cloth_real *drag,
                                         cloth_v3 x0, cloth_v3 x1, cloth_v3 x2, cloth_v3 v0,
                                         cloth_v3 v1, cloth_v3 v2)
{
  cloth_v3 wind = cloth_v3_make(a->wind[0], a->wind[1], a->wind[2]);
  cloth_v3 sum = cloth_v3_add(cloth_v3_add(v0, v1), v2);
  cloth_v3 u = cloth_v3_sub(cloth_v3_scale((cloth_real)1 / 3, sum), wind);
  cloth_drag_face face = cloth_drag_face_make(x0, x1, x2, u, a->half_density, drag);
  return cloth_drag_face_force(&face);
}

/// Drag [N] of every LANES-th triangle around a particle, from `lane` on.
CLOTH_FN cloth_v3 cloth_spring_air_share(const cloth_spring_air *a, int row, int lane,
                                         const cloth_real *x, const cloth_real *v)
{
  cloth_v3 f = cloth_v3_make(0, 0, 0);
  for (uint32_t e = a->first[row] + (uint32_t)lane; e < a->first[row + 1];
       e += CLOTH_SPRING_LANES) {
    const int *t = a->triangle + 3 * e;
    f = cloth_v3_add(f, cloth_spring_air_force(a, a->drag + 2 * row, cloth_v3_load(x, t[0]),
                                               cloth_v3_load(x, t[1]), cloth_v3_load(x, t[2]),
                                               cloth_v3_load(v, t[0]), cloth_v3_load(v, t[1]),
                                               cloth_v3_load(v, t[2])));
  }
  return f;
}

/// Springs and air [N]: what the lanes gather, along the tree by which threads add it up.
CLOTH_FN cloth_v3 cloth_spring_sum(const cloth_spring_step_args *a, int row)
{
  cloth_v3 lane[CLOTH_SPRING_LANES];
  for (int l = 0; l < CLOTH_SPRING_LANES; l++) {
    lane[l] = cloth_v3_make(0, 0, 0);
    if (a->springs.first)
      lane[l] = cloth_spring_share(&a->springs, row, l, a->first + row, a->x, a->v);
    if (a->air.first)
      lane[l] = cloth_v3_add(lane[l], cloth_spring_air_share(&a->air, row, l, a->x, a->v));
  }
  for (int width = CLOTH_SPRING_LANES / 2; width > 0; width /= 2)
    for (int l = 0; l < width; l++) lane[l] = cloth_v3_add(lane[l], lane[l + width]);
  return lane[0];
}

/// How far a particle strayed since candidates were found: 0, 1 at least half as far as it may, 2
/// farther than that (NaN has, too).
CLOTH_FN int cloth_spring_strayed(const cloth_spring_step_args *a, cloth_v3 x, cloth_v3 x_ref)
{
  cloth_v3 d =
      cloth_v3_sub(cloth_v3_sub(x, x_ref), cloth_v3_make(a->drift[0], a->drift[1], a->drift[2]));
  cloth_real far_sq = cloth_v3_dot(d, d), most_sq = a->stray * a->stray;
  return !(far_sq <= most_sq) ? 2 : !(4 * far_sq <= most_sq) ? 1 : 0;
}

/// Into `strayed`.
CLOTH_FN void cloth_spring_strayed_note(const cloth_spring_step_args *a, int far)
{
  if (far > 0) cloth_atomic_or(a->strayed + 1, 1);
  if (far > 1) cloth_atomic_or(a->strayed, 1);
}

/// What a force f [N] makes of the velocity *v [m/s] of a particle at *x [m] in a sub-step; one
/// that is held rigidly also goes where it is aimed at. Returns 1 if it has still to go. *impulse:
/// what its hold gave [N s].
CLOTH_FN int cloth_spring_push(const cloth_spring_step_args *a, const cloth_spring_particle *p,
                               cloth_v3 f, cloth_v3 *x, cloth_v3 *v, cloth_v3 *impulse)
{
  cloth_real h = a->h, m = p->mass;
  if (p->slot >= 0 && !(a->holds.free[p->i] > 0)) {
    cloth_v3 end = cloth_v3_load(a->holds.aim, p->slot);
    cloth_v3 v_end = cloth_v3_scale(1 / h, cloth_v3_sub(end, *x));
    *impulse = cloth_v3_add_scaled(cloth_v3_scale(m, cloth_v3_sub(v_end, *v)), -h, f);
    *x = end, *v = v_end;
    return 0;
  }
  if (p->slot >= 0) {
    cloth_v3 pull = cloth_v3_scale(a->holds.stiffness[p->i],
                                   cloth_v3_sub(cloth_v3_load(a->holds.aim, p->slot), *x));
    f = cloth_v3_add(f, pull);
    *impulse = cloth_v3_scale(h, pull);
  }
  *v = cloth_v3_add_scaled(*v, h / m, f);
  if (a->mass_drag) *v = cloth_v3_scale(1 / (1 + h * p->drag), *v); // implicit
  return 1;
}

/// What a hold gave in a sub-step [N s].
CLOTH_FN void cloth_spring_impulse_add(const cloth_spring_step_args *a, int slot, cloth_v3 impulse)
{
  cloth_v3 sum = cloth_v3_load(a->holds.impulse, slot);
  cloth_v3_store(a->holds.impulse, slot, cloth_v3_add(sum, impulse));
}

CLOTH_FN void cloth_spring_step(int row, const cloth_spring_step_args *a)
{
  int i = a->first + row, with_particles = 0, with_bodies = 0;
  cloth_spring_particle p = cloth_spring_particle_of(a, i);
  cloth_v3 x = cloth_v3_load(a->x, i), v = cloth_v3_load(a->v, i), impulse = cloth_v3_make(0, 0, 0);
  cloth_v3 f = cloth_v3_scale(p.mass, cloth_v3_make(a->gravity[0], a->gravity[1], a->gravity[2]));
  f = cloth_v3_add(f, cloth_spring_sum(a, row));
  if (a->particles.count > 0)
    f = cloth_v3_add(f, cloth_particle_sum(&a->particles, row, i, a->x, a->v, &with_particles));
  if (a->x_ref)
    cloth_spring_strayed_note(a, cloth_spring_strayed(a, x, cloth_v3_load(a->x_ref, i)));
  if (cloth_spring_push(a, &p, f, &x, &v, &impulse))
    x = cloth_shapes_move(&a->shapes, a->h, x, &v, &with_bodies);
  if (p.slot >= 0) cloth_spring_impulse_add(a, p.slot, impulse);
  cloth_v3_store(a->x_next, i, x);
  cloth_v3_store(a->v_next, i, v);
  if (a->touch)
    a->touch[2 * i] = (uint32_t)with_particles, a->touch[2 * i + 1] = (uint32_t)with_bodies;
}
