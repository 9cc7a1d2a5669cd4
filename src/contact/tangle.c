#include "contact/contact.h"
#include "contact/count.h"
#include "contact/pairs.h"
#include "effect/effect.h"
#include "state/state.h"
#include "tangle_find.h"

#include <stdlib.h>
#include <string.h>

void cloth_tangles_free(cloth_tangle_list *t)
{
  free(t->list), free(t->read_key), free(t->read_how), free(t->pull), free(t->mark);
  free(t->group), free(t->depth), free(t->size), free(t->inside), free(t->body), free(t->exit),
      free(t->cut);
}

void cloth_tangles_suspect(cloth_sim *sim) { sim->tangles.known_free = sim->tangles.found = false; }

void cloth_body_settle(cloth_sim *sim)
{
  cloth_tangles_suspect(sim);
  sim->tangles.settling = true;
}

bool cloth_tangles_forced(const cloth_sim *sim)
{
  return sim->tangles.settling && sim->tangles.held;
}

bool cloth_untangles(const cloth_sim *sim, int bodies)
{
  return sim->params.untangle || (bodies && sim->tangles.settling);
}

// ---- detection ----------------------------------------------------------------------------------

static cloth_status grow_list(cloth_tangle_list *t, int n, cloth_error *err)
{
  if (n <= t->capacity) return CLOTH_OK;
  size_t room = (size_t)n + (size_t)n / 2 + 64;
  cloth_tangle *list = realloc(t->list, sizeof *list * room);
  if (list) t->list = list;
  uint64_t *key = realloc(t->read_key, sizeof *key * room);
  if (key) t->read_key = key;
  uint32_t *how = realloc(t->read_how, sizeof *how * room);
  if (how) t->read_how = how;
  if (!list || !key || !how) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d intersecting triangles", n);
  t->capacity = (int)room;
  return CLOTH_OK;
}

static cloth_status find_on_part(cloth_sim *sim, cloth_part *p, uint32_t *count, cloth_error *err)
{
  CLOTH_TRY(cloth_pairs_of_parts(sim, p, 1, 0, 0, 0, CLOTH_PAIRS_TRIANGLES, err));
  for (;;) {
    CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_TANGLES, err));
    cloth_tangle_find_args a = {cloth_contact_scene_of(sim, p),
                                p->pair,
                                p->tangle_key,
                                p->tangle_how,
                                p->tangle_capacity,
                                cloth_counter(p, CLOTH_COUNT_TANGLES)};
    CLOTH_LAUNCH(sim, p, tangle_find, p->pair_count, &a, err);
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_TANGLES, count, err));
    if (*count <= p->tangle_capacity) return CLOTH_OK;
    size_t n = *count; // too small: once more
    CLOTH_TRY(cloth_grow(sim, p, "tangle_key", 8 * n, &p->tangle_key, err));
    CLOTH_TRY(cloth_grow(sim, p, "tangle_how", 4 * n, &p->tangle_how, err));
    p->tangle_capacity = *count + *count / 2;
  }
}

static int compare(const void *a, const void *b)
{
  const cloth_tangle *p = a, *q = b;
  return p->key < q->key ? -1 : p->key > q->key;
}

// the present state as a substep of no length, so that nothing is swept
static cloth_status find_frozen(cloth_sim *sim, double share, cloth_error *err)
{
  cloth_tangle_list *t = &sim->tangles;
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  for (int i = 0; i < sim->part_count; i++)
    CLOTH_TRY(cloth_copy_local(sim, &sim->part[i], sim->part[i].x, sim->part[i].x_t0, bytes, err));
  CLOTH_TRY(cloth_freeze_bodies_at(sim, share, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    uint32_t count;
    CLOTH_TRY(find_on_part(sim, p, &count, err));
    if (count == 0) continue;
    CLOTH_TRY(grow_list(t, t->count + (int)count, err));
    CLOTH_TRY(sim->backend->read(p->device, t->read_key, p->tangle_key, 8 * (size_t)count, err));
    CLOTH_TRY(sim->backend->read(p->device, t->read_how, p->tangle_how, 4 * (size_t)count, err));
    for (uint32_t k = 0; k < count; k++)
      t->list[t->count++] = (cloth_tangle){t->read_key[k], t->read_how[k]};
  }
  return CLOTH_OK;
}

cloth_status cloth_tangles_find(cloth_sim *sim, double share, cloth_error *err)
{
  cloth_tangle_list *t = &sim->tangles;
  t->count = 0;
  if (!sim->active[CLOTH_EFFECT_self_contact] && !sim->active[CLOTH_EFFECT_body_contact])
    return CLOTH_OK;
  double h = sim->h;
  sim->h = 0;
  sim->pairs_valid = false; // the candidates of the simulation are overwritten: it searches again
  sim->owner = cloth_contact_owner(sim);
  cloth_status status = find_frozen(sim, share, err);
  sim->owner = CLOTH_CORE;
  sim->h = h;
  if (t->count > 0) qsort(t->list, (size_t)t->count, sizeof *t->list, compare);
  return status;
}

// ---- what the step needs ------------------------------------------------------------------------

cloth_status cloth_tangles_mark(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  size_t bytes = sizeof *sim->tangles.mark * (size_t)sim->vertex_count;
  sim->owner = cloth_contact_owner(sim);
  if (p->stray == NULL) CLOTH_TRY(cloth_take(sim, p, "stray", bytes, &p->stray, err));
  CLOTH_TRY(sim->backend->write(p->device, p->stray, sim->tangles.mark, bytes, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

cloth_status cloth_tangles_update(cloth_sim *sim, double share, cloth_error *err)
{
  cloth_tangle_list *t = &sim->tangles;
  if (t->known_free || t->found || cloth_is_mass_spring(sim)) return CLOTH_OK;
  t->pull_count = 0;
  CLOTH_TRY(cloth_tangles_find(sim, share, err));
  t->found = true;
  CLOTH_TRY(cloth_blocking_look(sim, false, err));
  if (t->count == 0) {
    t->known_free = true, t->settling = false;
    return CLOTH_OK;
  }
  CLOTH_TRY(cloth_stray_find(sim, err));
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(cloth_tangles_mark(sim, &sim->part[i], err));
  return CLOTH_OK;
}

// ---- looking on ---------------------------------------------------------------------------------

static cloth_tangle_view view_of(const cloth_sim *sim, uint64_t key)
{
  cloth_pair pair = cloth_pair_unpack(sim->format, key);
  cloth_tangle_view v = {.cloth = cloth_of_triangle(sim, pair.a),
                         .triangle = sim->triangle_order[pair.a],
                         .other_cloth = -1,
                         .other_body = -1};
  if (pair.b < sim->triangle_count) {
    v.other_cloth = cloth_of_triangle(sim, pair.b);
    v.other_triangle = sim->triangle_order[pair.b];
  } else {
    v.other_body = cloth_body_of_triangle(sim, pair.b);
    v.other_triangle = pair.b - sim->body[v.other_body].triangle_first;
  }
  if (v.other_cloth >= 0 &&
      (v.other_cloth < v.cloth || (v.other_cloth == v.cloth && v.other_triangle < v.triangle))) {
    int cloth = v.cloth, triangle = v.triangle;
    v.cloth = v.other_cloth, v.triangle = v.other_triangle;
    v.other_cloth = cloth, v.other_triangle = triangle;
  }
  return v;
}

static int compare_views(const void *pa, const void *pb)
{
  const cloth_tangle_view *a = pa, *b = pb;
  const int ka[5] = {a->cloth, a->triangle, a->other_body, a->other_cloth, a->other_triangle};
  const int kb[5] = {b->cloth, b->triangle, b->other_body, b->other_cloth, b->other_triangle};
  for (int k = 0; k < 5; k++)
    if (ka[k] != kb[k]) return ka[k] < kb[k] ? -1 : 1;
  return 0;
}

cloth_status cloth_sim_tangles(void *data, cloth_tangle_view *out, int capacity, int *count,
                               cloth_error *err)
{
  cloth_sim *sim = data;
  cloth_step_report scratch = {0};
  cloth_tangle_list *t = &sim->tangles;
  *count = 0;
  if (cloth_is_mass_spring(sim))
    CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "integrator mass_spring has no pairs of triangles");
  sim->report = &scratch;
  CLOTH_TRY(cloth_tangles_find(sim, 0, err));
  *count = t->count;
  cloth_tangle_view *all = malloc(sizeof *all * ((size_t)t->count + 1));
  if (all == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "intersecting triangles");
  for (int i = 0; i < t->count; i++) all[i] = view_of(sim, t->list[i].key);
  qsort(all, (size_t)t->count, sizeof *all, compare_views);
  for (int i = 0; i < t->count && i < capacity; i++) out[i] = all[i];
  free(all);
  if (t->known_free) t->count = 0; // what a state that is free should not have changes no step
  return CLOTH_OK;
}
