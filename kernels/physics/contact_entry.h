// The four vertices of contact i as sort keys, so that each row finds its contacts in one fixed
// order.
#pragma once

#include "real.h"

typedef struct cloth_contact_entry_args {
  int first, last;   // rows of this part; other vertices sort behind them
  const int *vertex; // [n x 4]
  uint64_t *row;     // [n x 4], written: vertex - first, or last - first
  uint32_t *entry;   // [n x 4], written: 4 contact + corner
} cloth_contact_entry_args;

CLOTH_FN void cloth_contact_entry(int i, const cloth_contact_entry_args *a)
{
  for (int c = 0; c < 4; c++) {
    int v = a->vertex[4 * i + c];
    a->row[4 * i + c] =
        (uint64_t)(v >= a->first && v < a->last ? v - a->first : a->last - a->first);
    a->entry[4 * i + c] = (uint32_t)(4 * i + c);
  }
}
