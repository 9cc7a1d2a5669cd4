// Watched pairs: of many candidates, those that may touch in one of the next substeps. They are
// chosen by their distance, once for several substeps; in between contacts are looked for among
// them alone.
//
// Why none is missed: they are chosen for vertices that go straight on
// (kernels/physics/watch_find.h) up to a distance of a thickness and three slacks. Where each
// vertex is within a slack of its way at the start and the end of a substep, and goes a way of it
// that is within half a slack of its share (watch_stray.h), what is not watched stays farther apart
// than the thickness, whichever of its ends a solve chooses, and farther than an impact after what
// close.h lets it stray. Where one is not, they are chosen anew, from all candidates.
#pragma once

#include "state/sim.h"

/// Launch, for one part, the count of its vertices that strayed; bodies are the first part's.
cloth_status cloth_watch_count(cloth_sim *sim, cloth_part *part, uint32_t *count, cloth_error *err);

/// The candidates are known. searched: they are new; strayed: a vertex is not where watched pairs
/// are chosen for. Choose anew where they do not cover this substep, if that is worth its while,
/// and set sim->watch.covers.
cloth_status cloth_watch_update(cloth_sim *sim, bool searched, bool strayed, cloth_error *err);

/// The candidates are new.
void cloth_watch_forget(cloth_sim *sim);
