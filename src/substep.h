// One substep of a step (step.c).
#pragma once

#include "state/cutting.h"

/// The substep from share `from` to share `to` of the step, up to its velocities; the state before
/// it stays until it is accepted. *result says whether it stands. err: what a device says.
cloth_status cloth_advance(cloth_sim *sim, double from, double to, const cloth_cutting *cutting,
                           cloth_outcome *result, cloth_error *err);
