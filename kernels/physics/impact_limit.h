// Failsafe: if candidate i comes to an impact, its vertices may go only part of the way.
#pragma once

#include "atomic.h"
#include "impact.h"

typedef struct cloth_impact_limit_args {
  cloth_contact_scene scene;
  int stop;             // 1: whatever is involved stays where it was
  cloth_real gap;       // m, distance that counts as an impact
  const uint64_t *pair; // [n]
  uint32_t *allowed;    // [cloth vertices] of CLOTH_WHOLE, lowered
  uint32_t *count;      // [1] impacts seen by this part; counts up
} cloth_impact_limit_args;

CLOTH_FN void cloth_impact_limit(int i, const cloth_impact_limit_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_contact_geometry g;
  cloth_real toi;
  if (cloth_impact(s, a->pair[i], a->gap, 0, &g, &toi) != CLOTH_IMPACT) return;
  cloth_real share = a->stop || !(toi > (cloth_real)0.05) ? 0 : toi * (cloth_real)0.8;
  uint32_t allowed = (uint32_t)(share * (cloth_real)CLOTH_WHOLE);
  for (int k = 0; k < 4; k++)
    if (g.vertex[k] < s->cloth_vertices) cloth_atomic_min(a->allowed + g.vertex[k], allowed);
  cloth_atomic_add(a->count, 1);
}
