// A linear solve, and what to do about what it leaves.
#pragma once

#include "pcg.h"
#include "state/sim.h"

/// The vectors of a part.
cloth_pcg_vectors cloth_solve_vectors(const cloth_sim *sim, const cloth_part *p);

/// A dx = b as sim->asked says, and x += dx; r is the true residual then.
cloth_status cloth_solve(cloth_sim *sim, cloth_real scalar[CLOTH_PCG_SCALARS], cloth_error *err);

/// Has the iteration said that it was done, and was not?
bool cloth_solve_astray(const cloth_sim *sim, const cloth_real scalar[CLOTH_PCG_SCALARS]);

/// After a solve: goes on where a vertex is left farther from its place than what meets can bear
/// (solve/left.c). scalar: of that solve, and of the last one then; *correction [m]: added to;
/// *worse: that led farther away, as where rounding is all that is left of the matrix.
cloth_status cloth_solve_left(cloth_sim *sim, cloth_real scalar[CLOTH_PCG_SCALARS],
                              double *correction, bool *worse, cloth_error *err);
