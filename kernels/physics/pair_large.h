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

CLOTH_FN void cloth_pair_large(int i, const cloth_pair_large_args *a)
{
  const cloth_pair_mesh *m = &a->mesh;
  int large = (int)a->large[i / a->chunks], chunk = i % a->chunks;
  if (a->near && !a->near[chunk]) return;
  int begin = chunk * CLOTH_CHUNK, end = cloth_chunk_end(0, m->cloth_triangles, chunk);
  cloth_box box = cloth_box_load(m->box, large);
  for (int t = begin; t < end; t++)
    if (cloth_box_near(cloth_box_load(m->box, t), box, m->gap)) cloth_pair_emit(m, t, large);
}
