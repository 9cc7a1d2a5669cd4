// Counters that kernels count up and the host reads: cloth_count_place says which.
#pragma once

#include "state/sim.h"

/// Where a place counts now, on the device.
uint32_t *cloth_counter(const cloth_part *part, cloth_count_place place);

/// Read what a place has counted.
cloth_status cloth_count_read(cloth_sim *sim, cloth_part *part, cloth_count_place place,
                              uint32_t *out, cloth_error *err);

/// From here on a place counts from zero: most of the time in another word, which is zero already,
/// so that the device is not asked. Small scenes clear ten times a step.
cloth_status cloth_count_clear(cloth_sim *sim, cloth_part *part, cloth_count_place place,
                               cloth_error *err);
