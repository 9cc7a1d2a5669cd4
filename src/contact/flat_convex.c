// Which squares of a sheet are convex regions of a single layer, as kernels/physics/flat_patch.h
// asks. A pyramid over the tiles says what lies in squares of 2^level tiles, so that a square is
// judged without walking through all that it holds.
#include "contact/flat_sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- the pyramid --------------------------------------------------------------------------------

static const cloth_sheet_node nothing = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}, HUGE_VAL, 0};

static void join(cloth_sheet_node *to, const cloth_sheet_node *other)
{
  for (int k = 0; k < 2; k++) {
    to->lo[k] = fmin(to->lo[k], other->lo[k]);
    to->hi[k] = fmax(to->hi[k], other->hi[k]);
  }
  to->height = fmin(to->height, other->height);
  to->borders += other->borders;
}

static cloth_sheet_node node_of_tile(const cloth_sheet *s, int tile)
{
  cloth_sheet_node node = nothing;
  for (int n = s->tile_first[tile]; n < s->tile_first[tile + 1]; n++) {
    int t = s->tile_list[n];
    for (int i = 0; i < 6; i++) {
      double u = s->corner[6 * t + i];
      node.lo[i % 2] = fmin(node.lo[i % 2], u), node.hi[i % 2] = fmax(node.hi[i % 2], u);
    }
    node.height = fmin(node.height, s->height[t]);
  }
  node.borders = s->border_first[tile + 1] - s->border_first[tile];
  return node;
}

cloth_status cloth_sheet_pyramid(cloth_sheet *s, cloth_error *err)
{
  for (int l = 0; l < CLOTH_FLAT_LEVELS; l++) {
    int nx = cloth_sheet_level_size(s, l, 0), ny = cloth_sheet_level_size(s, l, 1);
    s->node[l] = malloc(sizeof *s->node[l] * (size_t)nx * (size_t)ny);
    if (s->node[l] == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "sheet of %d x %d tiles", nx, ny);
    for (int i = 0; i < nx * ny; i++) s->node[l][i] = l > 0 ? nothing : node_of_tile(s, i);
    int mx = l > 0 ? cloth_sheet_level_size(s, l - 1, 0) : 0;
    int my = l > 0 ? cloth_sheet_level_size(s, l - 1, 1) : 0;
    for (int i = 0; i < mx * my; i++)
      join(&s->node[l][i / mx / 2 * nx + i % mx / 2], &s->node[l - 1][i]);
  }
  return CLOTH_OK;
}

// NULL where the sheet has no such node
static const cloth_sheet_node *node_at(const cloth_sheet *s, int level, int x, int y)
{
  int nx = cloth_sheet_level_size(s, level, 0), ny = cloth_sheet_level_size(s, level, 1);
  return x < nx && y < ny ? &s->node[level][y * nx + x] : NULL;
}

// ---- squares ------------------------------------------------------------------------------------

/// CLOTH_FLAT_SPAN nodes of a level each way.
typedef struct square {
  int level, x, y;
  int lo[2], hi[2]; // tiles, hi not included
} square;

// calls `ok` with the nodes of a square; false as soon as one says no
static bool all_of(const cloth_sheet *s, const square *q, const void *data,
                   bool (*ok)(const cloth_sheet *s, int level, int x, int y, const void *data))
{
  for (int k = 0; k < CLOTH_FLAT_SPAN * CLOTH_FLAT_SPAN; k++) {
    int x = q->x + k % CLOTH_FLAT_SPAN, y = q->y + k / CLOTH_FLAT_SPAN;
    if (node_at(s, q->level, x, y) && !ok(s, q->level, x, y, data)) return false;
  }
  return true;
}

// the same of the four nodes below one
static bool all_below(const cloth_sheet *s, int level, int x, int y, const void *data,
                      bool (*ok)(const cloth_sheet *s, int level, int x, int y, const void *data))
{
  for (int k = 0; k < 4; k++) {
    int i = 2 * x + k % 2, j = 2 * y + k / 2;
    if (node_at(s, level - 1, i, j) && !ok(s, level - 1, i, j, data)) return false;
  }
  return true;
}

// twice the area of (a, b, p): positive where p is on the left of a b
static double side(const double *a, const double *b, const double *p)
{
  return (b[0] - a[0]) * (p[1] - a[1]) - (p[0] - a[0]) * (b[1] - a[1]);
}

// Are all corners of a node on the left of an edge? So they are if those of its box are; rounding
// is monotone.
static bool is_left(const cloth_sheet *s, int level, int x, int y, const void *data)
{
  const double *edge = data;
  const cloth_sheet_node *n = node_at(s, level, x, y);
  double worst[2] = {edge[3] > edge[1] ? n->hi[0] : n->lo[0],
                     edge[2] > edge[0] ? n->lo[1] : n->hi[1]};
  if (n->lo[0] > n->hi[0] || side(edge, edge + 2, worst) >= -CLOTH_SHEET_TOLERANCE) return true;
  if (level > 0) return all_below(s, level, x, y, data, is_left);
  int tile = x + s->size[0] * y;
  for (int i = s->tile_first[tile]; i < s->tile_first[tile + 1]; i++)
    for (int k = 0; k < 3; k++)
      if (!(side(edge, edge + 2, s->corner + 6 * s->tile_list[i] + 2 * k) >=
            -CLOTH_SHEET_TOLERANCE))
        return false;
  return true;
}

// do the borders in a node that pass through the square have all of the square on their left?
static bool borders_are_convex(const cloth_sheet *s, int level, int x, int y, const void *data)
{
  const square *q = data;
  if (node_at(s, level, x, y)->borders == 0) return true;
  if (level > 0) return all_below(s, level, x, y, data, borders_are_convex);
  int tile = x + s->size[0] * y;
  for (int i = s->border_first[tile]; i < s->border_first[tile + 1]; i++) {
    const double *edge = s->border + 4 * s->border_list[i];
    bool out = false;
    for (int k = 0; k < 2; k++)
      out |= !(fmin(edge[k], edge[2 + k]) < q->hi[k] && fmax(edge[k], edge[2 + k]) > q->lo[k]);
    if (!out && !all_of(s, q, edge, is_left)) return false;
  }
  return true;
}

typedef struct witness {
  const square *in;
  double *point; // [2], written
} witness;

// looks for a triangle whose centre is inside the square; false: there it is
static bool has_no_centre(const cloth_sheet *s, int level, int x, int y, const void *data)
{
  if (level > 0) return all_below(s, level, x, y, data, has_no_centre);
  const witness *w = data;
  int tile = x + s->size[0] * y;
  for (int i = s->tile_first[tile]; i < s->tile_first[tile + 1]; i++) {
    const double *u = s->corner + 6 * s->tile_list[i];
    bool inside = true;
    for (int k = 0; k < 2; k++) {
      w->point[k] = (u[k] + u[2 + k] + u[4 + k]) / 3;
      inside &= w->point[k] > w->in->lo[k] && w->point[k] < w->in->hi[k];
    }
    if (inside) return false;
  }
  return true;
}

// how many triangles lie over a point: all of them are listed in its tile
static int layers_at(const cloth_sheet *s, const double *point)
{
  int tile = (int)point[0] + s->size[0] * (int)point[1], layers = 0;
  for (int i = s->tile_first[tile]; i < s->tile_first[tile + 1]; i++) {
    const double *u = s->corner + 6 * s->tile_list[i];
    bool over = true;
    for (int k = 0; k < 3; k++) over &= side(u + 2 * k, u + 2 * ((k + 1) % 3), point) >= 0;
    layers += over;
  }
  return layers;
}

// Is the cloth in the square one layer over a convex region? No border of it may cut a line between
// two of its points: borders in the square have all of it on their left. Then a line that starts on
// the cloth stays on it, every point is under equally many layers, and one point tells how many.
static bool is_convex_layer(const cloth_sheet *s, const square *q)
{
  double point[2];
  witness w = {q, point};
  return all_of(s, q, q, borders_are_convex) && !all_of(s, q, &w, has_no_centre) &&
         layers_at(s, point) == 1;
}

double cloth_sheet_square_height(const cloth_sheet *s, int level, int x, int y)
{
  square q = {level,
              x,
              y,
              {x << level, y << level},
              {(x + CLOTH_FLAT_SPAN) << level, (y + CLOTH_FLAT_SPAN) << level}};
  if (!is_convex_layer(s, &q)) return 0;
  double height = HUGE_VAL;
  for (int k = 0; k < CLOTH_FLAT_SPAN * CLOTH_FLAT_SPAN; k++) {
    const cloth_sheet_node *n = node_at(s, level, x + k % CLOTH_FLAT_SPAN, y + k / CLOTH_FLAT_SPAN);
    if (n != NULL) height = fmin(height, n->height);
  }
  return height;
}
