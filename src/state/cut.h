// Where parts begin. A cut lies between units: groups of chunks (pcg.h), so that no sum depends on
// it, or with the solver's coarse level its aggregates, so that a part has all that its columns of
// the coarse matrix need.
#pragma once

#include "state/sim.h"

int cloth_cut_units(const cloth_sim *sim);

/// The first vertex of a unit; of unit cloth_cut_units() the end of all.
int cloth_cut_vertex(const cloth_sim *sim, int unit);

/// Part j gets units [first[j], first[j + 1]), as many each. first [parts + 1], written.
void cloth_cut_equally(int units, int parts, int *first);

/// The same with the smallest work that the part with most of it can have, which is returned. work
/// [units], none negative; units >= parts, and each part gets one.
double cloth_cut_by_work(int units, const double *work, int parts, int *first);
