// Internal numbering: vertices and triangles along a space-filling curve, so that neighbours on the
// cloth are neighbours in memory and runs of vertices are compact parts.
#include "sort.h"
#include "state/build.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// every third bit of a 21-bit number
static uint64_t spread(uint64_t v)
{
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffu;
  v = (v | v << 16) & 0x1f0000ff0000ffu;
  v = (v | v << 8) & 0x100f00f00f00f00fu;
  v = (v | v << 4) & 0x10c30c30c30c30c3u;
  return (v | v << 2) & 0x1249249249249249u;
}

// Morton code of a point in a box
static uint64_t curve(const double p[3], const double lo[3], double size)
{
  uint64_t code = 0;
  for (int k = 0; k < 3; k++) {
    double s = size > 0 ? (p[k] - lo[k]) / size : 0;
    code |= spread((uint64_t)(s * 2097151.0)) << k;
  }
  return code;
}

typedef struct sorter {
  uint64_t *key, *key_spare;
  uint32_t *value, *value_spare;
} sorter;

static cloth_status sorter_new(sorter *s, size_t n, cloth_error *err)
{
  *s = (sorter){malloc(8 * n + 8), malloc(8 * n + 8), malloc(4 * n + 4), malloc(4 * n + 4)};
  if (!s->key || !s->key_spare || !s->value || !s->value_spare)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "numbering");
  return CLOTH_OK;
}

static void sorter_free(sorter *s)
{
  free(s->key), free(s->key_spare), free(s->value), free(s->value_spare);
}

static void to_scene(const cloth_pose *pose, const double *p, int n, double *out)
{
  for (int i = 0; i < n; i++) cloth_pose_point(pose, p + 3 * i, out + 3 * i);
}

static void number_vertices(cloth_sim *sim, int c, sorter *s, double *place)
{
  const cloth_cloth_def *d = &sim->def->cloth[c];
  int n = d->mesh.vertex_count, first = sim->cloth_first[c];
  to_scene(&d->pose, d->mesh.position, n, place);
  double lo[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, size = 0;
  for (int i = 0; i < 3 * n; i++) lo[i % 3] = fmin(lo[i % 3], d->mesh.position[i]);
  for (int i = 0; i < 3 * n; i++) size = fmax(size, d->mesh.position[i] - lo[i % 3]);
  for (int v = 0; v < n; v++)
    s->key[v] = curve(d->mesh.position + 3 * v, lo, size), s->value[v] = (uint32_t)v;
  cloth_cpu_sort(n, 63, s->key, s->value, s->key_spare, s->value_spare, 1);
  for (int i = 0; i < n; i++) {
    int v = (int)s->value[i];
    sim->order[first + i] = v;
    sim->internal[first + v] = first + i;
    memcpy(sim->rest + 3 * (first + i), place + 3 * v, sizeof(double) * 3);
  }
}

static void number_triangles(cloth_sim *sim, int c, sorter *s)
{
  const cloth_mesh *m = &sim->def->cloth[c].mesh;
  int first = sim->triangle_first[c];
  for (int t = 0; t < m->triangle_count; t++) { // by their lowest vertex
    int lowest = sim->vertex_count;
    for (int k = 0; k < 3; k++) {
      int v = sim->internal[sim->cloth_first[c] + m->triangle[3 * t + k]];
      if (v < lowest) lowest = v;
    }
    s->key[t] = (uint64_t)lowest, s->value[t] = (uint32_t)t;
  }
  cloth_cpu_sort(m->triangle_count, 32, s->key, s->value, s->key_spare, s->value_spare, 1);
  for (int i = 0; i < m->triangle_count; i++) {
    sim->triangle_order[first + i] = (int)s->value[i];
    for (int k = 0; k < 3; k++)
      sim->triangle[3 * (first + i) + k] =
          sim->internal[sim->cloth_first[c] + m->triangle[3 * (int)s->value[i] + k]];
  }
}

// a plane is a large square
static double plane_spread(const cloth_mesh *m)
{
  const double reach = 50; // m; larger would cost digits in float
  double half = 0;
  for (int i = 0; i < 3 * m->vertex_count; i++) half = fmax(half, fabs(m->position[i]));
  return half > 0 && half < reach ? reach / half : 1;
}

static void number_bodies(cloth_sim *sim)
{
  int v = sim->vertex_count, t = sim->triangle_count;
  for (int b = 0; b < sim->def->body_count; b++) {
    const cloth_mesh *m = &sim->def->body[b].mesh;
    cloth_body *body = &sim->body[b];
    body->vertex_first = v, body->vertex_count = m->vertex_count;
    body->triangle_first = t, body->triangle_count = m->triangle_count;
    for (int i = 0; i < 3 * m->triangle_count; i++) sim->triangle[3 * t + i] = v + m->triangle[i];
    body->spread = sim->def->body[b].plane ? plane_spread(m) : 1;
    double lo[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, hi[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    for (int i = 0; i < 3 * m->vertex_count; i++) {
      lo[i % 3] = fmin(lo[i % 3], m->position[i]);
      hi[i % 3] = fmax(hi[i % 3], m->position[i]);
    }
    for (int k = 0; k < 3; k++) body->center[k] = m->vertex_count > 0 ? (lo[k] + hi[k]) / 2 : 0;
    for (int k = 0; k < 3; k++)
      body->half[k] = m->vertex_count > 0 ? body->spread * (hi[k] - lo[k]) / 2 : 0;
    for (int i = 0; i < m->vertex_count; i++) {
      double r_sq = 0;
      for (int k = 0; k < 3; k++) r_sq += pow(m->position[3 * i + k] - body->center[k], 2);
      body->radius = fmax(body->radius, sqrt(r_sq));
    }
    body->radius *= body->spread;
    v += m->vertex_count, t += m->triangle_count;
  }
}

int cloth_of_vertex(const cloth_sim *sim, int vertex)
{
  int c = 0;
  while (vertex >= sim->cloth_first[c + 1]) c++;
  return c;
}

int cloth_of_triangle(const cloth_sim *sim, int triangle)
{
  int c = 0;
  while (triangle >= sim->triangle_first[c + 1]) c++;
  return c;
}

int cloth_body_of_triangle(const cloth_sim *sim, int triangle)
{
  int b = 0;
  while (triangle >= sim->body[b].triangle_first + sim->body[b].triangle_count) b++;
  return b;
}

int cloth_body_of_vertex(const cloth_sim *sim, int vertex)
{
  int b = 0;
  while (vertex >= sim->body[b].vertex_first + sim->body[b].vertex_count) b++;
  return b;
}

// the edges of a triangle in a flat frame whose first axis is the mesh's x axis laid onto the
// triangle; axis, out: that direction
static void flatten(const double x[3][3], double u[2][2], double axis[3])
{
  double e[2][3], n[3];
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++) e[i][k] = x[i + 1][k] - x[0][k];
  n[0] = e[0][1] * e[1][2] - e[0][2] * e[1][1];
  n[1] = e[0][2] * e[1][0] - e[0][0] * e[1][2];
  n[2] = e[0][0] * e[1][1] - e[0][1] * e[1][0];
  double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int k = 0; k < 3; k++) n[k] /= length;
  int along = fabs(n[0]) < 0.9 ? 0 : 1; // a triangle across the x axis takes y
  double size = 0;
  for (int k = 0; k < 3; k++) axis[k] = (k == along) - n[along] * n[k], size += axis[k] * axis[k];
  for (int k = 0; k < 3; k++) axis[k] /= sqrt(size);
  double side[3] = {n[1] * axis[2] - n[2] * axis[1], n[2] * axis[0] - n[0] * axis[2],
                    n[0] * axis[1] - n[1] * axis[0]};
  for (int i = 0; i < 2; i++) {
    u[i][0] = e[i][0] * axis[0] + e[i][1] * axis[1] + e[i][2] * axis[2];
    u[i][1] = e[i][0] * side[0] + e[i][1] * side[1] + e[i][2] * side[2];
  }
}

// material edges 1 - 0 and 2 - 0 of a triangle [m]
static void material_edges(const cloth_sim *sim, int triangle, double u[2][2])
{
  int c = cloth_of_triangle(sim, triangle), t = sim->triangle_order[triangle];
  const cloth_mesh *m = &sim->def->cloth[c].mesh;
  if (m->material != NULL) {
    for (int i = 0; i < 2; i++)
      for (int k = 0; k < 2; k++)
        u[i][k] = m->material[6 * t + 2 * (i + 1) + k] - m->material[6 * t + k];
    return;
  }
  double x[3][3], axis[3];
  for (int i = 0; i < 3; i++) memcpy(x[i], m->position + 3 * m->triangle[3 * t + i], sizeof x[i]);
  flatten((const double(*)[3])x, u, axis);
}

void cloth_rest_triangle(const cloth_sim *sim, int triangle, double rest[5])
{
  double u[2][2];
  material_edges(sim, triangle, u);
  double det = u[0][0] * u[1][1] - u[1][0] * u[0][1]; // Dm = [u0 u1] as columns
  rest[0] = u[1][1] / det, rest[1] = -u[1][0] / det;
  rest[2] = -u[0][1] / det, rest[3] = u[0][0] / det;
  rest[4] = fabs(det) / 2;
}

void cloth_warp_direction(const cloth_sim *sim, int t, double warp[3])
{
  // dx / d(warp) through the material edges
  const int *v = sim->triangle + 3 * t;
  double rest[5], size = 0;
  cloth_rest_triangle(sim, t, rest);
  for (int k = 0; k < 3; k++) {
    double e0 = sim->rest[3 * v[1] + k] - sim->rest[3 * v[0] + k];
    double e1 = sim->rest[3 * v[2] + k] - sim->rest[3 * v[0] + k];
    warp[k] = e0 * rest[0] + e1 * rest[2];
    size += warp[k] * warp[k];
  }
  for (int k = 0; k < 3; k++) warp[k] = size > 0 ? warp[k] / sqrt(size) : k == 0;
}

static void weigh(cloth_sim *sim)
{
  double edges = 0;
  for (int t = 0; t < sim->triangle_count; t++) {
    double rest[5];
    cloth_rest_triangle(sim, t, rest);
    double third = rest[4] * sim->def->cloth[cloth_of_triangle(sim, t)].material.density / 3;
    for (int k = 0; k < 3; k++) sim->mass[sim->triangle[3 * t + k]] += third;
    sim->mass_total += 3 * third;
    edges += sqrt(rest[4] * 4 / sqrt(3.0)); // of an equilateral triangle of that area
  }
  sim->mean_edge = edges / sim->triangle_count;
}

static void measure(cloth_sim *sim)
{
  for (int c = 0; c < sim->def->cloth_count; c++) {
    double diagonal_sq = 0;
    for (int k = 0; k < 3; k++) {
      double low = INFINITY, high = -INFINITY;
      for (int v = sim->cloth_first[c]; v < sim->cloth_first[c + 1]; v++)
        low = fmin(low, sim->rest[3 * v + k]), high = fmax(high, sim->rest[3 * v + k]);
      diagonal_sq += (high - low) * (high - low);
    }
    sim->control.size = fmax(sim->control.size, sqrt(diagonal_sq));
  }
}

static cloth_status take_arrays(cloth_sim *sim, cloth_error *err)
{
  const cloth_def *d = sim->def;
  for (int c = 0; c < d->cloth_count; c++) {
    sim->vertex_count += d->cloth[c].mesh.vertex_count;
    sim->triangle_count += d->cloth[c].mesh.triangle_count;
  }
  sim->all_vertices = sim->vertex_count, sim->all_triangles = sim->triangle_count;
  for (int b = 0; b < d->body_count; b++) {
    sim->all_vertices += d->body[b].mesh.vertex_count;
    sim->all_triangles += d->body[b].mesh.triangle_count;
  }
  size_t n = (size_t)sim->vertex_count + 1, t = (size_t)sim->triangle_count + 1;
  sim->cloth_first = calloc((size_t)d->cloth_count + 1, sizeof(int));
  sim->triangle_first = calloc((size_t)d->cloth_count + 1, sizeof(int));
  sim->order = malloc(sizeof(int) * n), sim->internal = malloc(sizeof(int) * n);
  sim->triangle_order = malloc(sizeof(int) * t);
  sim->triangle = malloc(sizeof(int) * 3 * ((size_t)sim->all_triangles + 1));
  sim->rest = malloc(sizeof(double) * 3 * n), sim->mass = calloc(n, sizeof(double));
  sim->body = calloc((size_t)d->body_count + 1, sizeof *sim->body);
  sim->mean_velocity = calloc(3 * (size_t)d->cloth_count + 1, sizeof(double));
  sim->acceleration = calloc(3 * (size_t)d->cloth_count + 1, sizeof(double));
  sim->pin_broken = calloc((size_t)d->pin_count + 1, 1);
  if (!sim->pin_broken || !sim->mean_velocity || !sim->acceleration || !sim->cloth_first ||
      !sim->triangle_first || !sim->order || !sim->internal || !sim->triangle_order ||
      !sim->triangle || !sim->rest || !sim->mass || !sim->body)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "scene of %d vertices", sim->all_vertices);
  for (int c = 0; c < d->cloth_count; c++) {
    sim->cloth_first[c + 1] = sim->cloth_first[c] + d->cloth[c].mesh.vertex_count;
    sim->triangle_first[c + 1] = sim->triangle_first[c] + d->cloth[c].mesh.triangle_count;
  }
  return CLOTH_OK;
}

cloth_status cloth_number(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(take_arrays(sim, err));
  sorter s = {0};
  size_t n =
      (size_t)(sim->vertex_count > sim->triangle_count ? sim->vertex_count : sim->triangle_count);
  double *place = malloc(sizeof *place * 3 * ((size_t)sim->vertex_count + 1));
  cloth_status status = sorter_new(&s, n, err);
  if (place == NULL) status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "numbering");
  if (status == CLOTH_OK) {
    for (int c = 0; c < sim->def->cloth_count; c++) {
      number_vertices(sim, c, &s, place);
      number_triangles(sim, c, &s);
    }
    number_bodies(sim);
    weigh(sim);
    measure(sim);
  }
  sorter_free(&s), free(place);
  return status;
}
