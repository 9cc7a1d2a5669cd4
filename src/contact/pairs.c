// Broad phase: which features may touch in this substep (the search itself is contact/hash.c). The
// list stays valid until a vertex leaves the region for which it was made (pair_slack), so cloth at
// rest is not searched again.
#include "contact/pairs.h"

#include "contact/close.h"
#include "contact/contact.h"
#include "contact/count.h"
#include "contact/flat.h"
#include "contact/near.h"
#include "contact/watch.h"
#include "vertex_box.h"
#include "vertex_escape.h"

// ---- is a search due? ---------------------------------------------------------------------------

// what a list of pairs may be lost by; with VERTICES, one of: GUESS, that of close pairs, WATCH,
// that of watched ones
enum { VERTICES = 1, SQUARES = 2, GUESS = 4, WATCH = 8 };

// where less than one in FEW vertices escaped, their regions are enlarged, and where less than one
// in HURRIED would do so soon, theirs as well
enum { FEW = 16, HURRIED = 3 };

// what was asked about and lost
typedef struct lost {
  uint32_t vertices, strayed, squares, hurried;
} lost;

// Each part looks at its own vertices, and at the squares that it judges.
static cloth_status count_escaped(cloth_sim *sim, cloth_part *p, int what, cloth_error *err)
{
  cloth_real slack =
      (cloth_real)sim->params.pair_slack; // half of what bodies near keep (predict.c)
  CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_ESCAPED, err));
  cloth_vertex_escape_args a = {.first = p->v0,
                                .x_t0 = p->x_t0,
                                .x = p->x,
                                .box = p->vertex_box,
                                .guess = what & GUESS ? p->x_guess : NULL,
                                .cloth_vertices = sim->vertex_count,
                                .room =
                                    cloth_box_swept(sim->cloth_box.lo, sim->cloth_box.hi, slack),
                                .stray = (cloth_real)cloth_close_stray(sim),
                                .slack = slack,
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
  return what & SQUARES ? cloth_flat_check(sim, p, cloth_counter(p, CLOTH_COUNT_ESCAPED) + 2, err)
                        : CLOTH_OK;
}

// A vertex is counted by the part that owns it, so the vertices are the same for any parts.
static cloth_status count_lost(cloth_sim *sim, int what, lost *out, cloth_error *err)
{
  *out = (lost){0, 0, 0, 0};
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(count_escaped(sim, &sim->part[i], what, err));
  for (int i = 0; i < sim->part_count; i++) {
    uint32_t count[4] = {0, 0, 0, 0};
    CLOTH_TRY(cloth_count_read(sim, &sim->part[i], CLOTH_COUNT_ESCAPED, count, err));
    out->vertices += count[0], out->strayed += count[1], out->squares += count[2];
    out->hurried += count[3];
  }
  return CLOTH_OK;
}

static cloth_region_lost who_left(const cloth_sim *sim, const lost *l)
{
  if (l->vertices == 0) return CLOTH_REGION_LOST_NONE;
  if (FEW * (int64_t)l->vertices >= sim->vertex_count) return CLOTH_REGION_LOST_MANY;
  return HURRIED * (int64_t)l->hurried < sim->vertex_count ? CLOTH_REGION_LOST_FEW
                                                           : CLOTH_REGION_LOST_FEW_OF_MANY;
}

cloth_status cloth_pairs_escaped(cloth_sim *sim, bool *escaped, cloth_error *err)
{
  lost l;
  int what = VERTICES | SQUARES | (sim->close_known ? GUESS : 0);
  CLOTH_TRY(count_lost(sim, what, &l, err));
  *escaped = l.vertices > 0 || l.squares > 0;
  sim->region_lost = who_left(sim, &l);
  sim->close_covers = sim->close_known && !*escaped && l.strayed == 0;
  return CLOTH_OK;
}

// ---- the stage ---------------------------------------------------------------------------------

static cloth_status search(cloth_sim *sim, double gap, cloth_error *err)
{
  sim->report->pair_searches++;
  sim->report->pairs = 0;
  sim->close_known = sim->close_covers = false;
  cloth_watch_forget(sim);
  CLOTH_TRY(cloth_pairs_of_parts(sim, sim->part, sim->part_count, gap, sim->pairs_reach,
                                 sim->params.pair_slack, CLOTH_PAIRS_FEATURES, err));
  sim->region_lost = CLOTH_REGION_LOST_NONE; // their levels are set
  for (int p = 0; p < sim->part_count; p++)  // a pair on a border is counted by each of its parts
    sim->report->pairs += sim->part[p].pair_count;
  return CLOTH_OK;
}

cloth_status cloth_pairs_search(cloth_sim *sim, cloth_error *err)
{
  sim->pairs_reach = cloth_contact_reach(sim);
  CLOTH_TRY(search(sim, sim->params.thickness, err));
  sim->pairs_valid = sim->pairs_for_contacts = true;
  return CLOTH_OK;
}

cloth_status cloth_pairs_search_impacts(cloth_sim *sim, double gap, cloth_error *err)
{
  sim->pairs_reach = 0;
  CLOTH_TRY(search(sim, gap, err));
  sim->pairs_valid = true, sim->pairs_for_contacts = false;
  return CLOTH_OK;
}

cloth_status cloth_pairs_find(cloth_sim *sim, cloth_error *err)
{
  bool escaped = !sim->pairs_valid || !sim->pairs_for_contacts ||
                 !(cloth_contact_reach(sim) <= sim->pairs_reach);
  lost v = {0, 0, 0, 0}, square = {0, 0, 0, 0};
  // cloth on the move has left by its vertices, and need not be asked about its squares
  int what = VERTICES | (sim->watch.known ? WATCH : 0);
  if (!escaped) CLOTH_TRY(count_lost(sim, what, &v, err));
  escaped = escaped || v.vertices > 0;
  if (!escaped && sim->flat.nodes > 0) CLOTH_TRY(count_lost(sim, SQUARES, &square, err));
  if (escaped || square.squares > 0) {
    escaped = true;
    sim->region_lost = who_left(sim, &v);
    cloth_flat_expect(sim, square.squares > 0);
    CLOTH_TRY(cloth_pairs_search(sim, err));
  }
  sim->report->pairs = 0;
  for (int p = 0; p < sim->part_count; p++) sim->report->pairs += sim->part[p].pair_count;
  return cloth_watch_update(sim, escaped, v.strayed > 0, err);
}
