// The bin of particle i.
#pragma once

#include "bin.h"

typedef struct cloth_bin_key_args {
  cloth_bins bins;
  const cloth_real *x; // [n x 3] m
  uint64_t *key;       // [n], written: place in the table
  uint32_t *particle;  // [n], written: i
} cloth_bin_key_args;

CLOTH_FN void cloth_bin_key(int i, const cloth_bin_key_args *a)
{
  cloth_bin c = cloth_bin_of(&a->bins, cloth_v3_load(a->x, i));
  a->key[i] = cloth_bin_place(&a->bins, c.x, c.y, c.z);
  a->particle[i] = (uint32_t)i;
}
