// From a description to what the engine steps: internal numbering, masses, parts and their memory.
#include "state/build.h"

#include "chunk.h"
#include "contact/flat.h"
#include "contact/ghosts.h"
#include "effect/bend_rest.h"
#include "effect/effect.h"
#include "pcg.h"
#include "state/cut.h"
#include "state/part.h"
#include "transport/spread.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- devices and parts --------------------------------------------------------------------------

// can they solve together, and are they told to?
static bool parts_join(const cloth_sim *sim)
{
  cloth_device *device[CLOTH_DEVICES_MAX];
  for (int p = 0; p < sim->part_count; p++) device[p] = sim->part[p].device;
  return sim->part_count > 1 && sim->params.exchange != CLOTH_EXCHANGE_LAUNCHES &&
         sim->backend->solve_parts != NULL && sim->backend->joined(sim->part_count, device);
}

static void choose_aggregates(cloth_sim *sim)
{
  bool two = cloth_has_coarser_levels(sim) && sim->params.preconditioner == CLOTH_TWO_LEVEL;
  sim->aggregates = !two                                 ? 0
                    : sim->chunks < CLOTH_AGGREGATES_MAX ? sim->chunks
                                                         : CLOTH_AGGREGATES_MAX;
}

static cloth_status open_parts(cloth_sim *sim, cloth_error *err)
{
  sim->chunks = (sim->vertex_count + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
  choose_aggregates(sim);
  const cloth_def *def = sim->def;
  int parts = def->devices_are_processes ? sim->transport->ranks
              : def->device_count > 0    ? def->device_count
                                         : 1;
  int first[CLOTH_DEVICES_MAX + 1];
  cloth_cut_equally(cloth_cut_units(sim), parts, first);
  for (int p = 0; p < parts; p++) {
    cloth_part *part = &sim->part[p];
    int index = def->devices_are_processes ? p : def->device[p];
    if (index < 0 || (index >= sim->backend->device_count() && sim->backend->device_count() > 0))
      CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "device %d is not in [0, %d) of backend %s", index,
                 sim->backend->device_count(), sim->backend->name);
    part->index = p;
    part->v0 = cloth_cut_vertex(sim, first[p]), part->v1 = cloth_cut_vertex(sim, first[p + 1]);
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

// ---- life ---------------------------------------------------------------------------------------

void cloth_sim_free(void *data)
{
  cloth_sim *sim = data;
  if (sim == NULL) return;
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    if (part->device == NULL) continue;
    sim->backend->finish(part->device, NULL);
    cloth_drop_all(sim, part);
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
    CLOTH_TRY_GOTO(cloth_part_build(sim, &sim->part[p], err), status, fail);
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
