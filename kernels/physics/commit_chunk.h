// End of a substep for one chunk of vertices: velocity from displacement, and what the report and
// the checks need of it.
#pragma once

#include "chunk.h"

enum {
  CLOTH_COMMIT_WORST,
  CLOTH_COMMIT_SPEED,
  CLOTH_COMMIT_ENERGY,
  CLOTH_COMMIT_VELOCITY, // three fields
  CLOTH_COMMIT_DRIFT = CLOTH_COMMIT_VELOCITY + 3,
  CLOTH_COMMIT_CHANGE,
  CLOTH_COMMIT_FIELDS,
  CLOTH_COMMIT_SUMS = CLOTH_COMMIT_CHANGE - CLOTH_COMMIT_ENERGY // fields that are sums
};

typedef struct cloth_commit_chunk_args {
  int first, count;        // owned vertices
  const cloth_real *x_t0;  // [vertices x 3] m
  const cloth_real *x;     // [vertices x 3] m
  const cloth_real *mass;  // [vertices] kg
  cloth_real inverse_step; // 1/s
  const cloth_real *v;     // [vertices x 3] m/s, at the start
  const cloth_real *free;  // [vertices] 0: held, its change is no error; 1: not
  cloth_real *v_next;      // [vertices x 3] m/s, written
  cloth_real *out; // [chunks x CLOTH_COMMIT_FIELDS]: largest |coordinate| [m] (NaN if any is),
                   // largest speed [m/s], kinetic energy [J], sum of velocities [m/s], sum of mass
                   // times the squared change of velocity [kg m^2/s^2] of what is free, largest
                   // change of velocity [m/s]
} cloth_commit_chunk_args;

/// Vertex k: its velocity, and what it adds to each field.
CLOTH_FN void cloth_commit_vertex(int k, const cloth_commit_chunk_args *a, cloth_real *field)
{
  cloth_v3 x = cloth_v3_load(a->x, k);
  cloth_v3 v = cloth_v3_scale(a->inverse_step, cloth_v3_sub(x, cloth_v3_load(a->x_t0, k)));
  cloth_real far = cloth_fabs(x.x);
  if (!(cloth_fabs(x.y) <= far)) far = cloth_fabs(x.y);
  if (!(cloth_fabs(x.z) <= far) && far == far) far = cloth_fabs(x.z);
  cloth_real v_sq = cloth_v3_dot(v, v);
  field[CLOTH_COMMIT_WORST] = far;
  field[CLOTH_COMMIT_SPEED] = v_sq;
  field[CLOTH_COMMIT_ENERGY] = a->mass[k] * v_sq / 2;
  cloth_v3 change = cloth_v3_sub(v, cloth_v3_load(a->v, k));
  cloth_real change_sq = cloth_v3_dot(change, change);
  field[CLOTH_COMMIT_DRIFT] = a->free[k] * a->mass[k] * change_sq;
  field[CLOTH_COMMIT_CHANGE] = change_sq;
  cloth_v3_store(field + CLOTH_COMMIT_VELOCITY, 0, v);
  cloth_v3_store(a->v_next, k, v);
}

CLOTH_FN void cloth_commit_chunk(int i, const cloth_commit_chunk_args *a)
{
  cloth_real worst = 0, speed = 0, change = 0, term[CLOTH_COMMIT_SUMS][CLOTH_CHUNK];
  int begin = a->first + i * CLOTH_CHUNK, end = cloth_chunk_end(a->first, a->count, i);
  for (int lane = 0; lane < CLOTH_CHUNK; lane++) {
    cloth_real field[CLOTH_COMMIT_FIELDS];
    for (int f = 0; f < CLOTH_COMMIT_FIELDS; f++) field[f] = 0;
    if (begin + lane < end) cloth_commit_vertex(begin + lane, a, field);
    worst = cloth_larger(worst, field[CLOTH_COMMIT_WORST]);
    speed = cloth_larger(speed, field[CLOTH_COMMIT_SPEED]);
    change = cloth_larger(change, field[CLOTH_COMMIT_CHANGE]);
    for (int f = 0; f < CLOTH_COMMIT_SUMS; f++) term[f][lane] = field[CLOTH_COMMIT_ENERGY + f];
  }
  cloth_real *out = a->out + CLOTH_COMMIT_FIELDS * (a->first / CLOTH_CHUNK + i);
  out[CLOTH_COMMIT_WORST] = worst;
  out[CLOTH_COMMIT_SPEED] = cloth_sqrt(speed);
  out[CLOTH_COMMIT_CHANGE] = cloth_sqrt(change);
  for (int f = 0; f < CLOTH_COMMIT_SUMS; f++)
    out[CLOTH_COMMIT_ENERGY + f] = cloth_chunk_sum(term[f]);
}
