// Count vertices whose path leaves the region for which pairs are known or, of cloth, ends outside
// the room in which every body counts as near, those that end farther from the first guess than
// close pairs were listed for, and those of cloth that would leave a region soon.
#pragma once

#include "atomic.h"
#include "vertex_box.h"

typedef struct cloth_vertex_escape_args {
  int first;               // vertex of element 0
  const cloth_real *x_t0;  // [vertices x 3] m
  const cloth_real *x;     // [vertices x 3] m
  const cloth_real *box;   // [vertices x 6] m
  const cloth_real *guess; // [cloth vertices x 3] m; NULL: not asked
  int cloth_vertices;
  cloth_box room;   // m
  cloth_real stray; // m
  cloth_real slack; // m, vertex_box.h
  uint32_t *count;  // [4] escaped, strayed, (not this kernel's), in a hurry; count up
} cloth_vertex_escape_args;

CLOTH_FN void cloth_vertex_escape(int i, const cloth_vertex_escape_args *a)
{
  int v = a->first + i;
  cloth_box b = cloth_box_load(a->box, v);
  cloth_v3 x = cloth_v3_load(a->x, v), x_t0 = cloth_v3_load(a->x_t0, v);
  int is_cloth = v < a->cloth_vertices;
  if (!(cloth_box_holds(b, x_t0) && cloth_box_holds(b, x) &&
        (!is_cloth || cloth_box_holds(a->room, x))))
    cloth_atomic_next(a->count);
  if (is_cloth && cloth_vertex_hurries(cloth_v3_sub(x, x_t0), a->slack))
    cloth_atomic_next(a->count + 3);
  if (!a->guess || !is_cloth) return;
  cloth_v3 off = cloth_v3_sub(x, cloth_v3_load(a->guess, v));
  if (!(cloth_v3_dot(off, off) <= a->stray * a->stray)) cloth_atomic_next(a->count + 1);
}
