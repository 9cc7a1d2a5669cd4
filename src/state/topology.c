// Edges, owners and hinges of all triangles.
#include "sort.h"
#include "state/sim.h"

#include <stdlib.h>
#include <string.h>

// the three edges of every triangle as sort keys: lower vertex, higher vertex; value 3 triangle + k
typedef struct edge_list {
  int count;
  uint64_t *key, *key_spare;
  uint32_t *value, *value_spare;
} edge_list;

static void edge_list_free(edge_list *l)
{
  free(l->key), free(l->key_spare), free(l->value), free(l->value_spare);
}

static cloth_status edge_list_make(const cloth_sim *sim, edge_list *l, cloth_error *err)
{
  size_t n = 3 * (size_t)sim->all_triangles;
  *l = (edge_list){(int)n, malloc(n * 8 + 8), malloc(n * 8 + 8), malloc(n * 4 + 4),
                   malloc(n * 4 + 4)};
  if (!l->key || !l->key_spare || !l->value || !l->value_spare)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "edges of %d triangles", sim->all_triangles);
  for (int i = 0; i < l->count; i++) {
    int t = i / 3, a = sim->triangle[3 * t + i % 3], b = sim->triangle[3 * t + (i % 3 + 1) % 3];
    l->key[i] = (uint64_t)(a < b ? a : b) << 32 | (uint64_t)(a < b ? b : a);
    l->value[i] = (uint32_t)i;
  }
  cloth_cpu_sort(l->count, 64, l->key, l->value, l->key_spare, l->value_spare, 1);
  return CLOTH_OK;
}

// the corner of a triangle across from its edge k
static int across(const cloth_sim *sim, uint32_t place)
{
  return sim->triangle[3 * (place / 3) + (place % 3 + 2) % 3];
}

// one run of equal keys is one edge; cloth edges with two triangles are hinges
static void number_edges(cloth_sim *sim, const edge_list *l)
{
  sim->all_edges = sim->edge_count = sim->hinge_count = 0;
  for (int i = 0, j; i < l->count; i = j) {
    for (j = i + 1; j < l->count && l->key[j] == l->key[i];) j++;
    int e = sim->all_edges++, a = (int)(l->key[i] >> 32), b = (int)(l->key[i] & 0xffffffffu);
    sim->edge[2 * e] = a, sim->edge[2 * e + 1] = b;
    sim->edge_side[2 * e] = (int)(l->value[i] / 3);
    sim->edge_side[2 * e + 1] = j - i > 1 ? (int)(l->value[i + 1] / 3) : -1;
    for (int k = i; k < j; k++) sim->triangle_edge[l->value[k]] = e;
    sim->owns[l->value[i] / 3] |= 1 << (3 + l->value[i] % 3); // the sort is stable: lowest triangle
    if (a >= sim->vertex_count) continue;
    sim->edge_count = sim->all_edges;
    if (j - i != 2) continue;
    sim->hinge_triangle[sim->hinge_count] = (int)(l->value[i] / 3);
    int *h = sim->hinge + 4 * sim->hinge_count++;
    h[0] = a, h[1] = b, h[2] = across(sim, l->value[i]), h[3] = across(sim, l->value[i + 1]);
    // the first triangle must run from h[0] to h[1], which fixes the sign of the angle
    if (sim->triangle[l->value[i]] != a) {
      int swap = h[2];
      h[2] = h[3], h[3] = swap;
    }
  }
}

// where a vertex of a body lies in its frame
static const double *body_point(const cloth_sim *sim, int body, int v)
{
  return sim->def->body[body].mesh.position + 3 * (v - sim->body[body].vertex_first);
}

static void body_normal(const cloth_sim *sim, int body, int t, double n[3])
{
  const double *a = body_point(sim, body, sim->triangle[3 * t]);
  const double *b = body_point(sim, body, sim->triangle[3 * t + 1]);
  const double *c = body_point(sim, body, sim->triangle[3 * t + 2]);
  double u[3], v[3];
  for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
  for (int k = 0; k < 3; k++)
    n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

// the angle between two faces is below 1e-5 rad: what is left of a plane after a file in float
static void mark_flat_edges(cloth_sim *sim)
{
  for (int e = sim->edge_count, body = 0; e < sim->all_edges; e++) {
    while (sim->edge[2 * e] >= sim->body[body].vertex_first + sim->body[body].vertex_count) body++;
    const int *side = sim->edge_side + 2 * e;
    if (side[1] < 0) continue;
    double m[3], n[3], mm = 0, nn = 0, mn = 0, cross_sq = 0;
    body_normal(sim, body, side[0], m);
    body_normal(sim, body, side[1], n);
    for (int k = 0; k < 3; k++) {
      double c = m[(k + 1) % 3] * n[(k + 2) % 3] - m[(k + 2) % 3] * n[(k + 1) % 3];
      mm += m[k] * m[k], nn += n[k] * n[k], mn += m[k] * n[k], cross_sq += c * c;
    }
    sim->edge_flat[e] = mn > 0 && cross_sq <= 1e-10 * mm * nn;
  }
}

// inside a flat face of a body: only seams meet here
static void mark_flat_vertices(cloth_sim *sim)
{
  memset(sim->vertex_flat, 1, (size_t)(sim->all_vertices - sim->vertex_count));
  for (int e = sim->edge_count; e < sim->all_edges; e++)
    for (int k = 0; k < 2 && !sim->edge_flat[e]; k++)
      sim->vertex_flat[sim->edge[2 * e + k] - sim->vertex_count] = 0;
}

static void own_vertices(cloth_sim *sim)
{
  unsigned char *taken = calloc((size_t)sim->all_vertices + 1, 1);
  if (taken == NULL) return;
  for (int i = 0; i < 3 * sim->all_triangles; i++) {
    int v = sim->triangle[i];
    if (!taken[v]) sim->owns[i / 3] |= 1 << (i % 3);
    taken[v] = 1;
  }
  free(taken);
}

cloth_status cloth_topology_build(cloth_sim *sim, cloth_error *err)
{
  size_t n = 3 * (size_t)sim->all_triangles;
  sim->edge = malloc(sizeof(int) * (2 * n + 2));
  sim->edge_flat = calloc(n + 1, 1);
  sim->vertex_flat = calloc((size_t)(sim->all_vertices - sim->vertex_count) + 1, 1);
  sim->edge_side = malloc(sizeof(int) * (2 * n + 2));
  sim->triangle_edge = malloc(sizeof(int) * (n + 1));
  sim->owns = calloc((size_t)sim->all_triangles + 1, sizeof(int));
  sim->hinge = malloc(sizeof(int) * (2 * n + 4));
  sim->hinge_triangle = malloc(sizeof(int) * (n + 1));
  if (!sim->edge_flat || !sim->vertex_flat || !sim->edge_side || !sim->hinge_triangle ||
      !sim->edge || !sim->triangle_edge || !sim->owns || !sim->hinge)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "topology of %d triangles", sim->all_triangles);
  edge_list l = {0};
  cloth_status status = edge_list_make(sim, &l, err);
  if (status == CLOTH_OK) {
    number_edges(sim, &l);
    mark_flat_edges(sim);
    mark_flat_vertices(sim);
    own_vertices(sim);
  }
  edge_list_free(&l);
  return status;
}
