// Bending of one triangle from the angles over its three edges: a shape operator.
//
// The normal at the middle of an edge is half way between those of its two faces, so edge i adds
// the curvature theta_i |e_i| / (2 A) n_i n_i' to the triangle, n_i the edge's normal in the
// triangle's plane. With the orthotropic plate energy per area, D_warp k_ww^2 / 2 + D_weft k_ff^2 /
// 2 + sqrt(D_warp D_weft) k_wf^2 (bending without a Poisson effect), the energy is
//   E = 1/2 sum_ij W_ij (theta_i - rest_i) (theta_j - rest_j),
// W constant. A missing edge (the border) has no angle: no moment acts there, as on a free edge.
//
// Unlike one spring per edge (bend.h), a cylinder of any direction has the energy D/2 kappa^2 on a
// grid with all diagonals one way, and uneven triangles do not become soft by small folds between
// them: the moments of a constant curvature are in balance at every inner vertex of any mesh.
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
  const cloth_real *x;          // [vertices x 3] m   positions
  const cloth_real *x_t0;       // [vertices x 3] m   positions at the start of the step
  const cloth_real *free;       // [vertices]    1    0: held rigidly; NULL: none is
  cloth_real *force;            // [n x 18]      N    on the corners of the patch            (out)
  cloth_real *gradient;         // [n x 36]      1/m  d theta_i / d x of corners i + 1, i + 2, i,
                                //                    3 + i (modulo 3), edge by edge         (out)
  cloth_real *weight;           // [n x 6]       N m  W with damping: K_ab = W_ij g_ia g_jb' (out)
} cloth_bend_shape_args;

// corner of the patch for vertex k of edge i's hinge
CLOTH_FN int cloth_bend_shape_corner(int i, int k) { return k == 3 ? 3 + i : (i + 1 + k) % 3; }

CLOTH_FN void cloth_bend_shape(int i, const cloth_bend_shape_args *a)
{
  const int *patch = a->patch + 6 * i;
  const cloth_real *w = a->stiffness + 6 * i;
  cloth_real bend[3], d = a->damping[i];
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
    bend[e] = share * (cloth_bend_wrap(theta - rest) + d * cloth_bend_wrap(theta - theta_t0));
    for (int k = 0; k < 4; k++) {
      g[e][k] = cloth_v3_scale(share, g[e][k]);
      cloth_v3_store(a->gradient, 12 * i + 4 * e + k, g[e][k]);
    }
  }
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
  for (int k = 0; k < 6; k++) a->weight[6 * i + k] = w[k] * (1 + d);
}
