// The close calls of toi.h, decided in pairs of doubles (toi_wide.h).
//
// Two features that pass each other at 1e-17 m cannot be told from two that meet in double. Here
// the same search with separating planes is taken up where that one stopped, for contact itself
// (level 0), with every coordinate taken as exactly what it is. It costs some fifty times as much,
// so features that plainly pass through each other are seen beforehand, and where planes come on in
// ever smaller steps (long thin features that turn) the signs of polynomials decide
// (toi_signs.h). toi.h calls it only in double and only when its answer would be yes. In float the
// coordinates themselves are not that good.
#pragma once

#include "toi_signs.h"
#include "toi_turn.h"

#define CLOTH_TOI_CLOSE_STEPS  64 // of planes, in each round
#define CLOTH_TOI_CLOSE_ROUNDS 4  // of planes and signs

/// Four points in straight motion, x(t) = start + t rate, relative to the second of them.
typedef struct cloth_toi_close {
  cloth_toi_wide3 start[4], rate[4];
  double largest, error; // of the coordinates; how far a separation along a unit normal may be off
  int split;             // 1: points before this one are the first feature
} cloth_toi_close;

CLOTH_FN cloth_toi_close cloth_toi_close_make(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4],
                                              int split)
{
  cloth_toi_close m;
  m.largest = 0, m.split = split;
  for (int p = 0; p < 4; p++) {
    cloth_toi_wide3 end = cloth_toi_wide3_between(x_t1[p], x_t1[1]);
    m.start[p] = cloth_toi_wide3_between(x_t0[p], x_t0[1]);
    m.rate[p] = cloth_toi_wide3_sub(end, m.start[p]);
    m.largest = cloth_toi_wide3_largest(end, cloth_toi_wide3_largest(m.start[p], m.largest));
  }
  // the count of roundings in toi.h, and as much again for the tenfold operations here
  m.error = 1024 * CLOTH_TOI_WIDE_EPSILON * m.largest;
  return m;
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
// points lie is not asked: at this distance it is not known. It is made of d, from corner[0] to
// corner[1], and e, from corner[2] to corner[3]: 0 d x e, 1 d, 2 (e x d) x e.
CLOTH_FN int cloth_toi_close_corners(int split, int k, int corner[4])
{
  int corners = split == 1 ? 3 : 4; // normals between corners
  int p = k > corners ? k - corners : k, first_edge = k - corners == 1 || k - corners == 4;
  if (k == 0) {
    corner[0] = split == 1, corner[1] = split == 1 ? 2 : 1;
    corner[2] = split == 1 ? 1 : 2, corner[3] = 3;
    return 0;
  }
  corner[0] = split == 1 ? 0 : (p - 1) / 2;
  corner[1] = split == 1 ? p : 2 + (p - 1) % 2;
  // the edges of the face in turn; each edge with each end of the other once
  corner[2] = split == 1 ? p : first_edge ? 0 : 2;
  corner[3] = split == 1 ? p % 3 + 1 : first_edge ? 1 : 3;
  return k > corners ? 2 : 1;
}

CLOTH_FN cloth_toi_wide3 cloth_toi_close_normal(const cloth_toi_wide3 x[4], int split, int k)
{
  int c[4], made = cloth_toi_close_corners(split, k, c);
  cloth_toi_wide3 d = cloth_toi_wide3_sub(x[c[1]], x[c[0]]);
  if (made == 1) return d;
  cloth_toi_wide3 e = cloth_toi_wide3_sub(x[c[3]], x[c[2]]);
  return made == 0 ? cloth_toi_wide3_cross(d, e)
                   : cloth_toi_wide3_cross(cloth_toi_wide3_cross(e, d), e);
}

CLOTH_FN cloth_toi_double3 cloth_toi_close_rounded(cloth_toi_wide3 a, cloth_toi_wide3 b)
{
  cloth_toi_wide3 d = cloth_toi_wide3_sub(a, b);
  cloth_toi_double3 r = {d.x.hi, d.y.hi, d.z.hi};
  return r;
}

// Is the k-th normal far from separating the features? In double, where most are told to be.
// `largest` is that of the coordinates.
CLOTH_FN int cloth_toi_close_idle(const cloth_toi_wide3 x[4], int split, int k, double largest)
{
  const double around = 9.094947017729282e-13; // 2^-40, many times what rounding does
  int c[4], made = cloth_toi_close_corners(split, k, c);
  double least = 0, most = 0;
  cloth_toi_double3 n = cloth_toi_close_rounded(x[c[1]], x[c[0]]);
  double size = sqrt(cloth_toi_double3_dot(n, n)); // of what n is made of
  if (made != 1) {
    cloth_toi_double3 e = cloth_toi_close_rounded(x[c[3]], x[c[2]]);
    double length = sqrt(cloth_toi_double3_dot(e, e));
    n = cloth_toi_double3_cross(n, e);
    size *= length;
    if (made == 2) n = cloth_toi_double3_cross(e, n), size *= length;
  }
  for (int i = 0; i < split; i++)
    for (int j = split; j < 4; j++) {
      double h = cloth_toi_double3_dot(n, cloth_toi_close_rounded(x[j], x[i]));
      least = h < least ? h : least;
      most = h > most ? h : most;
    }
  double allowed = around * size * largest;
  return least < -allowed && most > allowed;
}

// Steps of planes from *now on. Returns CLOTH_TOI_APART if they keep the features apart until the
// end, CLOTH_TOI_MEET if none keeps them apart any longer, CLOTH_TOI_UNKNOWN if they still come on.
CLOTH_FN_RARE int cloth_toi_close_search(const cloth_toi_close *m, cloth_toi_wide *now)
{
  cloth_toi_wide3 x[4];
  for (int k = 0; k < CLOTH_TOI_CLOSE_STEPS; k++) {
    for (int p = 0; p < 4; p++) x[p] = cloth_toi_wide3_add_scaled(m->start[p], *now, m->rate[p]);
    cloth_toi_wide step = {0, 0};
    for (int c = 0; c < (m->split == 1 ? 7 : 9); c++) {
      if (cloth_toi_close_idle(x, m->split, c, m->largest)) continue;
      cloth_toi_wide3 n = cloth_toi_close_normal(x, m->split, c);
      cloth_toi_wide time = cloth_toi_close_time(x, m->rate, m->split, n, m->error);
      if (time.hi > step.hi || (time.hi == step.hi && time.lo > step.lo)) step = time;
    }
    if (!(step.hi > 0)) return CLOTH_TOI_MEET;
    *now = cloth_toi_wide_add(*now, step);
    // at that time they are still apart, by the error
    if (now->hi > 1 || (now->hi == 1 && now->lo >= 0)) return CLOTH_TOI_APART;
  }
  return CLOTH_TOI_UNKNOWN;
}

// Do the features, proved apart until *t, meet in [*t, 1]? 0 is a proof that they do not, for the
// coordinates as given. If they do, *t is a time until which they are apart, no earlier than it
// was.
CLOTH_FN_RARE int cloth_toi_close_calls(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], int split,
                                        double *t)
{
  cloth_toi_wide now = {*t, 0};
  cloth_toi_signs signs = cloth_toi_signs_make(x_t0, x_t1, split);
  if (cloth_toi_signs_cross(&signs, now)) return 1;
  cloth_toi_close m = cloth_toi_close_make(x_t0, x_t1, split);
  int found = CLOTH_TOI_UNKNOWN;
  for (int k = 0; k < CLOTH_TOI_CLOSE_ROUNDS && found == CLOTH_TOI_UNKNOWN; k++) {
    found = cloth_toi_close_search(&m, &now);
    if (found == CLOTH_TOI_UNKNOWN) found = cloth_toi_signs_search(&signs, &now);
  }
  if (found == CLOTH_TOI_APART) return 0;
  double down = now.lo < 0 ? now.hi * (1 - CLOTH_TOI_DOUBLE_EPSILON) : now.hi;
  if (down > *t) *t = down;
  return 1;
}
