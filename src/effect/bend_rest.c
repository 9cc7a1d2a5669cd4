// What bending is measured from: stiffness, angles and weights of hinges and patches at rest.
#include "effect/bend_rest.h"

#include "bend.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void cloth_bend_rest_free(cloth_bend_rest *rest)
{
  if (rest == NULL) return;
  free(rest->vertex), free(rest->cloth), free(rest->stiffness), free(rest->angle),
      free(rest->direction), free(rest->weight), free(rest);
}

static cloth_bend_rest *rest_new(int count, int corners)
{
  size_t n = (size_t)count + 1, sets = corners == 6 ? 3 : 1;
  cloth_bend_rest *r = calloc(1, sizeof *r);
  if (r == NULL) return NULL;
  r->corners = corners;
  r->vertex = malloc(sizeof(int) * n * (size_t)corners);
  r->cloth = malloc(sizeof(int) * n);
  r->stiffness = calloc(n * (corners == 6 ? 6 : 1), sizeof(double));
  r->angle = calloc(n * sets, sizeof(double));
  r->weight = calloc(4 * n, sizeof(double));
  r->direction = calloc(corners == 6 ? 6 * n : 1, sizeof(double));
  if (r->direction && r->vertex && r->cloth && r->stiffness && r->angle && r->weight) return r;
  cloth_bend_rest_free(r);
  return NULL;
}

static void edge(const cloth_sim *sim, int from, int to, double e[3])
{
  for (int k = 0; k < 3; k++) e[k] = sim->rest[3 * to + k] - sim->rest[3 * from + k];
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
  for (int k = 0; k < 3; k++)
    out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double area(const cloth_sim *sim, int a, int b, int c)
{
  double u[3], v[3], n[3];
  edge(sim, a, b, u), edge(sim, a, c, v), cross(u, v, n);
  return sqrt(dot(n, n)) / 2;
}

static double angle(const cloth_sim *sim, const int h[4])
{
  cloth_v3 x[4];
  for (int k = 0; k < 4; k++) {
    double e[3];
    edge(sim, h[0], h[k], e);
    x[k] = cloth_v3_make((cloth_real)e[0], (cloth_real)e[1], (cloth_real)e[2]);
  }
  return (double)cloth_bend_angle(x[0], x[1], x[2], x[3]);
}

// ---- hinges -------------------------------------------------------------------------------------

// rigidity for bending over an edge: the warp is curved by an edge that runs along the weft
double cloth_hinge_rigidity(const cloth_sim *sim, int hinge, const cloth_material *m)
{
  double warp[3], e[3];
  edge(sim, sim->hinge[4 * hinge], sim->hinge[4 * hinge + 1], e);
  cloth_warp_direction(sim, sim->hinge_triangle[hinge], warp);
  double along = dot(e, warp), length_sq = dot(e, e);
  double cos_sq = length_sq > 0 ? along * along / length_sq : 0; // of the angle to the warp
  return m->bend_weft * cos_sq + m->bend_warp * (1 - cos_sq);
}

// d angle / d height: one over the heights of the faces, and what balances them
static void weights(const cloth_sim *sim, const int h[4], double c[4])
{
  double e[3], d[3];
  edge(sim, h[0], h[1], e);
  double length_sq = dot(e, e);
  c[0] = c[1] = 0;
  for (int k = 2; k < 4; k++) {
    edge(sim, h[0], h[k], d);
    c[k] = -sqrt(length_sq) / (2 * area(sim, h[0], h[1], h[k]));
    c[1] -= c[k] * dot(d, e) / length_sq;
  }
  c[0] = -(c[1] + c[2] + c[3]);
}

static cloth_bend_rest *hinges(const cloth_sim *sim)
{
  cloth_bend_rest *r = rest_new(sim->hinge_count, 4);
  for (; r && r->count < sim->hinge_count; r->count++) {
    int i = r->count;
    const int *h = sim->hinge + 4 * i;
    double e[3];
    for (int k = 0; k < 4; k++) r->vertex[4 * i + k] = h[k];
    r->cloth[i] = cloth_of_vertex(sim, h[0]);
    edge(sim, h[0], h[1], e);
    r->stiffness[i] = (double)cloth_bend_stiffness(
        (cloth_real)cloth_hinge_rigidity(sim, i, &sim->def->cloth[r->cloth[i]].material),
        (cloth_real)sqrt(dot(e, e)), (cloth_real)area(sim, h[0], h[1], h[2]),
        (cloth_real)area(sim, h[0], h[1], h[3]));
    r->angle[i] = angle(sim, h);
    weights(sim, h, r->weight + 4 * i);
  }
  return r;
}

// ---- patches ------------------------------------------------------------------------------------

static void triangle_axes(const cloth_sim *sim, int triangle, double warp[3], double weft[3],
                          double *face)
{
  const int *v = sim->triangle + 3 * triangle;
  double up[3], u[3], w[3];
  edge(sim, v[0], v[1], u), edge(sim, v[0], v[2], w), cross(u, w, up);
  double size = sqrt(dot(up, up));
  *face = size / 2;
  cloth_warp_direction(sim, triangle, warp);
  cross(up, warp, weft);
  for (int k = 0; k < 3; k++) weft[k] = size > 0 ? weft[k] / size : 0;
}

// n of the three edges, (warp, weft), so that theta n n' is the curvature that an edge adds
static void edge_normals(const cloth_sim *sim, int triangle, double n[6])
{
  const int *v = sim->triangle + 3 * triangle;
  double warp[3], weft[3], face;
  triangle_axes(sim, triangle, warp, weft, &face);
  for (int i = 0; i < 3; i++) {
    double e[3];
    edge(sim, v[(i + 1) % 3], v[(i + 2) % 3], e);
    // n n' is to be unit normals times length / (2 area); e has the length squared
    double length = sqrt(dot(e, e)), scale = face > 0 ? 1 / sqrt(length * 2 * face) : 0;
    n[2 * i] = dot(e, weft) * scale, n[2 * i + 1] = -dot(e, warp) * scale;
  }
}

void cloth_bend_strain(const double n[2], double out[3])
{
  out[0] = n[0] * n[0], out[1] = n[1] * n[1], out[2] = sqrt(2) * n[0] * n[1];
}

void cloth_bend_corners(const cloth_sim *sim, int triangle, double p[3][2])
{
  const int *v = sim->triangle + 3 * triangle;
  double warp[3], weft[3], e[3], face;
  triangle_axes(sim, triangle, warp, weft, &face);
  for (int i = 0; i < 3; i++) {
    edge(sim, v[0], v[i], e);
    p[i][0] = dot(e, warp), p[i][1] = dot(e, weft);
  }
}

// even [3 x 3]: what the triangle measures of a curvature, evened out
static void patch_stiffness(const cloth_sim *sim, int triangle, const cloth_material *m,
                            const double *n, const double *even, double w[6])
{
  static const int row[6] = {0, 1, 2, 1, 2, 0}, col[6] = {0, 1, 2, 2, 0, 1};
  const double rigidity[3] = {m->bend_warp, m->bend_weft, sqrt(m->bend_warp * m->bend_weft)};
  double warp[3], weft[3], face, strain[3][3] = {{0}};
  triangle_axes(sim, triangle, warp, weft, &face);
  for (int i = 0; i < 3; i++) {
    double raw[3];
    cloth_bend_strain(n + 2 * i, raw);
    for (int k = 0; k < 9; k++) strain[i][k / 3] += even[k] * raw[k % 3];
  }
  for (int k = 0; k < 6; k++) {
    const double *a = strain[row[k]], *b = strain[col[k]];
    w[k] = 0;
    for (int j = 0; j < 3; j++) w[k] += face * rigidity[j] * a[j] * b[j];
  }
}

// the corner across edge i of a triangle, or -1
static int across(const cloth_sim *sim, int triangle, int i)
{
  const int *v = sim->triangle + 3 * triangle;
  int e = sim->triangle_edge[3 * triangle + (i + 1) % 3]; // from corner i + 1 to i + 2
  const int *side = sim->edge_side + 2 * e;
  int other = side[0] == triangle ? side[1] : side[0];
  if (other < 0) return -1;
  for (int k = 0; k < 3; k++) {
    int x = sim->triangle[3 * other + k];
    if (x != v[(i + 1) % 3] && x != v[(i + 2) % 3]) return x;
  }
  return -1;
}

static cloth_bend_rest *patches(const cloth_sim *sim)
{
  cloth_bend_rest *r = rest_new(sim->triangle_count, 6);
  for (; r && r->count < sim->triangle_count; r->count++) {
    int t = r->count, *patch = r->vertex + 6 * t;
    r->cloth[t] = cloth_of_triangle(sim, t);
    for (int i = 0; i < 3; i++) {
      patch[i] = sim->triangle[3 * t + i];
      patch[3 + i] = across(sim, t, i);
    }
    for (int i = 0; i < 3; i++) {
      if (patch[3 + i] < 0) {
        patch[3 + i] = patch[i];
        continue;
      }
      const int h[4] = {patch[(i + 1) % 3], patch[(i + 2) % 3], patch[i], patch[3 + i]};
      r->angle[3 * t + i] = angle(sim, h);
    }
    edge_normals(sim, t, r->direction + 6 * t);
  }
  double *even = r ? cloth_bend_even(sim, r) : NULL;
  for (int t = 0; even && t < r->count; t++)
    patch_stiffness(sim, t, &sim->def->cloth[r->cloth[t]].material, r->direction + 6 * t,
                    even + 9 * t, r->stiffness + 6 * t);
  if (even == NULL) cloth_bend_rest_free(r), r = NULL;
  free(even);
  return r;
}

cloth_status cloth_bend_rest_new(const cloth_sim *sim, cloth_bend_rest **out, cloth_error *err)
{
  int model = sim->params.bending_model;
  *out = model == CLOTH_BENDING_SHAPE ? patches(sim) : hinges(sim);
  if (*out == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "bending of %d hinges", sim->hinge_count);
  for (int i = 0; model == CLOTH_BENDING_QUADRATIC && i < (*out)->count; i++)
    if (!(fabs((*out)->angle[i]) < 1e-3))
      CLOTH_FAIL(err, CLOTH_UNSUPPORTED,
                 "cloth %s: bending_model quadratic is for cloth that is flat at rest; here is an "
                 "edge with an angle of %g rad",
                 sim->def->cloth[(*out)->cloth[i]].name, (*out)->angle[i]);
  return CLOTH_OK;
}
