// What leaves the cloth no room: the bodies and holds in the impacts that a substep could not
// clear, and in the impact zones that these are part of (cloth between two fingers hangs together
// in one zone, so both are named, whichever of them ran through in the end); and those of what
// intersects at the end of a step where a held vertex takes part, for as long as it does.
#pragma once

#include "status.h"

#include <stdbool.h>

struct cloth_sim;

/// On the host.
typedef struct cloth_blocking {
  int count;           // bodies of the last step
  unsigned char *body; // [bodies] 1: it left no room in the last step
  int hold_count;      // holds, likewise
  unsigned char *hold; // [hold_room]
  int hold_room;
} cloth_blocking;

/// A new step: nothing yet.
void cloth_blocking_clear(struct cloth_sim *sim);

/// Take in what has part in the impacts that are left (zones.found) and in the pairs in which
/// nothing gives way (zones.driven), in a substep that stands.
cloth_status cloth_blocking_add(struct cloth_sim *sim, cloth_error *err);

/// Of the triangles that intersect (tangles.list): is one held at a corner (tangles.held)? names:
/// take in the bodies and holds of those that are.
cloth_status cloth_blocking_look(struct cloth_sim *sim, bool names, cloth_error *err);

void cloth_blocking_free(cloth_blocking *blocking);
