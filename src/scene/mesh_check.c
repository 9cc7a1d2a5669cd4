// What makes a mesh unfit to be simulated, and how it is put right. One pass per defect, in the
// order of cloth_mesh_check() at the end; a dropped triangle is marked and leaves in compact().
#include "scene/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// twice the area over the longest edge squared: below this a triangle has no usable normal
static const double FLAT = 1e-9;

typedef struct check {
  const char *name;
  bool is_cloth, repair;
  cloth_mesh *mesh;
  bool *dropped; // [triangle_count]
  cloth_mesh_repairs *repairs;
} check;

// one side of a triangle; low < high
typedef struct side {
  int low, high;
  int triangle;
  int corner;   // the side runs from this corner to the next
  bool forward; // from low to high
} side;

static cloth_status check_positions(const check *c, cloth_error *err)
{
  const cloth_mesh *m = c->mesh;
  for (int v = 0; v < m->vertex_count; v++) {
    const double *x = m->position + 3 * (size_t)v;
    if (!(isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2])))
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': vertex %d = (%g, %g, %g) [m] is not finite", c->name,
                 v, x[0], x[1], x[2]);
  }
  return CLOTH_OK;
}

static cloth_status check_indices(const check *c, cloth_error *err)
{
  const cloth_mesh *m = c->mesh;
  for (int t = 0; t < m->triangle_count; t++)
    for (int k = 0; k < 3; k++) {
      int v = m->triangle[3 * (size_t)t + (size_t)k];
      if (v < 0 || v >= m->vertex_count)
        CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                   "'%s': triangle %d names vertex %d; indices are in [0, %d]", c->name, t, v,
                   m->vertex_count - 1);
    }
  return CLOTH_OK;
}

static double distance_sq(const double *a, const double *b, int dimensions)
{
  double sum = 0;
  for (int i = 0; i < dimensions; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

static double longest_side_sq(const double *a, const double *b, const double *c, int dimensions)
{
  double ab = distance_sq(a, b, dimensions), bc = distance_sq(b, c, dimensions);
  return fmax(fmax(ab, bc), distance_sq(c, a, dimensions));
}

static double twice_area(const double *a, const double *b, const double *c)
{
  double u[3], v[3];
  for (int i = 0; i < 3; i++) u[i] = b[i] - a[i], v[i] = c[i] - a[i];
  double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
         z = u[0] * v[1] - u[1] * v[0];
  return sqrt(x * x + y * y + z * z);
}

static cloth_status drop_zero_area(check *c, cloth_error *err)
{
  const cloth_mesh *m = c->mesh;
  for (int t = 0; t < m->triangle_count; t++) {
    const int *v = m->triangle + 3 * (size_t)t;
    const double *x[3];
    for (int k = 0; k < 3; k++) x[k] = m->position + 3 * (size_t)v[k];
    double area2 = twice_area(x[0], x[1], x[2]);
    if (area2 > FLAT * longest_side_sq(x[0], x[1], x[2], 3)) continue;
    if (c->is_cloth && !c->repair)
      CLOTH_FAIL(
          err, CLOTH_BAD_SCENE,
          "'%s': triangle %d (vertices %d, %d, %d) has no area; mesh_defects: repair drops it",
          c->name, t, v[0], v[1], v[2]);
    c->dropped[t] = true;
    c->repairs->zero_area++;
  }
  return CLOTH_OK;
}

// a triangle's vertices from the lowest on, in its own order (body) or ascending (cloth)
typedef struct key {
  int v[3];
  int triangle;
} key;

static key triangle_key(const check *c, int t)
{
  const int *v = c->mesh->triangle + 3 * (size_t)t;
  int first = v[1] < v[0] ? (v[2] < v[1] ? 2 : 1) : (v[2] < v[0] ? 2 : 0);
  key k = {{v[first], v[(first + 1) % 3], v[(first + 2) % 3]}, t};
  // two faces back to back are a thin wall of a body, but the same triangle twice in a cloth
  if (c->is_cloth && k.v[2] < k.v[1]) k = (key){{k.v[0], k.v[2], k.v[1]}, t};
  return k;
}

static int compare_keys(const void *a_, const void *b_)
{
  const key *a = a_, *b = b_;
  for (int k = 0; k < 3; k++)
    if (a->v[k] != b->v[k]) return a->v[k] < b->v[k] ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static cloth_status drop_duplicates(check *c, cloth_error *err)
{
  const cloth_mesh *m = c->mesh;
  key *keys = malloc(sizeof *keys * ((size_t)m->triangle_count + 1));
  if (keys == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "'%s': no memory to check the mesh", c->name);
  size_t n = 0;
  for (int t = 0; t < m->triangle_count; t++)
    if (!c->dropped[t]) keys[n++] = triangle_key(c, t);
  qsort(keys, n, sizeof *keys, compare_keys);

  cloth_status status = CLOTH_OK;
  for (size_t i = 1; i < n && status == CLOTH_OK; i++) {
    if (memcmp(keys[i].v, keys[i - 1].v, sizeof keys[i].v) != 0) continue;
    if (c->is_cloth && !c->repair)
      status = cloth_fail(err, CLOTH_BAD_SCENE, __FILE__, __LINE__,
                          "'%s': triangles %d and %d have the same vertices (%d, %d, %d); "
                          "mesh_defects: repair drops the second",
                          c->name, keys[i - 1].triangle, keys[i].triangle, keys[i].v[0],
                          keys[i].v[1], keys[i].v[2]);
    c->dropped[keys[i].triangle] = true;
    c->repairs->duplicate++;
  }
  free(keys);
  return status;
}

static int compare_sides(const void *a_, const void *b_)
{
  const side *a = a_, *b = b_;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

// the sides of all triangles that are left, sorted by edge, then by triangle
static size_t list_sides(const check *c, side *out)
{
  size_t n = 0;
  for (int t = 0; t < c->mesh->triangle_count; t++) {
    if (c->dropped[t]) continue;
    const int *v = c->mesh->triangle + 3 * (size_t)t;
    for (int k = 0; k < 3; k++) {
      int a = v[k], b = v[(k + 1) % 3];
      out[n++] = (side){a < b ? a : b, a < b ? b : a, t, k, a < b};
    }
  }
  qsort(out, n, sizeof *out, compare_sides);
  return n;
}

static bool same_edge(const side *a, const side *b)
{
  return a->low == b->low && a->high == b->high;
}

static cloth_status drop_non_manifold(check *c, const side *sides, size_t n, cloth_error *err)
{
  for (size_t first = 0, end; first < n; first = end) {
    int alive = 0, two[2] = {-1, -1};
    for (end = first; end < n && same_edge(&sides[first], &sides[end]); end++) {
      int t = sides[end].triangle;
      if (c->dropped[t]) continue;
      if (alive < 2) {
        two[alive++] = t;
        continue;
      }
      if (!c->repair)
        CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                   "'%s': the edge of vertices %d and %d has more than two triangles (%d, %d, %d); "
                   "mesh_defects: repair drops the third",
                   c->name, sides[first].low, sides[first].high, two[0], two[1], t);
      c->dropped[t] = true;
      c->repairs->non_manifold++;
    }
  }
  return CLOTH_OK;
}

static void turn_over(cloth_mesh *m, int t)
{
  int *v = m->triangle + 3 * (size_t)t;
  int swap = v[1];
  v[1] = v[2], v[2] = swap;
  if (m->material == NULL) return;
  double *u = m->material + 6 * (size_t)t;
  for (int i = 0; i < 2; i++) {
    double number = u[2 + i];
    u[2 + i] = u[4 + i], u[4 + i] = number;
  }
}

// The neighbour over each side and whether it is wound the same way; what two triangles on one edge
// both run along, one of them runs along the wrong way.
typedef struct winding {
  int *neighbour;    // [triangle_count x 3], -1: border
  signed char *turn; // [triangle_count] 0: not seen, 1: stays, -1: is turned over
  bool *against;     // [triangle_count x 3] the neighbour runs along this side the same way
  int *queue;        // [triangle_count]
  side first[2];     // the first two that are wound against each other, if `mixed`
  bool mixed;
} winding;

static void free_winding(winding *w)
{
  free(w->neighbour), free(w->turn), free(w->against), free(w->queue);
}

static cloth_status new_winding(const check *c, winding *w, cloth_error *err)
{
  size_t n = (size_t)c->mesh->triangle_count + 1;
  *w = (winding){.neighbour = malloc(sizeof(int) * 3 * n),
                 .turn = calloc(n, 1),
                 .against = calloc(3 * n, sizeof(bool)),
                 .queue = malloc(sizeof(int) * n)};
  if (w->neighbour && w->turn && w->against && w->queue) {
    for (size_t i = 0; i < 3 * n; i++) w->neighbour[i] = -1;
    return CLOTH_OK;
  }
  free_winding(w);
  CLOTH_FAIL(err, CLOTH_NO_MEMORY, "'%s': no memory to check the mesh", c->name);
}

static void link_neighbours(const check *c, const side *sides, size_t n, winding *w)
{
  for (size_t first = 0, end; first < n; first = end) {
    const side *pair[2];
    int alive = 0;
    for (end = first; end < n && same_edge(&sides[first], &sides[end]); end++)
      if (!c->dropped[sides[end].triangle] && alive < 2) pair[alive++] = &sides[end];
    if (alive < 2) continue;

    bool against = pair[0]->forward == pair[1]->forward;
    if (against && !w->mixed) {
      w->mixed = true;
      w->first[0] = *pair[0], w->first[1] = *pair[1];
    }
    for (int i = 0; i < 2; i++) {
      size_t slot = 3 * (size_t)pair[i]->triangle + (size_t)pair[i]->corner;
      w->neighbour[slot] = pair[1 - i]->triangle;
      w->against[slot] = against;
    }
  }
}

// Spread from one triangle over its piece of cloth and turn the smaller share of it over.
static cloth_status orient_piece(check *c, winding *w, int start, cloth_error *err)
{
  int head = 0, tail = 0, turned = 0;
  w->turn[start] = 1;
  w->queue[tail++] = start;
  while (head < tail) {
    int t = w->queue[head++];
    turned += w->turn[t] < 0;
    for (size_t slot = 3 * (size_t)t; slot < 3 * (size_t)t + 3; slot++) {
      int u = w->neighbour[slot];
      if (u < 0) continue;
      signed char turn = (signed char)(w->against[slot] ? -w->turn[t] : w->turn[t]);
      if (w->turn[u] == 0) {
        w->turn[u] = turn;
        w->queue[tail++] = u;
      } else if (w->turn[u] != turn) {
        CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                   "'%s': the cloth has only one side (a Moebius strip closes at triangles %d and "
                   "%d); no repair can orient it",
                   c->name, t, u);
      }
    }
  }
  signed char minority = 2 * turned > tail ? 1 : -1;
  for (int i = 0; i < tail; i++)
    if (w->turn[w->queue[i]] == minority) {
      turn_over(c->mesh, w->queue[i]);
      c->repairs->flipped++;
    }
  return CLOTH_OK;
}

static cloth_status orient(check *c, const side *sides, size_t n, cloth_error *err)
{
  winding w;
  CLOTH_TRY(new_winding(c, &w, err));
  link_neighbours(c, sides, n, &w);
  cloth_status status = CLOTH_OK;
  for (int t = 0; t < c->mesh->triangle_count && status == CLOTH_OK; t++)
    if (!c->dropped[t] && w.turn[t] == 0) status = orient_piece(c, &w, t, err);
  // only now, as a cloth with one side is beyond repair
  if (status == CLOTH_OK && w.mixed && !c->repair)
    status = cloth_fail(err, CLOTH_BAD_SCENE, __FILE__, __LINE__,
                        "'%s': triangles %d and %d are wound against each other at the edge of "
                        "vertices %d and %d; mesh_defects: repair turns one over",
                        c->name, w.first[0].triangle, w.first[1].triangle, w.first[0].low,
                        w.first[0].high);
  free_winding(&w);
  return status;
}

static cloth_status check_edges(check *c, cloth_error *err)
{
  side *sides = malloc(sizeof *sides * (3 * (size_t)c->mesh->triangle_count + 1));
  if (sides == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "'%s': no memory to check the mesh", c->name);
  size_t n = list_sides(c, sides);
  cloth_status status = drop_non_manifold(c, sides, n, err);
  if (status == CLOTH_OK) status = orient(c, sides, n, err);
  free(sides);
  return status;
}

// Material coordinates of a triangle in its own plane, warp along the mesh's x axis projected onto
// it (its y axis where x is the normal).
static void flatten(const double *x[3], double material[6])
{
  double u[3], v[3], normal[3], warp[3] = {1, 0, 0}, weft[3];
  for (int i = 0; i < 3; i++) u[i] = x[1][i] - x[0][i], v[i] = x[2][i] - x[0][i];
  double length = twice_area(x[0], x[1], x[2]);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    normal[i] = (u[j] * v[k] - u[k] * v[j]) / length;
  }
  if (fabs(normal[0]) > 0.999) warp[0] = 0, warp[1] = 1;
  double along = 0, norm_sq = 0;
  for (int i = 0; i < 3; i++) along += warp[i] * normal[i];
  for (int i = 0; i < 3; i++) {
    warp[i] -= along * normal[i];
    norm_sq += warp[i] * warp[i];
  }
  for (int i = 0; i < 3; i++) warp[i] /= sqrt(norm_sq);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    weft[i] = normal[j] * warp[k] - normal[k] * warp[j];
  }
  for (int corner = 0; corner < 3; corner++) {
    double *out = material + 2 * corner;
    out[0] = out[1] = 0;
    for (int i = 0; i < 3; i++) {
      out[0] += (x[corner][i] - x[0][i]) * warp[i];
      out[1] += (x[corner][i] - x[0][i]) * weft[i];
    }
  }
}

static cloth_status check_material(check *c, cloth_error *err)
{
  cloth_mesh *m = c->mesh;
  for (int t = 0; t < m->triangle_count; t++) {
    double *u = m->material + 6 * (size_t)t;
    for (int i = 0; i < 6; i++)
      if (!isfinite(u[i]))
        CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                   "'%s': triangle %d, corner %d: material coordinates (%g, %g) [m] are not finite",
                   c->name, t, i / 2, u[i - i % 2], u[i - i % 2 + 1]);
    if (c->dropped[t]) continue;
    double area2 = (u[2] - u[0]) * (u[5] - u[1]) - (u[3] - u[1]) * (u[4] - u[0]);
    if (fabs(area2) > FLAT * longest_side_sq(u, u + 2, u + 4, 2)) continue;
    if (!c->repair)
      CLOTH_FAIL(
          err, CLOTH_BAD_SCENE,
          "'%s': triangle %d has no area in material space: (%g, %g), (%g, %g), (%g, %g) [m]; "
          "mesh_defects: repair flattens its rest shape",
          c->name, t, u[0], u[1], u[2], u[3], u[4], u[5]);
    const double *x[3];
    for (int k = 0; k < 3; k++)
      x[k] = m->position + 3 * (size_t)m->triangle[3 * (size_t)t + (size_t)k];
    flatten(x, u);
    c->repairs->flattened++;
  }
  return CLOTH_OK;
}

static cloth_status drop_unreferenced(check *c, int *kept, cloth_error *err)
{
  cloth_mesh *m = c->mesh;
  for (int v = 0; v < m->vertex_count; v++) kept[v] = -1;
  for (int t = 0; t < m->triangle_count; t++)
    for (int k = 0; k < 3 && !c->dropped[t]; k++) kept[m->triangle[3 * (size_t)t + (size_t)k]] = 0;

  int n = 0;
  for (int v = 0; v < m->vertex_count; v++) {
    if (kept[v] < 0) {
      if (c->is_cloth && !c->repair)
        CLOTH_FAIL(
            err, CLOTH_BAD_SCENE,
            "'%s': vertex %d belongs to no triangle, so it has no mass; mesh_defects: repair "
            "drops it",
            c->name, v);
      c->repairs->unreferenced++;
      continue;
    }
    memmove(m->position + 3 * (size_t)n, m->position + 3 * (size_t)v, 3 * sizeof *m->position);
    kept[v] = n++;
  }
  m->vertex_count = n;
  return CLOTH_OK;
}

static void compact_triangles(check *c, const int *kept)
{
  cloth_mesh *m = c->mesh;
  size_t n = 0;
  for (size_t t = 0; t < (size_t)m->triangle_count; t++) {
    if (c->dropped[t]) continue;
    for (size_t k = 0; k < 3; k++) m->triangle[3 * n + k] = kept[m->triangle[3 * t + k]];
    if (m->material) memmove(m->material + 6 * n, m->material + 6 * t, 6 * sizeof *m->material);
    n++;
  }
  m->triangle_count = (int)n;
}

static cloth_status run_checks(check *c, int *kept, cloth_error *err)
{
  CLOTH_TRY(check_positions(c, err));
  CLOTH_TRY(check_indices(c, err));
  CLOTH_TRY(drop_zero_area(c, err));
  CLOTH_TRY(drop_duplicates(c, err));
  if (c->is_cloth) CLOTH_TRY(check_edges(c, err));
  if (c->is_cloth && c->mesh->material) CLOTH_TRY(check_material(c, err));
  CLOTH_TRY(drop_unreferenced(c, kept, err));
  compact_triangles(c, kept);
  if (c->mesh->triangle_count == 0)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': no triangle has an area", c->name);
  return CLOTH_OK;
}

cloth_status cloth_mesh_check(const char *name, bool is_cloth, bool repair, cloth_mesh *mesh,
                              int *kept, cloth_mesh_repairs *repairs, cloth_error *err)
{
  *repairs = (cloth_mesh_repairs){0};
  check c = {name, is_cloth, repair, mesh, NULL, repairs};
  c.dropped = calloc((size_t)mesh->triangle_count + 1, sizeof *c.dropped);
  if (c.dropped == NULL)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "'%s': no memory to check the mesh", name);
  cloth_status status = run_checks(&c, kept, err);
  free(c.dropped);
  return status;
}
