// dx += alpha p, r -= alpha q on free rows, z = B r with the preconditioner's levels inside the
// chunk; partial r'z, r'r and r of chunk i.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_update_args {
  cloth_pcg_vectors v;
} cloth_pcg_update_args;

/// r of vertex k after a step along p.
CLOTH_FN cloth_v3 cloth_pcg_residual_step(int k, const cloth_pcg_vectors *v, cloth_real alpha)
{
  return cloth_v3_add_scaled(cloth_v3_load(v->r, k), -alpha * v->free[k], cloth_v3_load(v->q, k));
}

/// Vertex k: its dx, its r.
CLOTH_FN cloth_v3 cloth_pcg_update_row(int k, const cloth_pcg_vectors *v, cloth_real alpha)
{
  cloth_v3_store(v->dx, k,
                 cloth_v3_add_scaled(cloth_v3_load(v->dx, k), alpha, cloth_v3_load(v->p, k)));
  cloth_v3 r = cloth_pcg_residual_step(k, v, alpha);
  cloth_v3_store(v->r, k, r);
  return r;
}

CLOTH_FN void cloth_pcg_update(int i, const cloth_pcg_update_args *a)
{
  cloth_pcg_vectors v = a->v; // a copy: no store can change where the arrays are
  if (v.scalar[CLOTH_PCG_DONE] > 0) return;
  cloth_pcg_chunk chunk;
  cloth_real alpha = v.scalar[CLOTH_PCG_ALPHA];
  int begin = v.first + i * CLOTH_CHUNK, end = cloth_chunk_end(v.first, v.count, i);
  for (int lane = 0; lane < end - begin; lane++)
    cloth_pcg_chunk_set(&chunk, lane, cloth_pcg_update_row(begin + lane, &v, alpha));
  cloth_pcg_chunk_finish(&v, &chunk, begin, end);
}
