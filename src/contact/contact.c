// Which pairs touch, as planes for this substep, and their forces at each iterate. The list is
// sorted by key, so neither the order of the search nor the number of threads or parts shows in the
// sums.
#include "contact/contact.h"

#include "contact/close.h"
#include "contact/count.h"
#include "contact/friction.h"
#include "contact_build.h"
#include "contact_count.h"
#include "contact_entry.h"
#include "contact_find.h"
#include "contact_force.h"
#include "contact_place.h"
#include "contact_row.h"
#include "effect/effect.h"
#include "state/recut.h"

#include <limits.h>
#include <math.h>

#define UNTANGLE_SPEED 0.15 // m/s, at which an intersection is worked out, and at most this
#define UNTANGLE_SHARE 0.6  // share of the thickness in a substep

double cloth_contact_reach(const cloth_sim *sim)
{
  const double *g = sim->params.gravity;
  double fall = sim->h * sim->h * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  return fmin(fall, sim->params.thickness);
}

cloth_contact_scene cloth_contact_scene_of(const cloth_sim *sim, const cloth_part *p)
{
  cloth_contact_scene s = {
      .cloth_vertices = sim->vertex_count,
      .triangle = p->triangle,
      .edge = p->edge,
      .triangle_edge = p->triangle_edge,
      .edge_side = p->edge_side,
      .edge_flat = p->edge_flat,
      .vertex_flat = p->vertex_flat,
      .x_t0 = p->x_t0,
      .x = p->x,
      .x_pred = p->x_pred,
      .rest = p->x_rest,
      .free = p->free,
      .mass = p->mass,
      .cloth_of = p->cloth_of,
      .body_of = p->body_of,
      .body_friction = p->body_friction,
      .grasp_of = p->grasp_of,
      .ignore = p->ignore,
      .carrier = sim->zones.carried ? p->carrier : NULL,
      .bodies = sim->def->body_count,
      .thickness = (cloth_real)sim->params.thickness,
      .reach = (cloth_real)cloth_contact_reach(sim),
      .friction = (cloth_real)sim->params.friction,
      .stray = sim->tangles.count > 0 ? p->stray : NULL,
      .let_cloth = cloth_untangles(sim, 0),
      .let_body = cloth_untangles(sim, 1),
      .pull = (cloth_real)fmin(UNTANGLE_SPEED * sim->h, UNTANGLE_SHARE * sim->params.thickness),
      .format = sim->format};
  return s;
}

// Room for n contacts; those there are stay.
static cloth_status grow_contacts(cloth_sim *sim, cloth_part *p, size_t n, cloth_error *err)
{
  if (n <= p->contact_capacity) return CLOTH_OK;
  const size_t real = sizeof(cloth_real);
  size_t kept = (size_t)p->contact_count;
  CLOTH_TRY(cloth_extend(sim, p, "contact", 8 * n, 8 * kept, &p->contact, err));
  CLOTH_TRY(cloth_extend(sim, p, "contact_toi", 4 * n, 4 * kept, &p->contact_toi, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_spare", 8 * n, &p->contact_spare, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_toi_spare", 4 * n, &p->contact_toi_spare, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_vertex", 4 * sizeof(int) * n, &p->contact_vertex, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_weight", 4 * real * n, &p->contact_weight, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_normal", 3 * real * n, &p->contact_normal, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_distance", real * n, &p->contact_distance, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_thickness", real * n, &p->contact_thickness, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_k", real * n, &p->contact_k, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_inertia", real * n, &p->contact_inertia, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_relief", real * n, &p->contact_relief, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_mu", real * n, &p->contact_mu, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_force", 3 * real * n, &p->contact_force, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_tangent", 6 * real * n, &p->contact_tangent, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_pressure", real * n, &p->contact_pressure, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_q", 4 * 3 * real * n, &p->contact_q, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_place", 4 * 4 * n, &p->contact_place, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_slot", 4 * 4 * 4 * n, &p->contact_slot, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_row", 4 * 8 * n, &p->contact_row, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_row_spare", 4 * 8 * n, &p->contact_row_spare, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_entry", 4 * 4 * n, &p->contact_entry, err));
  CLOTH_TRY(cloth_grow(sim, p, "contact_entry_spare", 4 * 4 * n, &p->contact_entry_spare, err));
  p->contact_capacity = (uint32_t)(n + n / 2);
  return CLOTH_OK;
}

static cloth_status find(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_CONTACTS, err));
  cloth_contact_find_args a = {.scene = cloth_contact_scene_of(sim, p),
                               .pair = sim->watch.covers ? p->watch : p->pair,
                               .contact = p->contact,
                               .capacity = p->contact_capacity,
                               .close = sim->close_known ? p->close : NULL,
                               .close_capacity = p->close_capacity,
                               .close_reach = (cloth_real)cloth_close_reach(sim),
                               .count = cloth_counter(p, CLOTH_COUNT_CONTACTS)};
  int pairs = sim->watch.covers ? p->watch_count : p->pair_count;
  sim->report->pairs_looked += pairs;
  cloth_work_look(p, pairs);
  return cloth_launch(sim, p, CLOTH_KERNEL_contact_find, pairs, &a, err);
}

// how many there are, and again with more room where it was too small
static cloth_status take_found(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  const cloth_tangle_list *t = &sim->tangles;
  uint32_t pulls = t->count > 0 ? (uint32_t)t->pull_count : 0;
  for (;;) {
    uint32_t found[2];
    bool again;
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_CONTACTS, found, err));
    uint32_t count = found[0];
    p->contact_count = 0;
    CLOTH_TRY(cloth_close_take(sim, p, found[1], &again, err));
    if (again || count + pulls > p->contact_capacity) {
      CLOTH_TRY(grow_contacts(sim, p, count + pulls, err));
      CLOTH_TRY(find(sim, p, err));
      continue;
    }
    if (pulls > 0) // some twice: also found by contact_find.h
      CLOTH_TRY(sim->backend->write(p->device, p->contact + count, t->pull, sizeof *t->pull * pulls,
                                    err));
    p->contact_count = (int)(count + pulls);
    return sim->backend->fill(p->device, p->contact_toi, 0, 4 * (size_t)(count + pulls), err);
  }
}

static int bits_below(int n)
{
  int bits = 1;
  while (n >> bits) bits++;
  return bits;
}

// Contacts with bodies lie in the matrix where it has blocks for the corners of a triangle.
int cloth_contact_body_first(const cloth_sim *sim)
{
  return sim->active[CLOTH_EFFECT_membrane] ? sim->vertex_count : INT_MAX;
}

// each row's contacts, in one order
static cloth_status index_rows(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  int rows = p->v1 - p->v0, entries = 4 * p->contact_count;
  if (p->contact_first == NULL)
    CLOTH_TRY(cloth_take(sim, p, "contact_first", sizeof(uint32_t) * (2 * (size_t)rows + 1),
                         &p->contact_first, err));
  CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_FACTORED, err));
  cloth_contact_entry_args e = {.first = p->v0,
                                .last = p->v1,
                                .body_first = cloth_contact_body_first(sim),
                                .vertex = p->contact_vertex,
                                .row = p->contact_row,
                                .entry = p->contact_entry,
                                .factored = cloth_counter(p, CLOTH_COUNT_FACTORED)};
  CLOTH_LAUNCH(sim, p, contact_entry, p->contact_count, &e, err);
  CLOTH_TRY(sim->backend->sort(p->device, entries, bits_below(2 * rows + 1), p->contact_row,
                               p->contact_entry, p->contact_row_spare, p->contact_entry_spare,
                               err));
  cloth_contact_place_args w = {.row_count = rows,
                                .cloth_vertices = sim->vertex_count,
                                .rows = {p->row_first, p->row_col, p->row_val, p->row_widest},
                                .vertex = p->contact_vertex,
                                .row = p->contact_row,
                                .entry = p->contact_entry,
                                .place = p->contact_place,
                                .slot = p->contact_slot};
  CLOTH_LAUNCH(sim, p, contact_place, entries, &w, err);
  cloth_contact_row_args r = {entries, p->contact_row, p->contact_first};
  return cloth_launch(sim, p, CLOTH_KERNEL_contact_row, 2 * rows + 1, &r, err);
}

// In units of mass / substep^2, but a step that is halved because its solve was rough keeps its
// springs. Where they do get stiffer, contacts that are pressed together would let go of several
// times the energy that pressed them: cloth_contact_relief() takes that off.
double cloth_contact_stiffness(const cloth_sim *sim)
{
  double share = sim->h / sim->h_contact;
  return sim->params.contact_stiffness * share * share;
}

// What a contact becomes stiffer by each time that its pair passes in spite of it. Not where cloth
// intersects: between bodies that leave no room it would be thrown from one to the other.
#define STIFFER 10

const uint32_t *cloth_contact_factored(const cloth_part *p)
{
  return cloth_counter(p, CLOTH_COUNT_FACTORED);
}

// planes and rows of the pairs in the list, which is put in order
static cloth_status build(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  if (p->contact_count == 0) return CLOTH_OK;
  CLOTH_TRY(sim->backend->sort(
      p->device, p->contact_count, CLOTH_TYPE_BITS + sim->format.bits_a + sim->format.bits_b,
      p->contact, p->contact_toi, p->contact_spare, p->contact_toi_spare, err));
  cloth_contact_build_args a = {.scene = cloth_contact_scene_of(sim, p),
                                .count = p->contact_count,
                                .stiffness = (cloth_real)cloth_contact_stiffness(sim),
                                .share = (cloth_real)(sim->h_contact / sim->h_whole),
                                .stiffer = sim->tangles.known_free ? STIFFER : 1,
                                .inverse_step = (cloth_real)(1 / sim->h),
                                .contact = p->contact,
                                .toi = p->contact_toi,
                                .vertex = p->contact_vertex,
                                .weight = p->contact_weight,
                                .normal = p->contact_normal,
                                .distance = p->contact_distance,
                                .thickness = p->contact_thickness,
                                .k = p->contact_k,
                                .inertia = p->contact_inertia,
                                .relief = p->contact_relief,
                                .mu = p->contact_mu};
  CLOTH_LAUNCH(sim, p, contact_build, p->contact_count, &a, err);
  CLOTH_TRY(cloth_friction_begin(sim, p, err));
  return index_rows(sim, p, err);
}

cloth_status cloth_contact_build_stage(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(cloth_close_begin(sim, err));
  // all look before the host asks the first how many it found
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(find(sim, &sim->part[i], err));
  for (int i = 0; i < sim->part_count; i++) {
    CLOTH_TRY(take_found(sim, &sim->part[i], err));
    CLOTH_TRY(build(sim, &sim->part[i], err));
  }
  return CLOTH_OK;
}

cloth_status cloth_contact_add_impacts(cloth_sim *sim, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    size_t n = (size_t)p->zone.found_count, known = (size_t)p->contact_count;
    if (n > 0) {
      CLOTH_TRY(grow_contacts(sim, p, known + n, err));
      CLOTH_TRY(cloth_copy_local(sim, p, p->contact + known, p->zone.found_key, 8 * n, err));
      CLOTH_TRY(cloth_copy_local(sim, p, p->contact_toi + known, p->zone.found_toi, 4 * n, err));
      p->contact_count += (int)n;
    }
    CLOTH_TRY(build(sim, p, err)); // all parts: earlier impacts are measured on the new way too
  }
  return CLOTH_OK;
}

cloth_status cloth_contact_apply(cloth_sim *sim, int iteration, cloth_error *err)
{
  sim->owner = cloth_contact_owner(sim);
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_contact_force_args a = {.vertex = p->contact_vertex,
                                  .weight = p->contact_weight,
                                  .normal = p->contact_normal,
                                  .distance = p->contact_distance,
                                  .thickness = p->contact_thickness,
                                  .k = p->contact_k,
                                  .inertia = p->contact_inertia,
                                  .relief = p->contact_relief,
                                  .mu = p->contact_mu,
                                  .x_t0 = p->x_t0,
                                  .x = p->x,
                                  .first_iterate = iteration == 0,
                                  .elastic = p->friction_elastic,
                                  .trial = p->friction_trial,
                                  .state = p->friction_state,
                                  .bound = p->friction_bound,
                                  .secant = p->friction_secant,
                                  .limit = cloth_friction_limit(sim),
                                  .force = p->contact_force,
                                  .tangent = p->contact_tangent,
                                  .pressure = p->contact_pressure};
    CLOTH_LAUNCH(sim, p, contact_force, p->contact_count, &a, err);
  }
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

cloth_status cloth_contact_totals(cloth_sim *sim, cloth_error *err)
{
  uint32_t *total = sim->along.totals;
  total[0] = total[1] = 0;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    if (p->contact_count == 0) continue;
    CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_TOTALS, err));
    cloth_contact_count_args a = {sim->vertex_count,
                                  p->v0,
                                  p->v1,
                                  p->contact_vertex,
                                  p->contact_pressure,
                                  cloth_counter(p, CLOTH_COUNT_TOTALS)};
    CLOTH_LAUNCH(sim, p, contact_count, p->contact_count, &a, err);
  }
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    uint32_t count[2];
    if (p->contact_count == 0) continue;
    if (cloth_reads_along(sim))
      return cloth_read_along(sim, total, cloth_counter(p, CLOTH_COUNT_TOTALS), sizeof count, err);
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_TOTALS, count, err));
    total[0] += count[0], total[1] += count[1];
  }
  return CLOTH_OK;
}
