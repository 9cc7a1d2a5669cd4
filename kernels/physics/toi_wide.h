// Pairs of doubles (about 31 digits), for the close calls of toi_close.h.
//
// Sources: T. Dekker, A floating-point technique for extending the available precision, 1971; D.
// Knuth, The Art of Computer Programming 2, 4.2.2 (exact sum); Y. Hida, X. Li, D. Bailey, Library
// for double-double and quad-double arithmetic, 2007.
#pragma once

#include "real.h"

/// hi + lo, lo at most half a last digit of hi.
typedef struct cloth_toi_wide {
  double hi, lo;
} cloth_toi_wide;

typedef struct cloth_toi_wide3 {
  cloth_toi_wide x, y, z;
} cloth_toi_wide3;

// 2^-104, bounds the error of each operation below
#define CLOTH_TOI_WIDE_EPSILON 4.9303806576313238e-32

// exact a + b
CLOTH_FN cloth_toi_wide cloth_toi_wide_sum(double a, double b)
{
  cloth_toi_wide s;
  s.hi = a + b;
  double part = s.hi - a;
  s.lo = (a - (s.hi - part)) + (b - part);
  return s;
}

// exact a * b; nvcc must not fuse this product into a later sum
CLOTH_FN cloth_toi_wide cloth_toi_wide_product(double a, double b)
{
  cloth_toi_wide p;
#ifdef __CUDA_ARCH__
  p.hi = __dmul_rn(a, b);
#else
  p.hi = a * b;
#endif
  p.lo = fma(a, b, -p.hi);
  return p;
}

CLOTH_FN cloth_toi_wide cloth_toi_wide_add(cloth_toi_wide a, cloth_toi_wide b)
{
  cloth_toi_wide s = cloth_toi_wide_sum(a.hi, b.hi), t = cloth_toi_wide_sum(a.lo, b.lo);
  s = cloth_toi_wide_sum(s.hi, s.lo + t.hi);
  return cloth_toi_wide_sum(s.hi, s.lo + t.lo);
}

CLOTH_FN cloth_toi_wide cloth_toi_wide_negate(cloth_toi_wide a)
{
  a.hi = -a.hi, a.lo = -a.lo;
  return a;
}

CLOTH_FN cloth_toi_wide cloth_toi_wide_sub(cloth_toi_wide a, cloth_toi_wide b)
{
  return cloth_toi_wide_add(a, cloth_toi_wide_negate(b));
}

CLOTH_FN cloth_toi_wide cloth_toi_wide_mul(cloth_toi_wide a, cloth_toi_wide b)
{
  cloth_toi_wide p = cloth_toi_wide_product(a.hi, b.hi);
  cloth_toi_wide q = cloth_toi_wide_product(a.hi, b.lo), r = cloth_toi_wide_product(a.lo, b.hi);
  return cloth_toi_wide_sum(p.hi, p.lo + (q.hi + r.hi));
}

CLOTH_FN cloth_toi_wide cloth_toi_wide_div(cloth_toi_wide a, cloth_toi_wide b)
{
  cloth_toi_wide q = cloth_toi_wide_sum(a.hi / b.hi, 0);
  for (int k = 0; k < 2; k++) {
    cloth_toi_wide rest = cloth_toi_wide_sub(a, cloth_toi_wide_mul(q, b));
    q = cloth_toi_wide_add(q, cloth_toi_wide_sum(rest.hi / b.hi, 0));
  }
  return q;
}

// a - b of given coordinates, exact
CLOTH_FN cloth_toi_wide3 cloth_toi_wide3_between(cloth_v3 a, cloth_v3 b)
{
  cloth_toi_wide3 d;
  d.x = cloth_toi_wide_sum(a.x, -b.x);
  d.y = cloth_toi_wide_sum(a.y, -b.y);
  d.z = cloth_toi_wide_sum(a.z, -b.z);
  return d;
}

CLOTH_FN cloth_toi_wide3 cloth_toi_wide3_sub(cloth_toi_wide3 a, cloth_toi_wide3 b)
{
  a.x = cloth_toi_wide_sub(a.x, b.x);
  a.y = cloth_toi_wide_sub(a.y, b.y);
  a.z = cloth_toi_wide_sub(a.z, b.z);
  return a;
}

// a + s b
CLOTH_FN cloth_toi_wide3 cloth_toi_wide3_add_scaled(cloth_toi_wide3 a, cloth_toi_wide s,
                                                    cloth_toi_wide3 b)
{
  a.x = cloth_toi_wide_add(a.x, cloth_toi_wide_mul(s, b.x));
  a.y = cloth_toi_wide_add(a.y, cloth_toi_wide_mul(s, b.y));
  a.z = cloth_toi_wide_add(a.z, cloth_toi_wide_mul(s, b.z));
  return a;
}

CLOTH_FN cloth_toi_wide cloth_toi_wide3_dot(cloth_toi_wide3 a, cloth_toi_wide3 b)
{
  cloth_toi_wide s = cloth_toi_wide_add(cloth_toi_wide_mul(a.x, b.x), cloth_toi_wide_mul(a.y, b.y));
  return cloth_toi_wide_add(s, cloth_toi_wide_mul(a.z, b.z));
}

CLOTH_FN cloth_toi_wide3 cloth_toi_wide3_cross(cloth_toi_wide3 a, cloth_toi_wide3 b)
{
  cloth_toi_wide3 c;
  c.x = cloth_toi_wide_sub(cloth_toi_wide_mul(a.y, b.z), cloth_toi_wide_mul(a.z, b.y));
  c.y = cloth_toi_wide_sub(cloth_toi_wide_mul(a.z, b.x), cloth_toi_wide_mul(a.x, b.z));
  c.z = cloth_toi_wide_sub(cloth_toi_wide_mul(a.x, b.y), cloth_toi_wide_mul(a.y, b.x));
  return c;
}

// the largest of |coordinate| and `most`
CLOTH_FN double cloth_toi_wide3_largest(cloth_toi_wide3 v, double most)
{
  return fmax(most, fmax(fmax(fabs(v.x.hi), fabs(v.y.hi)), fabs(v.z.hi)));
}
