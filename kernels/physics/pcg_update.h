// dx += alpha p, r -= alpha q on free rows, z = D^-1 r; partial r'z, r'r and r of chunk i.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_update_args {
  cloth_pcg_vectors v;
} cloth_pcg_update_args;

CLOTH_FN void cloth_pcg_update(int i, const cloth_pcg_update_args *a)
{
  const cloth_pcg_vectors *v = &a->v;
  cloth_real alpha = v->scalar[CLOTH_PCG_ALPHA], rz = 0, rr = 0;
  cloth_v3 sum = cloth_v3_make(0, 0, 0);
  int end = cloth_chunk_end(v->first, v->count, i);
  for (int k = v->first + i * CLOTH_CHUNK; k < end; k++) {
    cloth_v3_store(v->dx, k,
                   cloth_v3_add_scaled(cloth_v3_load(v->dx, k), alpha, cloth_v3_load(v->p, k)));
    cloth_v3 r =
        cloth_v3_add_scaled(cloth_v3_load(v->r, k), -alpha * v->free[k], cloth_v3_load(v->q, k));
    cloth_v3 z =
        cloth_v3_scale(v->free[k], cloth_sym3_mul(cloth_sym3_load(v->inverse_diagonal, k), r));
    cloth_v3_store(v->r, k, r);
    cloth_v3_store(v->z, k, z);
    sum = cloth_v3_add(sum, r);
    rz += cloth_v3_dot(r, z), rr += cloth_v3_dot(r, r);
  }
  cloth_real *partial = v->partial + CLOTH_PCG_PARTIALS * (v->first / CLOTH_CHUNK + i);
  partial[0] = rz, partial[1] = rr, partial[2] = sum.x, partial[3] = sum.y, partial[4] = sum.z;
}
