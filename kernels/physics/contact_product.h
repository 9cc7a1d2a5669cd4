// What contacts of cloth with cloth add to A p, kept in factors instead of 16 blocks: q = tangent *
// sum w_b p_b, and row a adds weight_a q. That is written where the row will read it.
#pragma once

#include "block_rows.h"
#include "contact_entry.h"

typedef struct cloth_contact_product_args {
  int cloth_vertices;        // body vertices do not move in the solve
  int body_first;            // contact_entry.h: what is in the matrix is left out
  const int *vertex;         // [n x 4]
  const cloth_real *weight;  // [n x 4]
  const cloth_real *tangent; // [n x 6] N/m
  const cloth_real *p;       // [cloth vertices x 3]
  const uint32_t *place;     // [n x 4] contact_place.h
  const uint32_t *entry;     // [n x 4] by place: 4 contact + corner
  cloth_real *q;             // [n x 4 x 3] by place, written
} cloth_contact_product_args;

#ifdef CLOTH_ROW_VECTORS

// x y z side by side, as block_rows.h reads them: half the instructions, the same sums
CLOTH_FN void cloth_contact_product(int i, const cloth_contact_product_args *a)
{
  if (!cloth_contact_is_factored(a->vertex + 4 * i, a->body_first)) return;
  cloth_lanes4 u = {0};
  for (int c = 0; c < 4; c++) {
    int v = a->vertex[4 * i + c];
    if (v < a->cloth_vertices) u += a->weight[4 * i + c] * *(const cloth_lanes4 *)(a->p + 3 * v);
  }
  const cloth_real *t = a->tangent + 6 * i; // xx yy zz yz, zz yz zx xy
  cloth_lanes4 t0 = *(const cloth_lanes4 *)t, t1 = *(const cloth_lanes4 *)(t + 2);
  u = __builtin_shufflevector(t0, t1, 0, 7, 6, 0) * u[0] +
      __builtin_shufflevector(t0, t1, 7, 1, 3, 1) * u[1] +
      __builtin_shufflevector(t0, t1, 6, 3, 2, 2) * u[2];
  for (int c = 0; c < 4; c++) {
    cloth_lanes4 q = a->weight[4 * i + c] * u;
    cloth_v3_store(a->q, (int)a->place[4 * i + c], cloth_v3_make(q[0], q[1], q[2]));
  }
}

#else

/// What a contact pulls with at a weight of one: tangent * sum w_b p_b.
CLOTH_FN cloth_v3 cloth_contact_pull_of(const cloth_contact_product_args *a, const int *vertex,
                                        const cloth_real *weight, cloth_sym3 tangent)
{
  cloth_v3 u = cloth_v3_make(0, 0, 0), p[4];
  int in[4];
  for (int c = 0; c < 4; c++) { // all loads before the first sum, so that none waits for another
    in[c] = vertex[c] < a->cloth_vertices;
    p[c] = cloth_v3_load(a->p, in[c] ? vertex[c] : 0);
  }
  for (int c = 0; c < 4; c++) {
    cloth_v3 sum = cloth_v3_add_scaled(u, weight[c], p[c]);
    u = in[c] ? sum : u;
  }
  return cloth_sym3_mul(tangent, u);
}

CLOTH_FN cloth_v3 cloth_contact_pull(int i, const cloth_contact_product_args *a)
{
  return cloth_contact_pull_of(a, a->vertex + 4 * i, a->weight + 4 * i,
                               cloth_sym3_load(a->tangent, i));
}

CLOTH_FN void cloth_contact_product(int i, const cloth_contact_product_args *a)
{
  if (!cloth_contact_is_factored(a->vertex + 4 * i, a->body_first)) return;
  cloth_v3 u = cloth_contact_pull(i, a);
  for (int c = 0; c < 4; c++)
    cloth_v3_store(a->q, (int)a->place[4 * i + c], cloth_v3_scale(a->weight[4 * i + c], u));
}

#endif
