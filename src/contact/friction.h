// What friction remembers from substep to substep.
#pragma once

#include "state/sim.h"

/// One remembered contact, on the host.
typedef struct cloth_friction_entry {
  uint64_t key;       // of the pair
  cloth_real slip[3]; // m, in the frame of the pair
} cloth_friction_entry;

/// Elastic slip that a contact can bear [m].
cloth_real cloth_friction_limit(const cloth_sim *sim);

/// The elastic slip with which the contacts of a part start, after they were built.
cloth_status cloth_friction_begin(cloth_sim *sim, cloth_part *part, cloth_error *err);

/// After a linear solve that may not be the last: what cloth_friction_settled() will ask, so that
/// it comes with what the host reads of the solve.
cloth_status cloth_friction_look(cloth_sim *sim, cloth_error *err);

/// Do all contacts still stick or slide as the last solve took them to?
cloth_status cloth_friction_settled(cloth_sim *sim, bool *settled, cloth_error *err);

/// Remember the contacts of a substep that stands; before x becomes x_t0.
cloth_status cloth_friction_finish(cloth_sim *sim, cloth_error *err);

/// Put the memory aside at the start of a step; take it back if the step is undone.
cloth_status cloth_friction_save(cloth_sim *sim, bool back, cloth_error *err);

/// Forget all.
void cloth_friction_forget(cloth_sim *sim);

/// The whole memory, sorted by key, the same for any number of parts. To be freed by the caller.
cloth_status cloth_friction_read(cloth_sim *sim, cloth_friction_entry **out, int *count,
                                 cloth_error *err);

/// Set it on every part. `count` entries, sorted by key.
cloth_status cloth_friction_write(cloth_sim *sim, const cloth_friction_entry *entry, int count,
                                  cloth_error *err);
