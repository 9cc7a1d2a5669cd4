// Count vertices whose path leaves the region for which pairs are known or, of cloth, ends outside
// the room in which every body counts as near, and those that end farther from the first guess than
// close pairs were listed for.
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
  cloth_box room;   // m
  cloth_real stray; // m
  uint32_t *count;  // [2] escaped, strayed; count up
} cloth_vertex_escape_args;

CLOTH_FN void cloth_vertex_escape(int i, const cloth_vertex_escape_args *a)
{
  int v = a->first + i;
  cloth_box b = cloth_box_load(a->box, v);
  cloth_v3 x = cloth_v3_load(a->x, v);
  if (!(cloth_box_holds(b, cloth_v3_load(a->x_t0, v)) && cloth_box_holds(b, x) &&
        (v >= a->cloth_vertices || cloth_box_holds(a->room, x))))
    cloth_atomic_next(a->count);
  if (!a->guess || v >= a->cloth_vertices) return;
  cloth_v3 off = cloth_v3_sub(x, cloth_v3_load(a->guess, v));
  if (!(cloth_v3_dot(off, off) <= a->stray * a->stray)) cloth_atomic_next(a->count + 1);
}
