// Count vertices whose path leaves the region for which pairs are known.
#pragma once

#include "atomic.h"
#include "box.h"

typedef struct cloth_vertex_escape_args {
  int first;              // vertex of element 0
  const cloth_real *x_t0; // [vertices x 3] m
  const cloth_real *x;    // [vertices x 3] m
  const cloth_real *box;  // [vertices x 6] m
  uint32_t *escaped;      // [1] counts up
} cloth_vertex_escape_args;

CLOTH_FN int cloth_box_holds(cloth_box b, cloth_v3 p)
{
  return p.x >= b.lo.x && p.x <= b.hi.x && p.y >= b.lo.y && p.y <= b.hi.y && p.z >= b.lo.z &&
         p.z <= b.hi.z;
}

CLOTH_FN void cloth_vertex_escape(int i, const cloth_vertex_escape_args *a)
{
  int v = a->first + i;
  cloth_box b = cloth_box_load(a->box, v);
  if (!(cloth_box_holds(b, cloth_v3_load(a->x_t0, v)) &&
        cloth_box_holds(b, cloth_v3_load(a->x, v))))
    cloth_atomic_next(a->escaped);
}
