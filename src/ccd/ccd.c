// Continuous collision detection and its answers, mildest first: impact zones move the involved
// vertices as little as they can (zones.c); what these cannot solve in zone_iterations_max rounds
// is held back along its way (failsafe.c), which always ends.
#include "ccd/impacts.h"
#include "contact/close.h"
#include "contact/contact.h"
#include "contact/count.h"
#include "effect/effect.h"
#include "impact_find.h"
#include "impact_pin.h"
#include "state/recut.h"

#include <stdlib.h>

enum { ZONE_LOOK = 3 }; // rounds in which the number of impacts should halve

#define IMPACT_GAP 0.05 // distance that counts as an impact, as a share of the thickness

double cloth_impact_gap(const cloth_sim *sim) { return IMPACT_GAP * sim->params.thickness; }

cloth_status cloth_impacts_cover(cloth_sim *sim, cloth_error *err)
{
  bool escaped = true;
  if (sim->pairs_valid) CLOTH_TRY(cloth_pairs_escaped(sim, &escaped, err));
  if (!escaped) return CLOTH_OK;
  CLOTH_TRY(cloth_bodies_join(sim, err));
  return cloth_pairs_search_impacts(sim, cloth_impact_gap(sim), err);
}

// ---- detection ----------------------------------------------------------------------------------

static int compare(const void *a, const void *b)
{
  const cloth_impact_pair *p = a, *q = b;
  return p->key < q->key ? -1 : p->key > q->key;
}

static int compare_keys(const void *a, const void *b)
{
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
  return p < q ? -1 : p > q;
}

// room on the host for n found pairs
static cloth_status grow_found(cloth_zones *z, int n, cloth_error *err)
{
  if (n <= z->found_capacity) return CLOTH_OK;
  size_t room = (size_t)n + (size_t)n / 2 + 64;
  cloth_impact_pair *found = realloc(z->found, sizeof *found * room);
  if (found) z->found = found;
  uint64_t *key = realloc(z->read_key, sizeof *key * room);
  if (key) z->read_key = key;
  uint32_t *toi = realloc(z->read_toi, sizeof *toi * room);
  if (toi) z->read_toi = toi;
  if (!found || !key || !toi) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d impacts", n);
  z->found_capacity = (int)room;
  return CLOTH_OK;
}

static cloth_status find_on_part(cloth_sim *sim, cloth_part *p, bool moved, cloth_error *err)
{
  cloth_zone_part *z = &p->zone;
  int pairs;
  CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_IMPACTS, err));
  cloth_impact_find_args a = {.scene = cloth_contact_scene_of(sim, p),
                              .gap = (cloth_real)cloth_impact_gap(sim),
                              .moved = moved ? z->moved : NULL,
                              .pair = cloth_close_pairs(sim, p, &pairs),
                              .key = z->found_key,
                              .toi = z->found_toi,
                              .capacity = z->found_capacity,
                              .driven = z->driven,
                              .driven_capacity = z->driven_capacity,
                              .count = cloth_counter(p, CLOTH_COUNT_IMPACTS)};
  cloth_work_look(p, pairs);
  return cloth_launch(sim, p, CLOTH_KERNEL_impact_find, pairs, &a, err);
}

static cloth_status grow_found_on_part(cloth_sim *sim, cloth_part *p, const uint32_t count[2],
                                       cloth_error *err)
{
  cloth_zone_part *z = &p->zone;
  if (count[0] > z->found_capacity) {
    CLOTH_TRY(cloth_grow(sim, p, "impact_key", 8 * (size_t)count[0], &z->found_key, err));
    CLOTH_TRY(cloth_grow(sim, p, "impact_toi", 4 * (size_t)count[0], &z->found_toi, err));
    z->found_capacity = count[0] + count[0] / 2;
  }
  if (count[1] > z->driven_capacity) {
    CLOTH_TRY(cloth_grow(sim, p, "impact_driven", 8 * (size_t)count[1], &z->driven, err));
    z->driven_capacity = count[1] + count[1] / 2;
  }
  return CLOTH_OK;
}

// how many impacts and driven pairs there are, and again with more room where it was too small;
// known: it has been read
static cloth_status count_found(cloth_sim *sim, cloth_part *p, bool moved, bool known,
                                uint32_t count[2], cloth_error *err)
{
  const cloth_zone_part *z = &p->zone;
  for (;; known = false) {
    if (!known) CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_IMPACTS, count, err));
    if (count[0] <= z->found_capacity && count[1] <= z->driven_capacity) return CLOTH_OK;
    CLOTH_TRY(grow_found_on_part(sim, p, count, err));
    CLOTH_TRY(find_on_part(sim, p, moved, err));
  }
}

static cloth_status read_found(cloth_sim *sim, cloth_part *p, size_t count, cloth_error *err)
{
  cloth_zones *z = &sim->zones;
  const cloth_backend *be = sim->backend;
  p->zone.found_count = (int)count;
  if (count == 0) return CLOTH_OK;
  CLOTH_TRY(grow_found(z, z->found_count + (int)count, err));
  CLOTH_TRY(be->read(p->device, z->read_key, p->zone.found_key, 8 * count, err));
  CLOTH_TRY(be->read(p->device, z->read_toi, p->zone.found_toi, 4 * count, err));
  for (size_t k = 0; k < count; k++)
    z->found[z->found_count++] = (cloth_impact_pair){z->read_key[k], z->read_toi[k]};
  return CLOTH_OK;
}

static cloth_status read_driven(cloth_sim *sim, cloth_part *p, size_t count, cloth_error *err)
{
  cloth_zones *z = &sim->zones;
  size_t n = (size_t)z->driven_count + count;
  if (count == 0) return CLOTH_OK;
  if (n > (size_t)z->driven_capacity) {
    uint64_t *driven = realloc(z->driven, sizeof *driven * 2 * n);
    if (driven == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%zu driven pairs", n);
    z->driven = driven, z->driven_capacity = (int)(2 * n);
  }
  CLOTH_TRY(
      sim->backend->read(p->device, z->driven + z->driven_count, p->zone.driven, 8 * count, err));
  z->driven_count = (int)n;
  return CLOTH_OK;
}

// a pair on a border is found by each of its parts, with the same time
static void sort_found(cloth_zones *z)
{
  int unique = 0;
  if (z->found_count > 0) qsort(z->found, (size_t)z->found_count, sizeof *z->found, compare);
  for (int k = 0; k < z->found_count; k++)
    if (k == 0 || z->found[k].key != z->found[k - 1].key) z->found[unique++] = z->found[k];
  z->found_count = unique, unique = 0;
  if (z->driven_count > 0)
    qsort(z->driven, (size_t)z->driven_count, sizeof *z->driven, compare_keys);
  for (int k = 0; k < z->driven_count; k++)
    if (k == 0 || z->driven[k] != z->driven[k - 1]) z->driven[unique++] = z->driven[k];
  z->driven_count = unique;
}

// what all parts have found
static cloth_status take_found(cloth_sim *sim, bool moved, bool known, cloth_error *err)
{
  cloth_zones *z = &sim->zones;
  z->found_count = 0;
  if (!moved) z->driven_count = 0; // zones move nothing that is driven
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    uint32_t count[2] = {sim->along.impacts[0], sim->along.impacts[1]};
    CLOTH_TRY(count_found(sim, p, moved, known, count, err));
    CLOTH_TRY(read_found(sim, p, count[0], err));
    CLOTH_TRY(read_driven(sim, p, count[1], err));
  }
  sort_found(z);
  return CLOTH_OK;
}

cloth_status cloth_impacts_find(cloth_sim *sim, bool moved, cloth_error *err)
{
  // all look before the host asks the first how many it found
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(find_on_part(sim, &sim->part[i], moved, err));
  return take_found(sim, moved, false, err);
}

int cloth_impacts_of_cloth(const cloth_sim *sim)
{
  int n = 0, v[4];
  for (int i = 0; i < sim->zones.found_count; i++) {
    cloth_pair_corners(sim, sim->zones.found[i].key, v);
    n += v[0] < sim->vertex_count && v[3] < sim->vertex_count; // one of each feature
  }
  return n;
}

cloth_status cloth_ccd_keep(cloth_sim *sim, bool back, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_real *to = back ? p->x : p->zone.x_solved, *from = back ? p->zone.x_solved : p->x;
    CLOTH_TRY(cloth_copy_local(sim, p, to, from, bytes, err));
  }
  return CLOTH_OK;
}

static void exchange_free(cloth_sim *sim)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_real *free = p->free;
    p->free = p->zone.free, p->zone.free = free;
  }
}

cloth_status cloth_ccd_pin(cloth_sim *sim, bool more, cloth_error *err)
{
  size_t row = sizeof(cloth_real), n = (size_t)sim->vertex_count;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_grow(sim, p, "zone_free", row * n, &p->zone.free, err));
    CLOTH_TRY(cloth_grow(sim, p, "x_held", row * 3 * n, &p->zone.x_held, err));
    CLOTH_TRY(cloth_copy_local(sim, p, p->zone.x_held, p->x, row * 3 * n, err));
    if (!more) CLOTH_TRY(cloth_copy_local(sim, p, p->zone.free, p->free, row * n, err));
    cloth_impact_pin_args a = {p->zone.x_solved, p->x, p->zone.free};
    CLOTH_LAUNCH(sim, p, impact_pin, sim->vertex_count, &a, err);
  }
  exchange_free(sim);
  return CLOTH_OK;
}

void cloth_ccd_unpin(cloth_sim *sim) { exchange_free(sim); }

cloth_status cloth_ccd_back_to_held(cloth_sim *sim, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_copy_local(sim, p, p->x, p->zone.x_held, bytes, err));
  }
  return CLOTH_OK;
}

// ---- the stage ----------------------------------------------------------------------------------

static cloth_status remember_solved(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(cloth_ccd_keep(sim, false, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(sim->backend->fill(p->device, p->zone.moved, 0, (size_t)sim->vertex_count, err));
  }
  return CLOTH_OK;
}

// Most of the time the pairs still cover all paths. So impacts are looked for before that is known,
// and both answers come at once; unless the last look was for nothing, or the answer decides what
// is to be looked at.
static bool looks_at_once(const cloth_sim *sim)
{
  return sim->pairs_valid && !sim->close_known && !sim->zones.searched && cloth_reads_along(sim);
}

cloth_status cloth_ccd_detect(cloth_sim *sim, int *impacts, cloth_error *err)
{
  bool at_once = looks_at_once(sim);
  int searches = sim->report->pair_searches;
  if (at_once) {
    cloth_part *p = &sim->part[0];
    CLOTH_TRY(find_on_part(sim, p, false, err));
    CLOTH_TRY(cloth_read_along(sim, sim->along.impacts, cloth_counter(p, CLOTH_COUNT_IMPACTS),
                               sizeof sim->along.impacts, err));
  }
  CLOTH_TRY(cloth_impacts_cover(sim, err));
  sim->zones.searched = sim->report->pair_searches > searches;
  if (at_once && !sim->zones.searched)
    CLOTH_TRY(take_found(sim, false, true, err));
  else
    CLOTH_TRY(cloth_impacts_find(sim, false, err));
  *impacts = sim->zones.found_count;
  return CLOTH_OK;
}

cloth_status cloth_ccd_resolve(cloth_sim *sim, int *left, cloth_error *err)
{
  cloth_zones *z = &sim->zones;
  *left = z->held_back = 0;
  if (z->found_count == 0) return CLOTH_OK;
  sim->report->impacts += z->found_count;
  CLOTH_TRY(remember_solved(sim, err));
  z->count = 0;
  int before = 0;
  for (int round = 0; round < sim->params.zone_iterations_max && z->found_count > 0; round++) {
    if (round % ZONE_LOOK == 0) {
      if (round > 0 && 2 * z->found_count > before)
        break; // no room: more of the same will not help
      before = z->found_count;
    }
    CLOTH_TRY(cloth_zones_add(sim, err));
    CLOTH_TRY(cloth_zones_project(sim, cloth_impact_gap(sim), err));
    CLOTH_TRY(cloth_impacts_cover(sim, err));
    CLOTH_TRY(cloth_impacts_find(sim, true, err));
    sim->report->zone_rounds++;
  }
  int largest = cloth_zones_largest(z);
  sim->report->zones += z->zones;
  if (largest > sim->report->zone_largest) sim->report->zone_largest = largest;
  z->held_back = z->found_count;
  sim->report->held_back += z->found_count;
  return z->found_count > 0 ? cloth_failsafe(sim, left, err) : CLOTH_OK;
}
