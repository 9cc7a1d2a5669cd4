// Are we there, and how much of the old direction is kept? One element.
#pragma once

#include "pcg.h"

typedef struct cloth_pcg_beta_args {
  int chunks, more;                // entries of `partial`: of all parts, and the hats' groups
  int start;                       // 1: right after pcg_start
  cloth_real tolerance;            // relative residual
  int first;                       // 1: later ones are measured against this one
  const cloth_real *partial;       // [chunks x CLOTH_PCG_PARTIALS] r'z, r'r
  int aggregates;                  // of the coarse level; 0: none
  const cloth_real *rest, *coarse; // [3 aggregates] N, m
  cloth_real *scalar;              // [CLOTH_PCG_SCALARS]
} cloth_pcg_beta_args;

/// The scalars from the sums r'z (both levels) and r'r.
CLOTH_FN void cloth_pcg_beta_set(const cloth_pcg_beta_args *a, cloth_real rz, cloth_real rr)
{
  cloth_real *s = a->scalar;
  if (a->start) { // later Newton iterations are measured against the first one's b
    if (a->first || !(rr <= s[CLOTH_PCG_BB])) s[CLOTH_PCG_BB] = rr;
    if (a->first || !(rz <= s[CLOTH_PCG_RZ_FIRST])) s[CLOTH_PCG_RZ_FIRST] = rz;
    s[CLOTH_PCG_ITERATIONS] = 0, s[CLOTH_PCG_DONE] = 0;
  }
  s[CLOTH_PCG_BETA] = a->start ? 0 : rz / s[CLOTH_PCG_RZ];
  s[CLOTH_PCG_RZ] = rz, s[CLOTH_PCG_RR] = rr;
  cloth_real share = a->tolerance * a->tolerance;
  if (!(rr > share * s[CLOTH_PCG_BB]) && !(rz > share * s[CLOTH_PCG_RZ_FIRST]))
    s[CLOTH_PCG_DONE] = 1;
}

CLOTH_FN void cloth_pcg_beta(int i, const cloth_pcg_beta_args *a)
{
  (void)i;
  if (!a->start && a->scalar[CLOTH_PCG_DONE] > 0) return;
  cloth_real rz = cloth_partial_sum(a->partial, a->chunks, a->more, 0);
  if (a->aggregates > 0) rz += cloth_coarse_rz(a->rest, a->coarse, a->aggregates);
  cloth_pcg_beta_set(a, rz, cloth_partial_sum(a->partial, a->chunks, 0, 1));
}
