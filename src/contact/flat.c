// Culling of flat patches: tables at load, one pass over the triangles and a pyramid of ranges per
// search and per check. kernels/physics/flat_patch.h says what is proved and why.
#include "contact/flat.h"

#include "contact/flat_part.h"
#include "effect/effect.h"
#include "flat_merge.h"
#include "flat_square.h"
#include "flat_tile.h"
#include "flat_triangle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A search asks for more than a check, so that a square which just passed is not lost at once; both
// for more than the exact bound, which covers rounding. How much more depends on how fast cloth
// bends: where squares are lost and nothing else asks for a search, the next one asks for twice as
// much. A square in a crumpled cloth saves few pairs, and one that is lost costs a search.
#define FLAT_SEARCH_MARGIN      0.04
#define FLAT_SEARCH_MARGIN_MOST 0.32
#define FLAT_SEARCH_MARGIN_FALL 0.9 // at a search for which no square was the reason
#define FLAT_CHECK_MARGIN       0.01

// ---- tables ------------------------------------------------------------------------------------

// a level is there unless the one below spans the cloth already
static bool level_exists(const cloth_sheet *s, int level)
{
  return s->flat && (level == 0 || cloth_sheet_level_size(s, level - 1, 0) > CLOTH_FLAT_SPAN ||
                     cloth_sheet_level_size(s, level - 1, 1) > CLOTH_FLAT_SPAN);
}

static void number_nodes(cloth_sim *sim, cloth_flat_tables *t)
{
  cloth_flat *f = &sim->flat;
  for (int l = 0; l < CLOTH_FLAT_LEVELS; l++) {
    f->level_first[l] = f->nodes;
    for (int c = 0; c < t->count; c++)
      if (level_exists(&t->sheet[c], l))
        f->nodes +=
            cloth_sheet_level_size(&t->sheet[c], l, 0) * cloth_sheet_level_size(&t->sheet[c], l, 1);
    if (l == 0) f->tiles = f->nodes;
  }
  f->level_first[CLOTH_FLAT_LEVELS] = f->nodes;
  for (int c = 0; c < t->count; c++)
    if (t->sheet[c].flat)
      t->listed += t->sheet[c].tile_first[t->sheet[c].size[0] * t->sheet[c].size[1]];
}

static int least(int a, int b) { return a < b ? a : b; }

// one sheet on one level, from node `first` on, out of what starts at node `below`
static void fill_level(const cloth_sheet *s, cloth_flat_tables *t, int level, int first, int below)
{
  int nx = cloth_sheet_level_size(s, level, 0), ny = cloth_sheet_level_size(s, level, 1);
  int mx = level > 0 ? cloth_sheet_level_size(s, level - 1, 0) : nx;
  int my = level > 0 ? cloth_sheet_level_size(s, level - 1, 1) : ny;
  for (int y = 0; y < ny; y++)
    for (int x = 0; x < nx; x++) {
      int node = first + y * nx + x;
      int *source = t->source + 4 * node, *square = t->square + 3 * node;
      if (level > 0) {
        source[0] = below + 2 * y * mx + 2 * x, source[3] = mx;
        source[1] = least(2, mx - 2 * x), source[2] = least(2, my - 2 * y);
      }
      square[0] = least(CLOTH_FLAT_SPAN, nx - x), square[1] = least(CLOTH_FLAT_SPAN, ny - y);
      square[2] = nx;
      t->height[node] = cloth_sheet_square_height(s, level, x, y);
    }
}

static void fill_levels(const cloth_sim *sim, cloth_flat_tables *t)
{
  int *below = malloc(sizeof(int) * ((size_t)t->count + 1));
  if (below == NULL) return; // nothing is valid then
  for (int c = 0; c < t->count; c++) below[c] = 0;
  for (int l = 0; l < CLOTH_FLAT_LEVELS; l++) {
    int node = sim->flat.level_first[l];
    for (int c = 0; c < t->count; c++) {
      int *level = t->level + 2 * (CLOTH_FLAT_LEVELS * c + l);
      level[0] = -1, level[1] = 0;
      if (!level_exists(&t->sheet[c], l)) continue;
      level[0] = node, level[1] = cloth_sheet_level_size(&t->sheet[c], l, 0);
      fill_level(&t->sheet[c], t, l, node, below[c]);
      below[c] = node;
      node += level[1] * cloth_sheet_level_size(&t->sheet[c], l, 1);
    }
  }
  free(below);
}

static void fill_triangles(const cloth_sim *sim, cloth_flat_tables *t)
{
  int tile = 0, listed = 0;
  for (int i = 0; i < sim->triangle_count; i++) t->place[5 * i] = -1;
  for (int c = 0; c < t->count; c++) {
    const cloth_sheet *s = &t->sheet[c];
    if (!s->flat) continue;
    for (int i = s->first; i < s->end; i++) {
      const double *u = s->corner + 6 * (i - s->first);
      double e[4] = {u[2] - u[0], u[3] - u[1], u[4] - u[0], u[5] - u[1]}; // of one tile's length
      double det = (e[0] * e[3] - e[1] * e[2]) * s->tile, *rest = t->rest + 4 * i;
      rest[0] = e[3] / det, rest[1] = -e[2] / det, rest[2] = -e[1] / det, rest[3] = e[0] / det;
      t->place[5 * i] = c;
      memcpy(t->place + 5 * i + 1, s->place + 4 * (i - s->first), sizeof(int) * 4);
    }
    for (int k = 0; k < s->size[0] * s->size[1]; k++) {
      t->tile_first[tile++] = listed;
      for (int n = s->tile_first[k]; n < s->tile_first[k + 1]; n++)
        t->tile_list[listed++] = s->first + s->tile_list[n];
    }
  }
  t->tile_first[tile] = listed;
}

static cloth_status take_tables(const cloth_sim *sim, cloth_flat_tables *t, cloth_error *err)
{
  size_t nodes = (size_t)sim->flat.nodes + 1, n = (size_t)sim->triangle_count + 1;
  t->tile_first = malloc(sizeof(int) * ((size_t)sim->flat.tiles + 1));
  t->tile_list = malloc(sizeof(int) * ((size_t)t->listed + 1)),
  t->place = malloc(sizeof(int) * 5 * n);
  t->source = calloc(4 * nodes, sizeof(int)), t->square = calloc(3 * nodes, sizeof(int));
  t->height = calloc(nodes, sizeof(double)), t->rest = calloc(4 * n, sizeof(double));
  t->level = malloc(sizeof(int) * 2 * CLOTH_FLAT_LEVELS * ((size_t)t->count + 1));
  if (!t->tile_first || !t->tile_list || !t->place || !t->source || !t->square || !t->height ||
      !t->rest || !t->level)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "flat patches: %d squares", sim->flat.nodes);
  return CLOTH_OK;
}

static void free_tables(cloth_flat_tables *t)
{
  for (int c = 0; c < t->count && t->sheet; c++) cloth_sheet_free(&t->sheet[c]);
  free(t->sheet), free(t->tile_first), free(t->tile_list), free(t->source), free(t->square);
  free(t->height), free(t->place), free(t->level), free(t->rest);
}

// the tables over all nodes
static cloth_status upload_nodes(cloth_sim *sim, cloth_part *p, const cloth_flat_tables *t,
                                 cloth_error *err)
{
  size_t nodes = (size_t)sim->flat.nodes, n = sizeof(int);
  size_t triangles = (size_t)sim->triangle_count;
  CLOTH_TRY(cloth_upload(sim, p, "flat_source", t->source, n * 4 * nodes, &p->flat_source, err));
  CLOTH_TRY(cloth_upload(sim, p, "flat_extent", t->square, n * 3 * nodes, &p->flat_extent, err));
  CLOTH_TRY(cloth_upload_real(sim, p, "flat_height", t->height, (int)nodes, &p->flat_height, err));
  CLOTH_TRY(cloth_upload(sim, p, "flat_place", t->place, n * 5 * triangles, &p->flat_place, err));
  CLOTH_TRY(cloth_upload(sim, p, "flat_level", t->level,
                         n * 2 * CLOTH_FLAT_LEVELS * (size_t)t->count, &p->flat_level, err));
  CLOTH_TRY(cloth_take(sim, p, "flat_range", sizeof(cloth_real) * CLOTH_FLAT_RANGE * nodes,
                       &p->flat_range, err));
  return cloth_take(sim, p, "flat", nodes, &p->flat, err);
}

static cloth_status upload_list(cloth_sim *sim, cloth_part *p, int **list, int n, cloth_error *err)
{
  const int *host = *list;
  return host == NULL ? CLOTH_OK
                      : cloth_upload(sim, p, "flat_part", host, sizeof(int) * (size_t)n, list, err);
}

// the tables over what the part judges
static cloth_status upload_share(cloth_sim *sim, cloth_part *p, const cloth_flat_lists *l,
                                 cloth_error *err)
{
  cloth_flat_part *s = &p->flat_part;
  *s = l->share; // lists of the host, which those of the device replace
  int tiles = s->nodes[0];
  CLOTH_TRY(upload_list(sim, p, &s->triangle, s->triangles, err));
  for (int k = 0; k < CLOTH_FLAT_LEVELS; k++)
    CLOTH_TRY(upload_list(sim, p, &s->node[k], s->nodes[k], err));
  CLOTH_TRY(upload_list(sim, p, &s->square, s->squares, err));
  CLOTH_TRY(cloth_upload(sim, p, "flat_first", l->tile_first, sizeof(int) * ((size_t)tiles + 1),
                         &p->flat_first, err));
  CLOTH_TRY(cloth_upload(sim, p, "flat_list", l->tile_list,
                         sizeof(int) * (size_t)l->tile_first[tiles], &p->flat_list, err));
  CLOTH_TRY(cloth_upload_real(sim, p, "flat_rest", l->rest, 4 * s->triangles, &p->flat_rest, err));
  return cloth_take(sim, p, "flat_gradient",
                    sizeof(cloth_real) * CLOTH_FLAT_RANGE * (size_t)s->triangles, &p->flat_gradient,
                    err);
}

static cloth_status upload(cloth_sim *sim, cloth_part *p, const cloth_flat_tables *t,
                           cloth_error *err)
{
  CLOTH_TRY(upload_nodes(sim, p, t, err));
  const cloth_flat *f = &sim->flat;
  if (sim->part_count == 1) {
    cloth_flat_lists all = {.share = {.triangles = sim->triangle_count, .squares = f->nodes},
                            .tile_first = t->tile_first,
                            .tile_list = t->tile_list,
                            .rest = t->rest};
    for (int l = 0; l < CLOTH_FLAT_LEVELS; l++)
      all.share.nodes[l] = f->level_first[l + 1] - f->level_first[l];
    return upload_share(sim, p, &all, err);
  }
  cloth_flat_lists own;
  cloth_status status = cloth_flat_part_make(sim, p, t, &own, err);
  if (status == CLOTH_OK) status = upload_share(sim, p, &own, err);
  cloth_flat_part_free(&own);
  return status;
}

cloth_status cloth_flat_build(cloth_sim *sim, cloth_error *err)
{
  cloth_flat_tables t = {.count = sim->def->cloth_count};
  cloth_status status = CLOTH_OK;
  cloth_flat *f = &sim->flat;
  *f = (cloth_flat){.margin = FLAT_SEARCH_MARGIN};
  if (!sim->active[CLOTH_EFFECT_self_contact] || !sim->params.flat_culling ||
      cloth_is_mass_spring(sim))
    return CLOTH_OK;
  t.sheet = calloc((size_t)t.count + 1, sizeof *t.sheet);
  if (t.sheet == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "flat patches");
  for (int c = 0; c < t.count; c++) {
    cloth_sheet *s = &t.sheet[c];
    CLOTH_TRY_GOTO(cloth_sheet_make(sim, c, s, err), status, done);
  }
  number_nodes(sim, &t);
  if (f->nodes == 0) goto done;
  CLOTH_TRY_GOTO(take_tables(sim, &t, err), status, done);
  fill_levels(sim, &t);
  fill_triangles(sim, &t);
  sim->owner = CLOTH_EFFECT_self_contact;
  for (int p = 0; p < sim->part_count; p++)
    CLOTH_TRY_GOTO(upload(sim, &sim->part[p], &t, err), status, done);
done:
  sim->owner = CLOTH_CORE;
  free_tables(&t);
  return status;
}

// ---- each search and check ---------------------------------------------------------------------

static cloth_status find_ranges(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  const cloth_flat_part *s = &p->flat_part;
  cloth_flat_triangle_args g = {s->triangle, p->triangle, p->flat_rest,    p->x_t0,
                                p->x,        p->x_pred,   p->flat_gradient};
  CLOTH_LAUNCH(sim, p, flat_triangle, s->triangles, &g, err);
  cloth_flat_tile_args t = {s->node[0], p->flat_first, p->flat_list, p->flat_gradient,
                            p->flat_range};
  CLOTH_LAUNCH(sim, p, flat_tile, s->nodes[0], &t, err);
  for (int l = 1; l < CLOTH_FLAT_LEVELS; l++) {
    cloth_flat_merge_args m = {s->node[l], sim->flat.level_first[l], p->flat_source, p->flat_range};
    CLOTH_LAUNCH(sim, p, flat_merge, s->nodes[l], &m, err);
  }
  return CLOTH_OK;
}

static cloth_status judge(cloth_sim *sim, cloth_part *p, double margin, uint32_t *lost,
                          cloth_error *err)
{
  CLOTH_TRY(find_ranges(sim, p, err));
  cloth_flat_square_args s = {.node = p->flat_part.square,
                              .square = p->flat_extent,
                              .height = p->flat_height,
                              .range = p->flat_range,
                              .thickness = (cloth_real)sim->params.thickness,
                              .margin = (cloth_real)margin,
                              .check = lost != NULL,
                              .flat = p->flat,
                              .lost = lost};
  return cloth_launch(sim, p, CLOTH_KERNEL_flat_square, p->flat_part.squares, &s, err);
}

cloth_status cloth_flat_note(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  return sim->flat.nodes > 0 ? judge(sim, part, sim->flat.margin, NULL, err) : CLOTH_OK;
}

void cloth_flat_expect(cloth_sim *sim, bool lost)
{
  double margin = sim->flat.margin * (lost ? 2 : FLAT_SEARCH_MARGIN_FALL);
  sim->flat.margin = fmin(fmax(margin, FLAT_SEARCH_MARGIN), FLAT_SEARCH_MARGIN_MOST);
}

cloth_status cloth_flat_check(cloth_sim *sim, cloth_part *part, uint32_t *lost, cloth_error *err)
{
  return sim->flat.nodes > 0 ? judge(sim, part, FLAT_CHECK_MARGIN, lost, err) : CLOTH_OK;
}

cloth_flat_map cloth_flat_map_of(const cloth_sim *sim, const cloth_part *part)
{
  cloth_flat_map m = {part->flat_place, part->flat_level, sim->flat.nodes > 0 ? part->flat : NULL};
  return m;
}
