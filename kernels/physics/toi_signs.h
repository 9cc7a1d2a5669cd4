// Do a vertex and a face, or two edges, meet in an interval of time? By the signs of polynomials,
// in pairs of doubles.
//
// Where they meet, four points lie in one plane,
//   f(t) = d . n = 0,  n = u x v
// with u, v the edges (those of the face from its first corner) and d from the one feature to the
// other, and the point of meeting lies in both: with weights a, b of u, v
//   a |n|^2 = (d x v) . n,  b |n|^2 = (u x d) . n  of the face, (d x u) . n  of the second edge
// neither these nor what is left to |n|^2 is negative. All are polynomials in t, and one whose
// Bernstein coefficients over an interval have one sign has it in all of the interval. So f of one
// sign or a weight below 0 is a proof that they do not meet there, and f that changes sign under
// weights above 0 that they do. Where u and v are parallel all vanish, and nothing is proved.
//
// How the features are shaped costs nothing here: the interval shrinks until signs are plain.
//
// Source: M. Tang, R. Tong, Z. Wang, D. Manocha, Fast and Exact Continuous Collision Detection with
// Bernstein Sign Classification, 2014.
#pragma once

#include "toi_wide.h"

#define CLOTH_TOI_SIGNS_INTERVALS 256
#define CLOTH_TOI_SIGNS_SHORTEST  7.8886090522101181e-31 // 2^-100, of the step
#define CLOTH_TOI_SIGNS_SHORT     9.3132257461547852e-10 // 2^-30: as near as that is the time known

enum { CLOTH_TOI_UNKNOWN, CLOTH_TOI_APART, CLOTH_TOI_MEET };

/// u, v, d in straight motion, start + t rate.
typedef struct cloth_toi_signs {
  cloth_toi_wide3 start[3], rate[3];
  double error_f, error_weight; // how far coefficients may be off
  int split;                    // 1: vertex and face, 2: two edges
} cloth_toi_signs;

CLOTH_FN cloth_toi_signs cloth_toi_signs_make(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4],
                                              int split)
{
  cloth_toi_signs s;
  double size[3];
  for (int k = 0; k < 3; k++) {
    int to = k == 0 ? (split == 1 ? 2 : 1) : k == 1 ? 3 : (split == 1 ? 0 : 2);
    int from = split == 1 ? 1 : k == 1 ? 2 : 0;
    cloth_toi_wide3 end = cloth_toi_wide3_between(x_t1[to], x_t1[from]);
    s.start[k] = cloth_toi_wide3_between(x_t0[to], x_t0[from]);
    s.rate[k] = cloth_toi_wide3_sub(end, s.start[k]);
    size[k] = cloth_toi_wide3_largest(end, cloth_toi_wide3_largest(s.start[k], 0));
  }
  // coefficients of f sum 420 roundings of that size at most, of weights 2200
  double uv = size[0] * size[1];
  s.error_f = 1024 * CLOTH_TOI_WIDE_EPSILON * uv * size[2];
  s.error_weight = 4096 * CLOTH_TOI_WIDE_EPSILON * uv * (uv + size[2] * (size[0] + size[1]));
  s.split = split;
  return s;
}

// Products of polynomials by their Bernstein coefficients times binomial coefficients, which have
// the same signs and multiply as those of powers do.
CLOTH_FN void cloth_toi_signs_cross_of(const cloth_toi_wide3 a[2], const cloth_toi_wide3 b[2],
                                       cloth_toi_wide3 out[3])
{
  cloth_toi_wide one = {1, 0};
  out[0] = cloth_toi_wide3_cross(a[0], b[0]);
  out[1] = cloth_toi_wide3_add_scaled(cloth_toi_wide3_cross(a[0], b[1]), one,
                                      cloth_toi_wide3_cross(a[1], b[0]));
  out[2] = cloth_toi_wide3_cross(a[1], b[1]);
}

CLOTH_FN void cloth_toi_signs_dot_of(const cloth_toi_wide3 *a, int count,
                                     const cloth_toi_wide3 b[3], cloth_toi_wide *out)
{
  for (int k = 0; k < count + 2; k++) out[k].hi = out[k].lo = 0;
  for (int i = 0; i < count; i++)
    for (int j = 0; j < 3; j++)
      out[i + j] = cloth_toi_wide_add(out[i + j], cloth_toi_wide3_dot(a[i], b[j]));
}

// 1 or -1 where all coefficients have that sign, else 0
CLOTH_FN int cloth_toi_signs_of(const cloth_toi_wide *c, int count, double error)
{
  int above = 0, below = 0;
  for (int k = 0; k < count; k++) above += c[k].hi > error, below += c[k].hi < -error;
  return (above == count) - (below == count);
}

// Do they meet in [from, to]? *blind: at `from` itself no sign can be told, so that no interval
// with it ever tells.
CLOTH_FN_RARE int cloth_toi_signs_look(const cloth_toi_signs *s, cloth_toi_wide from,
                                       cloth_toi_wide to, int *blind)
{
  cloth_toi_wide3 ends[3][2], n[3], a[3], b[3];
  cloth_toi_wide f[4], w[4][5];
  int weights = s->split == 1 ? 3 : 4, inside = 0;
  for (int k = 0; k < 3; k++) {
    ends[k][0] = cloth_toi_wide3_add_scaled(s->start[k], from, s->rate[k]);
    ends[k][1] = cloth_toi_wide3_add_scaled(s->start[k], to, s->rate[k]);
  }
  const cloth_toi_wide3 *u = ends[0], *v = ends[1], *d = ends[2];
  *blind = 0;
  cloth_toi_signs_cross_of(u, v, n);
  cloth_toi_signs_dot_of(d, 2, n, f);
  if (cloth_toi_signs_of(f, 4, s->error_f) != 0) return CLOTH_TOI_APART;
  cloth_toi_signs_cross_of(d, v, a);
  cloth_toi_signs_cross_of(s->split == 1 ? u : d, s->split == 1 ? d : u, b);
  cloth_toi_signs_dot_of(a, 3, n, w[0]);
  cloth_toi_signs_dot_of(b, 3, n, w[1]);
  cloth_toi_signs_dot_of(n, 3, n, w[2]);
  for (int k = 0; k < 5; k++) {
    if (s->split == 2) w[3][k] = cloth_toi_wide_sub(w[2][k], w[1][k]);
    w[2][k] = cloth_toi_wide_sub(w[2][k], w[0][k]);
    if (s->split == 1) w[2][k] = cloth_toi_wide_sub(w[2][k], w[1][k]);
  }
  *blind = fabs(f[0].hi) <= s->error_f;
  for (int k = 0; k < weights; k++) {
    int sign = cloth_toi_signs_of(w[k], 5, s->error_weight);
    if (sign < 0) return CLOTH_TOI_APART;
    inside += sign > 0;
    *blind = *blind && w[k][0].hi >= -s->error_weight;
  }
  int before = cloth_toi_signs_of(f, 1, s->error_f);
  int crosses = before != 0 && before == -cloth_toi_signs_of(f + 3, 1, s->error_f);
  return crosses && inside == weights ? CLOTH_TOI_MEET : CLOTH_TOI_UNKNOWN;
}

// Do they plainly pass through each other right behind `now`?
CLOTH_FN int cloth_toi_signs_cross(const cloth_toi_signs *s, cloth_toi_wide now)
{
  cloth_toi_wide end = {now.hi + CLOTH_TOI_SIGNS_SHORT, 0};
  int blind;
  return end.hi <= 1 && cloth_toi_signs_look(s, now, end, &blind) == CLOTH_TOI_MEET;
}

// Do the features, apart until *now, meet in [*now, 1]? *now is raised to what is proved.
CLOTH_FN_RARE int cloth_toi_signs_search(const cloth_toi_signs *s, cloth_toi_wide *now)
{
  double step = CLOTH_TOI_SIGNS_SHORT;
  for (int k = 0; k < CLOTH_TOI_SIGNS_INTERVALS; k++) {
    cloth_toi_wide length = {step, 0}, end = cloth_toi_wide_add(*now, length);
    int last = !(end.hi < 1), blind;
    if (last) end.hi = 1, end.lo = 0;
    int found = cloth_toi_signs_look(s, *now, end, &blind);
    if (found == CLOTH_TOI_APART) {
      if (last) return found;
      *now = end, step *= 4;
    } else if (found == CLOTH_TOI_MEET && step <= CLOTH_TOI_SIGNS_SHORT) {
      return found;
    } else if (blind || (step /= 4) < CLOTH_TOI_SIGNS_SHORTEST) {
      break;
    }
  }
  return CLOTH_TOI_UNKNOWN;
}
