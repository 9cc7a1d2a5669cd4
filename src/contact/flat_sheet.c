// Tiles and squares of one cloth that is flat at rest, and which of the squares are convex regions
// of a single layer, as kernels/physics/flat_patch.h asks. Host only, in double, once at load.
#include "contact/flat_sheet.h"

#include "flat_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// relative to the tile; a mesh in a plane by its file's digits is in a plane
#define FLAT_TOLERANCE 1e-4
// m/m, of a tile; the squares of the first level are to hold two near triangles and little more
#define TILE_EDGES 1.5

static void corner(const cloth_sim *sim, int t, int k, double x[3])
{
  memcpy(x, sim->rest + 3 * sim->triangle[3 * t + k], sizeof(double) * 3);
}

static void area_vector(const cloth_sim *sim, int t, double n[3])
{
  double a[3], b[3], c[3];
  corner(sim, t, 0, a), corner(sim, t, 1, b), corner(sim, t, 2, c);
  for (int k = 0; k < 3; k++) {
    int y = (k + 1) % 3, z = (k + 2) % 3;
    n[k] = (b[y] - a[y]) * (c[z] - a[z]) - (b[z] - a[z]) * (c[y] - a[y]);
  }
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// an orthonormal frame whose third axis is the cloth's mean normal; false: it has none
static bool frame_of(const cloth_sim *sim, const cloth_sheet *s, double axis[3][3])
{
  double sum[3] = {0, 0, 0}, n[3];
  for (int t = s->first; t < s->end; t++) {
    area_vector(sim, t, n);
    for (int k = 0; k < 3; k++) sum[k] += n[k];
  }
  double length = sqrt(dot(sum, sum));
  if (!(length > 0)) return false;
  for (int k = 0; k < 3; k++) axis[2][k] = sum[k] / length;
  int along = fabs(axis[2][0]) < 0.9 ? 0 : 1;
  for (int k = 0; k < 3; k++) axis[0][k] = (k == along) - axis[2][along] * axis[2][k];
  length = sqrt(dot(axis[0], axis[0]));
  for (int k = 0; k < 3; k++) axis[0][k] /= length;
  for (int k = 0; k < 3; k++) {
    int y = (k + 1) % 3, z = (k + 2) % 3;
    axis[1][k] = axis[2][y] * axis[0][z] - axis[2][z] * axis[0][y];
  }
  return true;
}

// corners in the plane and heights of triangles. false: not flat
static bool flatten(const cloth_sim *sim, cloth_sheet *s)
{
  double axis[3][3], o[3], off = 0;
  if (!frame_of(sim, s, axis)) return false;
  corner(sim, s->first, 0, o);
  for (int t = s->first; t < s->end; t++) {
    double *u = s->corner + 6 * (t - s->first), longest_sq = 0;
    for (int k = 0; k < 3; k++) {
      double x[3];
      corner(sim, t, k, x);
      for (int d = 0; d < 3; d++) x[d] -= o[d];
      u[2 * k] = dot(x, axis[0]), u[2 * k + 1] = dot(x, axis[1]);
      off = fmax(off, fabs(dot(x, axis[2])));
    }
    for (int k = 0; k < 3; k++) {
      double e[2] = {u[2 * ((k + 1) % 3)] - u[2 * k], u[2 * ((k + 1) % 3) + 1] - u[2 * k + 1]};
      longest_sq = fmax(longest_sq, e[0] * e[0] + e[1] * e[1]);
    }
    double twice = (u[2] - u[0]) * (u[5] - u[1]) - (u[4] - u[0]) * (u[3] - u[1]);
    if (!(twice > 0)) return false; // lies the other way up
    s->height[t - s->first] = twice / sqrt(longest_sq);
    s->mean_edge += sqrt(twice * 2 / sqrt(3.0)) / (s->end - s->first);
  }
  return off <= FLAT_TOLERANCE * s->mean_edge;
}

static int tile_of(double u, int size) { return u < size ? (int)u : size - 1; }

static void make_tiles(cloth_sheet *s)
{
  double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
  int n = s->end - s->first;
  for (int i = 0; i < 6 * n; i++) {
    lo[i % 2] = fmin(lo[i % 2], s->corner[i]);
    hi[i % 2] = fmax(hi[i % 2], s->corner[i]);
  }
  s->tile = TILE_EDGES * s->mean_edge;
  for (int i = 0; i < 6 * n; i++) s->corner[i] = (s->corner[i] - lo[i % 2]) / s->tile;
  for (int k = 0; k < 2; k++) s->size[k] = (int)fmin((hi[k] - lo[k]) / s->tile, 1 << 20) + 1;
  for (int t = 0; t < n; t++)
    for (int k = 0; k < 2; k++) {
      const double *u = s->corner + 6 * t + k;
      s->place[4 * t + k] = tile_of(fmin(u[0], fmin(u[2], u[4])), s->size[k]);
      s->place[4 * t + 2 + k] = tile_of(fmax(u[0], fmax(u[2], u[4])), s->size[k]);
    }
}

// how often a triangle is listed: once in each tile that its box meets
static double count_listed(const cloth_sheet *s)
{
  double n = 0;
  for (int t = 0; t < s->end - s->first; t++) {
    const int *p = s->place + 4 * t;
    n += (p[2] - p[0] + 1.0) * (p[3] - p[1] + 1.0);
  }
  return n;
}

static void list_tiles(cloth_sheet *s)
{
  int tiles = s->size[0] * s->size[1];
  memset(s->tile_first, 0, sizeof(int) * ((size_t)tiles + 2));
  for (int pass = 0; pass < 2; pass++) { // count, then fill: tile_first[k + 1] walks through tile k
    for (int t = 0; t < s->end - s->first; t++) {
      const int *p = s->place + 4 * t;
      for (int y = p[1]; y <= p[3]; y++)
        for (int x = p[0]; x <= p[2]; x++) {
          int tile = x + s->size[0] * y;
          if (pass == 0)
            s->tile_first[tile + 2]++;
          else
            s->tile_list[s->tile_first[tile + 1]++] = t;
        }
    }
    for (int i = 0; pass == 0 && i <= tiles; i++) s->tile_first[i + 1] += s->tile_first[i];
  }
}

// ---- squares ------------------------------------------------------------------------------------

// the triangles that reach into a square, tile by tile
typedef struct square {
  int lo[2], hi[2]; // tiles, hi not included
} square;

// twice the area of (a, b, p): positive where p is on the left of a b
static double side(const double *a, const double *b, const double *p)
{
  return (b[0] - a[0]) * (p[1] - a[1]) - (p[0] - a[0]) * (b[1] - a[1]);
}

// calls `ok` once for each triangle that reaches into the square; false as soon as one says no
static bool all_of(const cloth_sheet *s, const square *q,
                   bool (*ok)(const cloth_sheet *s, int t, void *data), void *data)
{
  for (int y = q->lo[1]; y < q->hi[1] && y < s->size[1]; y++)
    for (int x = q->lo[0]; x < q->hi[0] && x < s->size[0]; x++) {
      int tile = x + s->size[0] * y;
      for (int n = s->tile_first[tile]; n < s->tile_first[tile + 1]; n++) {
        const int *p = s->place + 4 * s->tile_list[n]; // its first tile in the square answers
        bool first = (x == p[0] || (x == q->lo[0] && p[0] < x)) &&
                     (y == p[1] || (y == q->lo[1] && p[1] < y));
        if (first && !ok(s, s->tile_list[n], data)) return false;
      }
    }
  return true;
}

static bool on_left(const cloth_sheet *s, int t, void *data)
{
  const double *edge = data, *u = s->corner + 6 * t;
  for (int k = 0; k < 3; k++)
    if (!(side(edge, edge + 2, u + 2 * k) >= -FLAT_TOLERANCE)) return false;
  return true;
}

typedef struct witness {
  const square *in;
  double point[2];
  int found;
} witness;

// the centre of some triangle, if it is inside the square
static bool look_for_point(const cloth_sheet *s, int t, void *data)
{
  witness *w = data;
  const double *u = s->corner + 6 * t;
  for (int k = 0; k < 2; k++) {
    w->point[k] = (u[k] + u[2 + k] + u[4 + k]) / 3;
    if (!(w->point[k] > w->in->lo[k] && w->point[k] < w->in->hi[k])) return true;
  }
  w->found = 1;
  return false; // enough
}

static bool count_layer(const cloth_sheet *s, int t, void *data)
{
  witness *w = data;
  const double *u = s->corner + 6 * t;
  for (int k = 0; k < 3; k++)
    if (!(side(u + 2 * k, u + 2 * ((k + 1) % 3), w->point) >= 0)) return true;
  return ++w->found <= 1;
}

// Is the cloth in the square one layer over a convex region? No border of it may cut a line between
// two of its points: borders in the square have all of it on their left. Then a line that starts on
// the cloth stays on it, every point is under equally many layers, and one point tells how many.
static bool is_convex_layer(const cloth_sheet *s, const square *q)
{
  for (int b = 0; b < s->border_count; b++) {
    double *edge = s->border + 4 * b;
    bool out = false;
    for (int k = 0; k < 2; k++)
      out |= !(fmin(edge[k], edge[2 + k]) < q->hi[k] && fmax(edge[k], edge[2 + k]) > q->lo[k]);
    if (!out && !all_of(s, q, on_left, edge)) return false;
  }
  witness w = {.in = q};
  all_of(s, q, look_for_point, &w);
  if (!w.found) return false;
  w.found = 0;
  return all_of(s, q, count_layer, &w);
}

static bool lower(const cloth_sheet *s, int t, void *data)
{
  double *height = data;
  *height = fmin(*height, s->height[t]);
  return true;
}

double cloth_sheet_square_height(const cloth_sheet *s, int level, int x, int y)
{
  square q = {{x << level, y << level},
              {(x + CLOTH_FLAT_SPAN) << level, (y + CLOTH_FLAT_SPAN) << level}};
  double height = HUGE_VAL;
  if (!is_convex_layer(s, &q)) return 0;
  all_of(s, &q, lower, &height);
  return height;
}

// ---- life ---------------------------------------------------------------------------------------

static void list_border(const cloth_sim *sim, cloth_sheet *s)
{
  for (int t = s->first; t < s->end; t++)
    for (int k = 0; k < 3; k++) {
      int e = sim->triangle_edge[3 * t + k];
      if (sim->edge_side[2 * e + 1] >= 0) continue;
      const double *u = s->corner + 6 * (t - s->first);
      double *to = s->border + 4 * s->border_count++;
      memcpy(to, u + 2 * k, sizeof(double) * 2);
      memcpy(to + 2, u + 2 * ((k + 1) % 3), sizeof(double) * 2);
    }
}

void cloth_sheet_free(cloth_sheet *s)
{
  free(s->corner), free(s->height), free(s->border), free(s->place), free(s->tile_first),
      free(s->tile_list);
}

cloth_status cloth_sheet_make(const cloth_sim *sim, int cloth, cloth_sheet *s, cloth_error *err)
{
  *s = (cloth_sheet){.first = sim->triangle_first[cloth], .end = sim->triangle_first[cloth + 1]};
  size_t n = (size_t)(s->end - s->first);
  s->corner = malloc(sizeof(double) * 6 * (n + 1)), s->height = malloc(sizeof(double) * (n + 1));
  s->border = malloc(sizeof(double) * 12 * (n + 1));
  s->place = malloc(sizeof(int) * 4 * (n + 1));
  if (!s->corner || !s->height || !s->border || !s->place)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "sheet of %zu triangles", n);
  if (n == 0 || !flatten(sim, s)) return CLOTH_OK;
  make_tiles(s);
  // a slanted strip, scraps far from each other, triangles of very different size
  double listed = count_listed(s), tiles = (double)s->size[0] * s->size[1];
  if (tiles > 4 * (double)n + 64 || listed > 16 * (double)n + 64) return CLOTH_OK;
  s->tile_first = malloc(sizeof(int) * ((size_t)tiles + 2));
  s->tile_list = malloc(sizeof(int) * ((size_t)listed + 1));
  if (!s->tile_first || !s->tile_list)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "sheet of %zu triangles", n);
  list_tiles(s);
  list_border(sim, s);
  s->flat = true;
  return CLOTH_OK;
}
