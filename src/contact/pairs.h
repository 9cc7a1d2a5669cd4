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

/// Search the pairs of one part into part->pair. gap: distance [m] at which a pair counts; slack:
/// how far a vertex may stray [m].
cloth_status cloth_pairs_of_part(cloth_sim *sim, cloth_part *part, double gap, double slack,
                                 cloth_pairs_wanted wanted, cloth_error *err);

/// Read, clear small counters in part->counter.
cloth_status cloth_count_read(cloth_sim *sim, cloth_part *part, int place, uint32_t *out,
                              cloth_error *err);
cloth_status cloth_count_clear(cloth_sim *sim, cloth_part *part, int place, int n,
                               cloth_error *err);
