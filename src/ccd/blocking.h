// Which bodies leave the cloth no room: those in the impacts that a substep could not clear, and in
// the impact zones that these are part of (cloth between two fingers hangs together in one zone, so
// both are named, whichever of them ran through in the end).
#pragma once

#include "status.h"

struct cloth_sim;

/// On the host.
typedef struct cloth_blocking {
  int count;           // bodies of the last step
  unsigned char *body; // [bodies] 1: it left no room in the last step
} cloth_blocking;

/// A new step: no body yet.
void cloth_blocking_clear(struct cloth_sim *sim);

/// Take in the bodies of the impacts that are left (zones.found) in a substep that stands.
cloth_status cloth_blocking_add(struct cloth_sim *sim, cloth_error *err);
