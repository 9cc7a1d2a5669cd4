// What a solve leaves, as a length: how far a vertex of chunk i is from where its own row of the
// system would have it, the others standing still. The residual says how large the forces are that
// are left; what they do depends on what bears them, and 100 N that are nothing beside a contact's
// 100 kN move a free vertex of 0.1 g by metres.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_left_args {
  cloth_pcg_vectors v; // r: the true residual
  cloth_real *largest; // [chunks] m, of own chunks, written; NaN if any is
} cloth_pcg_left_args;

CLOTH_FN void cloth_pcg_left(int i, const cloth_pcg_left_args *a)
{
  const cloth_pcg_vectors *v = &a->v;
  cloth_real largest = 0;
  int begin = v->first + i * CLOTH_CHUNK, end = cloth_chunk_end(v->first, v->count, i);
  for (int k = begin; k < end; k++)
    largest = cloth_larger(largest, cloth_v3_length(cloth_pcg_z(k, v, cloth_v3_load(v->r, k))));
  a->largest[begin / CLOTH_CHUNK] = largest;
}
