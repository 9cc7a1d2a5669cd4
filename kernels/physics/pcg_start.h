// dx = p = 0, r = b on free rows, z = B r with the preconditioner's levels inside the chunk;
// partial r'z, r'r and r of chunk i.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_start_args {
  cloth_pcg_vectors v;
} cloth_pcg_start_args;

/// Vertex k: its r.
CLOTH_FN cloth_v3 cloth_pcg_start_row(int k, const cloth_pcg_vectors *v)
{
  cloth_v3 r = cloth_v3_scale(v->free[k], cloth_v3_load(v->b, k));
  cloth_v3_store(v->dx, k, cloth_v3_make(0, 0, 0));
  cloth_v3_store(v->r, k, r);
  cloth_v3_store(v->p, k, cloth_v3_make(0, 0, 0));
  return r;
}

CLOTH_FN void cloth_pcg_start(int i, const cloth_pcg_start_args *a)
{
  cloth_pcg_vectors v = a->v;
  cloth_pcg_chunk chunk;
  int begin = v.first + i * CLOTH_CHUNK, end = cloth_chunk_end(v.first, v.count, i);
  for (int lane = 0; lane < end - begin; lane++)
    cloth_pcg_chunk_set(&chunk, lane, cloth_pcg_start_row(begin + lane, &v));
  cloth_pcg_chunk_finish(&v, &chunk, begin, end);
}
