// How far a triangle is stretched in its worst direction: largest principal stretch minus 1.
//
// The larger eigenvalue of F'F - I = 2 G is 2 (mean + radius) of the strain; the square root is
// taken of 1 plus it.
#pragma once

#include "membrane.h"

typedef struct cloth_membrane_stretch_args {
  const int *triangle;    // [n x 3]         corners, local ids
  const cloth_real *rest; // [n x 5]         as in membrane.h
  const cloth_real *x;    // [vertices x 3]  m  positions
  cloth_real *stretch;    // [n]             1  >= -1; 0 at rest  (out)
} cloth_membrane_stretch_args;

CLOTH_FN void cloth_membrane_stretch(int i, const cloth_membrane_stretch_args *a)
{
  const int *v = a->triangle + 3 * i;
  cloth_membrane_sym2 g = cloth_membrane_strain(
      cloth_membrane_deform(cloth_v3_load(a->x, v[0]), cloth_v3_load(a->x, v[1]),
                            cloth_v3_load(a->x, v[2]), a->rest + 5 * i));
  cloth_real half = (g.warp - g.weft) / 2;
  cloth_real most = (g.warp + g.weft) / 2 + cloth_sqrt(half * half + g.shear * g.shear);
  // sqrt(1 + y) - 1 = y / (sqrt(1 + y) + 1) keeps the digits of a small stretch
  cloth_real y = most > (cloth_real)-0.5 ? 2 * most : -1;
  a->stretch[i] = y / (cloth_sqrt(1 + y) + 1);
}
