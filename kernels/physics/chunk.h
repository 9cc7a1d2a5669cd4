// Sums over vertices run in chunks of fixed size and fixed places, whatever the number of threads
// or parts, and the chunks' sums are added in order: the same bits everywhere. Parts are cut at
// chunks.
#pragma once

#include "real.h"

enum { CLOTH_CHUNK = 64 };

CLOTH_FN int cloth_chunk_end(int first, int count, int chunk)
{
  int end = (chunk + 1) * CLOTH_CHUNK;
  return first + (end < count ? end : count);
}
