// A linear solve, and what to do about what it leaves.
#pragma once

#include "pcg.h"
#include "state/sim.h"

/// The vectors of a part.
cloth_pcg_vectors cloth_solve_vectors(const cloth_sim *sim, const cloth_part *p);

/// A dx = b as sim->asked says, and x += dx; r is the true residual then.
cloth_status cloth_solve(cloth_sim *sim, cloth_real scalar[CLOTH_PCG_SCALARS], cloth_error *err);

/// Did the iteration say that it had converged, and had not, by the true residual?
bool cloth_solve_failed(const cloth_sim *sim, const cloth_real scalar[CLOTH_PCG_SCALARS]);

/// Iterative refinement after a solve, where its residual is too long (solve/refine.c). scalar: of
/// that solve, and of the last one then; *correction [m]: added to; *worse: that led farther away,
/// as where rounding is all that is left of the matrix.
cloth_status cloth_solve_refine(cloth_sim *sim, cloth_real scalar[CLOTH_PCG_SCALARS],
                                double *correction, bool *worse, cloth_error *err);
