// A large body triangle against one chunk of cloth triangles, box by box.
#pragma once

#include "chunk.h"
#include "pair_emit.h"

typedef struct cloth_pair_large_args {
  cloth_pair_mesh mesh;
  int chunks;            // of cloth triangles; element i is (large i / chunks, chunk i % chunks)
  const uint32_t *large; // [n / chunks] triangles
  const unsigned char *near; // [chunks] 0: none of the part's; NULL: all may be
} cloth_pair_large_args;

// may a triangle of element i's chunk meet the large one?
CLOTH_FN int cloth_pair_large_near(int i, const cloth_pair_large_args *a)
{
  return !a->near || a->near[i % a->chunks];
}

// cloth triangle t of element i
CLOTH_FN void cloth_pair_large_one(int i, int t, const cloth_pair_large_args *a)
{
  int large = (int)a->large[i / a->chunks];
  cloth_box box = cloth_box_load(a->mesh.box, large);
  if (cloth_box_near(cloth_box_load(a->mesh.box, t), box, cloth_pair_gap(&a->mesh, t, large)))
    cloth_pair_emit(&a->mesh, t, large);
}

CLOTH_FN void cloth_pair_large(int i, const cloth_pair_large_args *a)
{
  int chunk = i % a->chunks, end = cloth_chunk_end(0, a->mesh.cloth_triangles, chunk);
  if (!cloth_pair_large_near(i, a)) return;
  for (int t = chunk * CLOTH_CHUNK; t < end; t++) cloth_pair_large_one(i, t, a);
}
