// End of a substep for one chunk of vertices: velocity from displacement, and what the report and
// the checks need of it.
#pragma once

#include "chunk.h"

enum {
  CLOTH_COMMIT_WORST,
  CLOTH_COMMIT_SPEED,
  CLOTH_COMMIT_ENERGY,
  CLOTH_COMMIT_CHANGE,
  CLOTH_COMMIT_VELOCITY, // three fields
  CLOTH_COMMIT_FIELDS = CLOTH_COMMIT_VELOCITY + 3
};

typedef struct cloth_commit_chunk_args {
  int first, count;        // owned vertices
  const cloth_real *x_t0;  // [vertices x 3] m
  const cloth_real *x;     // [vertices x 3] m
  const cloth_real *mass;  // [vertices] kg
  cloth_real inverse_step; // 1/s
  const cloth_real *v;     // [vertices x 3] m/s, at the start
  cloth_real *v_next;      // [vertices x 3] m/s, written
  cloth_real *out; // [chunks x CLOTH_COMMIT_FIELDS]: largest |coordinate| [m] (NaN if any is),
                   // largest speed [m/s], kinetic energy [J], largest change of
                   // velocity [m/s], sum of velocities [m/s]
} cloth_commit_chunk_args;

CLOTH_FN void cloth_commit_chunk(int i, const cloth_commit_chunk_args *a)
{
  cloth_real worst = 0, speed = 0, energy = 0, change = 0;
  cloth_v3 sum = cloth_v3_make(0, 0, 0);
  int begin = a->first + i * CLOTH_CHUNK, end = cloth_chunk_end(a->first, a->count, i);
  for (int k = begin; k < end; k++) {
    cloth_v3 x = cloth_v3_load(a->x, k);
    cloth_v3 v = cloth_v3_scale(a->inverse_step, cloth_v3_sub(x, cloth_v3_load(a->x_t0, k)));
    cloth_real far = cloth_fabs(x.x);
    if (!(cloth_fabs(x.y) <= far)) far = cloth_fabs(x.y);
    if (!(cloth_fabs(x.z) <= far)) far = cloth_fabs(x.z);
    if (!(far <= worst) && worst == worst) worst = far; // the first NaN stays
    cloth_real v_sq = cloth_v3_dot(v, v);
    if (!(v_sq <= speed)) speed = v_sq;
    cloth_v3 dv = cloth_v3_sub(v, cloth_v3_load(a->v, k));
    cloth_real dv_sq = cloth_v3_dot(dv, dv);
    if (!(dv_sq <= change)) change = dv_sq;
    energy += a->mass[k] * v_sq / 2;
    sum = cloth_v3_add(sum, v);
    cloth_v3_store(a->v_next, k, v);
  }
  cloth_real *out = a->out + CLOTH_COMMIT_FIELDS * (a->first / CLOTH_CHUNK + i);
  out[CLOTH_COMMIT_WORST] = worst;
  out[CLOTH_COMMIT_SPEED] = cloth_sqrt(speed);
  out[CLOTH_COMMIT_ENERGY] = energy;
  out[CLOTH_COMMIT_CHANGE] = cloth_sqrt(change);
  cloth_v3_store(out + CLOTH_COMMIT_VELOCITY, 0, sum);
}
