#include "geometry/mesh_impacts.h"

#include "geometry/box_tree.h"

#include <limits.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

// What is searched: features of one kind, and the tree of features that they are tested against.
typedef struct search {
  const cloth_mesh_view *mesh;
  const double *position1;
  cloth_impact_precision precision;
  cloth_impact_kind kind;
  int count, own, other;           // features that ask; vertices of each, and of each in the tree
  const int *vertex, *tree_vertex; // [count x own], [tree.count x other]
  const cloth_box *box;            // [count]
  cloth_box_tree tree;
} search;

// What a search found, or one thread's share of it.
typedef struct found {
  int64_t candidates, colliding;
  double first;
  int i, j; // the features with it
} found;

// ---- features ----------------------------------------------------------------------------------

static int compare_keys(const void *a, const void *b)
{
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

// edges [*count x 2] by ascending vertices, each once
static cloth_status list_edges(const cloth_mesh_view *m, int **out, int *count, cloth_error *err)
{
  size_t sides = 3 * (size_t)m->triangle_count, n = 0, unique = 0;
  uint64_t *key = malloc(sizeof *key * (sides + 1));
  *out = malloc(sizeof **out * (2 * sides + 1));
  if (!key || !*out || sides > INT_MAX / 4) {
    free(key);
    if (sides > INT_MAX / 4) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "more than %d edges", INT_MAX / 4);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %zu edges", sides);
  }
  for (size_t s = 0; s < sides; s++) {
    uint64_t a = (uint64_t)m->triangle[s];
    uint64_t b = (uint64_t)m->triangle[s % 3 == 2 ? s - 2 : s + 1];
    if (a != b) key[n++] = a < b ? a << 32 | b : b << 32 | a;
  }
  qsort(key, n, sizeof *key, compare_keys);
  for (size_t k = 0; k < n; k++) {
    if (k > 0 && key[k] == key[k - 1]) continue;
    (*out)[2 * unique] = (int)(key[k] >> 32);
    (*out)[2 * unique + 1] = (int)(key[k] & 0xffffffff);
    unique++;
  }
  *count = (int)unique;
  free(key);
  return CLOTH_OK;
}

static cloth_box vertex_box(const cloth_mesh_view *m, const double *position1, double inflate,
                            int v)
{
  cloth_box box;
  for (int k = 0; k < 3; k++) {
    double a = m->position[3 * (size_t)v + (size_t)k], b = position1[3 * (size_t)v + (size_t)k];
    box.min[k] = (a < b ? a : b) - inflate;
    box.max[k] = (a < b ? b : a) + inflate;
  }
  return box;
}

// Boxes around `size` vertices each. Rounding keeps order: inflated boxes joined are the join,
// inflated.
static cloth_box *feature_boxes(const cloth_mesh_view *m, const double *position1, double inflate,
                                const int *vertex, int size, int count)
{
  cloth_box *box = malloc(sizeof *box * ((size_t)count + 1));
  if (!box) return NULL;
#pragma omp parallel for
  for (int i = 0; i < count; i++)
    for (int k = 0; k < size; k++) {
      int v = vertex ? vertex[(size_t)size * (size_t)i + (size_t)k] : i;
      cloth_box one = vertex_box(m, position1, inflate, v);
      box[i] = k == 0 ? one : cloth_box_join(&box[i], &one);
    }
  return box;
}

// ---- pairs -------------------------------------------------------------------------------------

// The four vertices of pair (i, j); false if they share one, or it is found from the other side.
static bool take_pair(const search *s, int i, int j, int vertex[4])
{
  if (s->kind == CLOTH_IMPACT_EDGE_EDGE && j <= i) return false;
  for (int k = 0; k < s->own; k++)
    vertex[k] = s->vertex ? s->vertex[(size_t)s->own * (size_t)i + (size_t)k] : i;
  for (int k = 0; k < s->other; k++) {
    int v = s->tree_vertex[(size_t)s->other * (size_t)j + (size_t)k];
    for (int l = 0; l < s->own; l++)
      if (vertex[l] == v) return false;
    vertex[s->own + k] = v;
  }
  return true;
}

static void test_pair(const search *s, int i, int j, const int vertex[4], found *f)
{
  double x[8][3];
  for (int k = 0; k < 4; k++) {
    memcpy(x[k], s->mesh->position + 3 * (size_t)vertex[k], sizeof x[k]);
    memcpy(x[4 + k], s->position1 + 3 * (size_t)vertex[k], sizeof x[k]);
  }
  cloth_impact_result r = cloth_impact_test(s->kind, s->precision, (const double(*)[3])x);
  if (!r.hit) return;
  f->colliding++;
  bool earlier = r.toi < f->first || (r.toi == f->first && (i < f->i || (i == f->i && j < f->j)));
  if (earlier) f->first = r.toi, f->i = i, f->j = j;
}

static void add(found *sum, const found *f)
{
  sum->candidates += f->candidates, sum->colliding += f->colliding;
  bool earlier = f->first < sum->first ||
                 (f->first == sum->first && (f->i < sum->i || (f->i == sum->i && f->j < sum->j)));
  if (earlier) sum->first = f->first, sum->i = f->i, sum->j = f->j;
}

// every candidate, tested or only counted
static found walk_all(const search *s, bool test)
{
  const found nothing = {0, 0, 2, INT_MAX, INT_MAX};
  found sum = nothing;
#pragma omp parallel
  {
    found f = nothing;
#pragma omp for schedule(dynamic, 64)
    for (int i = 0; i < s->count; i++) {
      int vertex[4];
      cloth_box_walk walk = cloth_box_walk_start(&s->tree, &s->box[i]);
      for (int j; (j = cloth_box_walk_next(&walk)) >= 0;) {
        if (!take_pair(s, i, j, vertex)) continue;
        f.candidates++;
        if (test) test_pair(s, i, j, vertex, &f);
      }
    }
#pragma omp critical
    add(&sum, &f);
  }
  return sum;
}

static void run_search(const search *s, double start, cloth_mesh_impacts *out)
{
  int kind = s->kind == CLOTH_IMPACT_EDGE_EDGE ? 0 : 1;
  found f = walk_all(s, false);
  double middle = omp_get_wtime();
  out->candidates[kind] = f.candidates;
  f = walk_all(s, true);
  out->colliding[kind] = f.colliding;
  out->first[kind] = f.first;
  if (f.colliding) take_pair(s, f.i, f.j, out->first_vertex[kind]);
  out->seconds[0] += middle - start;
  out->seconds[1] += omp_get_wtime() - middle;
}

static cloth_status search_edges(search s, double inflate, cloth_mesh_impacts *out,
                                 cloth_error *err)
{
  int *edge = NULL;
  cloth_box *box = NULL;
  double start = omp_get_wtime();
  cloth_status status = list_edges(s.mesh, &edge, &out->edges, err);
  if (status == CLOTH_OK) {
    box = feature_boxes(s.mesh, s.position1, inflate, edge, 2, out->edges);
    if (!box)
      status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for the boxes");
  }
  if (status == CLOTH_OK) status = cloth_box_tree_make(box, out->edges, &s.tree, err);
  if (status == CLOTH_OK) {
    s.kind = CLOTH_IMPACT_EDGE_EDGE;
    s.count = out->edges, s.own = s.other = 2;
    s.vertex = s.tree_vertex = edge, s.box = box;
    run_search(&s, start, out);
  }
  cloth_box_tree_free(&s.tree);
  free(box);
  free(edge);
  return status;
}

static cloth_status search_faces(search s, double inflate, cloth_mesh_impacts *out,
                                 cloth_error *err)
{
  const cloth_mesh_view *m = s.mesh;
  double start = omp_get_wtime();
  cloth_status status = CLOTH_OK;
  cloth_box *point = feature_boxes(m, s.position1, inflate, NULL, 1, m->vertex_count);
  cloth_box *face = feature_boxes(m, s.position1, inflate, m->triangle, 3, m->triangle_count);
  if (!point || !face)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for the boxes");
  if (status == CLOTH_OK) status = cloth_box_tree_make(face, m->triangle_count, &s.tree, err);
  if (status == CLOTH_OK) {
    s.kind = CLOTH_IMPACT_VERTEX_FACE;
    s.count = m->vertex_count, s.own = 1, s.other = 3;
    s.vertex = NULL, s.tree_vertex = m->triangle, s.box = point;
    run_search(&s, start, out);
  }
  cloth_box_tree_free(&s.tree);
  free(point);
  free(face);
  return status;
}

static cloth_status count_unreferenced(const cloth_mesh_view *m, int *out, cloth_error *err)
{
  bool *used = calloc((size_t)m->vertex_count + 1, sizeof *used);
  if (!used) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d vertices", m->vertex_count);
  for (size_t k = 0; k < 3 * (size_t)m->triangle_count; k++) used[m->triangle[k]] = true;
  *out = 0;
  for (int v = 0; v < m->vertex_count; v++) *out += !used[v];
  free(used);
  return CLOTH_OK;
}

cloth_status cloth_mesh_impacts_find(const cloth_mesh_view *mesh, const double *position1,
                                     double inflate, cloth_impact_precision precision,
                                     cloth_mesh_impacts *out, cloth_error *err)
{
  *out = (cloth_mesh_impacts){.first = {2, 2}};
  search s = {.mesh = mesh, .position1 = position1, .precision = precision};
  CLOTH_TRY(count_unreferenced(mesh, &out->unreferenced, err));
  CLOTH_TRY(search_edges(s, inflate, out, err));
  return search_faces(s, inflate, out, err);
}
