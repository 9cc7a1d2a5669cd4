// Culling of flat patches; kernels/physics/flat_patch.h says why it is exact.
#pragma once

#include "flat_patch.h"
#include "state/sim.h"

/// Tiles and squares of every cloth that is flat at rest, for all parts, once. Nothing where no
/// cloth is, or where flat_culling is off.
cloth_status cloth_flat_build(cloth_sim *sim, cloth_error *err);

/// Note which squares are flat from x_t0 to x and x_pred.
cloth_status cloth_flat_note(cloth_sim *sim, cloth_part *part, cloth_error *err);

/// Before a search: were squares that were flat no more its reason?
void cloth_flat_expect(cloth_sim *sim, bool lost);

/// Count in *lost [1], on the device, the squares that were noted and are flat no more.
cloth_status cloth_flat_check(cloth_sim *sim, cloth_part *part, uint32_t *lost, cloth_error *err);

/// What the pair kernels ask.
cloth_flat_map cloth_flat_map_of(const cloth_sim *sim, const cloth_part *part);
