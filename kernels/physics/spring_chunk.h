// End of a step of the mass-spring cloth for one chunk of particles: what the report and the checks
// need of the state.
#pragma once

#include "chunk.h"

enum {
  CLOTH_SPRING_WORST,                                 // largest |coordinate|, m; NaN if any is
  CLOTH_SPRING_SPEED,                                 // largest speed, m/s
  CLOTH_SPRING_ENERGY,                                // kinetic, J
  CLOTH_SPRING_VELOCITY,                              // sum, m/s: three fields
  CLOTH_SPRING_PARTICLES = CLOTH_SPRING_VELOCITY + 3, // contacts of particles with particles
  CLOTH_SPRING_BODIES,                                // and with bodies
  CLOTH_SPRING_FIELDS
};

typedef struct cloth_spring_chunk_args {
  int first, count;       // owned particles
  const cloth_real *x;    // [n x 3] m
  const cloth_real *v;    // [n x 3] m/s
  const cloth_real *mass; // [n] kg
  const uint32_t *touch;  // [n x 2] contacts of the last sub-step, or NULL
  cloth_real *out;        // [chunks x CLOTH_SPRING_FIELDS], written
} cloth_spring_chunk_args;

CLOTH_FN void cloth_spring_chunk(int i, const cloth_spring_chunk_args *a)
{
  cloth_real worst = 0, speed_sq = 0, energy = 0, particles = 0, bodies = 0;
  cloth_v3 sum = cloth_v3_make(0, 0, 0);
  int begin = a->first + i * CLOTH_CHUNK, end = cloth_chunk_end(a->first, a->count, i);
  for (int k = begin; k < end; k++) {
    cloth_v3 x = cloth_v3_load(a->x, k), v = cloth_v3_load(a->v, k);
    cloth_real far = cloth_fabs(x.x), v_sq = cloth_v3_dot(v, v);
    if (!(cloth_fabs(x.y) <= far)) far = cloth_fabs(x.y);
    if (!(cloth_fabs(x.z) <= far) && far == far) far = cloth_fabs(x.z);
    if (!(v_sq <= speed_sq) && speed_sq == speed_sq) speed_sq = v_sq;
    if (!(far <= worst) && worst == worst) worst = far; // the first NaN stays
    energy += a->mass[k] * v_sq / 2;
    sum = cloth_v3_add(sum, v);
    if (!a->touch) continue;
    particles += (cloth_real)a->touch[2 * k], bodies += (cloth_real)a->touch[2 * k + 1];
  }
  cloth_real *out = a->out + CLOTH_SPRING_FIELDS * (a->first / CLOTH_CHUNK + i);
  out[CLOTH_SPRING_WORST] = worst;
  out[CLOTH_SPRING_SPEED] = cloth_sqrt(speed_sq);
  out[CLOTH_SPRING_ENERGY] = energy;
  cloth_v3_store(out + CLOTH_SPRING_VELOCITY, 0, sum);
  out[CLOTH_SPRING_PARTICLES] = particles;
  out[CLOTH_SPRING_BODIES] = bodies;
}
