// Tiles of one cloth that is flat at rest, and what lies in them. Host only, in double, once at
// load.
#include "contact/flat_sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
  return off <= CLOTH_SHEET_TOLERANCE * s->mean_edge;
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

// how often boxes over tiles are listed: once in each tile that they meet. place [n x 4]
static double count_listed(const int *place, int n)
{
  double listed = 0;
  for (const int *p = place; p < place + 4 * n; p += 4)
    listed += (p[2] - p[0] + 1.0) * (p[3] - p[1] + 1.0);
  return listed;
}

static void list_in_tiles(const cloth_sheet *s, const int *place, int n, int *first, int *list)
{
  int tiles = s->size[0] * s->size[1];
  memset(first, 0, sizeof(int) * ((size_t)tiles + 2));
  for (int pass = 0; pass < 2; pass++) { // count, then fill: first[k + 1] walks through tile k
    for (int i = 0; i < n; i++) {
      const int *p = place + 4 * i;
      for (int y = p[1]; y <= p[3]; y++)
        for (int x = p[0]; x <= p[2]; x++) {
          int tile = x + s->size[0] * y;
          if (pass == 0)
            first[tile + 2]++;
          else
            list[first[tile + 1]++] = i;
        }
    }
    for (int i = 0; pass == 0 && i <= tiles; i++) first[i + 1] += first[i];
  }
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

static cloth_status list_borders_in_tiles(cloth_sheet *s, cloth_error *err)
{
  int n = s->border_count, *place = malloc(sizeof(int) * 4 * ((size_t)n + 1));
  for (int i = 0; place != NULL && i < 4 * n; i++) { // least x y, largest x y
    const double *edge = s->border + 4 * (i / 4);
    int k = i % 2;
    double u = i % 4 < 2 ? fmin(edge[k], edge[2 + k]) : fmax(edge[k], edge[2 + k]);
    place[i] = tile_of(u, s->size[k]);
  }
  s->border_first = malloc(sizeof(int) * ((size_t)s->size[0] * (size_t)s->size[1] + 2));
  if (place != NULL) s->border_list = malloc(sizeof(int) * ((size_t)count_listed(place, n) + 1));
  bool there = s->border_first && s->border_list;
  if (there) list_in_tiles(s, place, n, s->border_first, s->border_list);
  free(place);
  if (!there) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "sheet of %d border edges", n);
  return CLOTH_OK;
}

void cloth_sheet_free(cloth_sheet *s)
{
  free(s->corner), free(s->height), free(s->border), free(s->place), free(s->tile_first),
      free(s->tile_list), free(s->border_first), free(s->border_list);
  for (int l = 0; l < CLOTH_FLAT_LEVELS; l++) free(s->node[l]);
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
  double listed = count_listed(s->place, (int)n), tiles = (double)s->size[0] * s->size[1];
  if (tiles > 4 * (double)n + 64 || listed > 16 * (double)n + 64) return CLOTH_OK;
  s->tile_first = malloc(sizeof(int) * ((size_t)tiles + 2));
  s->tile_list = malloc(sizeof(int) * ((size_t)listed + 1));
  if (!s->tile_first || !s->tile_list)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "sheet of %zu triangles", n);
  list_in_tiles(s, s->place, (int)n, s->tile_first, s->tile_list);
  list_border(sim, s);
  CLOTH_TRY(list_borders_in_tiles(s, err));
  CLOTH_TRY(cloth_sheet_pyramid(s, err));
  s->flat = true;
  return CLOTH_OK;
}
