// Bending elements of the whole scene at rest, on the host, in double.
#pragma once

#include "state/sim.h"

typedef enum cloth_bending_model {
  CLOTH_BENDING_HINGE,     // kernels/physics/bend.h
  CLOTH_BENDING_QUADRATIC, // bend_quadratic.h
  CLOTH_BENDING_SHAPE,     // bend_shape.h
} cloth_bending_model;     // the order of the choices of bending_model in params.inl

/// Hinges (4 corners) or patches (6).
struct cloth_bend_rest {
  int count, corners;
  int *vertex;       // [count x corners]
  int *cloth;        // [count]
  double *stiffness; // N m: [count], of patches [count x 6]
  double *angle;     // rad: [count], of patches [count x 3]
  double *weight;    // 1/m: [count x 4], d angle / d height of the corners; hinges only
  double *direction; // [count x 6] n of the edges of patches, (warp, weft): bend_shape.h; else NULL
};

/// Elements for the bending model of the scene. CLOTH_NO_MEMORY; CLOTH_UNSUPPORTED where quadratic
/// bending is asked for cloth that is not flat at rest.
cloth_status cloth_bend_rest_new(const cloth_sim *sim, cloth_bend_rest **out, cloth_error *err);

/// The curvature n n' as (ww, ff, sqrt(2) wf), so that its square is that of the vector.
void cloth_bend_strain(const double n[2], double out[3]);

/// Places of a triangle's corners, (warp, weft) [m] from the first.
void cloth_bend_corners(const cloth_sim *sim, int triangle, double p[3][2]);

/// [count x 3 x 3] by what a patch's curvatures are to be multiplied (bend_even.c); to be freed,
/// NULL without memory. Of `rest` it reads `vertex` and `direction`.
double *cloth_bend_even(const cloth_sim *sim, const cloth_bend_rest *rest);

/// NULL is allowed.
void cloth_bend_rest_free(cloth_bend_rest *rest);
