// The broad phase as the contact stage, the failsafe and the queries use it.
#pragma once

#include "state/sim.h"

/// What a search reports: features that may touch, (cloth triangle, body triangle), or
/// (cloth triangle, triangle).
typedef enum cloth_pairs_wanted {
  CLOTH_PAIRS_FEATURES,
  CLOTH_PAIRS_BODY_TRIANGLES,
  CLOTH_PAIRS_TRIANGLES
} cloth_pairs_wanted;

/// Search the pairs of `parts` parts into part->pair (contact/hash.c). gap: distance [m] at which a
/// pair of cloth counts, reach: how much farther one with a body does [m]; slack: how far a vertex
/// may stray [m].
cloth_status cloth_pairs_of_parts(cloth_sim *sim, cloth_part *part, int parts, double gap,
                                  double reach, double slack, cloth_pairs_wanted wanted,
                                  cloth_error *err);
