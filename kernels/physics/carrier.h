// Carriers: what the failsafe holds cloth back against (src/ccd/failsafe.c). A carrier is a rigid
// motion over the substep, that of a moving body or of a moving hold; what nothing moves is carried
// by the world. A vertex that is stopped on a carrier goes rigidly along with it, from x_t0 on.
#pragma once

#include "real.h"

#define CLOTH_RIDES 0x80000000u // of a vertex's carrier: it is stopped on it

typedef struct cloth_carriers {
  uint32_t count;           // carriers; the world is number `count`
  const cloth_real *motion; // [count x 15] see cloth_carried()
} cloth_carriers;

/// Where what starts at x [m] ends if it rides on carrier c. motion: the rotation less the unit
/// matrix, row by row, a point of the carrier at the start [m], and how far that point goes [m]:
/// what is added to x is small, so its rounding is that of x.
CLOTH_FN cloth_v3 cloth_carried(const cloth_carriers *s, uint32_t c, cloth_v3 x)
{
  if (c >= s->count) return x;
  const cloth_real *m = s->motion + 15 * c;
  cloth_v3 r = cloth_v3_sub(x, cloth_v3_load(m, 3));
  cloth_v3 turned =
      cloth_v3_make(m[0] * r.x + m[1] * r.y + m[2] * r.z, m[3] * r.x + m[4] * r.y + m[5] * r.z,
                    m[6] * r.x + m[7] * r.y + m[8] * r.z);
  return cloth_v3_add(x, cloth_v3_add(turned, cloth_v3_load(m, 4)));
}
