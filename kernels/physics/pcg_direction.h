// p = z + beta p for chunk i, where z is block Jacobi's plus the correction of the chunk's
// aggregate.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_direction_args {
  cloth_pcg_vectors v;
} cloth_pcg_direction_args;

/// Vertex k with the correction of the coarser levels.
CLOTH_FN void cloth_pcg_direction_row(int k, const cloth_pcg_vectors *v, cloth_real beta,
                                      cloth_v3 coarse)
{
  cloth_v3 z = cloth_v3_add_scaled(cloth_v3_load(v->z, k), v->free[k], coarse);
  cloth_v3_store(v->p, k, cloth_v3_add_scaled(z, beta, cloth_v3_load(v->p, k)));
}

/// What the coarser levels add to vertex k; 0 without them.
CLOTH_FN cloth_v3 cloth_pcg_coarse_of(int k, const cloth_pcg_vectors *v)
{
  if (v->hats.nodes > 0) return cloth_hat_of(&v->hats, k);
  if (!v->coarse) return cloth_v3_make(0, 0, 0);
  return cloth_v3_load(v->coarse, cloth_aggregate_of(k, v->chunks, v->aggregates));
}

CLOTH_FN void cloth_pcg_direction(int i, const cloth_pcg_direction_args *a)
{
  cloth_pcg_vectors v = a->v;
  if (v.scalar[CLOTH_PCG_DONE] > 0) return;
  int begin = v.first + i * CLOTH_CHUNK, end = cloth_chunk_end(v.first, v.count, i);
  cloth_real beta = v.scalar[CLOTH_PCG_BETA];
  for (int k = begin; k < end; k++)
    cloth_pcg_direction_row(k, &v, beta, cloth_pcg_coarse_of(k, &v));
}
