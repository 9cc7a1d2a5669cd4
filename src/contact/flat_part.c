#include "contact/flat_part.h"

#include <stdlib.h>
#include <string.h>

enum { TOUCHED = 1, JUDGED = 2, RANGED = 4 }; // of a node: own triangles, square, range

// the nodes of one sheet on one level
typedef struct grid {
  int first, nx, ny;
  unsigned char *of; // [nx x ny]
} grid;

static bool grid_of(const cloth_flat_tables *t, int sheet, int level, unsigned char *mark, grid *g)
{
  const int *row = t->level + 2 * (CLOTH_FLAT_LEVELS * sheet + level);
  if (!t->sheet[sheet].flat || level >= CLOTH_FLAT_LEVELS || row[0] < 0) return false;
  *g = (grid){row[0], row[1], cloth_sheet_level_size(&t->sheet[sheet], level, 1), mark + row[0]};
  return true;
}

static bool is_own(const cloth_sim *sim, const cloth_part *p, int t)
{
  for (int k = 0; k < 3; k++)
    if (sim->triangle[3 * t + k] >= p->v0 && sim->triangle[3 * t + k] < p->v1) return true;
  return false;
}

// tiles of own triangles, and what holds them on the levels above
static void touch(const cloth_sim *sim, const cloth_part *p, const cloth_flat_tables *t, int sheet,
                  unsigned char *mark)
{
  grid g, up;
  const cloth_sheet *s = &t->sheet[sheet];
  if (!grid_of(t, sheet, 0, mark, &g)) return;
  for (int i = s->first; i < s->end; i++) {
    const int *place = t->place + 5 * i;
    for (int y = place[2]; is_own(sim, p, i) && y <= place[4]; y++)
      for (int x = place[1]; x <= place[3]; x++) g.of[y * g.nx + x] |= TOUCHED;
  }
  for (int l = 1; grid_of(t, sheet, l, mark, &up); l++, g = up)
    for (int i = 0; i < g.nx * g.ny; i++)
      if (g.of[i] & TOUCHED) up.of[i / g.nx / 2 * up.nx + i % g.nx / 2] |= TOUCHED;
}

// squares that hold a touched node, and the nodes that they are made of
static void judge(const cloth_flat_tables *t, const grid *g)
{
  const int n = CLOTH_FLAT_SPAN;
  for (int y = 0; y < g->ny; y++)
    for (int x = 0; x < g->nx; x++) {
      int node = y * g->nx + x;
      bool holds = false;
      for (int k = 0; k < n * n; k++)
        holds |= x + k % n < g->nx && y + k / n < g->ny &&
                 (g->of[node + k / n * g->nx + k % n] & TOUCHED);
      if (!holds || !(t->height[g->first + node] > 0)) continue;
      g->of[node] |= JUDGED;
      for (int k = 0; k < n * n; k++)
        if (x + k % n < g->nx && y + k / n < g->ny) g->of[node + k / n * g->nx + k % n] |= RANGED;
    }
}

static void mark_nodes(const cloth_sim *sim, const cloth_part *p, const cloth_flat_tables *t,
                       int sheet, unsigned char *mark)
{
  grid g, below;
  touch(sim, p, t, sheet, mark);
  for (int l = CLOTH_FLAT_LEVELS - 1; l >= 0; l--) {
    if (!grid_of(t, sheet, l, mark, &g)) continue;
    judge(t, &g);
    if (l == 0) continue;
    grid_of(t, sheet, l - 1, mark, &below);
    for (int i = 0; i < below.nx * below.ny; i++)
      if (g.of[i / below.nx / 2 * g.nx + i % below.nx / 2] & RANGED) below.of[i] |= RANGED;
  }
}

// nodes of [begin, end) with a mark, in order. *list NULL: no memory
static int list_marked(const unsigned char *mark, int begin, int end, int bit, int **list)
{
  int n = 0;
  *list = malloc(sizeof(int) * ((size_t)(end - begin) + 1));
  for (int i = begin; *list != NULL && i < end; i++)
    if (mark[i] & bit) (*list)[n++] = i;
  return n;
}

// the tiles' lists over a numbering of the triangles that they name
static cloth_status list_triangles(const cloth_sim *sim, const cloth_flat_tables *t,
                                   cloth_flat_lists *out, cloth_error *err)
{
  cloth_flat_part *s = &out->share;
  size_t listed = 0, all = (size_t)sim->triangle_count;
  for (int i = 0; i < s->nodes[0]; i++)
    listed += (size_t)(t->tile_first[s->node[0][i] + 1] - t->tile_first[s->node[0][i]]);
  int *number = calloc(all + 1, sizeof *number);
  s->triangle = malloc(sizeof(int) * (all + 1));
  out->tile_first = malloc(sizeof(int) * ((size_t)s->nodes[0] + 1));
  out->tile_list = malloc(sizeof(int) * (listed + 1));
  if (!number || !s->triangle || !out->tile_first || !out->tile_list) {
    free(number);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "flat patches of a part");
  }
  listed = 0;
  for (int i = 0; i < s->nodes[0]; i++) {
    out->tile_first[i] = (int)listed;
    for (int k = t->tile_first[s->node[0][i]]; k < t->tile_first[s->node[0][i] + 1]; k++)
      out->tile_list[listed++] = t->tile_list[k], number[t->tile_list[k]] = 1;
  }
  out->tile_first[s->nodes[0]] = (int)listed;
  for (int i = 0; i < sim->triangle_count; i++)
    if (number[i]) number[i] = s->triangles, s->triangle[s->triangles++] = i;
  for (size_t k = 0; k < listed; k++) out->tile_list[k] = number[out->tile_list[k]];
  free(number);
  return CLOTH_OK;
}

static cloth_status list_all(const cloth_sim *sim, const cloth_flat_tables *t, unsigned char *mark,
                             cloth_flat_lists *out, cloth_error *err)
{
  const cloth_flat *f = &sim->flat;
  cloth_flat_part *s = &out->share;
  for (int l = 0; l < CLOTH_FLAT_LEVELS; l++) {
    s->nodes[l] = list_marked(mark, f->level_first[l], f->level_first[l + 1], RANGED, &s->node[l]);
    if (s->node[l] == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "flat patches of a part");
  }
  s->squares = list_marked(mark, 0, f->nodes, JUDGED, &s->square);
  if (s->square == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "flat patches of a part");
  CLOTH_TRY(list_triangles(sim, t, out, err));
  out->rest = malloc(sizeof(double) * 4 * ((size_t)s->triangles + 1));
  if (out->rest == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "flat patches of a part");
  for (int i = 0; i < s->triangles; i++)
    memcpy(out->rest + 4 * i, t->rest + 4 * s->triangle[i], sizeof(double) * 4);
  return CLOTH_OK;
}

cloth_status cloth_flat_part_make(const cloth_sim *sim, const cloth_part *part,
                                  const cloth_flat_tables *t, cloth_flat_lists *out,
                                  cloth_error *err)
{
  *out = (cloth_flat_lists){.share = {.triangles = 0}};
  unsigned char *mark = calloc((size_t)sim->flat.nodes + 1, 1);
  if (mark == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "flat patches of a part");
  for (int c = 0; c < t->count; c++) mark_nodes(sim, part, t, c, mark);
  cloth_status status = list_all(sim, t, mark, out, err);
  free(mark);
  return status;
}

void cloth_flat_part_free(cloth_flat_lists *lists)
{
  for (int l = 0; l < CLOTH_FLAT_LEVELS; l++) free(lists->share.node[l]);
  free(lists->share.square), free(lists->share.triangle);
  free(lists->tile_first), free(lists->tile_list), free(lists->rest);
}
