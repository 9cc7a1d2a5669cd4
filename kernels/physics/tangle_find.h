// List candidate pair i of triangles if they intersect, and how.
#pragma once

#include "atomic.h"
#include "contact_geometry.h"
#include "triangle_cross.h"

typedef struct cloth_tangle_find_args {
  cloth_contact_scene scene; // x_t0 is looked at
  const uint64_t *pair;      // [n] (cloth triangle, triangle)
  uint64_t *key;             // [capacity], appended
  uint32_t *how;             // [capacity], appended: triangle_cross.h
  uint32_t capacity;
  uint32_t *count; // [1] counts up, also past the capacity
} cloth_tangle_find_args;

// what a gripper holds may reach into its fingers: no contact keeps them apart
CLOTH_FN int cloth_triangle_grasped(const cloth_contact_scene *s, const int *cloth,
                                    const int *other)
{
  if (other[0] < s->cloth_vertices) return 0;
  int body = s->body_of[other[0] - s->cloth_vertices];
  for (int k = 0; k < 3; k++)
    if (s->grasp_of[cloth[k]] > 0 && s->ignore[(s->grasp_of[cloth[k]] - 1) * s->bodies + body])
      return 1;
  return 0;
}

CLOTH_FN void cloth_tangle_find(int i, const cloth_tangle_find_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_pair pair = cloth_pair_unpack(s->format, a->pair[i]);
  const int *va = s->triangle + 3 * pair.a, *vb = s->triangle + 3 * pair.b;
  int shared = 0, shared_a = -1, shared_b = -1;
  for (int k = 0; k < 3; k++)
    for (int n = 0; n < 3; n++)
      if (va[k] == vb[n]) shared++, shared_a = k, shared_b = n;
  if (shared > 1 || cloth_triangle_grasped(s, va, vb)) return;
  double x[2][3][3];
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) {
      x[0][k][c] = (double)s->x_t0[3 * va[k] + c];
      x[1][k][c] = (double)s->x_t0[3 * vb[k] + c];
    }
  int how =
      cloth_triangles_cross((const double(*)[3])x[0], (const double(*)[3])x[1], shared_a, shared_b);
  if (!how) return;
  uint32_t at = cloth_atomic_add(a->count, 1);
  if (at >= a->capacity) return;
  a->key[at] = a->pair[i];
  a->how[at] = (uint32_t)how;
}
