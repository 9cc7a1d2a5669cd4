#include "state/recut.h"

#include "ccd/zones.h"
#include "chunk.h"
#include "contact/flat.h"
#include "contact/friction.h"
#include "contact/ghosts.h"
#include "effect/effect.h"
#include "state/cut.h"
#include "state/part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Prices, in products of a 3x3 block with a vector (18 instructions): what callgrind counts on a
// CPU for a towel that falls on another, with two levels and with hats.
#define ROW_VECTORS    12 // what an iteration does to a row beside its product (8 and 21)
#define ROW_SYSTEM     16 // forces, tangents and assembly, in iterations over the row (29 and 19)
#define CONTACT        10 // an iteration over a contact
#define CONTACT_SYSTEM 6  // forces and places, in iterations over the contact
#define PAIR_TEST      9  // of two triangles that share a cell
#define PAIR_LOOK      30 // at a candidate: its distance, or its time of impact

// What a cut costs, in steps: the host makes the rows of every part anew, 8 us a vertex, which is
// one step of a CPU (ten, so that a passing moment is let pass) and by that some thousand of a GPU.
// Parts wait for so long before it is made (as one rents skis until the rent has come to
// their price), so that whatever the work does, waiting and cutting cost at most twice the least
// they could.
enum { COST_ON_CPU = 10, COST_ON_GPU = 1000 };

#define WORTH 0.95 // the part with most must get at most this share of what it has

// ---- counting -----------------------------------------------------------------------------------

void cloth_work_solve(const cloth_sim *sim, cloth_part *p, int iterations)
{
  double blocks = (double)p->row_slots * sim->backend->row_group;
  p->load.rows += (iterations + ROW_SYSTEM) * (blocks + ROW_VECTORS * (p->v1 - p->v0));
  p->load.contacts += (iterations + CONTACT_SYSTEM) * CONTACT * (double)p->contact_count;
}

void cloth_work_search(cloth_part *p, double tests) { p->load.pairs += PAIR_TEST * tests; }

void cloth_work_look(cloth_part *p, int pairs) { p->load.pairs += PAIR_LOOK * (double)pairs; }

void cloth_recut_note(cloth_sim *sim)
{
  cloth_recut *r = &sim->recut;
  double sum = 0;
  r->worst = 0;
  for (int i = 0; i < sim->part_count; i++) {
    const cloth_work *w = &sim->part[i].load;
    double work = w->rows + w->contacts + w->pairs;
    sum += work, r->worst = fmax(r->worst, work);
  }
  double share = sum > 0 ? r->worst * sim->part_count / sum : 1;
  sim->report->work_worst = share;
  bool wanted = sim->params.rebalance > 0 && !r->refused;
  if (wanted && share > sim->params.rebalance) r->waited += share - 1;
}

// ---- where the work lies ------------------------------------------------------------------------

// the work of a part spread over its units by what lies in them
typedef struct spreader {
  const cloth_sim *sim;
  int units;
  int *unit_of;  // [chunks]
  double *count; // [units] of one part and kind
  double *work;  // [units]
} spreader;

static void count_vertex(spreader *s, const cloth_part *p, int v, double count)
{
  if (v >= p->v0 && v < p->v1) s->count[s->unit_of[v / CLOTH_CHUNK]] += count;
}

static void spread(spreader *s, double work)
{
  double sum = 0;
  for (int u = 0; u < s->units; u++) sum += s->count[u];
  for (int u = 0; u < s->units && sum > 0; u++) s->work[u] += work * s->count[u] / sum;
  memset(s->count, 0, sizeof *s->count * (size_t)s->units);
}

static cloth_status read_list(const cloth_sim *sim, const cloth_part *p, const void *from,
                              size_t bytes, void **out, cloth_error *err)
{
  *out = malloc(bytes + 1);
  if (*out == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "another cut: %zu bytes", bytes);
  cloth_status status = sim->backend->read(p->device, *out, from, bytes, err);
  if (status == CLOTH_OK) return CLOTH_OK;
  free(*out);
  *out = NULL;
  return status;
}

static cloth_status count_rows(spreader *s, const cloth_part *p, cloth_error *err)
{
  int group = s->sim->backend->row_group, rows = p->v1 - p->v0, groups = (rows + group - 1) / group;
  void *list;
  CLOTH_TRY(read_list(s->sim, p, p->row_first, sizeof(int) * ((size_t)groups + 1), &list, err));
  const int *first = list;
  for (int row = 0; row < rows; row++) {
    int width = first[row / group + 1] - first[row / group];
    count_vertex(s, p, p->v0 + row, width + ROW_VECTORS);
  }
  free(list);
  return CLOTH_OK;
}

static cloth_status count_contacts(spreader *s, const cloth_part *p, cloth_error *err)
{
  size_t n = 4 * (size_t)p->contact_count;
  void *list;
  if (n == 0) return CLOTH_OK;
  CLOTH_TRY(read_list(s->sim, p, p->contact_vertex, sizeof(int) * n, &list, err));
  for (size_t i = 0; i < n; i++) count_vertex(s, p, ((const int *)list)[i], 1);
  free(list);
  return CLOTH_OK;
}

static cloth_status count_pairs(spreader *s, const cloth_part *p, cloth_error *err)
{
  size_t n = (size_t)p->pair_count;
  void *list;
  CLOTH_TRY(read_list(s->sim, p, p->pair, sizeof(uint64_t) * n, &list, err));
  for (size_t i = 0; i < n; i++) {
    int v[4];
    cloth_pair_corners(s->sim, ((const uint64_t *)list)[i], v);
    for (int k = 0; k < 4; k++) count_vertex(s, p, v[k], 1);
  }
  free(list);
  return CLOTH_OK;
}

static cloth_status spread_part(spreader *s, const cloth_part *p, cloth_error *err)
{
  const cloth_work *w = &p->load;
  double rest = w->rows;
  bool pairs = s->sim->pairs_valid && p->pair_count > 0; // else the list is of another kind
  if (p->contact_count > 0) {
    CLOTH_TRY(count_contacts(s, p, err));
    spread(s, w->contacts + (pairs ? 0 : w->pairs));
  } else {
    rest += w->contacts + (pairs ? 0 : w->pairs);
  }
  if (pairs) {
    CLOTH_TRY(count_pairs(s, p, err));
    spread(s, w->pairs);
  }
  CLOTH_TRY(count_rows(s, p, err));
  spread(s, rest);
  return CLOTH_OK;
}

// work [units] of the last step; to be freed
static cloth_status find_work(const cloth_sim *sim, int units, double **out, cloth_error *err)
{
  spreader s = {sim, units, malloc(sizeof(int) * (size_t)sim->chunks),
                calloc((size_t)units, sizeof(double)), calloc((size_t)units, sizeof(double))};
  cloth_status status = CLOTH_OK;
  if (!s.unit_of || !s.count || !s.work)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "another cut: %d units", units);
  for (int u = 0; u < units && status == CLOTH_OK; u++)
    for (int v = cloth_cut_vertex(sim, u); v < cloth_cut_vertex(sim, u + 1); v += CLOTH_CHUNK)
      s.unit_of[v / CLOTH_CHUNK] = u;
  for (int i = 0; i < sim->part_count && status == CLOTH_OK; i++)
    status = spread_part(&s, &sim->part[i], err);
  free(s.unit_of), free(s.count);
  *out = s.work;
  return status;
}

// ---- the new cut --------------------------------------------------------------------------------

// what the parts have of the state beside what the host has
typedef struct kept {
  cloth_real *vector; // [4][3 vertices] m, m/s: x, v, and of bdf2 those before
  cloth_friction_entry *friction;
  int friction_count;
} kept;

static int vectors_of(const cloth_sim *sim, const cloth_part *p, cloth_real *vector[4])
{
  cloth_real *all[] = {p->x_t0, p->v, p->x_last, p->v_last};
  memcpy(vector, all, sizeof all);
  return sim->bdf2.known ? 4 : 2;
}

static cloth_status keep(cloth_sim *sim, kept *k, cloth_error *err)
{
  const cloth_part *p = &sim->part[0];
  cloth_real *vector[4];
  int count = vectors_of(sim, p, vector);
  size_t n = 3 * (size_t)sim->vertex_count;
  CLOTH_TRY(cloth_friction_read(sim, &k->friction, &k->friction_count, err));
  k->vector = malloc(sizeof *k->vector * n * (size_t)count);
  if (k->vector == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "another cut: %zu numbers", n);
  for (int i = 0; i < count; i++)
    CLOTH_TRY(sim->backend->read(p->device, k->vector + n * (size_t)i, vector[i],
                                 sizeof(cloth_real) * n, err));
  return CLOTH_OK;
}

static cloth_status rebuild(cloth_sim *sim, cloth_part *p, const kept *k, cloth_error *err)
{
  bool stray = p->stray != NULL;
  cloth_real *vector[4];
  size_t n = 3 * (size_t)sim->vertex_count;
  p->lost = true; // until it holds the whole cloth again
  cloth_part_clear(sim, p);
  CLOTH_TRY(cloth_part_build(sim, p, err));
  int count = vectors_of(sim, p, vector);
  for (int i = 0; i < count; i++)
    CLOTH_TRY(sim->backend->write(p->device, vector[i], k->vector + n * (size_t)i,
                                  sizeof(cloth_real) * n, err));
  p->lost = false;
  CLOTH_TRY(cloth_holds_take(sim, p, err));
  return stray ? cloth_tangles_mark(sim, p, err) : CLOTH_OK;
}

// parts are built one after the other, so that no device holds two of them, and all the others the
// whole cloth
static cloth_status rebuild_all(cloth_sim *sim, const int *cut, const kept *k, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    CLOTH_TRY(sim->backend->finish(sim->part[i].device, err));
    sim->part[i].v0 = cut[i], sim->part[i].v1 = cut[i + 1];
  }
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(rebuild(sim, &sim->part[i], k, err));
  CLOTH_TRY(cloth_flat_build(sim, err));
  CLOTH_TRY(cloth_ghosts_build(sim, err));
  CLOTH_TRY(cloth_friction_write(sim, k->friction, k->friction_count, err));
  sim->damping_h = 0; // is written anew
  sim->pairs_valid = false;
  return CLOTH_OK;
}

cloth_status cloth_recut_at(cloth_sim *sim, const int *cut, cloth_error *err)
{
  int before[CLOTH_DEVICES_MAX + 1];
  kept k = {NULL, NULL, 0};
  cloth_error full = {0};
  cloth_cuts(sim, before);
  cloth_status status = keep(sim, &k, err);
  if (status == CLOTH_OK) {
    status = rebuild_all(sim, cut, &k, &full);
    sim->recut.refused = status == CLOTH_NO_MEMORY;
    if (sim->recut.refused)
      status = rebuild_all(sim, before, &k, err);
    else if (status != CLOTH_OK)
      cloth_fail(err, status, full.file, full.line, "%s", full.text);
  }
  sim->owner = CLOTH_CORE;
  free(k.vector), free(k.friction);
  return status;
}

cloth_status cloth_recut_if_due(cloth_sim *sim, cloth_error *err)
{
  cloth_recut *r = &sim->recut;
  int units = cloth_cut_units(sim), first[CLOTH_DEVICES_MAX + 1];
  if (r->waited < (sim->backend->elapsed != NULL ? COST_ON_GPU : COST_ON_CPU)) return CLOTH_OK;
  r->waited = 0;
  if (units < sim->part_count) return CLOTH_OK;
  double *work = NULL;
  cloth_status status = find_work(sim, units, &work, err);
  if (status == CLOTH_OK) {
    double worst = cloth_cut_by_work(units, work, sim->part_count, first);
    for (int j = 0; j <= sim->part_count; j++) first[j] = cloth_cut_vertex(sim, first[j]);
    bool worth = worst <= WORTH * r->worst;
    if (worth) status = cloth_recut_at(sim, first, err);
    sim->report->recuts += worth && !r->refused;
  }
  free(work);
  return status;
}
