// Vertex moving[i] is in an impact zone.
#pragma once

#include "real.h"

typedef struct cloth_zone_mark_args {
  const int *moving;    // [n] vertices
  unsigned char *moved; // [vertices], set to 1
} cloth_zone_mark_args;

CLOTH_FN void cloth_zone_mark(int i, const cloth_zone_mark_args *a) { a->moved[a->moving[i]] = 1; }
