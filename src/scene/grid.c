// Procedural sheets.
#include "scene/mesh.h"

#include <stdint.h>
#include <string.h>

// vertices move by at most this share of the spacing; 0.15 keeps the smallest angle above 20
// degrees
static const double JITTER = 0.15;

static cloth_status check_grid(const double size[2], const int resolution[2], cloth_error *err)
{
  for (int i = 0; i < 2; i++)
    if (!(size[i] >= 1e-6 && size[i] <= 1e4))
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "size = (%g, %g) [m]: the %s is not in [1e-06, 10000]",
                 size[0], size[1], i ? "height" : "width");
  for (int i = 0; i < 2; i++)
    if (resolution[i] < 2 || resolution[i] > 10000)
      CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                 "resolution = (%d, %d) [vertices]: the number along the %s is not in [2, 10000]",
                 resolution[0], resolution[1], i ? "height" : "width");
  if ((double)resolution[0] * resolution[1] > 2.5e7)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "resolution = (%d, %d): more than 25 million vertices",
               resolution[0], resolution[1]);
  return CLOTH_OK;
}

static void put_triangle(cloth_mesh *m, int *count, int a, int b, int c)
{
  int *t = m->triangle + 3 * (size_t)*count;
  t[0] = a, t[1] = b, t[2] = c;
  ++*count;
}

static void copy_material(cloth_mesh *m)
{
  for (size_t i = 0; i < 3 * (size_t)m->triangle_count; i++)
    memcpy(m->material + 2 * i, m->position + 3 * (size_t)m->triangle[i], 2 * sizeof(double));
}

// exact at both ends and, on a symmetric range, symmetric: a fold must meet the other half
static double between(double length, int i, int last)
{
  return length * ((double)(2 * i - last) / (2.0 * last));
}

static cloth_status regular(const double size[2], const int resolution[2],
                            cloth_grid_pattern pattern, cloth_mesh *out, cloth_error *err)
{
  int nx = resolution[0], ny = resolution[1], n = 0;
  CLOTH_TRY(cloth_mesh_new(nx * ny, 2 * (nx - 1) * (ny - 1), true, out, err));
  for (int row = 0; row < ny; row++)
    for (int col = 0; col < nx; col++) {
      double *x = out->position + 3 * ((size_t)row * (size_t)nx + (size_t)col);
      x[0] = between(size[0], col, nx - 1);
      x[1] = between(size[1], row, ny - 1);
    }
  for (int row = 0; row + 1 < ny; row++)
    for (int col = 0; col + 1 < nx; col++) {
      int a = row * nx + col, b = a + 1, c = a + nx + 1, d = a + nx;
      bool right = pattern == CLOTH_GRID_RIGHT ||
                   (pattern == CLOTH_GRID_ALTERNATING && (row + col) % 2 == 0);
      if (right) {
        put_triangle(out, &n, a, b, c);
        put_triangle(out, &n, a, c, d);
      } else {
        put_triangle(out, &n, a, b, d);
        put_triangle(out, &n, b, c, d);
      }
    }
  copy_material(out);
  return CLOTH_OK;
}

// in [-1, 1), the same on every machine (splitmix64's finaliser, Steele et al. 2014)
static double noise(uint64_t i)
{
  i += 0x9e3779b97f4a7c15u;
  i = (i ^ (i >> 30)) * 0xbf58476d1ce4e5b9u;
  i = (i ^ (i >> 27)) * 0x94d049bb133111ebu;
  i ^= i >> 31;
  return (double)(int64_t)i / 9223372036854775808.0;
}

// first vertex of a row: odd rows have nx + 1 vertices
static int row_start(int nx, int row) { return row * nx + row / 2; }

static void place_row(cloth_mesh *m, const double size[2], const int resolution[2], int row)
{
  int nx = resolution[0], ny = resolution[1], odd = row % 2, count = nx + odd;
  double dx = size[0] / (nx - 1), dy = size[1] / (ny - 1);
  for (int i = 0; i < count; i++) {
    int v = row_start(nx, row) + i;
    double *x = m->position + 3 * (size_t)v;
    bool side = i == 0 || i == count - 1;
    if (!odd || side)
      x[0] = between(size[0], i < nx ? i : nx - 1, nx - 1);
    else
      x[0] = between(size[0], 2 * i - 1, 2 * (nx - 1));
    x[1] = between(size[1], row, ny - 1);
    // a vertex of the border stays on it; next to a half triangle at the side nothing moves along
    bool end = row == 0 || row == ny - 1;
    if (!side && !(odd && (i == 1 || i == count - 2))) x[0] += JITTER * dx * noise(2 * (uint64_t)v);
    if (!end && !side) x[1] += JITTER * dy * noise(2 * (uint64_t)v + 1);
  }
}

static cloth_status unstructured(const double size[2], const int resolution[2], cloth_mesh *out,
                                 cloth_error *err)
{
  int nx = resolution[0], ny = resolution[1], n = 0;
  CLOTH_TRY(cloth_mesh_new(row_start(nx, ny), (2 * nx - 1) * (ny - 1), true, out, err));
  for (int row = 0; row < ny; row++) place_row(out, size, resolution, row);
  for (int row = 0; row + 1 < ny; row++) {
    int below = row_start(nx, row), above = row_start(nx, row + 1);
    // between the row with nx vertices and the one with nx + 1
    for (int i = 0; i < nx; i++) {
      if (row % 2 == 0) {
        put_triangle(out, &n, below + i, above + i + 1, above + i);
        if (i + 1 < nx) put_triangle(out, &n, below + i, below + i + 1, above + i + 1);
      } else {
        put_triangle(out, &n, below + i, below + i + 1, above + i);
        if (i + 1 < nx) put_triangle(out, &n, above + i, below + i + 1, above + i + 1);
      }
    }
  }
  copy_material(out);
  return CLOTH_OK;
}

cloth_status cloth_mesh_grid(const double size[2], const int resolution[2],
                             cloth_grid_pattern pattern, cloth_mesh *out, cloth_error *err)
{
  *out = (cloth_mesh){0};
  CLOTH_TRY(check_grid(size, resolution, err));
  if (pattern == CLOTH_GRID_UNSTRUCTURED) return unstructured(size, resolution, out, err);
  return regular(size, resolution, pattern, out, err);
}
