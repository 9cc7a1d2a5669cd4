// Momentum of cloth in flight. A solve that stops at one per cent leaves a residual whose sum is no
// force of nature, yet pushes the cloth as a whole: a towel that falls and turns gained 3 % of g.
// Forces inside cloth and between cloths cancel, so nothing but inertia answers a shift of all
// vertices, and the shift that takes the sum away is known: h^2 / M times it.
#include "balance_chunk.h"
#include "balance_mean.h"
#include "balance_shift.h"
#include "state/sim.h"

#include <stddef.h>

cloth_status cloth_balance(cloth_sim *sim, cloth_error *err)
{
  if (sim->held_count > 0 || sim->report->bodies_near > 0) return CLOTH_OK; // they answer too
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_balance_chunk_args a = {p->v0, p->v1 - p->v0, p->r, p->partial};
    CLOTH_LAUNCH(sim, p, balance_chunk, cloth_part_chunks(p), &a, err);
  }
  CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, partial), CLOTH_PER_CHUNK,
                           CLOTH_PCG_PARTIALS * sizeof(cloth_real), err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_balance_mean_args m = {sim->chunks, (cloth_real)(sim->h * sim->h / sim->mass_total),
                                 p->partial, p->balance};
    CLOTH_LAUNCH(sim, p, balance_mean, 3, &m, err);
    cloth_balance_shift_args s = {p->balance, p->x};
    CLOTH_LAUNCH(sim, p, balance_shift, sim->vertex_count, &s, err);
  }
  return CLOTH_OK;
}
