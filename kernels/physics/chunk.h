// Sums over vertices run in chunks of fixed size and fixed places, whatever the number of threads
// or parts, and the chunks' sums are added in one order (pcg.h): the same bits everywhere. Parts
// are cut at chunks.
#pragma once

#include "real.h"

enum { CLOTH_CHUNK = 64 };

/// Numbers of all levels, where n numbers become one for each chunk, these one for each chunk of
/// theirs, and so on until few are left: no more than this.
CLOTH_FN int cloth_chunk_levels(int n) { return n / (CLOTH_CHUNK - 1) + 8; }

CLOTH_FN int cloth_chunk_end(int first, int count, int chunk)
{
  int end = (chunk + 1) * CLOTH_CHUNK;
  return first + (end < count ? end : count);
}

/// The larger of two; NaN if either is.
CLOTH_FN cloth_real cloth_larger(cloth_real a, cloth_real b) { return !(b <= a) && a == a ? b : a; }

/// Pairwise sum of `width` numbers, a power of two: the tree that the threads of a GPU block walk
/// too, so that both give the same bits. v is overwritten.
CLOTH_FN cloth_real cloth_lanes_sum(cloth_real *v, int width)
{
  for (width /= 2; width > 0; width /= 2)
    for (int k = 0; k < width; k++) v[k] += v[k + width];
  return v[0];
}

/// The same where all but the first `used` numbers are zero: they are neither read nor added.
CLOTH_FN cloth_real cloth_lanes_sum_of(cloth_real *v, int used, int width)
{
  int some = 1;
  while (some < used) some *= 2;
  for (int k = used; k < some; k++) v[k] = 0;
  return some < width ? cloth_lanes_sum(v, some) + 0 : cloth_lanes_sum(v, width); // -0 + 0 is 0
}

/// Sum of a chunk's numbers; what lies behind the end of the chunk is zero.
CLOTH_FN cloth_real cloth_chunk_sum(cloth_real *v) { return cloth_lanes_sum(v, CLOTH_CHUNK); }
