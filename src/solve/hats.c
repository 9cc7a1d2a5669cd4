// The levels of the solver that lie between vertices and the whole cloth. At load: grids over each
// cloth as it lies at rest, their nodes in the order of the vertices, and lists of who shares in a
// node. In a substep: the nodes' blocks; in an iteration: their corrections.
#include "solve/hats.h"

#include "hat_matrix.h"
#include "hat_rest_upper.h"
#include "hat_row.h"
#include "hat_spread.h"
#include "hat_upper.h"
#include "sort.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  CELL_EDGES = 4, // width of a cell of the first level
  FEWEST = 4,     // a level that has no more nodes than this on each cloth is left out
  CORNERS = CLOTH_HAT_CORNERS,
  BLOCKS = 6 * (CORNERS + 1)
};

// shares of `count` places in the nodes of a level
typedef struct shares {
  int count, nodes;
  int *corner;        // [count x CORNERS]
  cloth_real *weight; // [count x CORNERS]
  cloth_real *node;   // [nodes x 3] their places, in cells of the level
} shares;

// ---- places -------------------------------------------------------------------------------------

static double area_of(const cloth_mesh *m)
{
  double sum = 0;
  for (int t = 0; t < m->triangle_count; t++) {
    const double *x[3];
    double u[3], v[3];
    for (int k = 0; k < 3; k++) x[k] = m->position + 3 * m->triangle[3 * t + k];
    for (int k = 0; k < 3; k++) u[k] = x[1][k] - x[0][k], v[k] = x[2][k] - x[0][k];
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    sum += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
  }
  return sum;
}

// places of a cloth's vertices; `from` is where its range of the first number begins. Returns its
// end, a node of every level.
static double place_cloth(const cloth_sim *sim, int c, double from, cloth_real *place)
{
  const cloth_mesh *m = &sim->def->cloth[c].mesh;
  int first = sim->cloth_first[c], axis[3] = {0, 1, 2};
  double lo[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, size[3] = {0, 0, 0};
  double cell = CELL_EDGES * sqrt(area_of(m) / fmax(1, m->vertex_count));
  for (int i = 0; i < 3 * m->vertex_count; i++) lo[i % 3] = fmin(lo[i % 3], m->position[i]);
  for (int i = 0; i < 3 * m->vertex_count; i++)
    size[i % 3] = fmax(size[i % 3], m->position[i] - lo[i % 3]);
  for (int a = 0; a < 2; a++) // the longest first
    for (int b = a + 1; b < 3; b++)
      if (size[axis[b]] > size[axis[a]]) {
        int swap = axis[a];
        axis[a] = axis[b], axis[b] = swap;
      }
  bool flat = size[axis[2]] < cell / 2;
  for (int i = 0; i < m->vertex_count; i++) {
    const double *x = m->position + 3 * sim->order[first + i];
    double u[3];
    for (int k = 0; k < 3; k++) u[k] = cell > 0 ? (x[axis[k]] - lo[axis[k]]) / cell : 0;
    u[0] += from;
    if (flat) u[2] = -1;
    for (int k = 0; k < 3; k++) place[3 * (first + i) + k] = (cloth_real)u[k];
  }
  double widest = pow(CLOTH_HAT_RATIO, CLOTH_HAT_LEVELS - 1);
  double end = from + (cell > 0 ? size[axis[0]] / cell : 0);
  return (floor(end / widest) + 3) * widest; // no hat reaches two cells
}

// ---- nodes --------------------------------------------------------------------------------------

static void shares_free(shares *s) { free(s->corner), free(s->weight), free(s->node); }

// bits of a node's three numbers, in turn: a Morton code
static uint64_t code_of(cloth_v3 node)
{
  uint64_t code = 0, k[3] = {(uint64_t)node.x, (uint64_t)node.y, (uint64_t)(node.z + 1)};
  for (int bit = 0; bit < 21; bit++)
    for (int a = 0; a < 3; a++) code |= (k[a] >> bit & 1) << (3 * bit + a);
  return code;
}

// a place in cells of a level, from cells of the first
static cloth_v3 at_level(const cloth_real *place, int i, cloth_real scale)
{
  cloth_v3 u = cloth_v3_load(place, i);
  return cloth_v3_make(u.x * scale, u.y * scale, u.z < 0 ? u.z : u.z * scale);
}

// nodes in the order of the first place that shares in them: as near each other as the places
static void number_nodes(shares *s, int *number)
{
  int next = 0;
  for (int c = 0; c < s->nodes; c++) number[c] = -1;
  for (int i = 0; i < s->count * CORNERS; i++)
    if (s->weight[i] > 0 && number[s->corner[i]] < 0) number[s->corner[i]] = next++;
  for (int i = 0; i < s->count * CORNERS; i++) s->corner[i] = number[s->corner[i]];
}

// number the corners of all places: equal codes are one node
static void number_corners(shares *s, const cloth_real *place, cloth_real scale, uint64_t *key,
                           uint32_t *value)
{
  size_t n = (size_t)s->count * CORNERS;
  for (size_t i = 0; i < n; i++) {
    cloth_v3 u = at_level(place, (int)(i / CORNERS), scale);
    cloth_v3 node = cloth_hat_corner(u, (int)(i % CORNERS));
    s->weight[i] = cloth_hat_at(u, node);
    if (!(s->weight[i] > 0)) node = cloth_hat_corner(u, 0); // shares in nothing, and adds no node
    key[i] = code_of(node), value[i] = (uint32_t)i;
  }
  cloth_cpu_sort((int)n, 63, key, value, key + n, value + n, 1);
  s->nodes = 0;
  for (size_t i = 0; i < n; i++) {
    if (i == 0 || key[i] != key[i - 1]) s->nodes++;
    s->corner[value[i]] = s->nodes - 1;
  }
  number_nodes(s, (int *)key);
}

// shares of `count` places, in cells of the first level, in the nodes of the level of that scale
static cloth_status shares_make(shares *s, int count, const cloth_real *place, cloth_real scale,
                                cloth_error *err)
{
  size_t n = (size_t)count * CORNERS;
  *s = (shares){.count = count};
  uint64_t *key = malloc(2 * n * sizeof *key + 8);
  uint32_t *value = malloc(2 * n * sizeof *value + 8);
  s->corner = malloc(n * sizeof(int) + 8), s->weight = malloc(n * sizeof(cloth_real) + 8);
  cloth_status status = CLOTH_OK;
  if (!key || !value || !s->corner || !s->weight)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "levels of the solver");
  if (status == CLOTH_OK) {
    number_corners(s, place, scale, key, value);
    s->node = malloc(sizeof(cloth_real) * 3 * (size_t)s->nodes + 8);
    if (!s->node)
      status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "levels of the solver");
  }
  for (size_t i = 0; i < n && status == CLOTH_OK; i++)
    if (s->weight[i] > 0)
      cloth_v3_store(
          s->node, s->corner[i],
          cloth_hat_corner(at_level(place, (int)(i / CORNERS), scale), (int)(i % CORNERS)));
  free(key), free(value);
  if (status != CLOTH_OK) shares_free(s), *s = (shares){.count = 0};
  return status;
}

// ---- lists --------------------------------------------------------------------------------------

typedef struct lists {
  int *first, *child;
  cloth_real *weight;
} lists;

static bool is_listed(const cloth_hat_share *share, const shares *s, int level, int i)
{
  int c = s->corner[i];
  return s->weight[i] > 0 && (level > 0 || (c >= share->begin && c < share->end));
}

// children of the part's own nodes of the first level and of all nodes of the others, in order
static cloth_status lists_make(lists *l, const shares *level, int levels, int nodes,
                               const cloth_hat_share *share, cloth_error *err)
{
  size_t entries = 0;
  for (int k = 0; k < levels; k++) entries += (size_t)level[k].count * CORNERS;
  l->first = calloc((size_t)nodes + 2, sizeof(int));
  l->child = malloc(entries * sizeof(int) + 8),
  l->weight = malloc(entries * sizeof(cloth_real) + 8);
  if (!l->first || !l->child || !l->weight)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "levels of the solver");
  int *place = l->first + 1; // place[c]: first the count of c, then where its next child goes
  for (int k = 0, node = 0; k < levels; node += level[k++].nodes)
    for (int i = 0; i < level[k].count * CORNERS; i++)
      place[node + level[k].corner[i]] += is_listed(share, &level[k], k, i);
  for (int c = 0, sum = 0; c < nodes; c++) {
    int count = place[c];
    place[c] = sum, sum += count;
  }
  for (int k = 0, node = 0; k < levels; node += level[k++].nodes)
    for (int i = 0; i < level[k].count * CORNERS; i++) {
      if (!is_listed(share, &level[k], k, i)) continue;
      int to = place[node + level[k].corner[i]]++;
      l->child[to] = i / CORNERS, l->weight[to] = level[k].weight[i];
    }
  return CLOTH_OK;
}

static void lists_free(lists *l) { free(l->first), free(l->child), free(l->weight); }

static cloth_status take_reals(cloth_sim *sim, cloth_part *p, const char *name, int rows, int width,
                               void *out, cloth_error *err)
{
  return cloth_take(sim, p, name, sizeof(cloth_real) * (size_t)rows * (size_t)width, out, err);
}

static cloth_status upload_lists(cloth_sim *sim, cloth_part *p, const shares *level, int levels,
                                 const lists *l, cloth_error *err)
{
  cloth_hats *h = &p->hats;
  size_t entries = (size_t)l->first[h->nodes], shared = CORNERS * (size_t)level[0].count;
  const size_t of_int = sizeof(int), of_real = sizeof(cloth_real);
  CLOTH_TRY(cloth_upload(sim, p, "hat_corner", level[0].corner, of_int * shared, &h->corner, err));
  size_t at = CORNERS * (size_t)p->v0, own = CORNERS * (size_t)(p->v1 - p->v0); // weights: own rows
  CLOTH_TRY(
      cloth_upload(sim, p, "hat_weight", level[0].weight + at, of_real * own, &h->weight, err));
  h->weight -= at;
  CLOTH_TRY(
      cloth_upload(sim, p, "hat_first", l->first, of_int * ((size_t)h->nodes + 1), &h->first, err));
  CLOTH_TRY(cloth_upload(sim, p, "hat_child", l->child, of_int * entries, &h->child, err));
  CLOTH_TRY(cloth_upload(sim, p, "hat_child_weight", l->weight, of_real * entries, &h->child_weight,
                         err));
  size_t n = (size_t)h->fine * (size_t)h->uppers;
  int *upper = malloc(of_int * n + 8);
  cloth_real *weight = malloc(of_real * n + 8);
  cloth_status status = CLOTH_OK;
  if (!upper || !weight)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "levels of the solver");
  for (int k = 1, node = h->fine; k < levels && status == CLOTH_OK; node += level[k++].nodes)
    for (int i = 0; i < h->fine * CORNERS; i++) {
      int to = h->uppers * (i / CORNERS) + CORNERS * (k - 1) + i % CORNERS;
      upper[to] = node + level[k].corner[i], weight[to] = level[k].weight[i];
    }
  if (status == CLOTH_OK)
    status = cloth_upload(sim, p, "hat_upper", upper, of_int * n, &h->upper, err);
  if (status == CLOTH_OK)
    status = cloth_upload(sim, p, "hat_upper_weight", weight, of_real * n, &h->upper_weight, err);
  free(upper), free(weight);
  return status;
}

// ---- at load ------------------------------------------------------------------------------------

static cloth_status take_levels(cloth_sim *sim, cloth_part *p, const shares *level, int levels,
                                cloth_error *err)
{
  cloth_hats *h = &p->hats;
  lists l = {NULL, NULL, NULL};
  *h = (cloth_hats){.fine = level[0].nodes, .uppers = CORNERS * (levels - 1)};
  for (int k = 0; k < levels; k++) {
    bool wide = k > 0 && h->fine >= CLOTH_HAT_WIDE_FINE &&
                (int64_t)CORNERS * h->fine >= (int64_t)CLOTH_HAT_WIDE_CHILDREN * level[k].nodes;
    h->nodes += level[k].nodes;
    if (!wide) h->wide = h->nodes;
  }
  CLOTH_TRY(cloth_hat_share_build(sim, p, level[0].corner, level[0].weight, err));
  cloth_status status = lists_make(&l, level, levels, h->nodes, &p->hat_share, err);
  if (status == CLOTH_OK) status = upload_lists(sim, p, level, levels, &l, err);
  lists_free(&l);
  CLOTH_TRY(status);
  CLOTH_TRY(take_reals(sim, p, "hat_inverse", h->nodes, 6, &h->inverse, err));
  CLOTH_TRY(take_reals(sim, p, "hat_rest", h->nodes, 3, &h->rest, err));
  CLOTH_TRY(take_reals(sim, p, "hat_correction", h->nodes, 3, &h->correction, err));
  int own = p->v1 - p->v0; // joined parts read the others' where they are
  CLOTH_TRY(take_reals(sim, p, "hat_block", sim->joined ? own : sim->vertex_count, BLOCKS,
                       &p->hat_block, err));
  if (sim->joined) p->hat_block -= (size_t)p->v0 * BLOCKS;
  sim->hat_groups = cloth_hat_fine_groups(h) + cloth_hat_groups(h);
  return take_reals(sim, p, "hat_part", h->fine, 12, &p->hat_part, err);
}

cloth_status cloth_hats_build(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  int n = sim->vertex_count, levels = 0;
  shares level[CLOTH_HAT_LEVELS] = {{0}};
  cloth_real *place = malloc(sizeof(cloth_real) * 3 * (size_t)n + 8), scale = 1;
  if (place == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "levels of the solver");
  double from = 0;
  for (int c = 0; c < sim->def->cloth_count; c++) from = place_cloth(sim, c, from, place);
  cloth_status status = shares_make(&level[0], n, place, scale, err);
  for (levels = 1; levels < CLOTH_HAT_LEVELS && status == CLOTH_OK; levels++) {
    if (level[levels - 1].nodes <= FEWEST * sim->def->cloth_count) break;
    scale /= CLOTH_HAT_RATIO;
    status = shares_make(&level[levels], level[0].nodes, level[0].node, scale, err);
  }
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)n;
  if (status == CLOTH_OK)
    status = cloth_upload(sim, p, "hat_place", place, bytes, &p->hat_place, err);
  if (status == CLOTH_OK) status = take_levels(sim, p, level, levels, err);
  for (int k = 0; k < CLOTH_HAT_LEVELS; k++) shares_free(&level[k]);
  free(place);
  return status;
}

// ---- in a substep -------------------------------------------------------------------------------

// blocks of the part's own nodes of the first level
static cloth_status matrix(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  cloth_hat_matrix_args m = {.hats = p->hats,
                             .first = p->hat_share.begin,
                             .parts = 1,
                             .cut = {0, sim->vertex_count},
                             .block = {p->hat_block},
                             .part = p->hat_part};
  if (sim->joined) {
    m.parts = sim->part_count;
    cloth_cuts(sim, m.cut);
    for (int j = 0; j < sim->part_count; j++) m.block[j] = sim->part[j].hat_block;
  }
  return cloth_launch(sim, p, CLOTH_KERNEL_hat_matrix, p->hat_share.end - p->hat_share.begin, &m,
                      err);
}

cloth_status cloth_hats_update(cloth_sim *sim, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_hat_row_args a = {.rows = {p->row_first, p->row_col, p->row_val, p->row_widest},
                            .first = p->v0,
                            .cloth_vertices = sim->vertex_count,
                            .place = p->hat_place,
                            .free = p->free,
                            .contact_first = p->contact_count > 0 ? p->contact_first : NULL,
                            .contact_entry = p->contact_entry,
                            .contact_vertex = p->contact_vertex,
                            .contact_weight = p->contact_weight,
                            .contact_tangent = p->contact_tangent,
                            .block = p->hat_block};
    CLOTH_LAUNCH(sim, p, hat_row, p->v1 - p->v0, &a, err);
  }
  if (sim->joined)
    CLOTH_TRY(cloth_meet(sim, err));
  else
    CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, hat_block), CLOTH_PER_VERTEX,
                             BLOCKS * sizeof(cloth_real), err));
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(matrix(sim, &sim->part[i], err));
  if (sim->joined)
    CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, hat_part), CLOTH_PER_NODE,
                             12 * sizeof(cloth_real), err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_hat_upper_args u = {p->hats, p->hat_part};
    CLOTH_LAUNCH(sim, p, hat_upper, p->hats.nodes - p->hats.fine, &u, err);
  }
  return CLOTH_OK;
}

cloth_hat_rest_args cloth_hats_args(const cloth_sim *sim, const cloth_part *p,
                                    const cloth_real *done)
{
  cloth_hat_rest_args a = {p->hats, p->r, done, p->partial + CLOTH_PCG_PARTIALS * sim->chunks};
  return a;
}

cloth_status cloth_hats_correct(cloth_sim *sim, bool start, cloth_error *err)
{
  CLOTH_TRY(
      cloth_exchange(sim, offsetof(cloth_part, r), CLOTH_PER_VERTEX, 3 * sizeof(cloth_real), err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    const cloth_real *done = start ? NULL : p->scalar + CLOTH_PCG_DONE;
    cloth_hat_rest_args a = cloth_hats_args(sim, p, done);
    CLOTH_LAUNCH(sim, p, hat_rest, cloth_hat_fine_groups(&p->hats), &a, err);
    CLOTH_LAUNCH(sim, p, hat_rest_upper, cloth_hat_groups(&p->hats), &a, err);
  }
  return CLOTH_OK;
}

cloth_status cloth_hats_spread(cloth_sim *sim, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_hat_spread_args a = {p->hats, p->scalar + CLOTH_PCG_DONE};
    CLOTH_LAUNCH(sim, p, hat_spread, p->hats.fine, &a, err);
  }
  return CLOTH_OK;
}
