// A part's memory: built from its run of vertices, and cleared to be built from another.
#pragma once

#include "state/sim.h"

enum { CLOTH_TWO_LEVEL = 1, CLOTH_MULTILEVEL = 2 }; // of the parameter preconditioner

/// Are coarser levels of the solver worth it?
bool cloth_has_coarser_levels(const cloth_sim *sim);

/// All that a part holds for its vertices [v0, v1), but for what contact/flat.h and
/// contact/ghosts.h make of all parts together. Vectors are zero, nothing is held.
cloth_status cloth_part_build(cloth_sim *sim, cloth_part *part, cloth_error *err);

/// Frees all of that, once the device is through with it; device, events and vertices stay.
void cloth_part_clear(cloth_sim *sim, cloth_part *part);
