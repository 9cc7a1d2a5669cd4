// How the parameter `accuracy` chooses substeps (doc/budget.md): an estimate of the error that each
// substep adds, root mean square over the cloth, and the length at which a second adds no more than
// was asked for. The estimate is the leading term of the integrator's local error, so it needs no
// second solve; control of error per unit step as in Hairer and Wanner (1996), IV.8. No clock is
// read, and sums run in the order of chunks: the same bits wherever the engine gives the same bits.
#pragma once

#include "state/cutting.h"

/// The parts a step of h seconds begins with: at least `least`.
int cloth_control_begin(cloth_sim *sim, double h, int least);

/// Into how many parts a substep that was computed is cut and repeated; 1: it stands.
int cloth_control_cut(const cloth_sim *sim, cloth_cutting *cutting, double share);

/// A substep stands that is off by `estimate` [m], root mean square.
void cloth_control_add(cloth_sim *sim, double estimate);

/// The step of h seconds ended in substeps of 1 / parts: report, and the parts of the next one.
void cloth_control_end(cloth_sim *sim, double h, int parts);

/// Nothing is known of the motion any more.
void cloth_control_forget(cloth_sim *sim);
