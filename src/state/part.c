// The memory of a part: what it holds of the scene by its run of vertices.
#include "state/part.h"

#include "chunk.h"
#include "commit_chunk.h"
#include "contact/count.h"
#include "effect/effect.h"
#include "impact_find.h"
#include "pcg.h"
#include "solve/hats.h"
#include "state/bdf2.h"
#include "state/flight.h"

#include <stdlib.h>

// coarser levels are worth it when there is something stiff to solve and more than a patch of it
bool cloth_has_coarser_levels(const cloth_sim *sim)
{
  return !cloth_is_mass_spring(sim) && sim->active[CLOTH_EFFECT_membrane] && sim->chunks >= 4;
}

static cloth_status take_reals(cloth_sim *sim, cloth_part *p, const char *name, int rows, int width,
                               void *out, cloth_error *err)
{
  return cloth_take(sim, p, name, sizeof(cloth_real) * (size_t)rows * (size_t)width, out, err);
}

// rows of the part's own chunks alone, `rows` of `width` in each. *out stands where the whole array
// would begin, so that all arrays are read with the same indices.
static cloth_status take_own(cloth_sim *sim, cloth_part *p, const char *name, int rows, int width,
                             cloth_real **out, cloth_error *err)
{
  size_t before = (size_t)(p->v0 / CLOTH_CHUNK) * (size_t)rows * (size_t)width;
  CLOTH_TRY(take_reals(sim, p, name, cloth_part_chunks(p) * rows, width, out, err));
  *out -= before;
  return CLOTH_OK;
}

static cloth_status take_vertices(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  bool alone = cloth_is_mass_spring(sim) || cloth_flies(sim); // vertices of bodies have no use
  int n = sim->vertex_count, all = alone ? n : sim->all_vertices;
  CLOTH_TRY(take_reals(sim, p, "x_t0", all, 3, &p->x_t0, err));
  CLOTH_TRY(take_reals(sim, p, "x", all, 3, &p->x, err));
  CLOTH_TRY(take_reals(sim, p, "v", n, 3, &p->v, err));
  CLOTH_TRY(take_reals(sim, p, "v_next", n, 3, &p->v_next, err));
  cloth_real **saved[] = {&p->x_saved, &p->v_saved};
  for (int i = 0; i < 2; i++) // cloth in flight changes them for x_t0 and v (state/flight.c)
    CLOTH_TRY(cloth_flies(sim) ? take_reals(sim, p, "saved", n, 3, saved[i], err)
                               : take_own(sim, p, "saved", CLOTH_CHUNK, 3, saved[i], err));
  CLOTH_TRY(cloth_upload_real(sim, p, "x_rest", sim->rest, 3 * n, &p->x_rest, err));
  CLOTH_TRY(cloth_upload_real(sim, p, "mass", sim->mass, n, &p->mass, err));
  for (int i = 0; i < n; i++) sim->host[i] = 1;
  return cloth_upload(sim, p, "free", sim->host, sizeof(cloth_real) * (size_t)n, &p->free, err);
}

static cloth_status take_solve(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  int n = sim->vertex_count, padded = sim->chunks * CLOTH_CHUNK;
  CLOTH_TRY(take_reals(sim, p, "x_pred", n, 3, &p->x_pred, err));
  bool hats = sim->hat_groups > 0; // their nodes need q of other parts' vertices
  cloth_real **all[] = {&p->dx, &p->p, &p->r, &p->q}, **own[] = {&p->b, &p->z, &p->q};
  for (int i = 0; i < (hats ? 4 : 3); i++) // one more: block_rows.h reads past the last vertex
    CLOTH_TRY(take_reals(sim, p, "solve", padded + 1, 3, all[i], err));
  for (int i = 0; i < (hats ? 2 : 3); i++)
    CLOTH_TRY(take_own(sim, p, "solve", CLOTH_CHUNK, 3, own[i], err));
  CLOTH_TRY(take_own(sim, p, "inverse_diagonal", CLOTH_CHUNK, 6, &p->inverse_diagonal, err));
  int sums = 2 * sim->chunks + sim->hat_groups; // some for z, others for the product
  CLOTH_TRY(take_reals(sim, p, "partial", sums, CLOTH_PCG_PARTIALS, &p->partial, err));
  sums = 2 * CLOTH_PCG_LANES + 3 * cloth_chunk_groups(sim->chunks) + sim->hat_groups;
  CLOTH_TRY(take_reals(sim, p, "terms", sums, 1, &p->terms, err));
  CLOTH_TRY(take_reals(sim, p, "scalar", 1, CLOTH_PCG_SCALARS, &p->scalar, err));
  CLOTH_TRY(cloth_take(sim, p, "product_ns", sizeof(uint64_t), &p->product_ns, err));
  CLOTH_TRY(take_reals(sim, p, "commit", sim->chunks, CLOTH_COMMIT_FIELDS, &p->commit, err));
  int boxes = sim->chunks + cloth_chunk_levels(sim->chunks);
  CLOTH_TRY(take_reals(sim, p, "box_of_chunk", boxes, 6, &p->box_of_chunk, err));
  CLOTH_TRY(take_reals(sim, p, "balance", 1, 3, &p->balance, err));
  return take_reals(sim, p, "largest", sim->chunks, 1, &p->largest, err);
}

// the coarse level of the solver
static cloth_status take_coarse(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  int n = 3 * sim->aggregates;
  CLOTH_TRY(take_own(sim, p, "slice", 1, 3 * n, &p->slice, err));
  CLOTH_TRY(take_reals(sim, p, "factor", n, n, &p->factor, err));
  CLOTH_TRY(take_reals(sim, p, "inverse", n, n, &p->inverse, err));
  CLOTH_TRY(take_reals(sim, p, "usable", 1, 1, &p->usable, err));
  CLOTH_TRY(take_reals(sim, p, "coarse_rest", n, 1, &p->coarse_rest, err));
  return take_reals(sim, p, "coarse", n, 1, &p->coarse, err);
}

// what contact needs; a scene without contact takes none of it
static cloth_status take_contact(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  size_t t = (size_t)sim->all_triangles, n = (size_t)sim->vertex_count;
  CLOTH_TRY(
      cloth_upload(sim, p, "triangle", sim->triangle, sizeof(int) * 3 * t, &p->triangle, err));
  CLOTH_TRY(cloth_upload(sim, p, "triangle_edge", sim->triangle_edge, sizeof(int) * 3 * t,
                         &p->triangle_edge, err));
  CLOTH_TRY(cloth_upload(sim, p, "owns", sim->owns, sizeof(int) * t, &p->owns, err));
  CLOTH_TRY(cloth_upload(sim, p, "edge", sim->edge, sizeof(int) * 2 * (size_t)sim->all_edges,
                         &p->edge, err));
  CLOTH_TRY(cloth_upload(sim, p, "edge_side", sim->edge_side,
                         sizeof(int) * 2 * (size_t)sim->all_edges, &p->edge_side, err));
  CLOTH_TRY(cloth_upload(sim, p, "edge_flat", sim->edge_flat, (size_t)sim->all_edges, &p->edge_flat,
                         err));
  CLOTH_TRY(cloth_upload(sim, p, "vertex_flat", sim->vertex_flat,
                         (size_t)(sim->all_vertices - sim->vertex_count), &p->vertex_flat, err));
  CLOTH_TRY(take_reals(sim, p, "vertex_box", sim->all_vertices, 6, &p->vertex_box, err));
  CLOTH_TRY(cloth_take(sim, p, "vertex_level", (size_t)sim->all_vertices, &p->vertex_level, err));
  CLOTH_TRY(sim->backend->fill(p->device, p->vertex_level, 0, (size_t)sim->all_vertices, err));
  CLOTH_TRY(take_reals(sim, p, "triangle_box", sim->all_triangles, 6, &p->triangle_box, err));
  CLOTH_TRY(cloth_take(sim, p, "counter", sizeof(uint32_t) * CLOTH_COUNTS * CLOTH_COUNT_ROUNDS,
                       &p->counter, err));
  CLOTH_TRY(sim->backend->fill(p->device, p->counter, 0,
                               sizeof(uint32_t) * CLOTH_COUNTS * CLOTH_COUNT_ROUNDS, err));
  int *number = malloc(sizeof(int) * (n + (size_t)sim->all_vertices + 1));
  if (number == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "contact");
  for (int c = 0; c < sim->def->cloth_count; c++)
    for (int v = sim->cloth_first[c]; v < sim->cloth_first[c + 1]; v++) number[v] = c;
  cloth_status status =
      cloth_upload(sim, p, "cloth_of", number, sizeof(int) * n, &p->cloth_of, err);
  for (size_t v = 0; v < n; v++) number[v] = CLOTH_WHOLE;
  if (status == CLOTH_OK)
    status = cloth_upload(sim, p, "allowed", number, sizeof(int) * n, &p->allowed, err);
  if (status == CLOTH_OK)
    status = cloth_take(sim, p, "claim", sizeof(uint32_t) * n, &p->claim, err);
  if (status == CLOTH_OK)
    status = cloth_take(sim, p, "carrier", sizeof(uint32_t) * (size_t)sim->all_vertices,
                        &p->carrier, err);
  if (status == CLOTH_OK)
    status = take_reals(sim, p, "x_solved", sim->vertex_count, 3, &p->zone.x_solved, err);
  if (status == CLOTH_OK) status = cloth_take(sim, p, "moved", n, &p->zone.moved, err);
  if (status == CLOTH_OK)
    status = cloth_take(sim, p, "grasp_of", sizeof(int) * n, &p->grasp_of, err);
  free(number);
  return status;
}

static cloth_status take_bodies(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  int bodies = sim->def->body_count, n = sim->all_vertices - sim->vertex_count;
  double *local = malloc(sizeof *local * 3 * (size_t)(n + 1)),
         *friction = malloc(sizeof *friction * (size_t)bodies);
  int *body_of = malloc(sizeof *body_of * (size_t)(n + 1));
  cloth_status status = CLOTH_NO_MEMORY;
  if (!local || !friction || !body_of) {
    cloth_fail(err, status, __FILE__, __LINE__, "bodies");
    goto done;
  }
  for (int b = 0; b < bodies; b++) {
    const cloth_mesh *m = &sim->def->body[b].mesh;
    int first = sim->body[b].vertex_first - sim->vertex_count;
    for (int i = 0; i < 3 * m->vertex_count; i++)
      local[3 * first + i] = sim->body[b].spread * m->position[i];
    for (int v = 0; v < m->vertex_count; v++) body_of[first + v] = b;
    friction[b] = sim->active[CLOTH_EFFECT_friction] ? sim->def->body[b].friction : 0;
  }
  CLOTH_TRY_GOTO(cloth_upload_real(sim, p, "body_local", local, 3 * n, &p->body_local, err), status,
                 done);
  CLOTH_TRY_GOTO(
      cloth_upload_real(sim, p, "body_friction", friction, bodies, &p->body_friction, err), status,
      done);
  CLOTH_TRY_GOTO(
      cloth_upload(sim, p, "body_of", body_of, sizeof(int) * (size_t)n, &p->body_of, err), status,
      done);
  CLOTH_TRY_GOTO(cloth_take(sim, p, "body_triangle",
                            sizeof(int) * (size_t)(sim->all_triangles - sim->triangle_count),
                            &p->body_triangle, err),
                 status, done);
done:
  free(local), free(friction), free(body_of);
  return status;
}

cloth_status cloth_part_build(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  sim->owner = CLOTH_CORE;
  CLOTH_TRY(cloth_staging(sim, 6 * (size_t)sim->all_vertices + 16, err));
  CLOTH_TRY(take_vertices(sim, p, err));
  if (cloth_is_mass_spring(sim)) return cloth_springs_upload(sim, p, err);
  if (cloth_flies(sim)) return cloth_flight_take(sim, p, err);
  if (sim->aggregates > 0) CLOTH_TRY(take_coarse(sim, p, err));
  if (cloth_has_coarser_levels(sim) && sim->params.preconditioner == CLOTH_MULTILEVEL)
    CLOTH_TRY(cloth_hats_build(sim, p, err));
  CLOTH_TRY(take_solve(sim, p, err));
  CLOTH_TRY(cloth_bdf2_take(sim, p, err));
  CLOTH_TRY(cloth_effects_prepare(sim, p, err));
  bool self = sim->active[CLOTH_EFFECT_self_contact], body = sim->active[CLOTH_EFFECT_body_contact];
  sim->owner = cloth_contact_owner(sim);
  if (self || body) CLOTH_TRY(take_contact(sim, p, err));
  sim->owner = CLOTH_EFFECT_body_contact;
  if (body) CLOTH_TRY(take_bodies(sim, p, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

void cloth_part_clear(cloth_sim *sim, cloth_part *p)
{
  cloth_drop_all(sim, p);
  free(p->body_listed);
  *p = (cloth_part){.device = p->device,
                    .index = p->index,
                    .lost = p->lost,
                    .v0 = p->v0,
                    .v1 = p->v1,
                    .block = p->block,
                    .block_capacity = p->block_capacity,
                    .ready = p->ready,
                    .sent = p->sent,
                    .stage_begin = p->stage_begin,
                    .stage_end = p->stage_end,
                    .launch_begin = p->launch_begin,
                    .launch_end = p->launch_end};
}
