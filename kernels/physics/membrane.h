// Stretch and shear of one triangle: Green strain in the material axes, orthotropic linear stress
// (St. Venant-Kirchhoff), E = A/2 (c11 Gww^2 + 2 c12 Gww Gff + c22 Gff^2 + 4 c33 Gwf^2).
//
// With shape gradients b_a [1/m] of the corners, F = sum_a x_a b_a' has the columns f_w, f_f (where
// a unit step along warp and weft has gone), G = (F'F - I)/2, S = C : G, force_a = -A F S b_a, and
//   K_ab = A [ (b_a' S b_b) I + sum of outer products of f_w and f_f ].
// The first part may be indefinite: it takes S with its negative eigenvalues set to zero, so that K
// is positive semi-definite whenever c12^2 <= c11 c22. A triangle under tension in every direction
// keeps its exact K.
//
// Damping is viscous stress over the step, S = C : (G + damping (G - G_t0)). To first order that is
// -damping K (x - x_t0); unlike it, a turn of the triangle as a whole feels nothing, and the force
// stays the gradient of one function of x, which a line search can use.
//
// A strain limit (membrane_limit.h) adds its own stress and tangent.
//
// The force of this energy grows by the cube of the stretch. Where a tiny triangle is torn to a
// hundred times its size, because an impact moves one of its corners, that is no cloth's answer but
// a number that throws everything: beyond a stretch of four the stiffness falls by its square, so
// that stress stays and the force grows in proportion (cloth_membrane_far).
//
// Sources: B. Thomaszewski,
// S. Pabst, W. Strasser, Continuum-based Strain Limiting, 2009 (triangle with Green strain in
// material axes); J. Teran, E. Sifakis, G. Irving, R. Fedkiw, Robust Quasistatic Finite Elements
// and Flesh Simulation, 2005 (element tangents made definite; here on the stress alone).
#pragma once

#include "bend.h"
#include "membrane_limit.h"

// rest is the inverse of [warp, weft of corners 1-0 and 2-0 as columns], m00 m01 m10 m11 [1/m], and
// the area [m^2]; tangent is K00 K11 K22 packed (xx yy zz yz zx xy), then K01 K12 K20 row by row,
// K_ab = - d force_a / d x_b.
typedef struct cloth_membrane_args {
  const int *triangle;         // [n x 3]              corners, local ids
  const cloth_real *rest;      // [n x 5]         1/m, m^2, see above
  const int *material;         // [n]                  row of stiffness and damping
  const cloth_real *stiffness; // [materials x 4] N/m  c11 c12 c22 c33
  const cloth_real *measured;  // [materials x 24] N/m see cloth_membrane_measured; first 0: linear
  const cloth_real *limit;     // [materials x 2] 1, N/m see membrane_limit.h; NULL: none
  const cloth_real *damping;   // [materials]     1    damping time over step length
  const cloth_real *x;         // [vertices x 3]  m    positions
  const cloth_real *x_t0;      // [vertices x 3]  m    positions at the start of the step
  cloth_real *force;           // [n x 9]         N    on corners 0 1 2   (out)
  cloth_real *tangent;         // [n x 45]        N/m  see above          (out)
} cloth_membrane_args;

/// The deformation gradient: images of the unit vectors along warp and weft.
typedef struct cloth_membrane_axes {
  cloth_v3 warp, weft;
} cloth_membrane_axes;

/// Strain or stress in the material axes.
typedef struct cloth_membrane_sym2 {
  cloth_real warp, weft, shear;
} cloth_membrane_sym2;

CLOTH_FN cloth_membrane_axes cloth_membrane_deform(cloth_v3 x0, cloth_v3 x1, cloth_v3 x2,
                                                   const cloth_real *rest)
{
  cloth_v3 e1 = cloth_v3_sub(x1, x0), e2 = cloth_v3_sub(x2, x0);
  cloth_membrane_axes f;
  f.warp = cloth_v3_add_scaled(cloth_v3_scale(rest[0], e1), rest[2], e2);
  f.weft = cloth_v3_add_scaled(cloth_v3_scale(rest[1], e1), rest[3], e2);
  return f;
}

CLOTH_FN cloth_membrane_sym2 cloth_membrane_strain(cloth_membrane_axes f)
{
  cloth_membrane_sym2 g;
  g.warp = (cloth_v3_dot(f.warp, f.warp) - 1) / 2;
  g.weft = (cloth_v3_dot(f.weft, f.weft) - 1) / 2;
  g.shear = cloth_v3_dot(f.warp, f.weft) / 2;
  return g;
}

CLOTH_FN cloth_membrane_sym2 cloth_membrane_stress(cloth_membrane_sym2 g, const cloth_real *c)
{
  cloth_membrane_sym2 s;
  s.warp = c[0] * g.warp + c[1] * g.weft;
  s.weft = c[1] * g.warp + c[2] * g.weft;
  s.shear = 2 * c[3] * g.shear;
  return s;
}

// Stiffness c11 c12 c22 c33 [N/m] of a measured fabric at a strain, from a table of six rows of
// half of them: at zero strain, then for a principal stretch of 7/6 at 0, 22.5, 45, 67.5 and 90
// degrees to the warp. Linear in the larger principal stretch, and in its angle; constant beyond
// 7/6 and in compression. Source: H. Wang, J. O'Brien, R. Ramamoorthi, Data-driven Elastic Models
// for Cloth, 2011, section 3. There is no energy that this stress is the gradient of; the tangent
// takes the stiffness as constant.
CLOTH_FN void cloth_membrane_measured(cloth_membrane_sym2 g, const cloth_real *table, cloth_real *c)
{
  cloth_real mean = (g.warp + g.weft) / 2, half = (g.warp - g.weft) / 2;
  cloth_real most = mean + cloth_sqrt(half * half + g.shear * g.shear); // eigenvalue of G
  cloth_real w = most > 0 ? 6 * (cloth_sqrt(1 + 2 * most) - 1) : 0;
  w = w < 1 ? w : 1;
  // the principal direction is at half the angle of (half, shear)
  cloth_real at = cloth_fabs(cloth_bend_atan2(g.shear, half)) * (4 / CLOTH_PI);
  int row = at < 3 ? (int)at : 3;
  cloth_real f = at - (cloth_real)row;
  for (int k = 0; k < 4; k++) {
    cloth_real a = table[4 + 4 * row + k], b = table[8 + 4 * row + k];
    c[k] = 2 * ((1 - w) * table[k] + w * (a + f * (b - a)));
  }
  // fits of knits hold what is no material: it would gain energy by being deformed
  cloth_real limit = (cloth_real)0.95 * cloth_sqrt(c[0] * c[2]);
  c[1] = c[1] < limit ? c[1] : limit;
  c[1] = c[1] > -limit ? c[1] : -limit;
  c[3] = c[3] > 0 ? c[3] : 0;
}

#define CLOTH_MEMBRANE_FAR (cloth_real)8 // mean of the squared stretches along warp and weft

/// The share of the stiffness that is left at a strain: 1 up to a stretch of four in one direction.
/// As with measured fabrics the tangent takes it as constant.
CLOTH_FN cloth_real cloth_membrane_far(cloth_membrane_sym2 g)
{
  cloth_real stretch_sq = 1 + g.warp + g.weft;
  return stretch_sq > CLOTH_MEMBRANE_FAR ? CLOTH_MEMBRANE_FAR / stretch_sq : 1;
}

// Energy of one triangle [J], without damping. Not called by the solver; the tests differentiate
// it.
CLOTH_FN cloth_real cloth_membrane_energy(cloth_v3 x0, cloth_v3 x1, cloth_v3 x2,
                                          const cloth_real *rest, const cloth_real *c)
{
  cloth_membrane_sym2 g = cloth_membrane_strain(cloth_membrane_deform(x0, x1, x2, rest));
  cloth_membrane_sym2 s = cloth_membrane_stress(g, c);
  return rest[4] * (s.warp * g.warp + s.weft * g.weft + 2 * s.shear * g.shear) / 2;
}

// s without its negative eigenvalues. S - least I over (most - least) projects on the larger one's
// direction; the weight of that projector goes from 1 (both positive) through (0, 1) to 0.
CLOTH_FN cloth_membrane_sym2 cloth_membrane_tension(cloth_membrane_sym2 s)
{
  cloth_real mean = (s.warp + s.weft) / 2, half = (s.warp - s.weft) / 2;
  cloth_real radius = cloth_sqrt(half * half + s.shear * s.shear);
  cloth_real least = mean > radius ? mean - radius : 0, most = mean > -radius ? mean + radius : 0;
  cloth_real w = radius > 0 ? (most - least) / (2 * radius) : 0;
  cloth_membrane_sym2 p;
  p.warp = least + w * (half + radius);
  p.weft = least + w * (radius - half);
  p.shear = w * s.shear;
  return p;
}

// The three blocks of corners 1 and 2; those of corner 0 follow because a translation costs
// nothing. f_w f_w', f_f f_f', f_w f_f' are shared by all blocks.
CLOTH_FN void cloth_membrane_tangent(cloth_membrane_axes f, cloth_membrane_sym2 s,
                                     const cloth_real *rest, const cloth_real *c,
                                     cloth_real *tangent)
{
  const int sym[9] = {0, 5, 4, 5, 1, 3, 4, 3, 2};  // full index -> packed index
  const int turn[9] = {0, 3, 6, 1, 4, 7, 2, 5, 8}; // index of the transpose
  const int full[6] = {0, 4, 8, 5, 6, 1};          // packed index -> full index
  cloth_v3 u = f.warp, v = f.weft;
  const cloth_real uu[6] = {u.x * u.x, u.y * u.y, u.z * u.z, u.y * u.z, u.z * u.x, u.x * u.y};
  const cloth_real vv[6] = {v.x * v.x, v.y * v.y, v.z * v.z, v.y * v.z, v.z * v.x, v.x * v.y};
  const cloth_real uv[9] = {u.x * v.x, u.x * v.y, u.x * v.z, u.y * v.x, u.y * v.y,
                            u.y * v.z, u.z * v.x, u.z * v.y, u.z * v.z};

  cloth_real b1w = rest[0], b1f = rest[1], b2w = rest[2], b2f = rest[3], area = rest[4];
  cloth_real c11 = area * c[0], c12 = area * c[1], c22 = area * c[2], c33 = area * c[3];
  cloth_real ww = b1w * b1w, wf = b1w * b1f, ff = b1f * b1f;
  cloth_real uu1 = c11 * ww + c33 * ff, vv1 = c22 * ff + c33 * ww, uv1 = (c12 + c33) * wf;
  cloth_real g1 = area * (s.warp * ww + s.weft * ff + 2 * s.shear * wf);
  ww = b2w * b2w, wf = b2w * b2f, ff = b2f * b2f;
  cloth_real uu2 = c11 * ww + c33 * ff, vv2 = c22 * ff + c33 * ww, uv2 = (c12 + c33) * wf;
  cloth_real g2 = area * (s.warp * ww + s.weft * ff + 2 * s.shear * wf);
  ww = b1w * b2w, ff = b1f * b2f;
  cloth_real wf12 = b1w * b2f, fw12 = b1f * b2w;
  cloth_real uu12 = c11 * ww + c33 * ff, vv12 = c22 * ff + c33 * ww;
  cloth_real uv12 = c12 * wf12 + c33 * fw12, vu12 = c12 * fw12 + c33 * wf12;
  cloth_real g12 = area * (s.warp * ww + s.weft * ff + s.shear * (wf12 + fw12));

  cloth_real k11[6], k22[6], k12[9];
  for (int p = 0; p < 6; p++) {
    cloth_real both = uv[full[p]] + uv[turn[full[p]]];
    k11[p] = uu1 * uu[p] + vv1 * vv[p] + uv1 * both + (p < 3 ? g1 : 0);
    k22[p] = uu2 * uu[p] + vv2 * vv[p] + uv2 * both + (p < 3 ? g2 : 0);
  }
  for (int q = 0; q < 9; q++)
    k12[q] = uu12 * uu[sym[q]] + vv12 * vv[sym[q]] + uv12 * uv[q] + vu12 * uv[turn[q]] +
             (q % 4 == 0 ? g12 : 0);

  for (int p = 0; p < 6; p++) {
    tangent[p] = k11[p] + k22[p] + (k12[full[p]] + k12[turn[full[p]]]);
    tangent[6 + p] = k11[p];
    tangent[12 + p] = k22[p];
  }
  for (int q = 0; q < 9; q++) {
    tangent[18 + q] = -(k11[sym[q]] + k12[turn[q]]);
    tangent[27 + q] = k12[q];
    tangent[36 + q] = -(k22[sym[q]] + k12[turn[q]]);
  }
}

CLOTH_FN void cloth_membrane(int i, const cloth_membrane_args *a)
{
  const int *v = a->triangle + 3 * i;
  const cloth_real *rest = a->rest + 5 * i;
  const cloth_real *c = a->stiffness + 4 * a->material[i];
  cloth_real d = a->damping[a->material[i]];
  cloth_membrane_axes f = cloth_membrane_deform(
      cloth_v3_load(a->x, v[0]), cloth_v3_load(a->x, v[1]), cloth_v3_load(a->x, v[2]), rest);
  cloth_membrane_axes f_t0 =
      cloth_membrane_deform(cloth_v3_load(a->x_t0, v[0]), cloth_v3_load(a->x_t0, v[1]),
                            cloth_v3_load(a->x_t0, v[2]), rest);
  cloth_membrane_sym2 g = cloth_membrane_strain(f), g_t0 = cloth_membrane_strain(f_t0);
  cloth_real measured[4];
  const cloth_real *table = a->measured ? a->measured + 24 * a->material[i] : 0;
  if (table && table[0] > 0) {
    cloth_membrane_measured(g, table, measured);
    c = measured;
  }
  cloth_real far = cloth_membrane_far(g), soft[4];
  for (int k = 0; k < 4; k++) soft[k] = far * c[k];
  if (far < 1) c = soft;
  cloth_limit_state limit;
  const cloth_real strain[3] = {g.warp, g.weft, g.shear};
  int limited = a->limit && cloth_limit_find(strain, a->limit + 2 * a->material[i], &limit);
  g.warp += d * (g.warp - g_t0.warp);
  g.weft += d * (g.weft - g_t0.weft);
  g.shear += d * (g.shear - g_t0.shear);
  cloth_membrane_sym2 s = cloth_membrane_stress(g, c);
  if (limited) {
    cloth_real more[3];
    cloth_limit_stress(&limit, more);
    s.warp += more[0], s.weft += more[1], s.shear += more[2];
  }

  // P = A F S: force_1 = -P b_1, force_2 = -P b_2, force_0 balances them
  cloth_v3 pw =
      cloth_v3_add_scaled(cloth_v3_scale(rest[4] * s.warp, f.warp), rest[4] * s.shear, f.weft);
  cloth_v3 pf =
      cloth_v3_add_scaled(cloth_v3_scale(rest[4] * s.shear, f.warp), rest[4] * s.weft, f.weft);
  cloth_v3 f1 = cloth_v3_add_scaled(cloth_v3_scale(-rest[0], pw), -rest[1], pf);
  cloth_v3 f2 = cloth_v3_add_scaled(cloth_v3_scale(-rest[2], pw), -rest[3], pf);
  cloth_v3_store(a->force, 3 * i, cloth_v3_scale(-1, cloth_v3_add(f1, f2)));
  cloth_v3_store(a->force, 3 * i + 1, f1);
  cloth_v3_store(a->force, 3 * i + 2, f2);

  const cloth_real stiff[4] = {(1 + d) * c[0], (1 + d) * c[1], (1 + d) * c[2], (1 + d) * c[3]};
  cloth_membrane_tangent(f, cloth_membrane_tension(s), rest, stiff, a->tangent + 45 * i);
  if (limited) cloth_limit_tangent(&limit, f.warp, f.weft, rest, a->tangent + 45 * i);
}
