// From a description to what the engine steps: internal numbering, masses, parts and their memory.
#include "state/build.h"

#include "chunk.h"
#include "commit_chunk.h"
#include "contact/flat.h"
#include "contact/ghosts.h"
#include "effect/bend_rest.h"
#include "effect/effect.h"
#include "impact_find.h"
#include "pcg.h"
#include "solve/hats.h"
#include "state/bdf2.h"
#include "state/flight.h"
#include "transport/spread.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CLOTH_TWO_LEVEL = 1, CLOTH_MULTILEVEL = 2 }; // of the parameter preconditioner

// ---- devices and parts --------------------------------------------------------------------------

// can they solve together, and are they told to?
static bool parts_join(const cloth_sim *sim)
{
  cloth_device *device[CLOTH_DEVICES_MAX];
  for (int p = 0; p < sim->part_count; p++) device[p] = sim->part[p].device;
  return sim->part_count > 1 && sim->params.exchange != CLOTH_EXCHANGE_LAUNCHES &&
         sim->backend->solve_parts != NULL && sim->backend->joined(sim->part_count, device);
}

// coarser levels are worth it when there is something stiff to solve and more than a patch of it
static bool has_coarser_levels(const cloth_sim *sim)
{
  return !cloth_is_mass_spring(sim) && sim->active[CLOTH_EFFECT_membrane] && sim->chunks >= 4;
}

static void choose_aggregates(cloth_sim *sim)
{
  bool two = has_coarser_levels(sim) && sim->params.preconditioner == CLOTH_TWO_LEVEL;
  sim->aggregates = !two                                 ? 0
                    : sim->chunks < CLOTH_AGGREGATES_MAX ? sim->chunks
                                                         : CLOTH_AGGREGATES_MAX;
}

// the first vertex of a part: that of a chunk, so that sums over chunks do not depend on the cut,
// and of an aggregate, so that a part has all that its columns of the coarse matrix need
static int cut_at(const cloth_sim *sim, int part, int parts)
{
  int chunk = (int)((int64_t)sim->chunks * part / parts);
  if (sim->aggregates > 0)
    chunk = cloth_aggregate_begin((int)((int64_t)sim->aggregates * part / parts), sim->chunks,
                                  sim->aggregates);
  int vertex = chunk * CLOTH_CHUNK;
  return vertex < sim->vertex_count ? vertex : sim->vertex_count;
}

static cloth_status open_parts(cloth_sim *sim, cloth_error *err)
{
  sim->chunks = (sim->vertex_count + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
  choose_aggregates(sim);
  const cloth_def *def = sim->def;
  int parts = def->devices_are_processes ? sim->transport->ranks
              : def->device_count > 0    ? def->device_count
                                         : 1;
  for (int p = 0; p < parts; p++) {
    cloth_part *part = &sim->part[p];
    int index = def->devices_are_processes ? p : def->device[p];
    if (index < 0 || (index >= sim->backend->device_count() && sim->backend->device_count() > 0))
      CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "device %d is not in [0, %d) of backend %s", index,
                 sim->backend->device_count(), sim->backend->name);
    part->index = p;
    part->v0 = cut_at(sim, p, parts), part->v1 = cut_at(sim, p + 1, parts);
    CLOTH_TRY(sim->backend->open(index, sim->params.threads, &part->device, err));
    sim->part_count = p + 1;
    CLOTH_TRY(sim->backend->event_new(part->device, &part->ready, err));
    CLOTH_TRY(sim->backend->event_new(part->device, &part->sent, err));
    CLOTH_TRY(sim->backend->event_new(part->device, &part->stage_begin, err));
    CLOTH_TRY(sim->backend->event_new(part->device, &part->stage_end, err));
    CLOTH_TRY(sim->backend->event_new(part->device, &part->launch_begin, err));
    CLOTH_TRY(sim->backend->event_new(part->device, &part->launch_end, err));
  }
  sim->joined = parts_join(sim);
  if (!def->devices_are_processes) return CLOTH_OK;
  return cloth_spread_connect(sim->part[sim->transport->rank].device, sim->transport, err);
}

// ---- memory of a part ---------------------------------------------------------------------------

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
  CLOTH_TRY(take_reals(sim, p, "scalar", 1, CLOTH_PCG_SCALARS, &p->scalar, err));
  CLOTH_TRY(cloth_take(sim, p, "product_ns", sizeof(uint64_t), &p->product_ns, err));
  CLOTH_TRY(take_reals(sim, p, "commit", sim->chunks, CLOTH_COMMIT_FIELDS, &p->commit, err));
  int boxes = sim->chunks + sim->chunks / (CLOTH_CHUNK - 1) + 8; // and chunks of chunks
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
  CLOTH_TRY(take_reals(sim, p, "triangle_box", sim->all_triangles, 6, &p->triangle_box, err));
  CLOTH_TRY(cloth_take(sim, p, "counter", sizeof(uint32_t) * 10, &p->counter, err));
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

static cloth_status build_part(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  sim->owner = CLOTH_CORE;
  CLOTH_TRY(cloth_staging(sim, 6 * (size_t)sim->all_vertices + 16, err));
  CLOTH_TRY(take_vertices(sim, p, err));
  if (cloth_is_mass_spring(sim)) return cloth_springs_upload(sim, p, err);
  if (cloth_flies(sim)) return cloth_flight_take(sim, p, err);
  if (sim->aggregates > 0) CLOTH_TRY(take_coarse(sim, p, err));
  if (has_coarser_levels(sim) && sim->params.preconditioner == CLOTH_MULTILEVEL)
    CLOTH_TRY(cloth_hats_build(sim, p, err));
  CLOTH_TRY(take_solve(sim, p, err));
  CLOTH_TRY(cloth_bdf2_take(sim, p, err));
  CLOTH_TRY(cloth_effects_prepare(sim, p, err));
  bool self = sim->active[CLOTH_EFFECT_self_contact], body = sim->active[CLOTH_EFFECT_body_contact];
  sim->owner = self ? CLOTH_EFFECT_self_contact : CLOTH_EFFECT_body_contact;
  if (self || body) CLOTH_TRY(take_contact(sim, p, err));
  sim->owner = CLOTH_EFFECT_body_contact;
  if (body) CLOTH_TRY(take_bodies(sim, p, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

// ---- life ---------------------------------------------------------------------------------------

void cloth_sim_free(void *data)
{
  cloth_sim *sim = data;
  if (sim == NULL) return;
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    if (part->device == NULL) continue;
    sim->backend->finish(part->device, NULL);
    for (int i = 0; i < part->block_count; i++)
      sim->backend->release(part->device, part->block[i].data);
    free(part->block), free(part->body_listed);
    sim->backend->event_free(part->ready);
    sim->backend->event_free(part->sent);
    sim->backend->event_free(part->stage_begin);
    sim->backend->event_free(part->stage_end);
    sim->backend->event_free(part->launch_begin);
    sim->backend->event_free(part->launch_end);
  }
  for (int p = 0; p < sim->part_count; p++) sim->backend->close(sim->part[p].device);
  for (int h = 0; h < sim->hold_capacity; h++) {
    free(sim->hold[h].vertex), free(sim->hold[h].local), free(sim->hold[h].ignore);
  }
  free(sim->hold), free(sim->body), free(sim->pin_broken), free(sim->mean_velocity),
      free(sim->acceleration);
  free(sim->cloth_first), free(sim->triangle_first), free(sim->order), free(sim->internal);
  free(sim->triangle_order), free(sim->triangle), free(sim->edge), free(sim->triangle_edge),
      free(sim->owns);
  cloth_zones_free(&sim->zones), cloth_tangles_free(&sim->tangles);
  cloth_blocking_free(&sim->blocking);
  cloth_bend_rest_free(sim->bend_rest);
  cloth_springs_free(&sim->springs);
  free(sim->edge_side), free(sim->edge_flat), free(sim->vertex_flat), free(sim->hinge),
      free(sim->hinge_triangle), free(sim->rest), free(sim->mass), free(sim->host),
      free(sim->held_index);
  free(sim);
}

static cloth_status no_cuda(cloth_error *err)
{
  CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "backend cuda is not in this build: nvcc was not found");
}

static int bits_for(int n)
{
  int bits = 1;
  while (bits < 31 && n >> bits) bits++;
  return bits;
}

static cloth_status build(const cloth_def *def, const cloth_backend *backend,
                          cloth_transport *transport, const char *why, cloth_sim **out,
                          cloth_error *err)
{
  cloth_sim *sim = calloc(1, sizeof *sim);
  if (sim == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "scene");
  sim->def = def;
  sim->params = def->params;
  sim->owner = CLOTH_CORE;
  sim->backend = backend;
  sim->transport = transport;
  snprintf(sim->backend_why, sizeof sim->backend_why, "%s", why);
  cloth_status status;
  CLOTH_TRY_GOTO(cloth_number(sim, err), status, fail);
  CLOTH_TRY_GOTO(cloth_topology_build(sim, err), status, fail);
  int edges = sim->all_edges, vertices = sim->all_vertices, triangles = sim->all_triangles;
  sim->format.bits_a = bits_for(edges > vertices ? edges : vertices);
  sim->format.bits_b = bits_for(edges > triangles ? edges : triangles);
  CLOTH_TRY_GOTO(cloth_effects_choose(sim, err), status, fail);
  CLOTH_TRY_GOTO(cloth_springs_make(sim, err), status, fail);
  CLOTH_TRY_GOTO(open_parts(sim, err), status, fail);
  for (int p = 0; p < sim->part_count; p++)
    CLOTH_TRY_GOTO(build_part(sim, &sim->part[p], err), status, fail);
  CLOTH_TRY_GOTO(cloth_flat_build(sim, err), status, fail);
  CLOTH_TRY_GOTO(cloth_ghosts_build(sim, err), status, fail);
  int pinned = 0;
  for (int i = 0; i < def->pin_count; i++)
    pinned += def->cloth[def->pin[i].cloth].group[def->pin[i].group].count;
  if (def->pin_count > 0)
    CLOTH_TRY_GOTO(cloth_holds_reserve(sim, def->pin_count, pinned, err), status, fail);
  CLOTH_TRY_GOTO(cloth_sim_reset(sim, err), status, fail);
  *out = sim;
  return CLOTH_OK;
fail:
  cloth_sim_free(sim);
  return status;
}

static cloth_status build_here(const cloth_def *def, const cloth_backend *backend, const char *why,
                               cloth_sim **out, cloth_error *err)
{
  return build(def, backend, cloth_transport_peer(), why, out, err);
}

// can every process open its device of this backend?
static cloth_status probe(const cloth_backend *spread, int processes, cloth_error *err)
{
  for (int p = 0; p < processes; p++) {
    cloth_device *device = NULL;
    CLOTH_TRY(spread->open(p, 0, &device, err));
    spread->close(device);
  }
  return CLOTH_OK;
}

// one part for each process: all on GPUs, or all on CPUs
static cloth_status build_spread(const cloth_def *def, cloth_transport *t, cloth_sim **out,
                                 cloth_error *err)
{
  const cloth_backend *cuda = cloth_backend_cuda();
  cloth_error refused = {0};
  const char *why = "asked for";
  bool gpu = strcmp(def->backend, "cpu") != 0;
  if (strcmp(def->backend, "shuffle") == 0)
    CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "backend shuffle does not go with devices: mpi");
  if (t->ranks > CLOTH_DEVICES_MAX)
    CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "%d processes, but a scene has at most %d parts", t->ranks,
               (int)CLOTH_DEVICES_MAX);
  if (gpu && cuda == NULL) {
    if (strcmp(def->backend, "cuda") == 0) return no_cuda(err);
    gpu = false, why = "this build has no CUDA backend";
  }
  if (gpu && probe(cloth_backend_spread(cuda, t), t->ranks, &refused) != CLOTH_OK) {
    if (strcmp(def->backend, "cuda") == 0)
      return cloth_fail(err, refused.status, refused.file, refused.line, "%s", refused.text);
    gpu = false, why = refused.text;
  }
  CLOTH_TRY(
      build(def, cloth_backend_spread(gpu ? cuda : cloth_backend_cpu(), t), t, why, out, err));
  snprintf((*out)->backend_why, sizeof(*out)->backend_why, "%s; %d processes, rows by %s%s%s", why,
           t->ranks, t->name, t->why[0] ? ": " : "", t->why);
  return CLOTH_OK;
}

// `auto`: the GPU where there is one that can hold the scene, else the CPU and why
static cloth_status build_auto(const cloth_def *def, cloth_sim **out, cloth_error *err)
{
  const cloth_backend *cuda = cloth_backend_cuda();
  if (def->devices_are_cpu)
    return build_here(def, cloth_backend_cpu(), "devices are cpu", out, err);
  if (cuda == NULL)
    return build_here(def, cloth_backend_cpu(), "this build has no CUDA backend", out, err);
  cloth_error refused = {0};
  cloth_device *probe = NULL; // cheap, where there is no GPU
  cloth_status status = cuda->open(def->device[0], 0, &probe, &refused);
  cuda->close(probe);
  if (status == CLOTH_OK) status = build_here(def, cuda, "a GPU is there", out, &refused);
  bool device =
      status == CLOTH_UNSUPPORTED || status == CLOTH_NO_MEMORY || status == CLOTH_DEVICE_LOST;
  if (device) return build_here(def, cloth_backend_cpu(), refused.text, out, err);
  if (status != CLOTH_OK)
    return cloth_fail(err, status, refused.file, refused.line, "%s", refused.text);
  return CLOTH_OK;
}

cloth_status cloth_sim_new(const cloth_def *def, cloth_transport *transport, void **out,
                           cloth_error *err)
{
  const char *name = def->backend, *asked = "asked for";
  cloth_sim *sim = NULL;
  cloth_status status;
  if (transport != NULL)
    status = build_spread(def, transport, &sim, err);
  else if (strcmp(name, "shuffle") == 0)
    status = build_here(def, cloth_backend_shuffle(1), asked, &sim, err);
  else if (strcmp(name, "cpu") == 0)
    status = build_here(def, cloth_backend_cpu(), asked, &sim, err);
  else if (strcmp(name, "cuda") != 0)
    status = build_auto(def, &sim, err);
  else if (cloth_backend_cuda() == NULL)
    return no_cuda(err);
  else
    status = build_here(def, cloth_backend_cuda(), asked, &sim, err);
  if (status == CLOTH_OK) *out = sim;
  return status;
}

const char *cloth_sim_backend(const void *sim) { return ((const cloth_sim *)sim)->backend->name; }

const char *cloth_sim_backend_why(const void *sim) { return ((const cloth_sim *)sim)->backend_why; }
