// Time of impact of a vertex and a face, or of two edges, whose four points move in straight lines
// at constant speed. Early or exact, never late.
//
// Conservative advancement with separating planes: at time t take a unit normal n that separates
// the two features. A face and an edge are convex hulls of their corners, so for every later t' the
// distance is at least the smallest n . (x_i - x_j)(t') over the corners i of one and j of the
// other, and each of these is a straight line in t'. The first of them to fall to the level ends
// the step; what lies between is proved free, whatever rounding did to the choice of n. There n is
// chosen again. A step is never shorter than that of additive conservative advancement (M. Li, D.
// Kaufman, C. Jiang, Codimensional Incremental Potential Contact, 2021), which divides by the
// fastest relative speed in any direction; features that slide past each other take one step here
// and many there.
//
// What counts as an impact is a distance that falls to
//   level = min(gap, share * distance at t0)
// so gap keeps a clearance [m], and a pair that starts nearer than gap/share keeps a share of what
// it has and can still move. gap = 0 asks for contact itself.
//
// Rounding. With eps the machine epsilon, M the largest coordinate relative to a point that moves
// along and X the largest coordinate as given, every n . (x_i - x_j)(t') above is known to within
// 64 eps M (positions 21, rates 21, division and sum of times 9, length of n 6), and 4 eps X covers
// coordinates that are themselves rounded, here and where the caller evaluates x(toi). Steps aim at
// level + that error, and a distance below level + 2 of it (+ level / 16, for fewer steps) is an
// impact. A pair that starts as near as that has toi 0. Running out of iterations is an impact at
// the time proved free so far, and so is NaN in the input.
//
// In double and for contact itself (level 0), what this leaves as an impact is put to toi_close.h
// once more: a 0 is then a proof for the coordinates exactly as given. In float, where 64 eps M of
// a floor of 50 m is more than the clearance of what lies on it, one plane for the whole step is
// tried in double; there 4 eps X is all that is left of the error, and not even that where a share
// of the distance is asked for: then the coordinates are the state itself, not rounded from
// another.
//
// Sources: B. Mirtich, Timewise Rigid Body Simulation, 2000 (conservative advancement); X. Zhang,
// M. Lee, Y. Kim, Interactive Continuous Collision Detection for Non-Convex Polyhedra, 2006 (motion
// along a normal).
#pragma once

#include "distance.h"
#include "toi_close.h"

// A handful of steps do, but where corners come near much faster than the nearest points (edges
// that roll on each other, cloth that bends over a tip) the normal of now proves little. There the
// normals of later are tried as well, which may hold for all the time until then.
#define CLOTH_TOI_ITERATIONS_MAX 128
#define CLOTH_TOI_SLOW           4 // steps after which it is

/// Four points in straight motion, x(t) = start + t rate, relative to the second of them.
typedef struct cloth_toi_motion {
  cloth_v3 start[4], rate[4]; // m, m per step
  cloth_real error;           // m  how far a separation along a unit normal may be off
  int split;                  // 1  points before this one are the first feature
} cloth_toi_motion;

CLOTH_FN cloth_real cloth_toi_largest(cloth_v3 v, cloth_real most)
{
  cloth_real x = cloth_fabs(v.x), y = cloth_fabs(v.y), z = cloth_fabs(v.z);
  most = x > most ? x : most;
  most = y > most ? y : most;
  return z > most ? z : most;
}

CLOTH_FN cloth_toi_motion cloth_toi_motion_make(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4],
                                                int split)
{
  cloth_toi_motion m;
  cloth_real relative = 0, absolute = 0;
  for (int p = 0; p < 4; p++) {
    cloth_v3 end = cloth_v3_sub(x_t1[p], x_t1[1]);
    m.start[p] = cloth_v3_sub(x_t0[p], x_t0[1]);
    m.rate[p] = cloth_v3_sub(end, m.start[p]);
    relative = cloth_toi_largest(end, cloth_toi_largest(m.start[p], relative));
    absolute = cloth_toi_largest(x_t1[p], cloth_toi_largest(x_t0[p], absolute));
  }
  m.error = CLOTH_REAL_EPSILON * (64 * relative + 4 * absolute);
  m.split = split;
  return m;
}

// v with its component along e taken out; v where e has no direction
CLOTH_FN cloth_v3 cloth_toi_across(cloth_v3 v, cloth_v3 e)
{
  cloth_real ee = cloth_v3_dot(e, e);
  return ee > 0 ? cloth_v3_add_scaled(v, -cloth_v3_dot(v, e) / ee, e) : v;
}

// Two normals worth trying at the positions x, from the first feature to the second, of any length.
// The first is made of the edges that hold the nearest points: where the distance is small its
// difference vector (the second) is mostly rounding, and an error in n counts with the size of the
// features.
CLOTH_FN void cloth_toi_normals(const cloth_v3 x[4], int split, cloth_v3 n[2])
{
  if (split == 1) {
    cloth_real w[3];
    cloth_distance_vertex_face_sq(x[0], x[1], x[2], x[3], w);
    cloth_v3 d = cloth_v3_scale(w[0], cloth_v3_sub(x[1], x[0]));
    d = cloth_v3_add_scaled(d, w[1], cloth_v3_sub(x[2], x[0]));
    d = cloth_v3_add_scaled(d, w[2], cloth_v3_sub(x[3], x[0]));
    cloth_v3 face = cloth_v3_cross(cloth_v3_sub(x[2], x[1]), cloth_v3_sub(x[3], x[1]));
    n[0] = n[1] = d;
    // beside a face, but little: the plane of a large face is known far better than the difference
    cloth_real lean = cloth_v3_dot(face, d);
    if (lean * lean > (cloth_real)0.81 * cloth_v3_dot(face, face) * cloth_v3_dot(d, d))
      n[1] = cloth_v3_scale(lean < 0 ? -1 : 1, face);
    if (w[0] > 0 && w[1] > 0 && w[2] > 0)
      n[0] = face, n[1] = d;
    else if (w[0] > 0 && w[1] > 0)
      n[0] = cloth_toi_across(d, cloth_v3_sub(x[2], x[1]));
    else if (w[1] > 0 && w[2] > 0)
      n[0] = cloth_toi_across(d, cloth_v3_sub(x[3], x[2]));
    else if (w[2] > 0 && w[0] > 0)
      n[0] = cloth_toi_across(d, cloth_v3_sub(x[1], x[3]));
  } else {
    cloth_real s, t;
    cloth_distance_edge_edge_sq(x[0], x[1], x[2], x[3], &s, &t);
    cloth_v3 u = cloth_v3_sub(x[1], x[0]), v = cloth_v3_sub(x[3], x[2]);
    cloth_v3 d =
        cloth_v3_sub(cloth_v3_add_scaled(cloth_v3_sub(x[2], x[0]), t, v), cloth_v3_scale(s, u));
    int inside_u = s > 0 && s<1, inside_v = t> 0 && t < 1;
    n[0] = n[1] = d;
    if (inside_u && inside_v) {
      n[0] = cloth_v3_cross(u, v);
      n[1] =
          cloth_toi_across(d, cloth_v3_dot(u, u) > cloth_v3_dot(v, v) ? u : v); // nearly parallel
    } else if (inside_u)
      n[0] = cloth_toi_across(d, u);
    else if (inside_v)
      n[0] = cloth_toi_across(d, v);
  }
  if (cloth_v3_dot(n[0], n[1]) < 0) n[0] = cloth_v3_scale(-1, n[0]);
}

// Smallest separation along n of the corners at x, and the time in which one of them falls to
// `level` (infinite, as 2, where none approaches). Negative when n has no direction.
CLOTH_FN cloth_real cloth_toi_separation(const cloth_toi_motion *m, const cloth_v3 x[4], cloth_v3 n,
                                         cloth_real level, cloth_real *time)
{
  cloth_real length = cloth_v3_length(n), least = 0;
  *time = 2;
  if (!(length > 0)) return -1;
  n = cloth_v3_scale(1 / length, n);
  for (int i = 0; i < m->split; i++) {
    for (int j = m->split; j < 4; j++) {
      cloth_real h = cloth_v3_dot(n, cloth_v3_sub(x[j], x[i]));
      cloth_real rate = cloth_v3_dot(n, cloth_v3_sub(m->rate[j], m->rate[i]));
      // written so that NaN ends up in `least`
      if ((i == 0 && j == m->split) || !(h >= least)) least = h;
      if (rate < 0 && h - level < -rate * *time) *time = (h - level) / -rate;
    }
  }
  return least;
}

#ifdef CLOTH_SINGLE_PRECISION
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

// The normal of the face, or of both edges, at x, of any length.
CLOTH_FN cloth_toi_double3 cloth_toi_double3_normal(const cloth_v3 x[4], int split)
{
  cloth_toi_double3 u = cloth_toi_double3_between(split == 1 ? x[2] : x[1], x[split == 1]);
  cloth_toi_double3 v = cloth_toi_double3_between(x[3], split == 1 ? x[1] : x[2]);
  cloth_toi_double3 n = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  return n;
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
  double rounding = share > 0 ? 64 * 2.2204460492503131e-16 : 4 * (double)CLOTH_REAL_EPSILON;
  level += rounding * (double)size;
  for (int c = 0; c < PLANES; c++)
    if (start[c] > level && cloth_toi_separation_double(x_t1, split, n[c]) > level) return 1;
  return 0;
}
#endif

// Until when two normals prove the features apart that are at x at time t; t where neither does.
CLOTH_FN cloth_real cloth_toi_proved(const cloth_toi_motion *m, const cloth_v3 x[4],
                                     const cloth_v3 n[2], cloth_real level, cloth_real enough,
                                     cloth_real t)
{
  cloth_real until = t;
  for (int c = 0; c < 2; c++) {
    cloth_real time, least = cloth_toi_separation(m, x, n[c], level + m->error, &time);
    if (least > enough && t + time > until) until = t + time;
  }
  return until;
}

CLOTH_FN int cloth_toi_search(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], int split,
                              cloth_real gap, cloth_real share, cloth_real *toi)
{
  cloth_toi_motion m = cloth_toi_motion_make(x_t0, x_t1, split);
  cloth_real t = 0, level = 0, enough = 0, ahead = 1;
  for (int k = 0; k < CLOTH_TOI_ITERATIONS_MAX; k++) {
    cloth_v3 x[4], n[2];
    for (int p = 0; p < 4; p++) x[p] = cloth_v3_add_scaled(m.start[p], t, m.rate[p]);
    cloth_toi_normals(x, split, n);
    if (k == 0) {
      cloth_real skip, kept = cloth_toi_separation(&m, x, n[0], 0, &skip);
      cloth_real other = cloth_toi_separation(&m, x, n[1], 0, &skip);
      kept = share * (other > kept ? other : kept);
      level = kept < gap ? (kept > 0 ? kept : 0) : gap;
      enough = level + level / 16 + 2 * m.error;
    }
    // the normal that proves more
    cloth_real next = cloth_toi_proved(&m, x, n, level, enough, t);
    if ((k >= CLOTH_TOI_SLOW || !(next > t)) && next <= 1) {
      cloth_real later = t + ahead < 1 ? t + ahead : 1;
      cloth_v3 y[4];
      for (int p = 0; p < 4; p++) y[p] = cloth_v3_add_scaled(m.start[p], later, m.rate[p]);
      cloth_toi_normals(y, split, n);
      cloth_real then = cloth_toi_proved(&m, x, n, level, enough, t);
      ahead = then >= later ? 2 * ahead : ahead / 2;
      if (then > next) next = then;
    }
    if (next > 1) return 0;
    if (!(next > t)) break;
    t = next;
  }
#ifdef CLOTH_SINGLE_PRECISION
  if (cloth_toi_stays_apart(x_t0, x_t1, split, gap, share)) return 0;
#else
  if (level == 0 && !cloth_toi_close(x_t0, x_t1, split, t)) return 0;
#endif
  *toi = t;
  return 1;
}

// May vertex x[0] come as near as the level to face x[1] x[2] x[3] while the points move from x_t0
// to x_t1 [m]? Returns 1 and a time no later than the first impact in toi, [0, 1], or 0 (toi
// untouched): then the pair is proved apart for the whole step. gap [m] >= 0 and share [0, 1) set
// the level, see above.
CLOTH_FN int cloth_toi_vertex_face(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], cloth_real gap,
                                   cloth_real share, cloth_real *toi)
{
  return cloth_toi_search(x_t0, x_t1, 1, gap, share, toi);
}

// The same for the edges x[0] x[1] and x[2] x[3].
CLOTH_FN int cloth_toi_edge_edge(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], cloth_real gap,
                                 cloth_real share, cloth_real *toi)
{
  return cloth_toi_search(x_t0, x_t1, 2, gap, share, toi);
}
