// r = b - q with q = A dx: the true residual. Its free rows are the error of the solve, by chunks:
// r'r in field 0 of partial, its length squared in field 1. Its held rows are minus the force that
// the hold exerts.
//
// The residual as a length, |D^-1 r| with the diagonal blocks D: how far a vertex is from where its
// own row of the system would have it, the others standing still. The residual itself is a force;
// what it does depends on what bears it, and 100 N that are nothing beside a contact's 100 kN move
// a free vertex of 0.1 g by metres.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_residual_args {
  cloth_pcg_vectors v;
} cloth_pcg_residual_args;

/// Vertex k; its share of r'r, and the length of its residual squared [m^2]: NaN if it is.
CLOTH_FN cloth_real cloth_pcg_residual_row(int k, const cloth_pcg_vectors *v, cloth_real *length_sq)
{
  cloth_v3 r = cloth_v3_sub(cloth_v3_load(v->b, k), cloth_v3_load(v->q, k));
  cloth_v3 z = cloth_pcg_z(k, v, r);
  cloth_v3_store(v->r, k, r);
  *length_sq = cloth_v3_dot(z, z);
  return v->free[k] * cloth_v3_dot(r, r);
}

CLOTH_FN void cloth_pcg_residual(int i, const cloth_pcg_residual_args *a)
{
  const cloth_pcg_vectors *v = &a->v;
  cloth_real rr[CLOTH_CHUNK], largest = 0, length_sq;
  int begin = v->first + i * CLOTH_CHUNK, end = cloth_chunk_end(v->first, v->count, i);
  for (int lane = 0; lane < CLOTH_CHUNK; lane++) {
    rr[lane] = 0;
    if (begin + lane >= end) continue;
    rr[lane] = cloth_pcg_residual_row(begin + lane, v, &length_sq);
    largest = cloth_larger(largest, length_sq);
  }
  cloth_real *partial = v->partial + CLOTH_PCG_PARTIALS * (begin / CLOTH_CHUNK);
  partial[0] = cloth_chunk_sum(rr), partial[1] = largest;
}
