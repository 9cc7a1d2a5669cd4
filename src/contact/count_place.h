// Counters that kernels count up and the host reads (contact/count.h): a *place* is the index of
// one, or of the first of a few that lie side by side.
#pragma once

/// Each is of one kernel; "a; b" lie side by side.
typedef enum cloth_count_place {
  CLOTH_COUNT_ESCAPED = 0,   // vertices that left their regions; close pairs'; squares; in a hurry
  CLOTH_COUNT_CONTACTS = 4,  // contacts; close pairs
  CLOTH_COUNT_TANGLES = 6,   // intersecting pairs of triangles
  CLOTH_COUNT_FACTORED = 7,  // contacts kept as factors (assemble_row.h)
  CLOTH_COUNT_TOTALS = 8,    // contacts of cloth with cloth; with bodies
  CLOTH_COUNT_IMPACTS = 10,  // pairs that come to an impact; pairs in which nothing gives way
  CLOTH_COUNT_LARGE = 12,    // triangles of too many cells: of bodies; of cloth
  CLOTH_COUNT_WATCH = 14,    // vertices that strayed; watched pairs
  CLOTH_COUNT_LIMITED = 16,  // impacts; of them such that can give way
  CLOTH_COUNT_PAIRS = 18,    // candidate pairs, also those for which there was no room
  CLOTH_COUNT_UNSETTLED = 19 // contacts that changed between sticking and sliding
} cloth_count_place;

enum {
  CLOTH_COUNTS = 20,      // counters
  CLOTH_COUNT_ROUNDS = 64 // times that a place is cleared before the device is asked to
};
