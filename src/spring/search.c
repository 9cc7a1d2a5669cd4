// Bins: which particles may meet until the next search. Everything within reach of a particle at
// the search is a candidate; the reach is the contact distance and twice what a particle may stray,
// so a list is complete until one has strayed, however many sub-steps that takes. Lists are
// ascending: forces are summed as if every pair were tested.
#include "bin_key.h"
#include "bin_search.h"
#include "contact_row.h"
#include "effect/effect.h"

#include <math.h>

double cloth_spring_stray(const cloth_sim *sim)
{
  return fmax(sim->params.pair_slack, 1.5 * sim->springs.radius);
}

// Twice as many places as particles, or more; four times that where a place is a list, along which
// a search goes step by step, and they need not be passed over.
static int place_bits(const cloth_sim *sim)
{
  int bits = 1;
  while (bits < 28 && (1 << bits) < 2 * sim->vertex_count) bits++;
  return cloth_springs_at_once(sim) ? bits + 2 : bits;
}

static cloth_status take(cloth_sim *sim, cloth_part *p, int bits, cloth_error *err)
{
  cloth_spring_part *s = &p->spring;
  size_t n = (size_t)sim->vertex_count, rows = (size_t)(p->v1 - p->v0);
  size_t places = (size_t)1 << bits;
  if (s->binned != NULL) return CLOTH_OK;
  if (!cloth_springs_at_once(sim)) { // what is sorted
    CLOTH_TRY(cloth_take(sim, p, "bin", 8 * n, &s->bin, err));
    CLOTH_TRY(cloth_take(sim, p, "bin_spare", 8 * n, &s->bin_spare, err));
    CLOTH_TRY(cloth_take(sim, p, "binned_spare", 4 * n, &s->binned_spare, err));
  }
  CLOTH_TRY(cloth_take(sim, p, "binned", 4 * n, &s->binned, err));
  CLOTH_TRY(cloth_take(sim, p, "bin_first", 4 * (places + 1), &s->bin_first, err));
  CLOTH_TRY(cloth_take(sim, p, "listed", 4 * rows, &s->listed, err));
  CLOTH_TRY(cloth_take(sim, p, "x_ref", sizeof(cloth_real) * 3 * n, &s->x_ref, err));
  CLOTH_TRY(cloth_take(sim, p, "v_ref", sizeof(cloth_real) * 3 * n, &s->v_ref, err));
  s->candidate_room = 32; // a flat sheet has 12
  return cloth_take(sim, p, "candidate", 4 * rows * s->candidate_room, &s->candidate, err);
}

cloth_bin_search_args cloth_spring_find(const cloth_sim *sim, const cloth_part *p)
{
  const cloth_spring_part *s = &p->spring;
  double reach = 2 * sim->springs.radius + 2 * cloth_spring_stray(sim);
  uint32_t mask = ((uint32_t)1 << place_bits(sim)) - 1;
  // a cell is larger than the reach by more than the rounding of a coordinate
  cloth_bins bins = {(cloth_real)(1 / (1.001 * reach)), (cloth_real)reach, mask};
  return (cloth_bin_search_args){.bins = bins,
                                 .first = p->v0,
                                 .x = p->x_t0,
                                 .start = s->bin_first,
                                 .particle = s->binned,
                                 .room = s->candidate_room,
                                 .count = s->listed,
                                 .candidate = s->candidate,
                                 .sums = s->sums};
}

cloth_status cloth_spring_search(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  cloth_spring_part *s = &p->spring;
  const cloth_backend *be = sim->backend;
  int bits = place_bits(sim);
  CLOTH_TRY(take(sim, p, bits, err));
  if (cloth_springs_at_once(sim)) return CLOTH_OK; // the block of sub-steps finds for itself
  cloth_bin_search_args a = cloth_spring_find(sim, p);
  cloth_bin_key_args key = {a.bins, p->x_t0, s->bin, s->binned};
  CLOTH_LAUNCH(sim, p, bin_key, sim->vertex_count, &key, err);
  CLOTH_TRY(be->sort(p->device, sim->vertex_count, bits, s->bin, s->binned, s->bin_spare,
                     s->binned_spare, err));
  cloth_contact_row_args start = {sim->vertex_count, s->bin, s->bin_first};
  CLOTH_LAUNCH(sim, p, contact_row, (1 << bits) + 1, &start, err);
  CLOTH_TRY(be->fill(p->device, s->sums, 0, sizeof(uint32_t) * CLOTH_SPRING_HEAD, err));
  CLOTH_LAUNCH(sim, p, bin_search, p->v1 - p->v0, &a, err);
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  CLOTH_TRY(cloth_copy_local(sim, p, s->x_ref, p->x_t0, bytes, err));
  return cloth_copy_local(sim, p, s->v_ref, p->v, bytes, err);
}

cloth_status cloth_spring_searched(cloth_sim *sim, cloth_part *p, cloth_spring_verdict *verdict,
                                   cloth_error *err)
{
  uint32_t sum[CLOTH_SPRING_HEAD];
  CLOTH_TRY(sim->backend->read(p->device, sum, p->spring.sums, sizeof sum, err));
  return cloth_spring_found(sim, p, sum, verdict, err);
}

cloth_status cloth_spring_found(cloth_sim *sim, cloth_part *p,
                                const uint32_t sum[CLOTH_SPRING_HEAD],
                                cloth_spring_verdict *verdict, cloth_error *err)
{
  cloth_spring_part *s = &p->spring;
  verdict->strayed |= sum[CLOTH_SPRING_STRAYED] > 0;
  verdict->nearly |= sum[CLOTH_SPRING_NEARLY] > 0;
  sim->report->pairs += (int)(sum[CLOTH_SPRING_CANDIDATES] / 2);
  sim->report->pair_searches += (int)sum[CLOTH_SPRING_AGAIN];
  if (sum[CLOTH_SPRING_FULL] == 0) return CLOTH_OK;
  verdict->room = false;
  s->candidate_room *= 2;
  sim->owner = CLOTH_EFFECT_self_contact;
  CLOTH_TRY(cloth_grow(sim, p, "candidate", 4 * (size_t)(p->v1 - p->v0) * (size_t)s->candidate_room,
                       &s->candidate, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}
