// A pair of features as one number, so that lists of pairs can be sorted into one order.
// Vertex-face: a is the vertex, b the triangle. Edge-edge: a < b are the edges. Pulls, which work
// out an intersection (tangle_pull.h): a is the vertex that is to go through triangle b to its
// front or its back.
#pragma once

#include "real.h"

typedef struct cloth_key_format {
  int bits_a, bits_b;
} cloth_key_format;

enum {
  CLOTH_VERTEX_FACE = 0,
  CLOTH_EDGE_EDGE = 1,
  CLOTH_PULL_FRONT = 2,
  CLOTH_PULL_BACK = 3,
  CLOTH_TYPE_BITS = 2
};

typedef struct cloth_pair {
  int type, a, b;
} cloth_pair;

CLOTH_FN uint64_t cloth_pair_pack(cloth_key_format f, int type, int a, int b)
{
  return ((((uint64_t)type << f.bits_a) | (uint64_t)a) << f.bits_b) | (uint64_t)b;
}

CLOTH_FN cloth_pair cloth_pair_unpack(cloth_key_format f, uint64_t key)
{
  cloth_pair p;
  p.b = (int)(key & (((uint64_t)1 << f.bits_b) - 1));
  key >>= f.bits_b;
  p.a = (int)(key & (((uint64_t)1 << f.bits_a) - 1));
  p.type = (int)(key >> f.bits_a);
  return p;
}
