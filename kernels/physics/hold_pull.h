// Force [N] by which held vertex number i is held, where no other vertex pulls at it (fly_chunk.h).
#pragma once

#include "fly_chunk.h"

typedef struct cloth_hold_pull_args {
  cloth_fly_chunk_args fly;
  const int *vertex; // [n]
  cloth_real *pull;  // [n x 3] N, written
} cloth_hold_pull_args;

CLOTH_FN void cloth_hold_pull(int i, const cloth_hold_pull_args *a)
{
  int k = a->vertex[i];
  cloth_v3 aim = cloth_v3_load(a->fly.target, k), x = cloth_fly_freely(k, &a->fly);
  cloth_real m = a->fly.commit.mass[k] * a->fly.commit.inverse_step * a->fly.commit.inverse_step;
  if (a->fly.free[k] > 0) // a spring
    x = cloth_fly_held(k, x, &a->fly), m = a->fly.hold_stiffness[k];
  cloth_v3_store(a->pull, i, cloth_v3_scale(m, cloth_v3_sub(aim, x)));
}
