// p = z + beta p for chunk i.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_direction_args {
  cloth_pcg_vectors v;
} cloth_pcg_direction_args;

CLOTH_FN void cloth_pcg_direction(int i, const cloth_pcg_direction_args *a)
{
  const cloth_pcg_vectors *v = &a->v;
  if (v->scalar[CLOTH_PCG_DONE] > 0) return;
  cloth_real beta = v->scalar[CLOTH_PCG_BETA];
  int end = cloth_chunk_end(v->first, v->count, i);
  for (int k = v->first + i * CLOTH_CHUNK; k < end; k++)
    cloth_v3_store(v->p, k,
                   cloth_v3_add_scaled(cloth_v3_load(v->z, k), beta, cloth_v3_load(v->p, k)));
}
