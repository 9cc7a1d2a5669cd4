// The box of a chunk of vertices on their way through the substep, and on the way that inertia
// alone would lead them: as vertex_box.h, without its slack.
#pragma once

#include "box.h"
#include "chunk.h"

typedef struct cloth_box_chunk_args {
  int count;              // vertices
  const cloth_real *x_t0; // [count x 3] m
  const cloth_real *x;    // [count x 3] m
  const cloth_real *v;    // [count x 3] m/s
  cloth_real h;           // s
  cloth_real *box;        // [chunks x 6] m, written
} cloth_box_chunk_args;

CLOTH_FN cloth_box cloth_box_of_way(const cloth_box_chunk_args *a, int v)
{
  cloth_v3 x_t0 = cloth_v3_load(a->x_t0, v);
  cloth_v3 coast = cloth_v3_add_scaled(x_t0, a->h, cloth_v3_load(a->v, v));
  return cloth_box_union(cloth_box_swept(x_t0, cloth_v3_load(a->x, v), 0),
                         cloth_box_swept(coast, coast, 0));
}

CLOTH_FN void cloth_box_chunk(int i, const cloth_box_chunk_args *a)
{
  int v = i * CLOTH_CHUNK, end = cloth_chunk_end(0, a->count, i);
  cloth_box b = cloth_box_of_way(a, v);
  for (v++; v < end; v++) b = cloth_box_union(b, cloth_box_of_way(a, v));
  cloth_box_store(a->box, i, b);
}
