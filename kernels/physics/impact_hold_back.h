// Vertex i goes only as far as its impacts allow, as seen from its carrier.
#pragma once

#include "carrier.h"
#include "contact_geometry.h"

typedef struct cloth_impact_hold_back_args {
  int first;      // vertex of element 0
  uint32_t world; // number of carriers
  cloth_carriers carriers;
  const cloth_real *x_t0; // [vertices x 3] m
  const cloth_real *free; // [vertices] 0: held rigidly, stays on its way
  uint32_t *allowed;      // [vertices] of CLOTH_WHOLE; reset to the whole way
  uint32_t *claim;        // [vertices] carrier; reset to the world
  uint32_t *carrier;      // [vertices] with CLOTH_RIDES; lowered to the claim
  cloth_real *x;          // [vertices x 3] m
  unsigned char *moved;   // [vertices] written: 1 where an impact asked for less than the whole way
} cloth_impact_hold_back_args;

CLOTH_FN void cloth_impact_hold_back(int i, const cloth_impact_hold_back_args *a)
{
  int v = a->first + i;
  uint32_t allowed = a->allowed[v], claim = a->claim[v], before = a->carrier[v];
  a->allowed[v] = CLOTH_WHOLE;
  a->claim[v] = a->world;
  a->moved[v] = allowed < CLOTH_WHOLE;
  if (allowed >= CLOTH_WHOLE || !(a->free[v] > 0)) return;
  uint32_t carrier = before & ~CLOTH_RIDES;
  if (claim < carrier) carrier = claim;
  if (before == (carrier | CLOTH_RIDES)) return;
  cloth_v3 ride = cloth_carried(&a->carriers, carrier, cloth_v3_load(a->x_t0, v));
  cloth_real share = (cloth_real)allowed / (cloth_real)CLOTH_WHOLE;
  cloth_v3 way = cloth_v3_sub(cloth_v3_load(a->x, v), ride);
  cloth_v3_store(a->x, v, allowed > 0 ? cloth_v3_add_scaled(ride, share, way) : ride);
  a->carrier[v] = allowed > 0 ? carrier : carrier | CLOTH_RIDES;
}
