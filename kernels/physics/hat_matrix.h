// The block of node i of the first level: P' A P, summed over the vertices that share in it. For
// the other levels it is kept in two parts, what holds it in space and what holds it against its
// neighbours. What the vertices' rows add is read where it lies, on other parts too.
#pragma once

#include "halo_contact.h"
#include "hat.h"

typedef struct cloth_hat_matrix_args {
  cloth_hats hats;                           // inverse is written
  int first;                                 // node 0 of this launch
  int parts;                                 // whose blocks are read
  int cut[CLOTH_HALO_PARTS + 1];             // vertices [cut[j], cut[j + 1]) are in block[j]
  const cloth_real *block[CLOTH_HALO_PARTS]; // [vertices x 5 x 6] N/m, hat_row.h
  cloth_real *part;                          // [fine x 2 x 6] N/m: neighbours, space; written
} cloth_hat_matrix_args;

CLOTH_FN void cloth_hat_matrix(int node, const cloth_hat_matrix_args *a)
{
  const cloth_hats *h = &a->hats;
  int i = a->first + node;
  cloth_real near[6], space[6];
  cloth_sym3 m = cloth_sym3_axis(0, 0, cloth_v3_make(0, 0, 0));
  for (int e = 0; e < 6; e++) near[e] = space[e] = 0;
  for (int n = h->first[i]; n < h->first[i + 1]; n++) {
    int v = h->child[n], k = 0;
    cloth_real w = h->child_weight[n];
    while (k < CLOTH_HAT_CORNERS - 1 && h->corner[CLOTH_HAT_CORNERS * v + k] != i) k++;
    const cloth_real *block =
        a->block[cloth_part_of(a->cut, a->parts, v)] + (int64_t)v * 6 * (CLOTH_HAT_CORNERS + 1);
    m = cloth_sym3_add(m, cloth_sym3_load(block, k));
    for (int e = 0; e < 6; e++) {
      cloth_real held = block[6 * CLOTH_HAT_CORNERS + e];
      near[e] += block[6 * k + e] - w * w * held, space[e] += w * held;
    }
  }
  for (int e = 0; e < 6; e++) a->part[12 * i + e] = near[e], a->part[12 * i + 6 + e] = space[e];
  cloth_sym3_store(h->inverse, i, cloth_hat_inverse(m));
}
