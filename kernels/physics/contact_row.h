// Where the contacts of row i / 2 begin in the sorted list: i even, all; i odd, those in factors
// (contact_entry.h).
#pragma once

#include "real.h"

typedef struct cloth_contact_row_args {
  int count;           // entries
  const uint64_t *row; // [count] sorted
  uint32_t *first;     // [2 rows + 1], written
} cloth_contact_row_args;

CLOTH_FN void cloth_contact_row(int i, const cloth_contact_row_args *a)
{
  int lo = 0, hi = a->count;
  while (lo < hi) {
    int mid = lo + (hi - lo) / 2;
    if (a->row[mid] < (uint64_t)i)
      lo = mid + 1;
    else
      hi = mid;
  }
  a->first[i] = (uint32_t)lo;
}
