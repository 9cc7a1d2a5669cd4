// r = b - q with q = A dx: the true residual. Its free rows are the error of the solve (partial r'r
// in field 0); its held rows are minus the force that the hold exerts.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_residual_args {
  cloth_pcg_vectors v;
} cloth_pcg_residual_args;

/// Vertex k, and its share of r'r.
CLOTH_FN cloth_real cloth_pcg_residual_row(int k, const cloth_pcg_vectors *v)
{
  cloth_v3 r = cloth_v3_sub(cloth_v3_load(v->b, k), cloth_v3_load(v->q, k));
  cloth_v3_store(v->r, k, r);
  return v->free[k] * cloth_v3_dot(r, r);
}

CLOTH_FN void cloth_pcg_residual(int i, const cloth_pcg_residual_args *a)
{
  const cloth_pcg_vectors *v = &a->v;
  cloth_real rr[CLOTH_CHUNK];
  int begin = v->first + i * CLOTH_CHUNK, end = cloth_chunk_end(v->first, v->count, i);
  for (int lane = 0; lane < CLOTH_CHUNK; lane++)
    rr[lane] = begin + lane < end ? cloth_pcg_residual_row(begin + lane, v) : 0;
  v->partial[CLOTH_PCG_PARTIALS * (begin / CLOTH_CHUNK)] = cloth_chunk_sum(rr);
}
