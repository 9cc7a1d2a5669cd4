// Strain limit of a fabric: beyond a principal strain its yarns lock. Each principal Green strain
// p_i of a triangle has the energy A w(p_i), where w' (a tension) is zero up to the limit, grows as
// a square over a ramp of CLOTH_LIMIT_RAMP and then linearly with the slope `stiffness`: w is
// convex and twice differentiable, and its force pulls only. So the element's exact tangent is
// positive semi-definite: A sum_i w''(p_i) h_i h_i' + 2 A k t t', where h_i is the gradient of p_i,
// t that of the shear strain between the principal directions, and k = (w'(p_1) - w'(p_2)) / (p_1 -
// p_2) >= 0, beside the part of the stress, which membrane.h adds.
//
// Sources: the energy of an isotropic function of principal strains and its derivatives, J. Simo
// and R. Taylor, Quasi-incompressible finite elasticity in principal stretches, 1991; a limit
// inside the implicit solve instead of a projection after it, X. Provot, Deformation constraints in
// a mass-spring model, 1995 (what a limit is for); M. Li, D. Kaufman, C. Jiang, Codimensional
// incremental potential contact, 2021 (a stiffening energy for it in the solve).
#pragma once

#include "real.h"

#define CLOTH_LIMIT_RAMP ((cloth_real)0.01) // of Green strain

/// A principal strain p beyond the limit: w' and w'' per `stiffness`.
CLOTH_FN void cloth_limit_law(cloth_real p, cloth_real limit, cloth_real *first, cloth_real *second)
{
  cloth_real over = p - limit;
  if (!(over > 0)) {
    *first = *second = 0;
  } else if (over < CLOTH_LIMIT_RAMP) {
    *first = over * over / (2 * CLOTH_LIMIT_RAMP);
    *second = over / CLOTH_LIMIT_RAMP;
  } else {
    *first = over - CLOTH_LIMIT_RAMP / 2;
    *second = 1;
  }
}

/// What the limit adds to a triangle: derivatives of w and the principal directions.
typedef struct cloth_limit_state {
  cloth_real first[2], second[2], twist; // w', w'', k [N/m]; principal strain 0 is the larger
  cloth_real warp, weft;                 // direction 0; direction 1 is (-weft, warp)
} cloth_limit_state;

/// g: Green strain warp, weft, shear; law: limit (of Green strain), stiffness [N/m]. 0: nothing.
CLOTH_FN int cloth_limit_find(const cloth_real *g, const cloth_real *law, cloth_limit_state *s)
{
  cloth_real mean = (g[0] + g[1]) / 2, half = (g[0] - g[1]) / 2;
  cloth_real radius = cloth_sqrt(half * half + g[2] * g[2]);
  if (!(mean + radius > law[0]) || !(law[1] > 0)) return 0;
  cloth_limit_law(mean + radius, law[0], &s->first[0], &s->second[0]);
  cloth_limit_law(mean - radius, law[0], &s->first[1], &s->second[1]);
  // where both strains are almost one the quotient is the derivative
  s->twist = radius > (cloth_real)1e-4 ? (s->first[0] - s->first[1]) / (2 * radius) : s->second[0];
  s->twist *= law[1];
  for (int i = 0; i < 2; i++) s->first[i] *= law[1], s->second[i] *= law[1];
  // half the angle of (half, shear): the direction is the sum of the unit vector and (1, 0)
  cloth_real c = radius > 0 ? half / radius : 1, z = radius > 0 ? g[2] / radius : 0;
  s->warp = cloth_sqrt((1 + c > 0 ? 1 + c : 0) / 2);
  s->weft = cloth_sqrt((1 - c > 0 ? 1 - c : 0) / 2);
  if (z < 0) s->weft = -s->weft;
  return 1;
}

/// Stress warp, weft, shear: sum of w' n n'.
CLOTH_FN void cloth_limit_stress(const cloth_limit_state *s, cloth_real *stress)
{
  cloth_real ww = s->warp * s->warp, ff = s->weft * s->weft, wf = s->warp * s->weft;
  stress[0] = s->first[0] * ww + s->first[1] * ff;
  stress[1] = s->first[0] * ff + s->first[1] * ww;
  stress[2] = (s->first[0] - s->first[1]) * wf;
}

/// tangent += weight v v' for the gradient v of corners 1 and 2; corner 0 balances them.
CLOTH_FN void cloth_limit_outer(cloth_v3 v1, cloth_v3 v2, cloth_real weight, cloth_real *tangent)
{
  const cloth_real v[3][3] = {
      {-(v1.x + v2.x), -(v1.y + v2.y), -(v1.z + v2.z)}, {v1.x, v1.y, v1.z}, {v2.x, v2.y, v2.z}};
  const int row[6] = {0, 1, 2, 1, 2, 0}, col[6] = {0, 1, 2, 2, 0, 1}; // xx yy zz yz zx xy
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3;
    for (int k = 0; k < 6; k++) tangent[6 * a + k] += weight * v[a][row[k]] * v[a][col[k]];
    for (int k = 0; k < 9; k++) tangent[18 + 9 * a + k] += weight * v[a][k / 3] * v[b][k % 3];
  }
}

/// warp, weft: images of the unit vectors; rest as in membrane.h; tangent [45] is added to.
CLOTH_FN void cloth_limit_tangent(const cloth_limit_state *s, cloth_v3 warp, cloth_v3 weft,
                                  const cloth_real *rest, cloth_real *tangent)
{
  cloth_real n[2][2] = {{s->warp, s->weft}, {-s->weft, s->warp}},
             along[2][2]; // [direction][corner]
  cloth_v3 image[2];
  for (int i = 0; i < 2; i++) {
    image[i] = cloth_v3_add_scaled(cloth_v3_scale(n[i][0], warp), n[i][1], weft);
    for (int k = 0; k < 2; k++) along[i][k] = rest[2 * k] * n[i][0] + rest[2 * k + 1] * n[i][1];
  }
  for (int i = 0; i < 2; i++)
    cloth_limit_outer(cloth_v3_scale(along[i][0], image[i]), cloth_v3_scale(along[i][1], image[i]),
                      rest[4] * s->second[i], tangent);
  cloth_v3 t[2];
  for (int k = 0; k < 2; k++)
    t[k] =
        cloth_v3_add_scaled(cloth_v3_scale(along[0][k] / 2, image[1]), along[1][k] / 2, image[0]);
  cloth_limit_outer(t[0], t[1], 2 * rest[4] * s->twist, tangent);
}
