// Vertex i before the failsafe holds anything back: what is driven rides on the motion that drives
// it, free cloth is the world's.
#pragma once

#include "carrier.h"

typedef struct cloth_carrier_start_args {
  int cloth_vertices;
  uint32_t world;          // number of carriers
  const cloth_real *free;  // [cloth vertices] 0: held rigidly
  const int *grasp_of;     // [cloth vertices] 0: none, else 1 + hold
  const int *body_of;      // [body vertices]
  const uint32_t *of_hold; // [holds] carrier
  const uint32_t *of_body; // [bodies] carrier
  uint32_t *carrier;       // [vertices] carrier, with CLOTH_RIDES; written
  uint32_t *claim;         // [cloth vertices] written
} cloth_carrier_start_args;

CLOTH_FN void cloth_carrier_start(int i, const cloth_carrier_start_args *a)
{
  if (i >= a->cloth_vertices) {
    a->carrier[i] = a->of_body[a->body_of[i - a->cloth_vertices]] | CLOTH_RIDES;
    return;
  }
  int held = !(a->free[i] > 0) && a->grasp_of[i] > 0;
  a->carrier[i] = held ? a->of_hold[a->grasp_of[i] - 1] | CLOTH_RIDES : a->world;
  a->claim[i] = a->world;
}
