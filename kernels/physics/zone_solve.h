// One impact zone: the end of the substep that is nearest, in the mass norm, to the one that the
// solver found and keeps every constraint of the zone:
//
//   min 1/2 |x - x_solved|_M^2   with   n_c . sum_k w_ck x_k >= apart_c
//
// (R. Bridson, R. Fedkiw, J. Anderson 2002, rigid zones; Harmon et al. 2008, inelastic projection;
// M. Tang et al. 2018, I-Cloth, augmented Lagrangian.) Solved in the multipliers, one constraint
// after the other: each sets its own to what closes it, never below zero. The impulses sum to zero
// over a pair of cloth features, so momentum stays. Bodies and held vertices do not give way. Where
// there is no room it ends after so many sweeps with what it has.
//
// Constraints are sorted by colours: those of one have no moving vertex in common, so the threads
// of a GPU block that close them side by side get the bits of the loop (kernels/cuda/zones.cu).
// Only those of the last colour, for which there were not enough, go one after the other
// everywhere.
#pragma once

#include "real.h"

// Around a sharp tip normals are nearly opposite to each other, and sweeps gain a few per cent
// each.
enum { CLOTH_ZONE_SWEEPS = 600, CLOTH_ZONE_LOOK = 60, CLOTH_ZONE_COLOURS = 64 };

typedef struct cloth_zone_solve_args {
  const int *zone;   // [n] zone of element i
  const int *first;  // [zones + 1] its constraints in `member`
  const int *member; // [constraints] constraint
  const int *local;  // [constraints x 4] place in `moving` of each corner of member c; -1: fixed
  const unsigned char *colour; // [constraints] by member, ascending in each zone
  const int *moving_first;     // [zones + 1] its vertices in `moving`
  const int *moving;           // [moving] vertex
  const int *vertex;           // [constraints x 4]
  const cloth_real *weight;    // [constraints x 4]
  const cloth_real *normal;    // [constraints x 3]
  const cloth_real *apart;     // [constraints] m
  const cloth_real *mass;      // [cloth vertices] kg
  const cloth_real *x_solved;  // [cloth vertices x 3] m
  int cloth_vertices;
  cloth_real *multiplier; // [constraints] by member, scratch
  cloth_real *need;       // [constraints x 2] by member, scratch: m, and 1 / compliance
  cloth_real *move;       // [moving x 3] m, scratch
  cloth_real *x;          // [vertices x 3] m, those in `moving` written
} cloth_zone_solve_args;

// n . sum w x relative to the first corner; bodies and their like at x
CLOTH_FN cloth_real cloth_zone_distance(const cloth_zone_solve_args *a, int c)
{
  cloth_v3 n = cloth_v3_load(a->normal, c), o = cloth_v3_make(0, 0, 0);
  cloth_real sum = 0;
  for (int k = 0; k < 4; k++) {
    int v = a->vertex[4 * c + k];
    cloth_v3 x = cloth_v3_load(v < a->cloth_vertices ? a->x_solved : a->x, v);
    if (k == 0) o = x;
    sum += a->weight[4 * c + k] * cloth_v3_dot(n, cloth_v3_sub(x, o));
  }
  return sum;
}

CLOTH_FN void cloth_zone_prepare(const cloth_zone_solve_args *a, int m)
{
  int c = a->member[m];
  cloth_real compliance = 0; // 1/kg
  for (int k = 0; k < 4; k++) {
    int at = a->local[4 * m + k];
    cloth_real w = a->weight[4 * c + k];
    if (at >= 0) compliance += w * w / a->mass[a->moving[at]];
  }
  a->multiplier[m] = 0;
  a->need[2 * m] = a->apart[c] - cloth_zone_distance(a, c);
  a->need[2 * m + 1] = compliance > 0 ? 1 / compliance : 0;
}

// close constraint m; how far it was open, as a share of what it asks for
CLOTH_FN cloth_real cloth_zone_close(const cloth_zone_solve_args *a, int m)
{
  int c = a->member[m];
  cloth_v3 n = cloth_v3_load(a->normal, c);
  cloth_real open = a->need[2 * m];
  for (int k = 0; k < 4; k++) {
    int at = a->local[4 * m + k];
    if (at >= 0) open -= a->weight[4 * c + k] * cloth_v3_dot(n, cloth_v3_load(a->move, at));
  }
  cloth_real before = a->multiplier[m], after = before + open * a->need[2 * m + 1];
  if (!(after > 0)) after = 0;
  a->multiplier[m] = after;
  for (int k = 0; k < 4 && after != before; k++) {
    int at = a->local[4 * m + k];
    if (at < 0) continue;
    cloth_real push = (after - before) * a->weight[4 * c + k] / a->mass[a->moving[at]];
    cloth_v3_store(a->move, at, cloth_v3_add_scaled(cloth_v3_load(a->move, at), push, n));
  }
  return a->need[2 * m + 1] > 0 && open > 0 ? open / a->apart[c] : 0;
}

/// Is that enough after sweep number `sweep`? worst: largest opening in it; *last: of the last
/// look.
CLOTH_FN int cloth_zone_done(int sweep, cloth_real worst, cloth_real *last)
{
  if (!(worst > (cloth_real)0.1)) return 1;
  if (sweep % CLOTH_ZONE_LOOK != 0) return 0;
  if (sweep > 0 && !(worst < (cloth_real)0.9 * *last)) return 1; // no room, or far too tight
  *last = worst;
  return 0;
}

/// Vertex number k of `moving` goes where the constraints moved it.
CLOTH_FN void cloth_zone_place(const cloth_zone_solve_args *a, int k)
{
  int v = a->moving[k];
  cloth_v3_store(a->x, v, cloth_v3_add(cloth_v3_load(a->x_solved, v), cloth_v3_load(a->move, k)));
}

CLOTH_FN void cloth_zone_solve(int i, const cloth_zone_solve_args *a)
{
  int z = a->zone[i];
  for (int k = a->moving_first[z]; k < a->moving_first[z + 1]; k++)
    cloth_v3_store(a->move, k, cloth_v3_make(0, 0, 0));
  for (int m = a->first[z]; m < a->first[z + 1]; m++) cloth_zone_prepare(a, m);
  cloth_real last = 0;
  for (int sweep = 0; sweep < CLOTH_ZONE_SWEEPS; sweep++) {
    cloth_real worst = 0;
    for (int m = a->first[z]; m < a->first[z + 1]; m++) {
      cloth_real open = cloth_zone_close(a, m);
      if (open > worst) worst = open;
    }
    if (cloth_zone_done(sweep, worst, &last)) break;
  }
  for (int k = a->moving_first[z]; k < a->moving_first[z + 1]; k++) cloth_zone_place(a, k);
}
