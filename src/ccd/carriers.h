// Carriers: the rigid motions of this substep that the failsafe holds cloth back against
// (kernels/physics/carrier.h). A body that moves has its own number, a hold that moves and is not
// on a body its own behind the bodies'. What does not move is the world's, which is the last.
#pragma once

#include "carrier.h"
#include "state/sim.h"

/// Number the carriers of this substep [*count], send their motions to all parts, and set out from
/// where what is driven rides on what drives it and free cloth is the world's.
cloth_status cloth_carriers_begin(cloth_sim *sim, uint32_t *count, cloth_error *err);
