// What friction remembers: the elastic slip of every contact, sorted by the key of its pair. A
// contact finds its own of the last substep by search in that list. Each part remembers the
// contacts that touch its rows, so those on a border are remembered by each of their parts, with
// the same bits.
#include "contact/friction.h"

#include "contact/contact.h"
#include "contact/count.h"
#include "effect/effect.h"
#include "friction_check.h"
#include "friction_keep.h"
#include "friction_recall.h"

#include <stdlib.h>
#include <string.h>

cloth_real cloth_friction_limit(const cloth_sim *sim)
{
  return (cloth_real)(sim->params.friction_elastic_slip * sim->params.thickness);
}

static cloth_status grow_contacts(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  size_t n = (size_t)p->contact_count;
  if (n <= p->friction_capacity) return CLOTH_OK;
  const size_t row = 3 * sizeof(cloth_real);
  CLOTH_TRY(cloth_grow(sim, p, "friction_elastic", row * n, &p->friction_elastic, err));
  CLOTH_TRY(cloth_grow(sim, p, "friction_trial", row * n, &p->friction_trial, err));
  CLOTH_TRY(cloth_grow(sim, p, "friction_bound", sizeof(cloth_real) * n, &p->friction_bound, err));
  CLOTH_TRY(
      cloth_grow(sim, p, "friction_secant", sizeof(cloth_real) * n, &p->friction_secant, err));
  CLOTH_TRY(cloth_grow(sim, p, "friction_state", n, &p->friction_state, err));
  p->friction_capacity = (uint32_t)(n + n / 2);
  return CLOTH_OK;
}

// contents are lost, of what is put aside too
static cloth_status grow_kept(cloth_sim *sim, cloth_part *p, size_t n, cloth_error *err)
{
  if (n <= p->kept_capacity) return CLOTH_OK;
  const size_t row = 3 * sizeof(cloth_real);
  CLOTH_TRY(cloth_grow(sim, p, "friction_kept", 8 * n, &p->kept, err));
  CLOTH_TRY(cloth_grow(sim, p, "friction_kept_slip", row * n, &p->kept_slip, err));
  p->kept_capacity = (uint32_t)(n + n / 2);
  return CLOTH_OK;
}

cloth_status cloth_friction_begin(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  if (!sim->active[CLOTH_EFFECT_friction]) return CLOTH_OK;
  int owner = sim->owner;
  sim->owner = CLOTH_EFFECT_friction;
  CLOTH_TRY(grow_contacts(sim, p, err));
  cloth_friction_recall_args a = {.scene = cloth_contact_scene_of(sim, p),
                                  .count = p->contact_count,
                                  .contact = p->contact,
                                  .normal = p->contact_normal,
                                  .distance = p->contact_distance,
                                  .kept_count = p->kept_count,
                                  .kept = p->kept,
                                  .kept_slip = p->kept_slip,
                                  .elastic = p->friction_elastic,
                                  .state = p->friction_state};
  CLOTH_LAUNCH(sim, p, friction_recall, p->contact_count, &a, err);
  sim->owner = owner;
  return CLOTH_OK;
}

// The parts count the contacts that the last solve did not leave where it took them to be.
static cloth_status count_unsettled(cloth_sim *sim, cloth_error *err)
{
  sim->owner = CLOTH_EFFECT_friction;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    if (p->contact_count == 0) continue;
    CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_UNSETTLED, err));
    cloth_friction_check_args a = {.vertex = p->contact_vertex,
                                   .weight = p->contact_weight,
                                   .normal = p->contact_normal,
                                   .elastic = p->friction_elastic,
                                   .trial = p->friction_trial,
                                   .state = p->friction_state,
                                   .bound = p->friction_bound,
                                   .distance = p->contact_distance,
                                   .thickness = p->contact_thickness,
                                   .k = p->contact_k,
                                   .inertia = p->contact_inertia,
                                   .relief = p->contact_relief,
                                   .mu = p->contact_mu,
                                   .x_t0 = p->x_t0,
                                   .x = p->x,
                                   .limit = cloth_friction_limit(sim),
                                   .count = cloth_counter(p, CLOTH_COUNT_UNSETTLED)};
    CLOTH_LAUNCH(sim, p, friction_check, p->contact_count, &a, err);
  }
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

cloth_status cloth_friction_look(cloth_sim *sim, cloth_error *err)
{
  cloth_along *along = &sim->along;
  cloth_part *p = &sim->part[0];
  along->friction =
      !sim->asked.last && sim->active[CLOTH_EFFECT_friction] && cloth_reads_along(sim);
  along->unsettled = 0;
  if (!along->friction || p->contact_count == 0) return CLOTH_OK;
  CLOTH_TRY(count_unsettled(sim, err));
  return cloth_read_along(sim, &along->unsettled, cloth_counter(p, CLOTH_COUNT_UNSETTLED),
                          sizeof along->unsettled, err);
}

cloth_status cloth_friction_settled(cloth_sim *sim, bool *settled, cloth_error *err)
{
  *settled = true;
  if (!sim->active[CLOTH_EFFECT_friction]) return CLOTH_OK;
  if (sim->along.friction) {
    *settled = sim->along.unsettled == 0;
    return CLOTH_OK;
  }
  CLOTH_TRY(count_unsettled(sim, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    uint32_t count;
    if (p->contact_count == 0) continue;
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_UNSETTLED, &count, err));
    *settled = *settled && count == 0;
  }
  return CLOTH_OK;
}

cloth_status cloth_friction_finish(cloth_sim *sim, cloth_error *err)
{
  if (!sim->active[CLOTH_EFFECT_friction]) return CLOTH_OK;
  sim->owner = CLOTH_EFFECT_friction;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    p->kept_count = p->contact_count;
    if (p->contact_count == 0) continue;
    CLOTH_TRY(grow_kept(sim, p, (size_t)p->contact_count, err));
    cloth_friction_keep_args a = {.scene = cloth_contact_scene_of(sim, p),
                                  .contact = p->contact,
                                  .vertex = p->contact_vertex,
                                  .weight = p->contact_weight,
                                  .normal = p->contact_normal,
                                  .distance = p->contact_distance,
                                  .thickness = p->contact_thickness,
                                  .elastic = p->friction_elastic,
                                  .limit = cloth_friction_limit(sim),
                                  .kept = p->kept,
                                  .kept_slip = p->kept_slip};
    CLOTH_LAUNCH(sim, p, friction_keep, p->contact_count, &a, err);
  }
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

static cloth_status save_part(cloth_sim *sim, cloth_part *p, bool back, cloth_error *err)
{
  int n = back ? p->kept_count_saved : p->kept_count;
  size_t keys = 8 * (size_t)n, slips = 3 * sizeof(cloth_real) * (size_t)n;
  *(back ? &p->kept_count : &p->kept_count_saved) = n;
  if (n == 0) return CLOTH_OK;
  if (back) {
    CLOTH_TRY(grow_kept(sim, p, (size_t)n, err));
  } else {
    // as much as `kept` holds, so that it does not grow with every contact
    size_t room = p->kept_capacity;
    CLOTH_TRY(cloth_grow(sim, p, "friction_kept_saved", 8 * room, &p->kept_saved, err));
    CLOTH_TRY(cloth_grow(sim, p, "friction_kept_slip_saved", 3 * sizeof(cloth_real) * room,
                         &p->kept_slip_saved, err));
  }
  CLOTH_TRY(cloth_copy_local(sim, p, back ? p->kept : p->kept_saved, back ? p->kept_saved : p->kept,
                             keys, err));
  return cloth_copy_local(sim, p, back ? p->kept_slip : p->kept_slip_saved,
                          back ? p->kept_slip_saved : p->kept_slip, slips, err);
}

cloth_status cloth_friction_save(cloth_sim *sim, bool back, cloth_error *err)
{
  if (!sim->active[CLOTH_EFFECT_friction]) return CLOTH_OK;
  sim->owner = CLOTH_EFFECT_friction;
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(save_part(sim, &sim->part[i], back, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

void cloth_friction_forget(cloth_sim *sim)
{
  for (int i = 0; i < sim->part_count; i++) sim->part[i].kept_count = 0;
}

// ---- for state files ----------------------------------------------------------------------------

// the first cloth vertex of a pair: the part that owns it speaks for the pair
static int first_cloth_vertex(const cloth_sim *sim, uint64_t key)
{
  cloth_pair p = cloth_pair_unpack(sim->format, key);
  if (p.type == CLOTH_EDGE_EDGE) return sim->edge[2 * p.a]; // edges of cloth come first
  return p.a < sim->vertex_count ? p.a : sim->triangle[3 * p.b];
}

static int compare_entries(const void *pa, const void *pb)
{
  const cloth_friction_entry *a = pa, *b = pb;
  return a->key < b->key ? -1 : a->key > b->key;
}

static cloth_status read_part(cloth_sim *sim, cloth_part *p, uint64_t *key, cloth_real *slip,
                              cloth_friction_entry *out, int *count, cloth_error *err)
{
  size_t n = (size_t)p->kept_count;
  if (n == 0) return CLOTH_OK;
  CLOTH_TRY(sim->backend->read(p->device, key, p->kept, 8 * n, err));
  CLOTH_TRY(sim->backend->read(p->device, slip, p->kept_slip, 3 * sizeof *slip * n, err));
  for (size_t i = 0; i < n; i++) {
    int v = first_cloth_vertex(sim, key[i]);
    bool latest = i + 1 == n || key[i + 1] != key[i]; // of a pair that came to an impact
    if (v < p->v0 || v >= p->v1 || !latest) continue;
    cloth_friction_entry *e = &out[(*count)++];
    memset(e, 0, sizeof *e); // padding too: files are checksummed
    e->key = key[i];
    memcpy(e->slip, slip + 3 * i, sizeof e->slip);
  }
  return CLOTH_OK;
}

cloth_status cloth_friction_read(cloth_sim *sim, cloth_friction_entry **out, int *count,
                                 cloth_error *err)
{
  size_t all = 1;
  *count = 0;
  for (int i = 0; i < sim->part_count; i++) all += (size_t)sim->part[i].kept_count;
  uint64_t *key = malloc(sizeof *key * all);
  cloth_real *slip = malloc(3 * sizeof *slip * all);
  cloth_status status = CLOTH_OK;
  *out = malloc(sizeof **out * all);
  if (!key || !slip || !*out)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "friction: %zu contacts", all);
  for (int i = 0; i < sim->part_count && status == CLOTH_OK; i++)
    if (!sim->part[i].lost) // what it remembered is gone with it
      status = read_part(sim, &sim->part[i], key, slip, *out, count, err);
  free(key), free(slip);
  if (status != CLOTH_OK) {
    free(*out);
    *out = NULL;
    return status;
  }
  qsort(*out, (size_t)*count, sizeof **out, compare_entries);
  return CLOTH_OK;
}

cloth_status cloth_friction_write(cloth_sim *sim, const cloth_friction_entry *entry, int count,
                                  cloth_error *err)
{
  cloth_friction_forget(sim);
  if (!sim->active[CLOTH_EFFECT_friction] || count == 0) return CLOTH_OK;
  size_t n = (size_t)count;
  uint64_t *key = malloc(sizeof *key * n);
  cloth_real *slip = malloc(3 * sizeof *slip * n);
  cloth_status status = CLOTH_OK;
  if (!key || !slip)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "friction: %d contacts", count);
  for (size_t i = 0; i < n && status == CLOTH_OK; i++) {
    key[i] = entry[i].key;
    memcpy(slip + 3 * i, entry[i].slip, sizeof entry[i].slip);
  }
  sim->owner = CLOTH_EFFECT_friction;
  for (int i = 0; i < sim->part_count && status == CLOTH_OK; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY_GOTO(grow_kept(sim, p, n, err), status, done);
    CLOTH_TRY_GOTO(sim->backend->write(p->device, p->kept, key, 8 * n, err), status, done);
    CLOTH_TRY_GOTO(sim->backend->write(p->device, p->kept_slip, slip, 3 * sizeof *slip * n, err),
                   status, done);
    p->kept_count = count;
  }
done:
  sim->owner = CLOTH_CORE;
  free(key), free(slip);
  return status;
}
