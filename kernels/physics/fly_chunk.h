// A substep of backward Euler where no force couples vertices: each one's system is its own and is
// solved in closed form, x = x* = x + h v + h^2 g, or where its hold has it. One pass over the
// state with the reports of commit_chunk.h, in loops over a chunk that compilers turn into vector
// code.
#pragma once

#include "commit_chunk.h"

typedef struct cloth_fly_chunk_args {
  cloth_commit_chunk_args commit;   // all vertices; x is written, too
  cloth_real h;                     // s
  cloth_real gravity[3];            // m/s^2
  const cloth_real *free;           // [vertices] 0: held rigidly; NULL: nothing is held
  const cloth_real *hold_stiffness; // [vertices] N/m, compliant holds; NULL: none
  const cloth_real *target;         // [vertices x 3] m, of holds
  cloth_real *x;                    // [vertices x 3] m, commit.x
} cloth_fly_chunk_args;

CLOTH_FN int cloth_fly_is_held(int k, const cloth_fly_chunk_args *a)
{
  return !(a->free[k] > 0) || (a->hold_stiffness && a->hold_stiffness[k] > 0);
}

/// Where vertex k ends, whose hold lets it go freely to x.
CLOTH_FN cloth_v3 cloth_fly_held(int k, cloth_v3 x, const cloth_fly_chunk_args *a)
{
  cloth_v3 target = cloth_v3_load(a->target, k);
  if (!(a->free[k] > 0)) return target;
  cloth_real m = a->commit.mass[k] * a->commit.inverse_step * a->commit.inverse_step;
  cloth_real share = a->hold_stiffness[k] / (m + a->hold_stiffness[k]);
  return cloth_v3_add_scaled(x, share, cloth_v3_sub(target, x));
}

/// x* of vertex k.
CLOTH_FN cloth_v3 cloth_fly_freely(int k, const cloth_fly_chunk_args *a)
{
  cloth_v3 g = cloth_v3_make(a->h * a->gravity[0], a->h * a->gravity[1], a->h * a->gravity[2]);
  return cloth_v3_add_scaled(cloth_v3_load(a->commit.x_t0, k), a->h,
                             cloth_v3_add(cloth_v3_load(a->commit.v, k), g));
}

/// Square of the change of velocity of what is not held.
CLOTH_FN cloth_real cloth_fly_change(const cloth_fly_chunk_args *a)
{
  cloth_v3 g = cloth_v3_make(a->h * a->gravity[0], a->h * a->gravity[1], a->h * a->gravity[2]);
  return cloth_v3_dot(g, g);
}

/// Vertex k alone, as a thread of a GPU block does it: as cloth_commit_vertex(), with x written.
CLOTH_FN void cloth_fly_vertex(int k, const cloth_fly_chunk_args *a, cloth_real *field)
{
  cloth_v3 x = cloth_fly_freely(k, a);
  int held = a->free && cloth_fly_is_held(k, a);
  if (held) x = cloth_fly_held(k, x, a);
  cloth_v3_store(a->x, k, x);
  cloth_commit_vertex(k, &a->commit, field);
  if (!held) field[CLOTH_COMMIT_CHANGE] = cloth_fly_change(a);
}

// the larger of pairs of numbers that are not NaN; a vector instruction, unlike cloth_larger()
CLOTH_FN cloth_real cloth_fly_larger(cloth_real a, cloth_real b) { return a > b ? a : b; }

CLOTH_FN void cloth_fly_halve(cloth_real *speed, cloth_real *energy, int n)
{
  for (int k = 0; k < n; k++) speed[k] = cloth_fly_larger(speed[k], speed[k + n]);
  for (int k = 0; k < n; k++) energy[k] += energy[k + n];
}

/// The largest |coordinate| of a chunk [lanes x 3].
CLOTH_FN cloth_real cloth_fly_far(const cloth_real *x, int lanes)
{
  enum { N = 3 * CLOTH_CHUNK / 2 };
  cloth_real far[N];
  for (int k = 0; k < N && lanes == CLOTH_CHUNK; k++)
    far[k] = cloth_fly_larger(cloth_fabs(x[k]), cloth_fabs(x[k + N]));
  if (lanes < CLOTH_CHUNK) {
    for (int k = 0; k < N; k++) far[k] = 0;
    for (int k = 0; k < 3 * lanes; k++) far[k % N] = cloth_fly_larger(cloth_fabs(x[k]), far[k % N]);
  }
  for (int k = 0; k < N / 2; k++) far[k] = cloth_fly_larger(far[k], far[k + N / 2]);
  for (int k = 0; k < N / 4; k++) far[k] = cloth_fly_larger(far[k], far[k + N / 4]);
  for (int k = 0; k < N / 8; k++) far[k] = cloth_fly_larger(far[k], far[k + N / 8]);
  for (int k = 1; k < N / 8; k++) far[0] = cloth_fly_larger(far[0], far[k]);
  return far[0];
}

/// Fields of a chunk from the squares of its velocities [64 x 3], its masses [64], its largest
/// coordinate and the square of the largest change, along the tree of cloth_chunk_sum(). What lies
/// behind the chunk's end is zero. CLOTH_COMMIT_VELOCITY is not written: no solve asks for it.
CLOTH_FN void cloth_fly_fields(const cloth_real *square, const cloth_real *mass, cloth_real far,
                               cloth_real change, cloth_real *out)
{
  cloth_real speed[CLOTH_CHUNK], energy[CLOTH_CHUNK];
  for (int k = 0; k < CLOTH_CHUNK; k++) {
    speed[k] = square[3 * k] + square[3 * k + 1] + square[3 * k + 2];
    energy[k] = mass[k] * speed[k] / 2;
  }
  cloth_fly_halve(speed, energy, 32), cloth_fly_halve(speed, energy, 16); // lengths are constants
  cloth_fly_halve(speed, energy, 8), cloth_fly_halve(speed, energy, 4);
  cloth_fly_halve(speed, energy, 2), cloth_fly_halve(speed, energy, 1);
  // comparisons lose a NaN, the sum does not
  out[CLOTH_COMMIT_WORST] = energy[0] - energy[0] == 0 ? far : energy[0] - energy[0];
  out[CLOTH_COMMIT_SPEED] = cloth_sqrt(speed[0]);
  out[CLOTH_COMMIT_ENERGY] = energy[0];
  out[CLOTH_COMMIT_CHANGE] = cloth_sqrt(change);
}

/// Square of the largest change of velocity in a chunk of which some vertices are held: they move.
CLOTH_FN cloth_real cloth_fly_hold(int begin, int lanes, const cloth_fly_chunk_args *a)
{
  cloth_real change = cloth_fly_change(a);
  for (int k = begin; k < begin + lanes; k++) {
    if (!cloth_fly_is_held(k, a)) continue;
    cloth_v3 x = cloth_fly_held(k, cloth_v3_load(a->x, k), a);
    cloth_v3 v =
        cloth_v3_scale(a->commit.inverse_step, cloth_v3_sub(x, cloth_v3_load(a->commit.x_t0, k)));
    cloth_v3 d = cloth_v3_sub(v, cloth_v3_load(a->commit.v, k));
    cloth_v3_store(a->x, k, x);
    change = cloth_larger(change, cloth_v3_dot(d, d));
  }
  return change;
}

CLOTH_FN void cloth_fly_lanes(int begin, int lanes, const cloth_fly_chunk_args *a, cloth_real *out)
{
  enum {
    N = 3 * CLOTH_CHUNK,
    BLOCK = 12
  }; // 12 numbers fill whole vector registers with whole rows
  const cloth_real *x_t0 = a->commit.x_t0 + 3 * begin, *v_t0 = a->commit.v + 3 * begin;
  const cloth_real *mass = a->commit.mass + begin;
  cloth_real *__restrict__ x = a->x + 3 * begin, *__restrict__ v = a->commit.v_next + 3 * begin;
  cloth_real g[BLOCK], square[N], padded[CLOTH_CHUNK], change = cloth_fly_change(a);
  cloth_real h = a->h, inverse_step = a->commit.inverse_step;
  int n = 3 * lanes, whole = n / BLOCK * BLOCK, held = 0;
  for (int k = 0; k < BLOCK; k++) g[k] = h * a->gravity[k % 3];
  for (int b = 0; b < whole; b += BLOCK)
    for (int k = 0; k < BLOCK; k++) x[b + k] = x_t0[b + k] + h * (v_t0[b + k] + g[k]);
  for (int k = whole; k < n; k++) x[k] = x_t0[k] + h * (v_t0[k] + g[k % 3]);
  if (a->free)
    for (int k = begin; k < begin + lanes; k++) held |= a->free[k] > 0 ? 0 : 1;
  if (held || a->hold_stiffness) change = cloth_fly_hold(begin, lanes, a);
  for (int k = 0; k < n; k++) {
    v[k] = inverse_step * (x[k] - x_t0[k]);
    square[k] = v[k] * v[k];
  }
  if (lanes < CLOTH_CHUNK) {
    for (int k = n; k < N; k++) square[k] = 0;
    for (int k = 0; k < CLOTH_CHUNK; k++) padded[k] = k < lanes ? mass[k] : 0;
    mass = padded;
  }
  cloth_fly_fields(square, mass, cloth_fly_far(x, lanes), change, out);
}

CLOTH_FN void cloth_fly_chunk(int i, const cloth_fly_chunk_args *a)
{
  int begin = i * CLOTH_CHUNK, lanes = cloth_chunk_end(0, a->commit.count, i) - begin;
  cloth_real *out = a->commit.out + CLOTH_COMMIT_FIELDS * i;
  if (lanes == CLOTH_CHUNK) // a length that compilers know
    cloth_fly_lanes(begin, CLOTH_CHUNK, a, out);
  else
    cloth_fly_lanes(begin, lanes, a, out);
}
