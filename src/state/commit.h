// The end of a substep: velocities, and what the report sums over all vertices.
#pragma once

#include "state/sim.h"

/// Velocities of the substep's end. *good is false where something is not finite or out of bounds.
cloth_status cloth_commit(cloth_sim *sim, bool *good, cloth_error *err);

/// How velocities changed against what was expected, of what is not held [m/s].
typedef struct cloth_change {
  double largest;
  double
      mean; // root of the mean of squares, by mass; flight leaves it to `largest`, all change alike
} cloth_change;

/// Adds up what commit_chunk.h left of each chunk, into the report and *change.
cloth_status cloth_commit_sums(cloth_sim *sim, bool *good, cloth_change *change, cloth_error *err);

/// Mean velocity and acceleration of each cloth; a chunk counts for the cloth of its first vertex.
void cloth_mean_motion(cloth_sim *sim);
