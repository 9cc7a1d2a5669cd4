// Close pairs: the pass over the candidates that looks for contacts also lists those that may come
// to an impact in this substep, and only these are looked at after the solve.
//
// Why none is missed: the list is made for the way from x_t0 to the first guess of x, with `reach`
// (pair_close.h). Where each vertex ends within `stray` of its guess, features come at most 2 stray
// nearer than on that way, so what is not in the list stays farther apart than an impact is wide,
// with room for all rounding in toi.h. Where one does not, all candidates are looked at.
#pragma once

#include "state/sim.h"

/// How far a vertex may end from its guess [m], and up to which distance pairs are close [m].
double cloth_close_stray(const cloth_sim *sim);
double cloth_close_reach(const cloth_sim *sim);

/// Candidates of all parts, where lists of them are worth their while by number and may be made;
/// else 0.
int64_t cloth_close_worth(const cloth_sim *sim);

/// Before contacts are looked for: is a list worth its while? Into sim->close_known.
cloth_status cloth_close_begin(cloth_sim *sim, cloth_error *err);

/// Of one part: how many were found. *again: there was no room, now there is.
cloth_status cloth_close_take(cloth_sim *sim, cloth_part *part, uint32_t found, bool *again,
                              cloth_error *err);

/// What to look at for impacts [*count], on the part's device: close pairs where sim->close_covers,
/// else all. Counted in the report.
const uint64_t *cloth_close_pairs(cloth_sim *sim, const cloth_part *part, int *count);
