// Counters that kernels count up and the host reads (contact/count.h): a *place* is the index of
// one, or of the first of two that lie side by side.
#pragma once

/// Each is of one kernel; "a; b" are two side by side.
typedef enum cloth_count_place {
  CLOTH_COUNT_ESCAPED = 0,   // vertices and squares that left their regions; close pairs' vertices
  CLOTH_COUNT_CONTACTS = 2,  // contacts; close pairs
  CLOTH_COUNT_TANGLES = 4,   // intersecting pairs of triangles
  CLOTH_COUNT_FACTORED = 5,  // contacts kept as factors (assemble_row.h)
  CLOTH_COUNT_TOTALS = 6,    // contacts of cloth with cloth; with bodies
  CLOTH_COUNT_IMPACTS = 8,   // pairs that come to an impact; pairs in which nothing gives way
  CLOTH_COUNT_LARGE = 10,    // triangles of too many cells: of bodies; of cloth
  CLOTH_COUNT_WATCH = 12,    // vertices that strayed; watched pairs
  CLOTH_COUNT_LIMITED = 14,  // impacts; of them such that can give way
  CLOTH_COUNT_PAIRS = 16,    // candidate pairs, also those for which there was no room
  CLOTH_COUNT_UNSETTLED = 17 // contacts that changed between sticking and sliding
} cloth_count_place;

enum {
  CLOTH_COUNTS = 18,      // counters
  CLOTH_COUNT_ROUNDS = 64 // times that a place is cleared before the device is asked to
};
