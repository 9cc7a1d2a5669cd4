// What row i of A adds to the blocks of its four nodes of the first level, and the row's sum: what
// holds it in space (inertia, bodies), not against its neighbours.
#pragma once

#include "block_rows.h"
#include "hat.h"

typedef struct cloth_hat_row_args {
  cloth_block_rows rows; // of this part
  int first;             // first owned vertex
  int cloth_vertices;
  const cloth_real *place;           // [cloth vertices x 3] hat.h
  const cloth_real *free;            // [cloth vertices]
  const uint32_t *contact_first;     // [2 rows + 1] contact_row.h; NULL: no contacts
  const uint32_t *contact_entry;     // [entries] 4 contact + corner
  const int *contact_vertex;         // [contacts x 4]
  const cloth_real *contact_weight;  // [contacts x 4]
  const cloth_real *contact_tangent; // [contacts x 6] N/m
  cloth_real *block;                 // [cloth vertices x 5 x 6] N/m: four nodes, the sum; written
} cloth_hat_row_args;

CLOTH_FN void cloth_hat_add(cloth_real *to, cloth_real s, cloth_sym3 m)
{
  to[0] += s * m.xx, to[1] += s * m.yy, to[2] += s * m.zz;
  to[3] += s * m.yz, to[4] += s * m.zx, to[5] += s * m.xy;
}

// a block that couples the row to vertex v, added to the five sums
CLOTH_FN void cloth_hat_couple(const cloth_hat_row_args *a, cloth_v3 u, const cloth_v3 *node, int v,
                               cloth_real scale, cloth_sym3 m, cloth_real *sum)
{
  cloth_v3 at = cloth_v3_load(a->place, v);
  scale *= a->free[v];
  for (int k = 0; k < CLOTH_HAT_CORNERS; k++)
    cloth_hat_add(sum + 6 * k, scale * cloth_hat_at(at, node[k]), m);
  if (cloth_hat_near(u, at)) cloth_hat_add(sum + 6 * CLOTH_HAT_CORNERS, scale, m);
}

CLOTH_FN void cloth_hat_row(int i, const cloth_hat_row_args *a)
{
  const int g = CLOTH_ROW_GROUP;
  int group = i / g, lane = i % g, at = a->first + i;
  cloth_v3 u = cloth_v3_load(a->place, at), node[CLOTH_HAT_CORNERS];
  cloth_real sum[6 * (CLOTH_HAT_CORNERS + 1)];
  for (int k = 0; k < CLOTH_HAT_CORNERS; k++) node[k] = cloth_hat_corner(u, k);
  for (int e = 0; e < 6 * (CLOTH_HAT_CORNERS + 1); e++) sum[e] = 0;
  for (int s = a->rows.first[group]; s < a->rows.first[group + 1]; s++) {
    const cloth_real *b = a->rows.val + (int64_t)s * 9 * g + lane;
    cloth_sym3 m;
    m.xx = b[0], m.yy = b[4 * g], m.zz = b[8 * g];
    m.yz = (b[5 * g] + b[7 * g]) / 2, m.zx = (b[2 * g] + b[6 * g]) / 2,
    m.xy = (b[g] + b[3 * g]) / 2;
    cloth_hat_couple(a, u, node, a->rows.col[(int64_t)s * g + lane], 1, m, sum);
  }
  uint32_t begin = a->contact_first ? a->contact_first[2 * i + 1] : 0;
  uint32_t end = a->contact_first ? a->contact_first[2 * i + 2] : 0;
  for (uint32_t n = begin; n < end; n++) {
    int corner = (int)a->contact_entry[n], contact = corner / 4;
    cloth_sym3 m = cloth_sym3_load(a->contact_tangent, contact);
    for (int k = 0; k < 4; k++) {
      int v = a->contact_vertex[4 * contact + k];
      if (v < a->cloth_vertices)
        cloth_hat_couple(a, u, node, v,
                         a->contact_weight[corner] * a->contact_weight[4 * contact + k], m, sum);
    }
  }
  cloth_real *to = a->block + (int64_t)at * 6 * (CLOTH_HAT_CORNERS + 1);
  for (int k = 0; k <= CLOTH_HAT_CORNERS; k++) {
    cloth_real w = a->free[at] * (k < CLOTH_HAT_CORNERS ? cloth_hat_at(u, node[k]) : 1);
    for (int e = 0; e < 6; e++) to[6 * k + e] = w * sum[6 * k + e];
  }
}
