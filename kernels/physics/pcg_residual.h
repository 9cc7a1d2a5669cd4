// r = b - q with q = A dx: the true residual. Its free rows are the error of the solve (partial r'r
// in field 0); its held rows are minus the force that the hold exerts.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_residual_args {
  cloth_pcg_vectors v;
} cloth_pcg_residual_args;

CLOTH_FN void cloth_pcg_residual(int i, const cloth_pcg_residual_args *a)
{
  const cloth_pcg_vectors *v = &a->v;
  cloth_real rr = 0;
  int end = cloth_chunk_end(v->first, v->count, i);
  for (int k = v->first + i * CLOTH_CHUNK; k < end; k++) {
    cloth_v3 r = cloth_v3_sub(cloth_v3_load(v->b, k), cloth_v3_load(v->q, k));
    cloth_v3_store(v->r, k, r);
    rr += v->free[k] * cloth_v3_dot(r, r);
  }
  v->partial[CLOTH_PCG_PARTIALS * (v->first / CLOTH_CHUNK + i)] = rr;
}
