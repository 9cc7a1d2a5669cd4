// Carriers: the rigid motions of this substep that the failsafe holds cloth back against
// (kernels/physics/carrier.h). First the bodies that move, in their order, then the holds that move
// and are not on a body. What does not move is the world.
#pragma once

#include "carrier.h"
#include "state/sim.h"

/// Number the carriers of this substep [*count], send their motions to all parts, and set out from
/// where what is driven rides on what drives it and free cloth is the world's.
cloth_status cloth_carriers_begin(cloth_sim *sim, uint32_t *count, cloth_error *err);
