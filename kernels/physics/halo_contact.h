// Which rows of a part others read because of contact i: all its own corners, by every part that
// has another corner. That part has the contact too, so both know without a word.
#pragma once

#include "atomic.h"

enum { CLOTH_HALO_PARTS = 16 };

typedef struct cloth_halo_contact_args {
  int parts, me;
  int cut[CLOTH_HALO_PARTS + 1]; // vertices [cut[j], cut[j + 1]) are part j's; the last: all cloth
  const int *vertex;             // [n x 4]
  uint32_t *reader;              // [rows of the part] bit j: part j reads it; added to
  uint32_t *outer;               // [1] contacts with a corner of another part, counts up
} cloth_halo_contact_args;

/// The part that vertex v belongs to; `parts` if it is a body's.
CLOTH_FN int cloth_part_of(const int *cut, int parts, int v)
{
  int j = 0;
  while (j < parts && v >= cut[j + 1]) j++;
  return j;
}

CLOTH_FN void cloth_halo_contact(int i, const cloth_halo_contact_args *a)
{
  uint32_t others = 0;
  int part[4];
  for (int c = 0; c < 4; c++) {
    part[c] = cloth_part_of(a->cut, a->parts, a->vertex[4 * i + c]);
    if (part[c] < a->parts && part[c] != a->me) others |= 1u << part[c];
  }
  if (!others) return;
  cloth_atomic_next(a->outer);
  for (int c = 0; c < 4; c++)
    if (part[c] == a->me)
      cloth_atomic_or(a->reader + (a->vertex[4 * i + c] - a->cut[a->me]), others);
}
