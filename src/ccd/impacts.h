// (Not ccd.h: FCL includes a <ccd/ccd.h> of its own.)
// Nothing passes through: detection along the straight way from the start to the end of a substep.
#pragma once

#include "state/sim.h"

/// Distance that counts as an impact [m].
double cloth_impact_gap(const cloth_sim *sim);

/// Are all paths covered by the known pairs? If not, search again.
cloth_status cloth_impacts_cover(cloth_sim *sim, cloth_error *err);

/// Pairs that come to an impact into sim->zones.found: sorted, each once, whatever the parts.
/// moved: only pairs with a vertex that is in a zone.
cloth_status cloth_impacts_find(cloth_sim *sim, bool moved, cloth_error *err);

/// Hold vertices back until nothing passes through; *left: impacts that no holding back can
/// clear, because a body or a held vertex runs into what stands still.
cloth_status cloth_failsafe(cloth_sim *sim, int *left, cloth_error *err);
