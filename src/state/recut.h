// Parts are cut anew when their work drifts: contacts gather where the cloth folds or lies, and a
// step takes as long as the part that has most to do. Work is counted, never timed, so a run is cut
// at the same steps every time; the bits do not depend on the cut at all.
#pragma once

#include "state/sim.h"

/// A solve of so many iterations over a part's rows and contacts.
void cloth_work_solve(const cloth_sim *sim, cloth_part *part, int iterations);

/// So many tests of triangles in the cells of a search.
void cloth_work_search(cloth_part *part, double tests);

/// One look at so many candidate pairs: for contacts, or for impacts.
void cloth_work_look(cloth_part *part, int pairs);

/// Between steps: part j becomes that of vertices [cut[j], cut[j + 1]), which lie as cut.h says,
/// and the state moves there. Where that does not fit into a device, back to the cut before, which
/// did.
cloth_status cloth_recut_at(cloth_sim *sim, const int *cut, cloth_error *err);

/// Before a step: cut anew if the waiting has cost as much as that costs. On failure the scene
/// takes no further step; parts that do not hold the whole cloth are marked lost.
cloth_status cloth_recut_if_due(cloth_sim *sim, cloth_error *err);

/// After a step: the share of the part with most work, into the report, and what was waited.
void cloth_recut_note(cloth_sim *sim);
