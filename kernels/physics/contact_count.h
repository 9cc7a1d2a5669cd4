// Count the contacts that push, each by the part that owns its first cloth vertex.
#pragma once

#include "atomic.h"

typedef struct cloth_contact_count_args {
  int cloth_vertices;
  int first, last;            // vertices of this part
  const int *vertex;          // [n x 4]
  const cloth_real *pressure; // [n] N
  uint32_t *count;            // [2] cloth-cloth, cloth-body; counts up
} cloth_contact_count_args;

CLOTH_FN void cloth_contact_count(int i, const cloth_contact_count_args *a)
{
  if (!(a->pressure[i] > 0)) return;
  int owner = -1, body = 0;
  for (int c = 0; c < 4; c++) {
    int v = a->vertex[4 * i + c];
    if (v >= a->cloth_vertices)
      body = 1;
    else if (owner < 0)
      owner = v;
  }
  if (owner < a->first || owner >= a->last) return;
  if (body) // apart, so that each is one address for a warp
    cloth_atomic_next(a->count + 1);
  else
    cloth_atomic_next(a->count);
}
