// The integrator BDF2: a substep of order 2 is one of backward Euler with another length from
// another place (kernels/physics/bdf2_start.h), so everything from prediction to commit is shared.
// It needs the substep before: what is not smooth in between (a start, a cut, a collision, a
// teleport, a change of holds) makes the next substep one of backward Euler.
#pragma once

#include "state/sim.h"

/// Buffers of a part; nothing for other integrators.
cloth_status cloth_bdf2_take(cloth_sim *sim, cloth_part *part, cloth_error *err);

/// Start a substep of sim->h: sets sim->gamma, and sim->bdf2.used if it is of order 2.
cloth_status cloth_bdf2_begin(cloth_sim *sim, cloth_error *err);

/// The substep stands; before x_t0 and v become those of its end. smooth: the next may build on it.
cloth_status cloth_bdf2_keep(cloth_sim *sim, bool smooth, cloth_error *err);

/// Keep the history of the start of a step, or go back to it.
cloth_status cloth_bdf2_save(cloth_sim *sim, bool back, cloth_error *err);

/// Does contact act in this substep? Then it cannot be of order 2.
bool cloth_bdf2_touches(const cloth_sim *sim);
