// The search of the broad phase: a spatial hash of triangles, a workload table cut into equal
// shares, and pairs of features as keys.
#include "cell_count.h"
#include "cell_fill.h"
#include "chunk.h"
#include "contact/count.h"
#include "contact/flat.h"
#include "contact/ghosts.h"
#include "contact/near.h"
#include "contact/pairs.h"
#include "effect/effect.h"
#include "entry_work.h"
#include "pair_large.h"
#include "pair_share.h"
#include "state/recut.h"
#include "triangle_box.h"
#include "vertex_box.h"

#include <math.h>

enum { ENTRIES_USUAL = 64, ENTRIES_ALWAYS = 1 << 16 }; // cells for each triangle, and for all
enum { CELLS_MOST = 1 << 10 };                         // along an axis: keys of 30 bits

typedef struct hash {
  cloth_grid grid;
  double gap;   // m, distance at which a pair of cloth counts
  double reach; // m, that much farther where one of the two is a body's
  double slack; // m, how far a vertex may stray
  int active;   // triangles: cloth, then near bodies
  int entries, units, large;
  cloth_pair_mesh mesh;
} hash;

static double widest(const hash *h) { return h->gap + h->reach; }

// ---- regions -----------------------------------------------------------------------------------

// of all vertices, and of the triangles of bodies; those of cloth come when ghosts are known
static cloth_status make_boxes(cloth_sim *sim, cloth_part *p, double slack, bool levels,
                               cloth_error *err)
{
  cloth_vertex_box_args v = {0,
                             p->x_t0,
                             p->x,
                             sim->h > 0 ? p->v : NULL,
                             (cloth_real)sim->h,
                             (cloth_real)slack,
                             levels ? p->vertex_level : NULL,
                             sim->region_lost,
                             p->vertex_box};
  cloth_triangle_box_args t = {0, p->triangle, p->vertex_box, NULL, p->triangle_box};
  CLOTH_LAUNCH(sim, p, vertex_box, sim->vertex_count, &v, err);
  for (int b = 0; b < sim->def->body_count; b++) {
    if (!sim->body[b].near) continue;
    v.v = NULL, v.first = sim->body[b].vertex_first;
    CLOTH_LAUNCH(sim, p, vertex_box, sim->body[b].vertex_count, &v, err);
  }
  for (int b = cloth_near_next(sim, 0), triangles; b < sim->def->body_count;) {
    b = cloth_near_run(sim, b, true, &t.first, &triangles);
    CLOTH_LAUNCH(sim, p, triangle_box, triangles, &t, err);
  }
  return CLOTH_OK;
}

// Cells about as large as a swept triangle's box, times `coarser`; the grid spans the cloth. Their
// size decides how long a search takes, not which pairs it finds.
static cloth_grid choose_grid(const cloth_sim *sim, double gap, double slack, double coarser)
{
  double sweep = fmin(sim->speed_last * sim->h, 4 * sim->mean_edge);
  double cell = coarser * (1.2 * sim->mean_edge + gap + 2 * slack + 0.7 * sweep);
  double lo[3] = {(double)sim->cloth_box.lo.x, (double)sim->cloth_box.lo.y,
                  (double)sim->cloth_box.lo.z};
  double hi[3] = {(double)sim->cloth_box.hi.x, (double)sim->cloth_box.hi.y,
                  (double)sim->cloth_box.hi.z};
  double reach = gap + slack, longest = 0;
  for (int k = 0; k < 3; k++) longest = fmax(longest, hi[k] - lo[k] + 2 * reach);
  cell = fmax(cell, longest / (CELLS_MOST - 1));
  cloth_grid g;
  g.inverse = (cloth_real)(1 / cell);
  for (int k = 0; k < 3; k++) {
    g.origin[k] = (cloth_real)(lo[k] - reach);
    g.size[k] = (int)((hi[k] - lo[k] + 2 * reach) / cell) + 1;
  }
  return g;
}

static int key_bits(const cloth_grid *g)
{
  uint64_t cells = (uint64_t)g->size[0] * (uint64_t)g->size[1] * (uint64_t)g->size[2];
  int bits = 1;
  while (bits < 63 && cells >> bits) bits++;
  return bits;
}

// ---- the hash ----------------------------------------------------------------------------------

// The capacities noted are what was asked for: a buffer that happens to be large enough is not
// grown, so what it holds beyond the request must not be counted on.
static cloth_status grow_cells(cloth_sim *sim, cloth_part *p, size_t entries, cloth_error *err)
{
  if (entries <= p->cell_capacity) return CLOTH_OK;
  CLOTH_TRY(cloth_grow_little(sim, p, "cell_key", 8 * entries, &p->cell_key, err));
  CLOTH_TRY(cloth_grow_little(sim, p, "cell_key_spare", 8 * entries, &p->cell_key_spare, err));
  CLOTH_TRY(cloth_grow_little(sim, p, "cell_triangle", 4 * entries, &p->cell_triangle, err));
  CLOTH_TRY(
      cloth_grow_little(sim, p, "cell_triangle_spare", 4 * entries, &p->cell_triangle_spare, err));
  CLOTH_TRY(cloth_grow_little(sim, p, "work", 4 * (entries + 1), &p->work, err));
  p->cell_capacity = (uint32_t)entries;
  return CLOTH_OK;
}

static cloth_status grow_active(cloth_sim *sim, cloth_part *p, size_t active, cloth_error *err)
{
  if (active <= p->active_capacity) return CLOTH_OK;
  size_t bodies = active - (size_t)sim->triangle_count;
  CLOTH_TRY(cloth_grow(sim, p, "cells", 4 * (active + 1), &p->cells, err));
  CLOTH_TRY(cloth_grow(sim, p, "large", 4 * (bodies + 1), &p->large, err));
  p->active_capacity = (uint32_t)active;
  return CLOTH_OK;
}

// Cells of every triangle, counted and scanned.
static cloth_status count_cells(cloth_sim *sim, cloth_part *p, const hash *h, cloth_error *err)
{
  CLOTH_TRY(grow_active(sim, p, (size_t)h->active, err));
  CLOTH_TRY(cloth_ghosts_find(sim, p, &h->grid, widest(h) / 2, err));
  cloth_triangle_box_args t = {0, p->triangle, p->vertex_box, p->ghost_near, p->triangle_box};
  CLOTH_LAUNCH(sim, p, triangle_box, sim->triangle_count, &t, err);
  CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_LARGE, err));
  cloth_cell_count_args count = {.grid = h->grid,
                                 .gap = (cloth_real)(widest(h) / 2),
                                 .cloth_triangles = sim->triangle_count,
                                 .body_triangle = p->body_triangle,
                                 .box = p->triangle_box,
                                 .count = p->cells,
                                 .large = p->large,
                                 .large_count = cloth_counter(p, CLOTH_COUNT_LARGE),
                                 .vast_count = cloth_counter(p, CLOTH_COUNT_LARGE) + 1,
                                 .mark = cloth_ghosts_marks(p),
                                 .near = p->ghost_near};
  cloth_box all = cloth_box_swept(sim->cloth_box.lo, sim->cloth_box.hi, (cloth_real)h->slack);
  cloth_box_store(count.cloth_box, 0, all);
  CLOTH_LAUNCH(sim, p, cell_count, h->active, &count, err);
  return sim->backend->scan(p->device, h->active, p->cells, err);
}

// What was counted. Cells that are too small for triangles of this size (a solve that has run away,
// a mesh of very unequal triangles) are doubled: memory stays bounded, and which pairs are found
// does not depend on the grid.
static cloth_status read_cells(cloth_sim *sim, cloth_part *p, hash *h, cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  size_t usual = ENTRIES_ALWAYS + (size_t)ENTRIES_USUAL * (size_t)h->active;
  for (double coarser = 2;; coarser *= 2) {
    uint32_t entries, found[2];
    CLOTH_TRY(be->read(p->device, &entries, p->cells + h->active, sizeof entries, err));
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_LARGE, found, err));
    h->entries = (int)entries, h->large = (int)found[0];
    bool one = h->grid.size[0] == 1 && h->grid.size[1] == 1 && h->grid.size[2] == 1;
    if (one || (found[1] == 0 && entries <= usual)) return CLOTH_OK;
    h->grid = choose_grid(sim, widest(h), h->slack, coarser);
    CLOTH_TRY(count_cells(sim, p, h, err));
  }
}

static cloth_status fill_cells(cloth_sim *sim, cloth_part *p, hash *h, cloth_error *err)
{
  CLOTH_TRY(read_cells(sim, p, h, err));
  if (h->entries == 0) return CLOTH_OK;
  CLOTH_TRY(grow_cells(sim, p, (size_t)h->entries, err));
  cloth_cell_fill_args fill = {.grid = h->grid,
                               .gap = (cloth_real)(widest(h) / 2),
                               .cloth_triangles = sim->triangle_count,
                               .body_triangle = p->body_triangle,
                               .box = p->triangle_box,
                               .first = p->cells,
                               .cell = p->cell_key,
                               .triangle = p->cell_triangle,
                               .mark = cloth_ghosts_marks(p)};
  CLOTH_LAUNCH(sim, p, cell_fill, h->active, &fill, err);
  return sim->backend->sort(p->device, h->entries, key_bits(&h->grid), p->cell_key,
                            p->cell_triangle, p->cell_key_spare, p->cell_triangle_spare, err);
}

static cloth_status weigh_cells(cloth_sim *sim, cloth_part *p, const hash *h, cloth_error *err)
{
  if (h->entries == 0) return CLOTH_OK;
  cloth_entry_work_args a = {.count = h->entries,
                             .cell = p->cell_key,
                             .triangle = p->cell_triangle,
                             .cloth_triangles = sim->triangle_count,
                             .self = h->mesh.self,
                             .flat = h->mesh.flat,
                             .work = p->work};
  CLOTH_LAUNCH(sim, p, entry_work, h->entries, &a, err);
  return sim->backend->scan(p->device, h->entries, p->work, err);
}

// ---- pairs -------------------------------------------------------------------------------------

static cloth_status emit_pairs(cloth_sim *sim, cloth_part *p, hash *h, cloth_error *err)
{
  h->mesh.key = p->pair, h->mesh.capacity = p->pair_capacity;
  CLOTH_TRY(cloth_count_clear(sim, p, CLOTH_COUNT_PAIRS, err));
  h->mesh.count = cloth_counter(p, CLOTH_COUNT_PAIRS);
  cloth_pair_share_args share = {h->mesh,    h->grid,     (cloth_real)(widest(h) / 2),
                                 h->entries, p->cell_key, p->cell_triangle,
                                 p->work};
  CLOTH_LAUNCH(sim, p, pair_share, (h->units + CLOTH_SHARE - 1) / CLOTH_SHARE, &share, err);
  int chunks = (sim->triangle_count + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
  cloth_pair_large_args large = {h->mesh, chunks, p->large, p->ghost_near};
  CLOTH_LAUNCH(sim, p, pair_large, h->large * chunks, &large, err);
  return CLOTH_OK;
}

static cloth_pair_mesh mesh_of(const cloth_sim *sim, const cloth_part *p, const hash *h,
                               cloth_pairs_wanted wanted)
{
  cloth_pair_mesh mesh = {.cloth_vertices = sim->vertex_count,
                          .cloth_triangles = sim->triangle_count,
                          .triangle = p->triangle,
                          .triangle_edge = p->triangle_edge,
                          .owns = p->owns,
                          .edge = p->edge,
                          .vertex_box = p->vertex_box,
                          .box = p->triangle_box,
                          .gap = (cloth_real)h->gap,
                          .reach = (cloth_real)h->reach,
                          .self = sim->active[CLOTH_EFFECT_self_contact] &&
                                  wanted != CLOTH_PAIRS_BODY_TRIANGLES,
                          .first = p->v0,
                          .last = p->v1,
                          .triangles_only = wanted != CLOTH_PAIRS_FEATURES,
                          .format = sim->format};
  return mesh;
}

// A search in four steps, between which the host reads a number. All parts do one before the host
// asks the first for its number, so that they do it at the same time.

static cloth_status begin(cloth_sim *sim, cloth_part *p, hash *h, cloth_pairs_wanted wanted,
                          cloth_error *err)
{
  int near;
  CLOTH_TRY(cloth_near_list(sim, p, &near, err));
  h->active = sim->triangle_count + near;
  CLOTH_TRY(make_boxes(sim, p, h->slack, wanted == CLOTH_PAIRS_FEATURES, err));
  CLOTH_TRY(count_cells(sim, p, h, err));
  h->mesh = mesh_of(sim, p, h, wanted);
  return CLOTH_OK;
}

static cloth_status sort_and_weigh(cloth_sim *sim, cloth_part *p, hash *h, cloth_error *err)
{
  CLOTH_TRY(fill_cells(sim, p, h, err));
  if (h->mesh.self) {
    CLOTH_TRY(cloth_flat_note(sim, p, err));
    h->mesh.flat = cloth_flat_map_of(sim, p);
  }
  return weigh_cells(sim, p, h, err);
}

static cloth_status emit(cloth_sim *sim, cloth_part *p, hash *h, cloth_error *err)
{
  uint32_t units = 0;
  if (h->entries > 0)
    CLOTH_TRY(sim->backend->read(p->device, &units, p->work + h->entries, sizeof units, err));
  h->units = (int)units;
  cloth_work_search(p, h->units);
  return emit_pairs(sim, p, h, err);
}

static cloth_status end(cloth_sim *sim, cloth_part *p, hash *h, cloth_error *err)
{
  for (;;) {
    uint32_t count;
    CLOTH_TRY(cloth_count_read(sim, p, CLOTH_COUNT_PAIRS, &count, err));
    p->pair_count = (int)count;
    if (count <= p->pair_capacity) return CLOTH_OK;
    CLOTH_TRY(cloth_grow(sim, p, "pair", 8 * (size_t)count, &p->pair, err)); // too small: once more
    p->pair_capacity = count + count / 2;
    CLOTH_TRY(emit_pairs(sim, p, h, err));
  }
}

cloth_status cloth_pairs_of_parts(cloth_sim *sim, cloth_part *part, int parts, double gap,
                                  double reach, double slack, cloth_pairs_wanted wanted,
                                  cloth_error *err)
{
  hash h[CLOTH_DEVICES_MAX];
  for (int i = 0; i < parts; i++) {
    h[i] = (hash){.grid = choose_grid(sim, gap + reach, slack, 1),
                  .gap = gap,
                  .reach = reach,
                  .slack = slack};
    CLOTH_TRY(begin(sim, &part[i], &h[i], wanted, err));
  }
  for (int i = 0; i < parts; i++) CLOTH_TRY(sort_and_weigh(sim, &part[i], &h[i], err));
  for (int i = 0; i < parts; i++) CLOTH_TRY(emit(sim, &part[i], &h[i], err));
  for (int i = 0; i < parts; i++) CLOTH_TRY(end(sim, &part[i], &h[i], err));
  return CLOTH_OK;
}
