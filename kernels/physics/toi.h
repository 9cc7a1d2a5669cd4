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
// once more: a 0 is then a proof for the coordinates exactly as given, and so is that nothing meets
// before the time. In float, where 64 eps M of a floor of 50 m is more than the clearance of what
// lies on it, one plane for the whole step is tried in double; there 4 eps X is all that is left of
// the error, and not even that where a share of the distance is asked for: then the coordinates are
// the state itself, not rounded from another.
//
// Where a share of the distance is asked for, what ran out of iterations, and in float what
// rounding hides, is put to planes that turn (toi_turn.h).
//
// Sources: B. Mirtich, Timewise Rigid Body Simulation, 2000 (conservative advancement); X. Zhang,
// M. Lee, Y. Kim, Interactive Continuous Collision Detection for Non-Convex Polyhedra, 2006 (motion
// along a normal).
#pragma once

#include "toi_close.h"
#include "toi_turn.h"

// Steps shrink in a fixed ratio where corners come near much faster than the nearest points (edges
// that roll on each other); there this many end some 1e-8 of the size too early, elsewhere a
// handful do.
#define CLOTH_TOI_ITERATIONS_MAX 128

/// Four points in straight motion, x(t) = start + t rate, relative to the second of them.
typedef struct cloth_toi_motion {
  cloth_v3 start[4], rate[4]; // m, m per step
  cloth_real error;           // m  how far a separation along a unit normal may be off
  int split;                  // 1  points before this one are the first feature
} cloth_toi_motion;

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

CLOTH_FN int cloth_toi_search(const cloth_v3 x_t0[4], const cloth_v3 x_t1[4], int split,
                              cloth_real gap, cloth_real share, cloth_real *toi)
{
  cloth_toi_motion m = cloth_toi_motion_make(x_t0, x_t1, split);
  cloth_real t = 0, level = 0, enough = 0;
  int steps = 0;
  for (; steps < CLOTH_TOI_ITERATIONS_MAX; steps++) {
    cloth_v3 x[4], n[2];
    for (int p = 0; p < 4; p++) x[p] = cloth_v3_add_scaled(m.start[p], t, m.rate[p]);
    cloth_toi_normals(x, split, n);
    if (steps == 0) {
      cloth_real skip, kept = cloth_toi_separation(&m, x, n[0], 0, &skip);
      cloth_real other = cloth_toi_separation(&m, x, n[1], 0, &skip);
      kept = share * (other > kept ? other : kept);
      level = kept < gap ? (kept > 0 ? kept : 0) : gap;
      enough = level + level / 16 + 2 * m.error;
    }
    // the normal that proves more
    cloth_real next = t;
    for (int c = 0; c < 2; c++) {
      cloth_real time, least = cloth_toi_separation(&m, x, n[c], level + m.error, &time);
      if (least > enough && t + time > next) next = t + time;
    }
    if (next > 1) return 0;
    if (!(next > t)) break;
    t = next;
  }
#ifdef CLOTH_SINGLE_PRECISION
  if (cloth_toi_stays_apart(x_t0, x_t1, split, gap, share)) return 0;
  double apart = (double)t; // t stays: contacts are measured there, in float
  if (share > 0 && cloth_toi_turn_search(x_t0, x_t1, split, gap, share, &apart)) return 0;
#else
  if (level == 0 && !cloth_toi_close_calls(x_t0, x_t1, split, &t)) return 0;
  if (level > 0 && steps == CLOTH_TOI_ITERATIONS_MAX &&
      cloth_toi_turn_search(x_t0, x_t1, split, gap, share, &t))
    return 0;
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
