// What toi.h is about to call an impact, put to planes that turn, in double.
//
// Where a feature is much longer than the two are apart, a plane between them runs along the long
// one, whose far end leaves it at once when the feature turns: triangles of a micrometre and 5 cm
// that turn by a tenth would take thousands of steps of the search, each with a plane that stands
// still, and were told to be impacts that no answer to impacts could cure. So the plane turns
// along: from the normal n0 at the start of an interval to n1 at its end its normal is (1 - s) n0 +
// s n1, never longer than 1, and along it the corners i and j are apart by
//   a (1 - s)^2 + 2 b s (1 - s) + c s^2
//   a = n0 . d0,  b = (n0 . d1 + n1 . d0) / 2,  c = n1 . d1,  d = x_j - x_i
// at least, which is positive in [0, 1] where a > 0, c > 0 and b > -sqrt(a c). That is a proof,
// whatever rounding did to the choice of n0 and n1. What is longer by a factor f than it is away
// from the other takes some sqrt(f) intervals for a turn of 1.
//
// Normals are chosen in cloth_real; separations along them are measured in double, where float
// coordinates are exact.
#pragma once

#include "toi_normals.h"

#define CLOTH_TOI_DOUBLE_EPSILON 2.2204460492503131e-16

typedef struct cloth_toi_double3 {
  double x, y, z;
} cloth_toi_double3;

CLOTH_FN cloth_toi_double3 cloth_toi_double3_between(cloth_v3 a, cloth_v3 b) // exact for near ones
{
  cloth_toi_double3 d = {(double)a.x - (double)b.x, (double)a.y - (double)b.y,
                         (double)a.z - (double)b.z};
  return d;
}

CLOTH_FN double cloth_toi_double3_dot(cloth_toi_double3 a, cloth_toi_double3 b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

CLOTH_FN cloth_toi_double3 cloth_toi_double3_cross(cloth_toi_double3 a, cloth_toi_double3 b)
{
  cloth_toi_double3 c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  return c;
}

#ifdef CLOTH_SINGLE_PRECISION
// The normal of the face, or of both edges, at x, of any length.
CLOTH_FN cloth_toi_double3 cloth_toi_double3_normal(const cloth_v3 x[4], int split)
{
  cloth_toi_double3 u = cloth_toi_double3_between(split == 1 ? x[2] : x[1], x[split == 1]);
  cloth_toi_double3 v = cloth_toi_double3_between(x[3], split == 1 ? x[1] : x[2]);
  return cloth_toi_double3_cross(u, v);
}

// Smallest separation along n of the corners at x [m], the second feature behind the first; NaN if
// a coordinate is.
CLOTH_FN double cloth_toi_separation_double(const cloth_v3 x[4], int split, cloth_toi_double3 n)
{
  double length = sqrt(cloth_toi_double3_dot(n, n)), least = 0;
  for (int i = 0; i < split; i++)
    for (int j = split; j < 4; j++) {
      double h = cloth_toi_double3_dot(n, cloth_toi_double3_between(x[j], x[i]));
      if ((i == 0 && j == split) || (least == least && !(h >= least))) least = h;
    }
  return length > 0 ? least / length : -1;
}

// Does one plane keep the features apart for the whole step? Along it the corners move in straight
// lines, so start and end tell. Tried are those of the face or of both edges at the start and at
// the end, on either side, and those that the search would begin with.
CLOTH_FN int cloth_toi_stays_apart(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], int split,
                                   cloth_real gap, cloth_real share)
{
  enum { PLANES = 6 };
  cloth_v3 x[4], search[2];
  cloth_real size = 0;
  for (int p = 0; p < 4; p++) {
    x[p] = cloth_v3_sub(x_t0[p], x_t0[1]);
    size = cloth_toi_largest(x_t1[p], cloth_toi_largest(x_t0[p], size));
  }
  cloth_toi_normals(x, split, search);
  cloth_toi_double3 n[PLANES];
  n[0] = cloth_toi_double3_normal(x_t0, split);
  n[1] = cloth_toi_double3_normal(x_t1, split);
  for (int c = 0; c < 2; c++) {
    cloth_toi_double3 back = {-n[c].x, -n[c].y, -n[c].z};
    cloth_toi_double3 first = {(double)search[c].x, (double)search[c].y, (double)search[c].z};
    n[2 + c] = back, n[4 + c] = first;
  }
  double start[PLANES], kept = 0;
  for (int c = 0; c < PLANES; c++) {
    start[c] = cloth_toi_separation_double(x_t0, split, n[c]);
    if (start[c] > kept) kept = start[c];
  }
  double level = fmin((double)gap, (double)share * kept);
  double rounding = share > 0 ? 64 * CLOTH_TOI_DOUBLE_EPSILON : 4 * (double)CLOTH_REAL_EPSILON;
  level += rounding * (double)size;
  for (int c = 0; c < PLANES; c++)
    if (start[c] > level && cloth_toi_separation_double(x_t1, split, n[c]) > level) return 1;
  return 0;
}
#endif

// Intervals that are tried, and the shortest of them as a share of the step.
#define CLOTH_TOI_TURNS         512
#define CLOTH_TOI_TURN_SHORTEST (1.0 / 4096)

// four points in straight motion relative to the second of them
typedef struct cloth_toi_turn {
  cloth_toi_double3 start[4], rate[4]; // m, m per step
  double error;                        // m  how far a separation along a unit normal may be off
  int split;                           // 1  points before this one are the first feature
} cloth_toi_turn;

// the points at a time, and the unit normals to try there, NaN without a direction
typedef struct cloth_toi_turn_at {
  cloth_toi_double3 x[4], n[2];
} cloth_toi_turn_at;

// a + s b
CLOTH_FN cloth_toi_double3 cloth_toi_double3_add_scaled(cloth_toi_double3 a, double s,
                                                        cloth_toi_double3 b)
{
  cloth_toi_double3 sum = {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
  return sum;
}

CLOTH_FN cloth_toi_turn cloth_toi_turn_make(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4],
                                            int split)
{
  cloth_toi_turn m;
  cloth_real relative = 0, absolute = 0;
  for (int p = 0; p < 4; p++) {
    cloth_toi_double3 end = cloth_toi_double3_between(x_t1[p], x_t1[1]);
    m.start[p] = cloth_toi_double3_between(x_t0[p], x_t0[1]);
    m.rate[p] = cloth_toi_double3_add_scaled(end, -1, m.start[p]);
    absolute = cloth_toi_largest(x_t1[p], cloth_toi_largest(x_t0[p], absolute));
    relative = cloth_toi_largest(cloth_v3_sub(x_t0[p], x_t0[1]), relative);
    relative = cloth_toi_largest(cloth_v3_sub(x_t1[p], x_t1[1]), relative);
  }
  m.error = CLOTH_TOI_DOUBLE_EPSILON * (65 * (double)relative + 4 * (double)absolute);
  m.split = split;
  return m;
}

CLOTH_FN void cloth_toi_turn_look(const cloth_toi_turn *m, double t, cloth_toi_turn_at *at)
{
  cloth_v3 x[4], n[2];
  for (int p = 0; p < 4; p++) {
    cloth_toi_double3 d = cloth_toi_double3_add_scaled(m->start[p], t, m->rate[p]);
    at->x[p] = d;
    x[p] = cloth_v3_make((cloth_real)d.x, (cloth_real)d.y, (cloth_real)d.z);
  }
  cloth_toi_normals(x, m->split, n);
  for (int c = 0; c < 2; c++) {
    cloth_toi_double3 v = {(double)n[c].x, (double)n[c].y, (double)n[c].z}, none = {0, 0, 0};
    at->n[c] = cloth_toi_double3_add_scaled(none, 1 / sqrt(cloth_toi_double3_dot(v, v)), v);
  }
}

// smallest separation along unit normal c, NaN if a coordinate is
CLOTH_FN double cloth_toi_turn_least(const cloth_toi_turn *m, const cloth_toi_turn_at *at, int c)
{
  double least = 0;
  for (int i = 0; i < m->split; i++)
    for (int j = m->split; j < 4; j++) {
      cloth_toi_double3 d = cloth_toi_double3_add_scaled(at->x[j], -1, at->x[i]);
      double h = cloth_toi_double3_dot(at->n[c], d);
      if ((i == 0 && j == m->split) || (least == least && !(h >= least))) least = h;
    }
  return least;
}

// does the plane that turns from normal c at the one time to normal c at the other keep all corners
// more than `level` apart in between?
CLOTH_FN int cloth_toi_turn_keeps(const cloth_toi_turn *m, const cloth_toi_turn_at *from,
                                  const cloth_toi_turn_at *to, int c, double level)
{
  for (int i = 0; i < m->split; i++)
    for (int j = m->split; j < 4; j++) {
      cloth_toi_double3 d0 = cloth_toi_double3_add_scaled(from->x[j], -1, from->x[i]);
      cloth_toi_double3 d1 = cloth_toi_double3_add_scaled(to->x[j], -1, to->x[i]);
      double a = cloth_toi_double3_dot(from->n[c], d0) - level;
      double b = (cloth_toi_double3_dot(from->n[c], d1) + cloth_toi_double3_dot(to->n[c], d0)) / 2;
      double e = cloth_toi_double3_dot(to->n[c], d1) - level;
      b -= level;
      if (!(a > 0 && e > 0 && (b > 0 || b * b < a * e))) return 0; // NaN is not kept
    }
  return 1;
}

// Are the features, known to be apart until *t, apart for the whole step? If not, *t is a time
// until which they are, no earlier than it was. gap, share: as in toi.h; share above 0, so that the
// coordinates are the state itself.
CLOTH_FN int cloth_toi_turn_search(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], int split,
                                   cloth_real gap, cloth_real share, double *t)
{
  cloth_toi_turn m = cloth_toi_turn_make(x_t0, x_t1, split);
  cloth_toi_turn_at from, to;
  cloth_toi_turn_look(&m, 0, &from);
  double kept = cloth_toi_turn_least(&m, &from, 0), other = cloth_toi_turn_least(&m, &from, 1);
  if (!(kept >= other)) kept = other;
  double level = fmin((double)gap, (double)share * kept) + 2 * m.error, step = 1 - *t;
  if (!(kept > level)) return 0;
  cloth_toi_turn_look(&m, *t, &from);
  for (int k = 0; k < CLOTH_TOI_TURNS; k++) {
    int last = !(*t + step < 1);
    double end = last ? 1 : *t + step;
    cloth_toi_turn_look(&m, end, &to);
    if (cloth_toi_turn_keeps(&m, &from, &to, 0, level) ||
        cloth_toi_turn_keeps(&m, &from, &to, 1, level)) {
      if (last) return 1;
      *t = end, from = to, step *= 2;
    } else if ((step /= 2) < CLOTH_TOI_TURN_SHORTEST) {
      break;
    }
  }
  return 0;
}
