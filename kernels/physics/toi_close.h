// The close calls of toi.h, decided in pairs of doubles (about 31 digits).
//
// Two features that pass each other at 1e-17 m cannot be told from two that meet in double. Here
// the same search with separating planes is taken up where that one stopped, for contact itself
// (level 0), with every coordinate taken as exactly what it is. It costs some hundred times as
// much, so features that plainly pass through each other are seen beforehand; toi.h calls it only
// in double and only when its answer would be yes. In float the coordinates themselves are not that
// good.
//
// Sources: T. Dekker, A floating-point technique for
// extending the available precision, 1971; D. Knuth, The Art of Computer Programming 2, 4.2.2
// (exact sum); Y. Hida, X. Li, D. Bailey, Library for double-double and quad-double arithmetic,
// 2007.
#pragma once

#include "real.h"

/// hi + lo, lo at most half a last digit of hi.
typedef struct cloth_toi_wide {
  double hi, lo;
} cloth_toi_wide;

typedef struct cloth_toi_wide3 {
  cloth_toi_wide x, y, z;
} cloth_toi_wide3;

#define CLOTH_TOI_WIDE_EPSILON                                                                     \
  4.9303806576313238e-32 // 2^-104, bounds the error of each operation below
#define CLOTH_TOI_WIDE_ITERATIONS 64

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

// How long the plane with normal n keeps points before `split` and the rest at least `error` apart;
// 0 if it does not, 2 if for ever. Either direction of n, any length.
CLOTH_FN cloth_toi_wide cloth_toi_close_time(const cloth_toi_wide3 x[4],
                                             const cloth_toi_wide3 rate[4], int split,
                                             cloth_toi_wide3 n, double error)
{
  cloth_toi_wide none = {0, 0}, time = {2, 0}, floor = {error, 0}, scale = {0, 0};
  double length = sqrt(n.x.hi * n.x.hi + n.y.hi * n.y.hi + n.z.hi * n.z.hi);
  if (!(length > 0)) return none;
  cloth_toi_wide towards = cloth_toi_wide3_dot(n, cloth_toi_wide3_sub(x[split], x[0]));
  scale.hi = (towards.hi < 0 ? -1 : 1) / length;
  n.x = cloth_toi_wide_mul(scale, n.x);
  n.y = cloth_toi_wide_mul(scale, n.y);
  n.z = cloth_toi_wide_mul(scale, n.z);
  for (int i = 0; i < split; i++) {
    for (int j = split; j < 4; j++) {
      cloth_toi_wide h = cloth_toi_wide3_dot(n, cloth_toi_wide3_sub(x[j], x[i]));
      if (!(h.hi > 2 * error)) return none;
      cloth_toi_wide speed = cloth_toi_wide3_dot(n, cloth_toi_wide3_sub(rate[i], rate[j]));
      if (!(speed.hi > 0)) continue;
      if (h.hi > 2 * speed.hi) continue;
      h = cloth_toi_wide_div(cloth_toi_wide_sub(h, floor), speed);
      if (h.hi < time.hi || (h.hi == time.hi && h.lo < time.lo)) time = h;
    }
  }
  return time;
}

// The k-th normal that may separate a vertex from a face (7) or an edge from an edge (9): of the
// face or of both edges, between corners, and between a corner and an edge. Where the nearest
// points lie is not asked: at this distance it is not known.
CLOTH_FN cloth_toi_wide3 cloth_toi_close_normal(const cloth_toi_wide3 x[4], int split, int k)
{
  cloth_toi_wide3 e, d;
  if (split == 1) {
    if (k == 0)
      return cloth_toi_wide3_cross(cloth_toi_wide3_sub(x[2], x[1]),
                                   cloth_toi_wide3_sub(x[3], x[1]));
    int p = k < 4 ? k : k - 3, q = p == 3 ? 1 : p + 1;
    d = cloth_toi_wide3_sub(x[p], x[0]);
    if (k < 4) return d;
    e = cloth_toi_wide3_sub(x[q], x[p]);
  } else {
    cloth_toi_wide3 u = cloth_toi_wide3_sub(x[1], x[0]), v = cloth_toi_wide3_sub(x[3], x[2]);
    if (k == 0) return cloth_toi_wide3_cross(u, v);
    int p = (k - 1) % 4; // ends 0 and 1 of the first edge against those of the second
    d = cloth_toi_wide3_sub(x[2 + p % 2], x[p / 2]);
    if (k < 5) return d;
    e = p == 0 || p == 3 ? u : v; // each edge with each end of the other once
  }
  return cloth_toi_wide3_cross(cloth_toi_wide3_cross(e, d), e);
}

// On which side of the plane of the face (of both edges) are the features at time t? 1 or -1 where
// their lines of sight clearly cross: well inside both, well off the plane, no sliver; else 0.
CLOTH_FN int cloth_toi_close_side(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], int split,
                                  cloth_real t)
{
  const cloth_real within = (cloth_real)0.0009765625;          // 2^-10, of a weight, of a sine
  const cloth_real clear = (cloth_real)1.4551915228366852e-11; // 2^-36, of the length of the edges
  cloth_v3 x[4];
  for (int p = 0; p < 4; p++) {
    cloth_v3 start = cloth_v3_sub(x_t0[p], x_t0[1]);
    x[p] = cloth_v3_add_scaled(start, t, cloth_v3_sub(cloth_v3_sub(x_t1[p], x_t1[1]), start));
  }
  cloth_v3 u = split == 1 ? cloth_v3_sub(x[2], x[1]) : cloth_v3_sub(x[1], x[0]);
  cloth_v3 v = split == 1 ? cloth_v3_sub(x[3], x[1]) : cloth_v3_sub(x[3], x[2]);
  cloth_v3 d = split == 1 ? cloth_v3_sub(x[0], x[1]) : cloth_v3_sub(x[2], x[0]);
  cloth_v3 n = cloth_v3_cross(u, v);
  cloth_real nn = cloth_v3_dot(n, n), uu = cloth_v3_dot(u, u), vv = cloth_v3_dot(v, v);
  if (!(nn > within * within * uu * vv)) return 0;
  cloth_real a = cloth_v3_dot(cloth_v3_cross(d, v), n) / nn;
  cloth_real b = cloth_v3_dot(cloth_v3_cross(split == 1 ? u : d, split == 1 ? d : u), n) / nn;
  if (!(a > within && b > within)) return 0;
  if (!(split == 1 ? a + b < 1 - within : a < 1 - within && b < 1 - within)) return 0;
  cloth_real height = cloth_v3_dot(d, n);
  if (!(height * height > clear * clear * nn * (uu + vv))) return 0;
  return height > 0 ? 1 : -1;
}

// Is it plain that they pass through each other around t? Most impacts are of this kind, and what
// follows need not be asked. A wrong yes would be an impact too many, no miss.
CLOTH_FN int cloth_toi_close_plain(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], int split,
                                   cloth_real t)
{
  const cloth_real around = (cloth_real)1.52587890625e-05; // 2^-16 of the step
  if (!(t >= around && t + around <= 1)) return 0;
  int before = cloth_toi_close_side(x_t0, x_t1, split, t - around);
  return before && before == -cloth_toi_close_side(x_t0, x_t1, split, t + around);
}

// Do the features, proved apart until t, meet in [t, 1]? 0 is a proof that they do not, for the
// coordinates as given.
CLOTH_FN int cloth_toi_close(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], int split, double t)
{
  cloth_toi_wide3 start[4], rate[4], x[4];
  cloth_toi_wide now = {t, 0};
  if (cloth_toi_close_plain(x_t0, x_t1, split, (cloth_real)t)) return 1;
  double largest = 0;
  for (int p = 0; p < 4; p++) {
    cloth_toi_wide3 end = cloth_toi_wide3_between(x_t1[p], x_t1[1]);
    start[p] = cloth_toi_wide3_between(x_t0[p], x_t0[1]);
    rate[p] = cloth_toi_wide3_sub(end, start[p]);
    largest =
        fmax(largest, fmax(fmax(fabs(start[p].x.hi), fabs(start[p].y.hi)), fabs(start[p].z.hi)));
    largest = fmax(largest, fmax(fmax(fabs(end.x.hi), fabs(end.y.hi)), fabs(end.z.hi)));
  }
  // the count of roundings in toi.h, and as much again for the tenfold operations here
  double error = 1024 * CLOTH_TOI_WIDE_EPSILON * largest;
  for (int k = 0; k < CLOTH_TOI_WIDE_ITERATIONS; k++) {
    for (int p = 0; p < 4; p++) x[p] = cloth_toi_wide3_add_scaled(start[p], now, rate[p]);
    cloth_toi_wide step = {0, 0};
    for (int c = 0; c < (split == 1 ? 7 : 9); c++) {
      cloth_toi_wide time =
          cloth_toi_close_time(x, rate, split, cloth_toi_close_normal(x, split, c), error);
      if (time.hi > step.hi || (time.hi == step.hi && time.lo > step.lo)) step = time;
    }
    if (!(step.hi > 0)) return 1;
    now = cloth_toi_wide_add(now, step);
    if (now.hi > 1) return 0;
  }
  return 1;
}
