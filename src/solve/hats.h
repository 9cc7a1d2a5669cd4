// Nodes of the solver's levels, and who shares in them: kernels/physics/hat.h.
#pragma once

#include "hat_rest.h"
#include "state/sim.h"

/// Build the levels of all cloths on a part, at load. Writes part->hats and the arrays behind it;
/// sim->hat_groups, the same on every part. Fails when out of memory.
cloth_status cloth_hats_build(cloth_sim *sim, cloth_part *part, cloth_error *err);

/// Whose nodes are whose, where parts are joined; without that, every part has all. Writes
/// part->hat_share. corner, weight [vertices x 4] as in cloth_hats. Fails when out of memory.
cloth_status cloth_hat_share_build(cloth_sim *sim, cloth_part *part, const int *corner,
                                   const cloth_real *weight, cloth_error *err);

/// Queue the blocks of all nodes, from the rows of the first linear system of a substep.
cloth_status cloth_hats_update(cloth_sim *sim, cloth_error *err);

/// What a launch of hat_rest or hat_rest_upper needs; done: [1] or NULL.
cloth_hat_rest_args cloth_hats_args(const cloth_sim *sim, const cloth_part *part,
                                    const cloth_real *done);

/// Queue the residual and the correction of each node, and their share of r'z. Afterwards r is
/// complete on every part. start: after pcg_start, when nobody has said yet whether all is done.
cloth_status cloth_hats_correct(cloth_sim *sim, bool start, cloth_error *err);

/// Queue the gathering of all levels' corrections at the first one's nodes, for pcg_direction.h.
cloth_status cloth_hats_spread(cloth_sim *sim, cloth_error *err);
