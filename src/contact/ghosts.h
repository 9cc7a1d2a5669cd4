// Which triangles of others a part has to do with in a search: those that may lie in a cell with
// one of its own. They are found chunk by chunk, so that the rest costs a part nothing.
#pragma once

#include "cell_mark.h"
#include "state/sim.h"

/// The chunks of vertices that each chunk of triangles has, on all parts. Nothing with one part.
cloth_status cloth_ghosts_build(cloth_sim *sim, cloth_error *err);

/// Mark the cells of the part's own triangles, and the chunks of triangles that may lie in them,
/// into ghost_near; from the boxes of vertices. Nothing with one part.
cloth_status cloth_ghosts_find(cloth_sim *sim, cloth_part *part, const cloth_grid *grid, double gap,
                               cloth_error *err);

/// What the kernels ask: all cells with one part.
cloth_cell_marks cloth_ghosts_marks(const cloth_part *part);
