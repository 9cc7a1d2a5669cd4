// Bending of one triangle from the angles over its three edges: a shape operator.
//
// The normal at the middle of an edge is half way between those of its two faces, so edge i adds
// the curvature theta_i |e_i| / (2 A) n_i n_i' to the triangle, n_i the edge's normal in the
// triangle's plane. With the orthotropic plate energy per area, D_warp k_ww^2 / 2 + D_weft k_ff^2 /
// 2 + sqrt(D_warp D_weft) k_wf^2 (bending without a Poisson effect), the energy is
//   E = 1/2 sum_ij W_ij (theta_i - rest_i) (theta_j - rest_j),
// W constant, of curvatures that are evened out where triangles are uneven
// (src/effect/bend_even.c). A missing edge (the border) has no angle: no moment acts there, as on a
// free edge.
//
// Unlike one spring per edge (bend.h), a cylinder of any direction has the energy D/2 kappa^2 on a
// grid with all diagonals one way, and nearly so on any mesh of triangles that are not thin; and
// uneven triangles hardly become soft by small folds between them: before it is evened out, the
// moments of a constant curvature are in balance at every inner vertex of any mesh.
//
// Patch: corners 0 1 2 of the triangle, then 3 + i, the corner across edge i, which is opposite
// corner i. A missing one names corner i itself.
//
// Sources: E. Grinspun, Y. Gingold, J. Reisman, D. Zorin, Computing Discrete Shape Operators on
// General Meshes, 2006 (triangle-averaged operator); E. Onate, F. Zarate, Rotation-free Triangular
// Plate and Shell Elements, 2000 (the same as a finite element, and its free edge).
#pragma once

#include "bend.h"

typedef struct cloth_bend_shape_args {
  const int *patch;             // [n x 6]            see above, local ids
  const cloth_real *stiffness;  // [n x 6]       N m  W00 W11 W22 W12 W20 W01
  const cloth_real *rest_angle; // [n x 3]       rad
  const cloth_real *damping;    // [n]           1    damping time over step length
  const cloth_real
      *direction; // [n x 6]    1/m^.5  n of the three edges, (warp, weft); NULL: no table
  const cloth_real *measured; // [materials x 15] N m see cloth_bend_measured; first 0: linear
  const int *material;        // [n]                row of measured
  const cloth_real *x;        // [vertices x 3] m   positions
  const cloth_real *x_t0;     // [vertices x 3] m   positions at the start of the step
  const cloth_real *free;     // [vertices]    1    0: held rigidly; NULL: none is
  cloth_real *force;          // [n x 18]      N    on the corners of the patch            (out)
  cloth_real *gradient;       // [n x 36]      1/m  d theta_i / d x of corners i + 1, i + 2, i,
                              //                    3 + i (modulo 3), edge by edge         (out)
  cloth_real *weight;         // [n x 6]       N m  W with damping: K_ab = W_ij g_ia g_jb' (out)
} cloth_bend_shape_args;

// corner of the patch for vertex k of edge i's hinge
CLOTH_FN int cloth_bend_shape_corner(int i, int k) { return k == 3 ? 3 + i : (i + 1 + k) % 3; }

// Rigidity of a measured fabric over that of the linear one, at angles `bend` of the three edges:
// from a table with a row for an edge at 0, 45 and 90 degrees to the warp and a column for a
// curvature of 0, 5, 10, 15 and 20 1/m, taken for the larger principal curvature. Linear in both;
// constant beyond. Source: H. Wang, J. O'Brien, R. Ramamoorthi, Data-driven Elastic Models for
// Cloth, 2011, section 4. The tangent takes it as constant.
CLOTH_FN cloth_real cloth_bend_measured(const cloth_real *bend, const cloth_real *n,
                                        const cloth_real *table)
{
  cloth_real ww = 0, ff = 0, wf = 0;
  for (int e = 0; e < 3; e++) {
    ww += bend[e] * n[2 * e] * n[2 * e], ff += bend[e] * n[2 * e + 1] * n[2 * e + 1];
    wf += bend[e] * n[2 * e] * n[2 * e + 1];
  }
  cloth_real sign = ww + ff < 0 ? -1 : 1, mean = sign * (ww + ff) / 2, half = sign * (ww - ff) / 2;
  cloth_real radius = cloth_sqrt(half * half + wf * wf), column = (mean + radius) / 5;
  // the edge lies across the curvature: 90 degrees where the warp is curved
  cloth_real row = 2 - cloth_fabs(cloth_bend_atan2(sign * wf, half)) * (2 / CLOTH_PI);
  int r = row < 1 ? 0 : 1, c = column < 3 ? (int)column : 3;
  cloth_real y = row - (cloth_real)r, x = column - (cloth_real)c;
  x = x < 1 ? x : 1;
  const cloth_real *t = table + 5 * r + c;
  cloth_real low = t[0] + x * (t[1] - t[0]), high = t[5] + x * (t[6] - t[5]);
  cloth_real cos_sq = radius > 0 ? (1 + half / radius) / 2 : (cloth_real)0.5;
  cloth_real root = cloth_sqrt(table[10]) * cos_sq + cloth_sqrt(table[0]) * (1 - cos_sq);
  return (low + y * (high - low)) / (root * root);
}

CLOTH_FN void cloth_bend_shape(int i, const cloth_bend_shape_args *a)
{
  const int *patch = a->patch + 6 * i;
  const cloth_real *w = a->stiffness + 6 * i;
  cloth_real bend[3], bent[3], d = a->damping[i];
  cloth_v3 g[3][4];
  int held = cloth_bend_held(a->free, patch[0], patch[1], patch[2]);
  for (int e = 0; e < 3; e++) {
    int v[4];
    for (int k = 0; k < 4; k++) v[k] = patch[cloth_bend_shape_corner(e, k)];
    cloth_real theta = 0, theta_t0 = 0, rest = a->rest_angle[3 * i + e], share = 1;
    if (v[3] == v[2] || held) {
      for (int k = 0; k < 4; k++) g[e][k] = cloth_v3_make(0, 0, 0);
      share = 0;
    } else {
      theta = cloth_bend_gradient(a->x, v, g[e]), theta_t0 = cloth_bend_angle_of(a->x_t0, v);
      if (cloth_bend_held(a->free, v[0], v[1], v[3])) share = 2; // all of the angle is bent here
    }
    bent[e] = share * cloth_bend_wrap(theta - rest);
    bend[e] = share * (cloth_bend_wrap(theta - rest) + d * cloth_bend_wrap(theta - theta_t0));
    for (int k = 0; k < 4; k++) {
      g[e][k] = cloth_v3_scale(share, g[e][k]);
      cloth_v3_store(a->gradient, 12 * i + 4 * e + k, g[e][k]);
    }
  }
  cloth_real scale = 1;
  const cloth_real *table = a->direction ? a->measured + 15 * a->material[i] : 0;
  if (table && table[0] > 0) scale = cloth_bend_measured(bent, a->direction + 6 * i, table);
  for (int e = 0; e < 3; e++) bend[e] *= scale;
  const cloth_real moment[3] = {w[0] * bend[0] + w[5] * bend[1] + w[4] * bend[2],
                                w[5] * bend[0] + w[1] * bend[1] + w[3] * bend[2],
                                w[4] * bend[0] + w[3] * bend[1] + w[2] * bend[2]};
  for (int c = 0; c < 3; c++) { // corner c is vertex 1, 0, 2 of the hinges c + 1, c + 2, c
    int e = (c + 1) % 3, f = (c + 2) % 3;
    cloth_v3 sum = cloth_v3_scale(-moment[e], g[e][1]);
    sum = cloth_v3_add_scaled(sum, -moment[f], g[f][0]);
    cloth_v3_store(a->force, 6 * i + c, cloth_v3_add_scaled(sum, -moment[c], g[c][2]));
    cloth_v3_store(a->force, 6 * i + 3 + c, cloth_v3_scale(-moment[c], g[c][3]));
  }
  for (int k = 0; k < 6; k++) a->weight[6 * i + k] = scale * w[k] * (1 + d);
}
