// Failsafe: if candidate i comes to an impact, its vertices may go only part of the way, measured
// from where the pair's carrier takes them: the lowest of those of its vertices, bodies included.
#pragma once

#include "atomic.h"
#include "carrier.h"
#include "impact.h"

// A corner with less weight in the point that meets is left to its own way but in the last passes:
// all around a vertex under a tip would be stopped with it.
#define CLOTH_LIMIT_LIGHT (cloth_real)0.1

// Vertices go this share of their way to the impact; not at all where that is this soon in the
// substep.
#define CLOTH_LIMIT_WAY  (cloth_real)0.8
#define CLOTH_LIMIT_SOON (cloth_real)0.05

typedef struct cloth_impact_limit_args {
  cloth_contact_scene scene;  // with carriers
  int stop;                   // 1: whatever is involved goes along with its carrier
  cloth_real gap;             // m, distance that counts as an impact
  const uint64_t *pair;       // [n]
  const unsigned char *moved; // [cloth vertices] only pairs with a vertex so marked; NULL: all
  uint32_t *allowed;          // [cloth vertices] of CLOTH_WHOLE, lowered
  uint32_t *claim;            // [cloth vertices] carrier, lowered
  uint32_t *count; // [2] impacts seen by this part, and those in which a vertex gives way
                   // that does not ride on the pair's carrier yet; count up
} cloth_impact_limit_args;

CLOTH_FN void cloth_impact_limit(int i, const cloth_impact_limit_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_contact_geometry g;
  cloth_real toi;
  if (cloth_impact(s, a->pair[i], a->gap, a->moved, &g, &toi) != CLOTH_IMPACT) return;
  cloth_real share = a->stop || !(toi > CLOTH_LIMIT_SOON) ? 0 : toi * CLOTH_LIMIT_WAY;
  uint32_t allowed = (uint32_t)(share * (cloth_real)CLOTH_WHOLE), lowest = CLOTH_RIDES;
  for (int k = 0; k < 4; k++) {
    uint32_t carrier = s->carrier[g.vertex[k]] & ~CLOTH_RIDES;
    lowest = carrier < lowest ? carrier : lowest;
  }
  if (!a->stop) cloth_contact_measure_at(s, toi, &g);
  int gives = 0;
  for (int k = 0; k < 4; k++) {
    int v = g.vertex[k];
    if (v >= s->cloth_vertices || !(s->free[v] > 0)) continue;
    gives |= s->carrier[v] != (lowest | CLOTH_RIDES);
    if (!a->stop && g.weight[k] * g.weight[k] < CLOTH_LIMIT_LIGHT * CLOTH_LIMIT_LIGHT) continue;
    cloth_atomic_min(a->allowed + v, allowed);
    cloth_atomic_min(a->claim + v, lowest);
  }
  cloth_atomic_add(a->count, 1);
  if (gives) cloth_atomic_add(a->count + 1, 1);
}
