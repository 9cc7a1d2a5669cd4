// List candidate i if it comes to an impact, with its time.
#pragma once

#include "atomic.h"
#include "impact.h"

typedef struct cloth_impact_find_args {
  cloth_contact_scene scene;
  cloth_real gap;             // m, distance that counts as an impact
  const unsigned char *moved; // [cloth vertices], see impact.h
  const uint64_t *pair;       // [n]
  uint64_t *key;              // [capacity], appended
  uint32_t *toi;              // [capacity] of CLOTH_WHOLE, at least 1; appended
  uint32_t capacity;
  uint32_t *count; // [1] counts up, also past the capacity
} cloth_impact_find_args;

CLOTH_FN void cloth_impact_find(int i, const cloth_impact_find_args *a)
{
  cloth_contact_geometry g;
  cloth_real toi;
  if (!cloth_impact(&a->scene, a->pair[i], a->gap, a->moved, &g, &toi)) return;
  uint32_t at = cloth_atomic_next(a->count);
  if (at >= a->capacity) return;
  a->key[at] = a->pair[i];
  uint32_t time = (uint32_t)(toi * (cloth_real)CLOTH_WHOLE); // rounded down: earlier
  a->toi[at] = time > 0 ? time : 1;                          // 0 is no impact, see contact_build.h
}
