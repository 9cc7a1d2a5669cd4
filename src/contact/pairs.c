// Broad phase: which features may touch in this substep (the search itself is contact/hash.c). The
// list stays valid until a vertex leaves the region for which it was made (pair_slack), so cloth at
// rest is not searched again.
#include "contact/pairs.h"

#include "contact/close.h"
#include "contact/count.h"
#include "contact/flat.h"
#include "contact/near.h"
#include "contact/watch.h"
#include "vertex_escape.h"

// ---- is a search due? ---------------------------------------------------------------------------

// what a list of pairs may be lost by; with VERTICES, one of: GUESS, that of close pairs, WATCH,
// that of watched ones
enum { VERTICES = 1, SQUARES = 2, GUESS = 4, WATCH = 8 };

// Each part looks at its own vertices, and at the squares that it judges.
static cloth_status count_escaped(cloth_sim *sim, cloth_part *p, int what, cloth_error *err)
{
  CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_ESCAPED, err));
  cloth_vertex_escape_args a = {.first = p->v0,
                                .x_t0 = p->x_t0,
                                .x = p->x,
                                .box = p->vertex_box,
                                .guess = what & GUESS ? p->x_guess : NULL,
                                .cloth_vertices = sim->vertex_count,
                                .stray = (cloth_real)cloth_close_stray(sim),
                                .count = cloth_counter(p, CLOTH_COUNT_ESCAPED)};
  int b = -1, bodies = sim->def->body_count, vertices;
  if (what & VERTICES && sim->part_count > 1) {
    CLOTH_LAUNCH(sim, p, vertex_escape, p->v1 - p->v0, &a, err);
    b = p->index == 0 ? cloth_near_next(sim, 0)
                      : bodies; // vertices of bodies are the same on every part
  }
  while (what & VERTICES && b < bodies) {
    b = cloth_near_run(sim, b, false, &a.first, &vertices);
    CLOTH_LAUNCH(sim, p, vertex_escape, vertices, &a, err);
  }
  if (what & WATCH)
    CLOTH_TRY(cloth_watch_count(sim, p, cloth_counter(p, CLOTH_COUNT_ESCAPED) + 1, err));
  return what & SQUARES ? cloth_flat_check(sim, p, cloth_counter(p, CLOTH_COUNT_ESCAPED), err)
                        : CLOTH_OK;
}

// *strayed: the list of GUESS or WATCH is lost
static cloth_status escaped_any(cloth_sim *sim, int what, bool *escaped, bool *strayed,
                                cloth_error *err)
{
  *escaped = *strayed = false;
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(count_escaped(sim, &sim->part[i], what, err));
  for (int i = 0; i < sim->part_count && !*escaped; i++) {
    cloth_part *p = &sim->part[i];
    uint32_t count[2] = {0, 0};
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_ESCAPED, count, err));
    *escaped = count[0] > 0, *strayed = *strayed || count[1] > 0;
  }
  return CLOTH_OK;
}

cloth_status cloth_pairs_escaped(cloth_sim *sim, bool *escaped, cloth_error *err)
{
  bool strayed;
  int what = VERTICES | SQUARES | (sim->close_known ? GUESS : 0);
  CLOTH_TRY(escaped_any(sim, what, escaped, &strayed, err));
  sim->close_covers = sim->close_known && !*escaped && !strayed;
  return CLOTH_OK;
}

// ---- the stage ---------------------------------------------------------------------------------

static cloth_status search(cloth_sim *sim, double gap, double slack, cloth_error *err)
{
  sim->report->pair_searches++;
  sim->report->pairs = 0;
  sim->close_known = sim->close_covers = false;
  cloth_watch_forget(sim);
  CLOTH_TRY(
      cloth_pairs_of_parts(sim, sim->part, sim->part_count, gap, slack, CLOTH_PAIRS_FEATURES, err));
  for (int p = 0; p < sim->part_count; p++) // a pair on a border is counted by each of its parts
    sim->report->pairs += sim->part[p].pair_count;
  return CLOTH_OK;
}

cloth_status cloth_pairs_search(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(search(sim, sim->params.thickness, sim->params.pair_slack, err));
  sim->pairs_valid = sim->pairs_for_contacts = true;
  return CLOTH_OK;
}

cloth_status cloth_pairs_search_impacts(cloth_sim *sim, double gap, cloth_error *err)
{
  CLOTH_TRY(search(sim, gap, sim->params.pair_slack, err));
  sim->pairs_valid = true, sim->pairs_for_contacts = false;
  return CLOTH_OK;
}

cloth_status cloth_pairs_find(cloth_sim *sim, cloth_error *err)
{
  bool escaped = !sim->pairs_valid || !sim->pairs_for_contacts, strayed = false, lost = false, none;
  // cloth on the move has left by its vertices, and need not be asked about its squares
  int what = VERTICES | (sim->watch.known ? WATCH : 0);
  if (!escaped) CLOTH_TRY(escaped_any(sim, what, &escaped, &strayed, err));
  if (!escaped && sim->flat.nodes > 0) CLOTH_TRY(escaped_any(sim, SQUARES, &lost, &none, err));
  escaped = escaped || lost;
  if (escaped) {
    cloth_flat_expect(sim, lost);
    CLOTH_TRY(cloth_pairs_search(sim, err));
  }
  sim->report->pairs = 0;
  for (int p = 0; p < sim->part_count; p++) sim->report->pairs += sim->part[p].pair_count;
  return cloth_watch_update(sim, escaped, strayed, err);
}
