// List candidate i if it comes to an impact, with its time, or if it passes through and nothing in
// it gives way.
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
  uint64_t *driven; // [driven_capacity] keys of pairs in which nothing gives way, appended
  uint32_t driven_capacity;
  uint32_t *count; // [2] impacts, driven pairs; count up, also past the capacities
} cloth_impact_find_args;

CLOTH_FN void cloth_impact_list_driven(const cloth_impact_find_args *a, uint64_t key)
{
  uint32_t at = cloth_atomic_add(a->count + 1, 1);
  if (at < a->driven_capacity) a->driven[at] = key;
}

CLOTH_FN void cloth_impact_find(int i, const cloth_impact_find_args *a)
{
  cloth_contact_geometry g;
  cloth_real toi;
  int impact = cloth_impact(&a->scene, a->pair[i], a->gap, a->moved, &g, &toi);
  if (impact == CLOTH_IMPACT_DRIVEN) cloth_impact_list_driven(a, a->pair[i]);
  if (impact != CLOTH_IMPACT) return;
  uint32_t at = cloth_atomic_next(a->count);
  if (at >= a->capacity) return;
  a->key[at] = a->pair[i];
  uint32_t time = (uint32_t)(toi * (cloth_real)CLOTH_WHOLE); // rounded down: earlier
  a->toi[at] = time > 0 ? time : 1;                          // 0 is no impact, see contact_build.h
}
