// Where corner e of a contact stands in the list of the rows' contacts: the inverse of the sorted
// order, so that what a contact adds to its rows can be written where each row reads it in one
// piece.
#pragma once

#include "real.h"

typedef struct cloth_contact_place_args {
  const uint32_t *entry; // [n] 4 contact + corner, sorted by row
  uint32_t *place;       // [n] by 4 contact + corner, written
} cloth_contact_place_args;

CLOTH_FN void cloth_contact_place(int i, const cloth_contact_place_args *a)
{
  a->place[a->entry[i]] = (uint32_t)i;
}
