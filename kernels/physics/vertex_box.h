// The region that vertex i may visit before pairs must be searched again.
#pragma once

#include "box.h"

typedef struct cloth_vertex_box_args {
  int first;              // vertex of element 0
  const cloth_real *x_t0; // [vertices x 3] m, start of the substep
  const cloth_real *x;    // [vertices x 3] m, predicted end
  cloth_real slack;       // m
  cloth_real *box;        // [vertices x 6] m, written
} cloth_vertex_box_args;

CLOTH_FN void cloth_vertex_box(int i, const cloth_vertex_box_args *a)
{
  int v = a->first + i;
  cloth_box_store(a->box, v,
                  cloth_box_swept(cloth_v3_load(a->x_t0, v), cloth_v3_load(a->x, v), a->slack));
}
