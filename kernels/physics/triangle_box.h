// The region that triangle i may visit: the union of its vertices' regions.
#pragma once

#include "box.h"
#include "chunk.h"

typedef struct cloth_triangle_box_args {
  int first;                    // triangle of element 0
  const int *triangle;          // [triangles x 3]
  const cloth_real *vertex_box; // [vertices x 6] m
  const unsigned char *near;    // [chunks of triangles] 0: left out; NULL: all are wanted
  cloth_real *box;              // [triangles x 6] m, written
} cloth_triangle_box_args;

CLOTH_FN void cloth_triangle_box(int i, const cloth_triangle_box_args *a)
{
  if (a->near && !a->near[(a->first + i) / CLOTH_CHUNK]) return;
  const int *t = a->triangle + 3 * (a->first + i);
  cloth_box b =
      cloth_box_union(cloth_box_load(a->vertex_box, t[0]), cloth_box_load(a->vertex_box, t[1]));
  cloth_box_store(a->box, a->first + i, cloth_box_union(b, cloth_box_load(a->vertex_box, t[2])));
}
