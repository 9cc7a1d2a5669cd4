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
  CLOTH_SPRING_FIELDS,
  CLOTH_SPRING_SUMS = CLOTH_SPRING_FIELDS - CLOTH_SPRING_ENERGY
};

typedef struct cloth_spring_chunk_args {
  int first, count;       // owned particles
  const cloth_real *x;    // [n x 3] m
  const cloth_real *v;    // [n x 3] m/s
  const cloth_real *mass; // [n] kg
  const uint32_t *touch;  // [n x 2] contacts of the last sub-step, or NULL
  cloth_real *out;        // [chunks x CLOTH_SPRING_FIELDS], written
} cloth_spring_chunk_args;

/// What particle k adds to each field; of the speed its square.
CLOTH_FN void cloth_spring_chunk_particle(int k, const cloth_spring_chunk_args *a,
                                          cloth_real *field)
{
  cloth_v3 x = cloth_v3_load(a->x, k), v = cloth_v3_load(a->v, k);
  cloth_real v_sq = cloth_v3_dot(v, v);
  field[CLOTH_SPRING_WORST] =
      cloth_larger(cloth_larger(cloth_fabs(x.x), cloth_fabs(x.y)), cloth_fabs(x.z));
  field[CLOTH_SPRING_SPEED] = v_sq;
  field[CLOTH_SPRING_ENERGY] = a->mass[k] * v_sq / 2;
  cloth_v3_store(field + CLOTH_SPRING_VELOCITY, 0, v);
  field[CLOTH_SPRING_PARTICLES] = a->touch ? (cloth_real)a->touch[2 * k] : 0;
  field[CLOTH_SPRING_BODIES] = a->touch ? (cloth_real)a->touch[2 * k + 1] : 0;
}

CLOTH_FN void cloth_spring_chunk(int i, const cloth_spring_chunk_args *a)
{
  cloth_real worst = 0, speed_sq = 0, term[CLOTH_SPRING_SUMS][CLOTH_CHUNK];
  int begin = a->first + i * CLOTH_CHUNK, end = cloth_chunk_end(a->first, a->count, i);
  for (int lane = 0; lane < CLOTH_CHUNK; lane++) {
    cloth_real field[CLOTH_SPRING_FIELDS];
    for (int f = 0; f < CLOTH_SPRING_FIELDS; f++) field[f] = 0;
    if (begin + lane < end) cloth_spring_chunk_particle(begin + lane, a, field);
    worst = cloth_larger(worst, field[CLOTH_SPRING_WORST]);
    speed_sq = cloth_larger(speed_sq, field[CLOTH_SPRING_SPEED]);
    for (int f = 0; f < CLOTH_SPRING_SUMS; f++) term[f][lane] = field[CLOTH_SPRING_ENERGY + f];
  }
  cloth_real *out = a->out + CLOTH_SPRING_FIELDS * (a->first / CLOTH_CHUNK + i);
  out[CLOTH_SPRING_WORST] = worst;
  out[CLOTH_SPRING_SPEED] = cloth_sqrt(speed_sq);
  for (int f = 0; f < CLOTH_SPRING_SUMS; f++)
    out[CLOTH_SPRING_ENERGY + f] = cloth_chunk_sum(term[f]);
}
