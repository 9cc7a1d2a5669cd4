// Looking at contact from outside: the broad phase on the present state, and the last contacts.
#include "contact/contact.h"
#include "contact/pairs.h"
#include "effect/effect.h"
#include "state/state.h"

#include <stdlib.h>
#include <string.h>

static int compare_pairs(const void *pa, const void *pb)
{
  const cloth_body_pair *a = pa, *b = pb;
  const int ka[4] = {a->body, a->body_triangle, a->cloth, a->cloth_triangle};
  const int kb[4] = {b->body, b->body_triangle, b->cloth, b->cloth_triangle};
  for (int k = 0; k < 4; k++)
    if (ka[k] != kb[k]) return ka[k] < kb[k] ? -1 : 1;
  return 0;
}

static cloth_status read_pairs(cloth_sim *sim, cloth_part *p, cloth_body_pair *all,
                               cloth_error *err)
{
  uint64_t *key = malloc(8 * (size_t)p->pair_count + 8);
  if (key == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "body pairs");
  cloth_status status = sim->backend->read(p->device, key, p->pair, 8 * (size_t)p->pair_count, err);
  for (int i = 0; status == CLOTH_OK && i < p->pair_count; i++) {
    cloth_pair pair = cloth_pair_unpack(sim->format, key[i]);
    int b = cloth_body_of_triangle(sim, pair.b), c = cloth_of_triangle(sim, pair.a);
    all[i] =
        (cloth_body_pair){b, pair.b - sim->body[b].triangle_first, c, sim->triangle_order[pair.a]};
  }
  free(key);
  return status;
}

// the present state as a substep of no length: nothing moves
static cloth_status freeze(cloth_sim *sim, double margin, cloth_error *err)
{
  double thickness = sim->params.thickness;
  sim->h = 0;
  sim->params.thickness = margin; // what counts as near
  for (int p = 0; p < sim->part_count; p++)
    CLOTH_TRY(cloth_copy_local(sim, &sim->part[p], sim->part[p].x, sim->part[p].x_t0,
                               sizeof(cloth_real) * 3 * (size_t)sim->vertex_count, err));
  cloth_status status = cloth_freeze_bodies(sim, err);
  sim->params.thickness = thickness;
  return status;
}

cloth_status cloth_sim_body_pairs(void *data, double margin, cloth_body_pair *out, int capacity,
                                  int *count, cloth_error *err)
{
  cloth_sim *sim = data;
  cloth_step_report scratch = {0};
  *count = 0;
  if (cloth_is_mass_spring(sim))
    CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "integrator mass_spring has no pairs of triangles");
  if (!sim->active[CLOTH_EFFECT_body_contact]) return CLOTH_OK;
  sim->report = &scratch;
  sim->pairs_valid = false; // the candidates of the simulation are overwritten: it searches again
  sim->owner = CLOTH_EFFECT_body_contact;
  CLOTH_TRY(freeze(sim, margin, err));
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    CLOTH_TRY(cloth_pairs_of_parts(sim, part, 1, margin, 0, 0, CLOTH_PAIRS_BODY_TRIANGLES, err));
    cloth_body_pair *all = malloc(sizeof *all * ((size_t)part->pair_count + 1));
    if (all == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "body pairs");
    cloth_status status = read_pairs(sim, part, all, err);
    for (int i = 0; status == CLOTH_OK && i < part->pair_count; i++, ++*count)
      if (*count < capacity) out[*count] = all[i];
    free(all);
    CLOTH_TRY(status);
  }
  sim->owner = CLOTH_CORE;
  qsort(out, (size_t)(*count < capacity ? *count : capacity), sizeof *out, compare_pairs);
  return CLOTH_OK;
}

// ---- the last contacts --------------------------------------------------------------------------

typedef struct contact_arrays {
  int *vertex;
  cloth_real *weight, *normal, *pressure, *distance, *x;
} contact_arrays;

static cloth_status read_contacts(cloth_sim *sim, cloth_part *p, contact_arrays *a,
                                  cloth_error *err)
{
  size_t n = (size_t)p->contact_count, real = sizeof(cloth_real),
         all = 3 * (size_t)sim->all_vertices;
  const cloth_backend *be = sim->backend;
  *a = (contact_arrays){malloc(4 * sizeof(int) * n + 8),
                        malloc(4 * real * n + 8),
                        malloc(3 * real * n + 8),
                        malloc(real * n + 8),
                        malloc(real * n + 8),
                        malloc(real * all)};
  if (!a->vertex || !a->weight || !a->normal || !a->pressure || !a->distance || !a->x)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "contacts");
  CLOTH_TRY(be->read(p->device, a->vertex, p->contact_vertex, 4 * sizeof(int) * n, err));
  CLOTH_TRY(be->read(p->device, a->weight, p->contact_weight, 4 * real * n, err));
  CLOTH_TRY(be->read(p->device, a->normal, p->contact_normal, 3 * real * n, err));
  CLOTH_TRY(be->read(p->device, a->pressure, p->contact_pressure, real * n, err));
  CLOTH_TRY(be->read(p->device, a->distance, p->contact_distance, real * n, err));
  return be->read(p->device, a->x, p->x, real * all, err);
}

// where the contact is: the closest point of its first feature
static cloth_contact_view view_of(const cloth_sim *sim, const contact_arrays *a, int i)
{
  cloth_contact_view v = {.cloth = -1, .body = -1};
  for (int c = 0; c < 4; c++) {
    int vertex = a->vertex[4 * i + c];
    double w = (double)a->weight[4 * i + c];
    for (int k = 0; k < 3 && w > 0; k++) v.position[k] += w * (double)a->x[3 * vertex + k];
    for (int b = 0; vertex >= sim->vertex_count && v.body < 0 && b < sim->def->body_count; b++)
      if (vertex < sim->body[b].vertex_first + sim->body[b].vertex_count) v.body = b;
    if (vertex < sim->vertex_count && v.cloth < 0) v.cloth = cloth_of_vertex(sim, vertex);
  }
  for (int k = 0; k < 3; k++) v.normal[k] = (double)a->normal[3 * i + k];
  v.distance = (double)a->distance[i];
  v.force = (double)a->pressure[i];
  return v;
}

cloth_status cloth_sim_contacts(void *data, cloth_contact_view *out, int capacity, int *count,
                                cloth_error *err)
{
  cloth_sim *sim = data;
  *count = 0;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    contact_arrays a = {0};
    if (p->contact_count == 0) continue;
    cloth_status status = read_contacts(sim, p, &a, err);
    for (int c = 0; status == CLOTH_OK && c < p->contact_count; c++) {
      int owner = sim->vertex_count;
      for (int k = 3; k >= 0; k--)
        if (a.vertex[4 * c + k] < sim->vertex_count) owner = a.vertex[4 * c + k];
      if (!(a.pressure[c] > 0) || owner < p->v0 || owner >= p->v1) continue;
      if (*count < capacity) out[*count] = view_of(sim, &a, c);
      ++*count;
    }
    free(a.vertex), free(a.weight), free(a.normal), free(a.pressure), free(a.distance), free(a.x);
    CLOTH_TRY(status);
  }
  return CLOTH_OK;
}
