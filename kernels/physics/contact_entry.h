// The four vertices of contact i as sort keys, so that each row finds its contacts in one fixed
// order: first those with a body, whose blocks lie in the matrix (assemble_row.h), then those of
// cloth with cloth, which the product takes in factors (contact_product.h).
#pragma once

#include "atomic.h"

typedef struct cloth_contact_entry_args {
  int first, last;   // rows of this part; other vertices sort behind them
  int body_first;    // vertices from here on are bodies'; above all: no contact is in the matrix
  const int *vertex; // [n x 4]
  uint64_t *row;     // [n x 4], written: 2 (vertex - first), or 2 (last - first), and 1 if factored
  uint32_t *entry;   // [n x 4], written: 4 contact + corner
  uint32_t *factored; // [1] contacts in factors, counts up
} cloth_contact_entry_args;

/// Is a contact with these corners kept in factors? One with a body is not: what is left of it are
/// corners of one vertex, edge or face, which have blocks of the mesh between them.
CLOTH_FN int cloth_contact_is_factored(const int *vertex, int body_first)
{
  return vertex[0] < body_first && vertex[1] < body_first && vertex[2] < body_first &&
         vertex[3] < body_first;
}

CLOTH_FN void cloth_contact_entry(int i, const cloth_contact_entry_args *a)
{
  int factored = cloth_contact_is_factored(a->vertex + 4 * i, a->body_first);
  if (factored) cloth_atomic_next(a->factored);
  for (int c = 0; c < 4; c++) {
    int v = a->vertex[4 * i + c];
    int row = v >= a->first && v < a->last ? v - a->first : a->last - a->first;
    a->row[4 * i + c] = (uint64_t)(2 * row + factored);
    a->entry[4 * i + c] = (uint32_t)(4 * i + c);
  }
}
