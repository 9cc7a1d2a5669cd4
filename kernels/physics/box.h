// Axis-aligned boxes, rows of a [n x 6] array: lo x y z, hi x y z.
#pragma once

#include "real.h"

typedef struct cloth_box {
  cloth_v3 lo, hi;
} cloth_box;

CLOTH_FN cloth_box cloth_box_load(const cloth_real *a, int i)
{
  cloth_box b;
#ifdef __CUDA_ARCH__
  cloth_real v[6];
  for (int k = 0; k < 3; k++) cloth_load2(a + 6 * i + 2 * k, v + 2 * k);
  b.lo = cloth_v3_make(v[0], v[1], v[2]), b.hi = cloth_v3_make(v[3], v[4], v[5]);
#else
  b.lo = cloth_v3_load(a, 2 * i), b.hi = cloth_v3_load(a, 2 * i + 1);
#endif
  return b;
}

CLOTH_FN void cloth_box_store(cloth_real *a, int i, cloth_box b)
{
  cloth_v3_store(a, 2 * i, b.lo), cloth_v3_store(a, 2 * i + 1, b.hi);
}

CLOTH_FN cloth_v3 cloth_v3_min(cloth_v3 a, cloth_v3 b)
{
  return cloth_v3_make(a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z);
}

CLOTH_FN cloth_v3 cloth_v3_max(cloth_v3 a, cloth_v3 b)
{
  return cloth_v3_make(a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z);
}

CLOTH_FN cloth_box cloth_box_union(cloth_box a, cloth_box b)
{
  a.lo = cloth_v3_min(a.lo, b.lo), a.hi = cloth_v3_max(a.hi, b.hi);
  return a;
}

/// Are they closer than gap in every axis?
CLOTH_FN int cloth_box_near(cloth_box a, cloth_box b, cloth_real gap)
{
  return a.lo.x <= b.hi.x + gap && b.lo.x <= a.hi.x + gap && a.lo.y <= b.hi.y + gap &&
         b.lo.y <= a.hi.y + gap && a.lo.z <= b.hi.z + gap && b.lo.z <= a.hi.z + gap;
}

CLOTH_FN int cloth_box_holds(cloth_box b, cloth_v3 p)
{
  return p.x >= b.lo.x && p.x <= b.hi.x && p.y >= b.lo.y && p.y <= b.hi.y && p.z >= b.lo.z &&
         p.z <= b.hi.z;
}

/// The box of a vertex that moves from a to b.
CLOTH_FN cloth_box cloth_box_swept(cloth_v3 a, cloth_v3 b, cloth_real inflate)
{
  cloth_v3 r = cloth_v3_make(inflate, inflate, inflate);
  cloth_box box;
  box.lo = cloth_v3_sub(cloth_v3_min(a, b), r), box.hi = cloth_v3_add(cloth_v3_max(a, b), r);
  return box;
}
