// The region that vertex i may visit before pairs must be searched again: from its start to where
// inertia with and without gravity takes it (cloth that rests does not fall), and a little more.
#pragma once

#include "box.h"

typedef struct cloth_vertex_box_args {
  int first;              // vertex of element 0
  const cloth_real *x_t0; // [vertices x 3] m, start of the substep
  const cloth_real *x;    // [vertices x 3] m, predicted end
  const cloth_real *v;    // [vertices x 3] m/s; NULL: a body's vertices, which arrive at x exactly
  cloth_real h;           // s
  cloth_real slack;       // m
  cloth_real *box;        // [vertices x 6] m, written
} cloth_vertex_box_args;

CLOTH_FN void cloth_vertex_box(int i, const cloth_vertex_box_args *a)
{
  int k = a->first + i;
  cloth_v3 x_t0 = cloth_v3_load(a->x_t0, k);
  cloth_box b = cloth_box_swept(x_t0, cloth_v3_load(a->x, k), a->slack);
  if (a->v) {
    cloth_v3 coast = cloth_v3_add_scaled(x_t0, a->h, cloth_v3_load(a->v, k));
    b = cloth_box_union(b, cloth_box_swept(coast, coast, a->slack));
  }
  cloth_box_store(a->box, k, b);
}
