// Count vertices whose path leaves the region for which pairs are known, and those that end farther
// from the first guess than close pairs were listed for.
#pragma once

#include "atomic.h"
#include "box.h"

typedef struct cloth_vertex_escape_args {
  int first;               // vertex of element 0
  const cloth_real *x_t0;  // [vertices x 3] m
  const cloth_real *x;     // [vertices x 3] m
  const cloth_real *box;   // [vertices x 6] m
  const cloth_real *guess; // [cloth vertices x 3] m; NULL: not asked
  int cloth_vertices;
  cloth_real stray; // m
  uint32_t *count;  // [2] escaped, strayed; count up
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
  cloth_v3 x = cloth_v3_load(a->x, v);
  if (!(cloth_box_holds(b, cloth_v3_load(a->x_t0, v)) && cloth_box_holds(b, x)))
    cloth_atomic_next(a->count);
  if (!a->guess || v >= a->cloth_vertices) return;
  cloth_v3 off = cloth_v3_sub(x, cloth_v3_load(a->guess, v));
  if (!(cloth_v3_dot(off, off) <= a->stray * a->stray)) cloth_atomic_next(a->count + 1);
}
