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
  uint32_t *strayed;       // [2] particles that did, and that went half as far: count up
  uint32_t *touch; // [n x 2] contacts with particles, with bodies, written; NULL: not wanted
} cloth_spring_step_args;

// drag of the triangles around a particle [N]
CLOTH_FN cloth_v3 cloth_spring_air_sum(const cloth_spring_air *a, int row, const cloth_real *x,
                                       const cloth_real *v)
{
  cloth_v3 f = cloth_v3_make(0, 0, 0), wind = cloth_v3_make(a->wind[0], a->wind[1], a->wind[2]);
  for (uint32_t e = a->first[row]; e < a->first[row + 1]; e++) {
    const int *t = a->triangle + 3 * e;
    cloth_v3 sum = cloth_v3_add(cloth_v3_add(cloth_v3_load(v, t[0]), cloth_v3_load(v, t[1])),
                                cloth_v3_load(v, t[2]));
    cloth_v3 u = cloth_v3_sub(cloth_v3_scale((cloth_real)1 / 3, sum), wind);
    cloth_drag_face face =
        cloth_drag_face_make(cloth_v3_load(x, t[0]), cloth_v3_load(x, t[1]), cloth_v3_load(x, t[2]),
                             u, a->half_density, a->drag + 2 * row);
    f = cloth_v3_add(f, cloth_drag_face_force(&face));
  }
  return f;
}

// has particle i strayed (NaN has), or at least half as far?
CLOTH_FN void cloth_spring_watch(const cloth_spring_step_args *a, int i)
{
  cloth_v3 d = cloth_v3_sub(cloth_v3_load(a->x, i), cloth_v3_load(a->x_ref, i));
  d = cloth_v3_sub(d, cloth_v3_make(a->drift[0], a->drift[1], a->drift[2]));
  cloth_real far_sq = cloth_v3_dot(d, d), most_sq = a->stray * a->stray;
  if (!(far_sq <= most_sq)) cloth_atomic_add(a->strayed, 1);
  if (!(4 * far_sq <= most_sq)) cloth_atomic_add(a->strayed + 1, 1);
}

CLOTH_FN void cloth_spring_step(int row, const cloth_spring_step_args *a)
{
  int i = a->first + row, with_particles = 0, with_bodies = 0;
  cloth_real h = a->h, m = a->mass[i];
  cloth_v3 x = cloth_v3_load(a->x, i), v = cloth_v3_load(a->v, i);
  cloth_v3 f = cloth_v3_scale(m, cloth_v3_make(a->gravity[0], a->gravity[1], a->gravity[2]));
  if (a->springs.first) f = cloth_v3_add(f, cloth_spring_sum(&a->springs, row, i, a->x, a->v));
  if (a->air.first) f = cloth_v3_add(f, cloth_spring_air_sum(&a->air, row, a->x, a->v));
  if (a->particles.count > 0)
    f = cloth_v3_add(f, cloth_particle_sum(&a->particles, row, i, a->x, a->v, &with_particles));
  if (a->x_ref) cloth_spring_watch(a, i);

  int slot = a->holds.slot ? a->holds.slot[i] : -1;
  cloth_v3 end, v_end;
  if (slot >= 0 && !(a->holds.free[i] > 0)) {
    end = cloth_v3_load(a->holds.aim, slot);
    v_end = cloth_v3_scale(1 / h, cloth_v3_sub(end, x));
    cloth_v3 impulse = cloth_v3_add_scaled(cloth_v3_scale(m, cloth_v3_sub(v_end, v)), -h, f);
    cloth_v3_store(a->holds.impulse, slot,
                   cloth_v3_add(cloth_v3_load(a->holds.impulse, slot), impulse));
  } else {
    if (slot >= 0) {
      cloth_v3 pull =
          cloth_v3_scale(a->holds.stiffness[i], cloth_v3_sub(cloth_v3_load(a->holds.aim, slot), x));
      f = cloth_v3_add(f, pull);
      cloth_v3_store(a->holds.impulse, slot,
                     cloth_v3_add_scaled(cloth_v3_load(a->holds.impulse, slot), h, pull));
    }
    v_end = cloth_v3_add_scaled(v, h / m, f);
    if (a->mass_drag) v_end = cloth_v3_scale(1 / (1 + h * a->mass_drag[i]), v_end); // implicit
    end = cloth_shapes_move(&a->shapes, h, x, &v_end, &with_bodies);
  }
  cloth_v3_store(a->x_next, i, end);
  cloth_v3_store(a->v_next, i, v_end);
  if (a->touch)
    a->touch[2 * i] = (uint32_t)with_particles, a->touch[2 * i + 1] = (uint32_t)with_bodies;
}
