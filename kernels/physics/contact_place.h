// Where corner e of a contact stands in the list of the rows' contacts: the inverse of the sorted
// order, so that what a contact adds to its rows can be written where each row reads it in one
// piece. And where the row's matrix has room for a contact that lies there: looked up once for all
// the systems of a substep.
#pragma once

#include "block_rows.h"

typedef struct cloth_contact_place_args {
  int row_count, cloth_vertices;
  cloth_block_rows rows; // of this part
  const int *vertex;     // [contacts x 4]
  const uint64_t *row;   // [n] contact_entry.h, sorted
  const uint32_t *entry; // [n] 4 contact + corner, sorted by row
  uint32_t *place;       // [n] by 4 contact + corner, written
  int *slot; // [n x 4] of the corners in the row, -1 if a body's; written if in the matrix
} cloth_contact_place_args;

CLOTH_FN void cloth_contact_place(int i, const cloth_contact_place_args *a)
{
  uint32_t e = a->entry[i];
  int row = (int)(a->row[i] / 2), factored = (int)(a->row[i] % 2);
  a->place[e] = (uint32_t)i;
  for (int k = 0; k < 4 && !factored && row < a->row_count; k++) {
    int v = a->vertex[e / 4 * 4 + (uint32_t)k];
    a->slot[4 * i + k] = v < a->cloth_vertices ? cloth_block_slot(&a->rows, row, v) : -1;
  }
}
