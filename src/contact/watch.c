#include "contact/watch.h"

#include "contact/close.h"
#include "contact/contact.h"
#include "contact/count.h"
#include "effect/effect.h"
#include "state/recut.h"
#include "watch_find.h"
#include "watch_stray.h"

enum {
  AHEAD = 8,      // substeps for which pairs are chosen
  REST = 16,      // substeps in which it is not tried again after it was of no use
  SHARE_MOST = 3, // a third of the candidates at most, which bounds the memory
  PER_VERTEX = 8  // candidates from which on it is worth the copies of all positions
};

// Slack, in thicknesses: where it begins, and its bounds
#define SLACK       0.3
#define SLACK_LEAST 0.05
#define SLACK_MOST  1.0
#define SLACK_GROWS 1.25 // factors when pairs are chosen anew
#define SLACK_FALLS 0.8
#define MARGIN      1.05 // of the thickness: what is watched, and some for rounding

void cloth_watch_forget(cloth_sim *sim) { sim->watch.known = sim->watch.covers = false; }

// share of x1 - x0 that lies behind a vertex at this time
static double share_at(const cloth_watch *w, double time) { return (time - w->begin) / w->h; }

static cloth_watch_stray_args stray_args(const cloth_sim *sim, const cloth_part *p, uint32_t *count)
{
  const cloth_watch *w = &sim->watch;
  return (cloth_watch_stray_args){.cloth_vertices = sim->vertex_count,
                                  .x0 = p->watch_x0,
                                  .x1 = p->watch_x1,
                                  .begin = (cloth_real)share_at(w, sim->time_t0),
                                  .end = (cloth_real)share_at(w, sim->time_t0 + sim->h),
                                  .x_t0 = p->x_t0,
                                  .x = p->x,
                                  .x_pred = p->x_pred,
                                  .slack = (cloth_real)w->slack,
                                  .strayed = count};
}

cloth_status cloth_watch_count(cloth_sim *sim, cloth_part *p, uint32_t *count, cloth_error *err)
{
  cloth_watch_stray_args a = stray_args(sim, p, count);
  a.first = p->v0;
  CLOTH_LAUNCH(sim, p, watch_stray, p->v1 - p->v0, &a, err);
  for (int b = 0; b < sim->def->body_count && p->index == 0; b++) {
    const cloth_body *body = &sim->body[b];
    if (!body->near) continue;
    a.first = body->vertex_first;
    CLOTH_LAUNCH(sim, p, watch_stray, body->vertex_count, &a, err);
  }
  return CLOTH_OK;
}

static bool is_wanted(const cloth_sim *sim)
{
  return cloth_close_worth(sim) >= PER_VERTEX * (int64_t)sim->vertex_count;
}

static cloth_status find(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  const cloth_watch *w = &sim->watch;
  double reach = MARGIN * sim->params.thickness + cloth_contact_reach(sim) + 3 * w->slack;
  CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_WATCH, err));
  uint32_t *count = cloth_counter(p, CLOTH_COUNT_WATCH);
  CLOTH_TRY(cloth_watch_count(sim, p, count, err));
  cloth_watch_find_args a = {.scene = cloth_contact_scene_of(sim, p),
                             .x0 = p->watch_x0,
                             .x1 = p->watch_x1,
                             .middle = (cloth_real)(0.5 * AHEAD),
                             .span = (cloth_real)(0.5 * AHEAD + 1),
                             .reach = (cloth_real)reach,
                             .pair = p->pair,
                             .watch = p->watch,
                             .capacity = p->watch_capacity,
                             .count = count + 1};
  sim->report->pairs_looked += p->pair_count;
  cloth_work_look(p, p->pair_count);
  return cloth_launch(sim, p, CLOTH_KERNEL_watch_find, p->pair_count, &a, err);
}

static cloth_status begin(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->all_vertices;
  if (p->watch_x0 == NULL) {
    CLOTH_TRY(cloth_take(sim, p, "watch_x0", bytes, &p->watch_x0, err));
    CLOTH_TRY(cloth_take(sim, p, "watch_x1", bytes, &p->watch_x1, err));
  }
  CLOTH_TRY(cloth_copy_local(sim, p, p->watch_x0, p->x_t0, bytes, err));
  CLOTH_TRY(cloth_copy_local(sim, p, p->watch_x1, p->x, bytes, err));
  return find(sim, p, err);
}

// how many there are, and again with more room where it was too small; *useful: few enough, and
// no vertex strays at once
static cloth_status take(cloth_sim *sim, cloth_part *p, bool *useful, cloth_error *err)
{
  for (;;) {
    uint32_t count[2];
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_WATCH, count, err));
    if (count[0] > 0 || SHARE_MOST * (int64_t)count[1] > p->pair_count) *useful = false;
    p->watch_count = (int)count[1];
    if (!*useful || count[1] <= p->watch_capacity) return CLOTH_OK;
    CLOTH_TRY(cloth_grow(sim, p, "watch", 8 * (size_t)count[1], &p->watch, err));
    p->watch_capacity = count[1] + count[1] / 2;
    CLOTH_TRY(find(sim, p, err));
  }
}

static cloth_status choose(cloth_sim *sim, cloth_error *err)
{
  bool useful = true;
  cloth_watch *w = &sim->watch;
  w->begin = sim->time_t0, w->h = sim->h, w->used = 0;
  if (!(w->slack > 0)) w->slack = SLACK * sim->params.thickness;
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(begin(sim, &sim->part[i], err));
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(take(sim, &sim->part[i], &useful, err));
  w->known = w->covers = useful;
  w->rest = useful ? 0 : REST;
  if (!useful) w->slack /= 2;
  return CLOTH_OK;
}

// A slack that is too small has pairs chosen too often, one that is too large has too many watched:
// both cost the same where their sum is least.
static void adapt(cloth_sim *sim, bool strayed)
{
  cloth_watch *w = &sim->watch;
  int64_t all = 0, watched = 0;
  for (int i = 0; i < sim->part_count; i++)
    all += sim->part[i].pair_count, watched += sim->part[i].watch_count;
  bool larger = strayed && watched * (w->used + 1) < all;
  double slack = w->slack / sim->params.thickness * (larger ? SLACK_GROWS : SLACK_FALLS);
  slack = slack < SLACK_LEAST ? SLACK_LEAST : slack > SLACK_MOST ? SLACK_MOST : slack;
  w->slack = slack * sim->params.thickness;
}

cloth_status cloth_watch_update(cloth_sim *sim, bool searched, bool strayed, cloth_error *err)
{
  cloth_watch *w = &sim->watch;
  bool lasted = w->lasted; // candidates that are searched in every substep are passed over once
  w->lasted = !searched;
  if (searched && !lasted) return CLOTH_OK;
  double begin = share_at(w, sim->time_t0), end = share_at(w, sim->time_t0 + sim->h);
  bool in_time = begin >= 0 && end <= AHEAD * (1 + 1e-6) && end - begin <= 1 + 1e-6;
  w->covers = false;
  if (!is_wanted(sim)) return CLOTH_OK;
  w->covers = w->known && !strayed && in_time;
  if (w->covers) {
    w->used++;
    return CLOTH_OK;
  }
  if (w->rest > 0) {
    w->rest--;
    return CLOTH_OK;
  }
  if (w->known) adapt(sim, strayed);
  return choose(sim, err);
}
