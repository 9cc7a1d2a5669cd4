// Steps of a scene in which no force couples vertices (gravity, pins and grasps are all there is):
// nothing to assemble and nothing to solve. One pass over the state, kernels/physics/fly_chunk.h;
// x_t0 and x, v and v_next swap, and what a step would copy for going back is swapped, too.
#pragma once

#include "state/sim.h"

/// Is the scene such a one? Holds may come and go; no other effect begins in a running scene.
bool cloth_flies(const cloth_sim *sim);

/// What a part holds for it, instead of a linear system.
cloth_status cloth_flight_take(cloth_sim *sim, cloth_part *part, cloth_error *err);

/// A step of h seconds. *good is false where a vertex left the bounds; the state is then that
/// before.
cloth_status cloth_flight_advance(cloth_sim *sim, double h, bool *good, cloth_error *err);
