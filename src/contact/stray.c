// Which side is the right one? Where cloth intersects, the edges that are pierced cut it into
// groups of vertices that are still joined; the largest is taken to be where it belongs (for cloth
// in bodies: the largest outside), and what lies beyond one cut, two cuts and so on has strayed,
// and has to come back through what cut it (flood fill: D. Baraff, A. Witkin, M. Kass, Untangling
// cloth, 2003). Contours that cut nothing off are left to contour.c; where they are in a body, its
// own front tells its outside. Integers from sorted lists alone, so no thread and no part shows in
// it.
#include "contact/stray.h"

#include "triangle_cross.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

// ---- memory -------------------------------------------------------------------------------------

static cloth_status take_scratch(cloth_sim *sim, cloth_error *err)
{
  cloth_tangle_list *t = &sim->tangles;
  size_t n = (size_t)sim->vertex_count + 1;
  if (t->cut != NULL) return CLOTH_OK;
  int **list[] = {&t->mark, &t->group, &t->depth, &t->size, &t->inside, &t->body, &t->exit};
  for (int i = 0; i < 7; i++) {
    free(*list[i]); // of an attempt that failed
    *list[i] = malloc(sizeof(int) * n);
    if (*list[i] == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%zu vertices", n);
  }
  t->cut = calloc((size_t)sim->edge_count + 1, sizeof(int));
  if (t->cut == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d edges", sim->edge_count);
  return CLOTH_OK;
}

cloth_status cloth_pull_add(cloth_sim *sim, int type, int vertex, int face, cloth_error *err)
{
  cloth_tangle_list *t = &sim->tangles;
  if (t->pull_count == t->pull_capacity) {
    int capacity = t->pull_capacity ? 2 * t->pull_capacity : 256;
    uint64_t *pull = realloc(t->pull, sizeof *pull * (size_t)capacity);
    if (pull == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d pulls", capacity);
    t->pull = pull, t->pull_capacity = capacity;
  }
  t->pull[t->pull_count++] = cloth_pair_pack(sim->format, type, vertex, face);
  return CLOTH_OK;
}

static int compare_keys(const void *a, const void *b)
{
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return x < y ? -1 : x > y;
}

static void sort_pulls(cloth_tangle_list *t)
{
  int unique = 0;
  if (t->pull_count == 0) return;
  qsort(t->pull, (size_t)t->pull_count, sizeof *t->pull, compare_keys);
  for (int i = 0; i < t->pull_count; i++)
    if (i == 0 || t->pull[i] != t->pull[i - 1]) t->pull[unique++] = t->pull[i];
  t->pull_count = unique;
}

// ---- a pair, seen from one of its triangles -----------------------------------------------------

int cloth_roles_of(const cloth_sim *sim, const cloth_tangle *tangle, cloth_role out[2])
{
  cloth_pair p = cloth_pair_unpack(sim->format, tangle->key);
  uint32_t how = tangle->how;
  bool body = p.b >= sim->triangle_count;
  out[0] = (cloth_role){p.a, p.b, body ? cloth_body_of_triangle(sim, p.b) : -1, {0, 0, 0}, 0};
  out[1] = (cloth_role){p.b, p.a, -1, {0, 0, 0}, 0};
  out[0].pierces = how >> CLOTH_CROSS_EDGE_A & 7, out[1].pierces = how >> CLOTH_CROSS_EDGE_B & 7;
  for (int k = 0; k < 3; k++) {
    out[0].side[k] = how >> (CLOTH_CROSS_SIDE_A + 2 * k) & 3;
    out[1].side[k] = how >> (CLOTH_CROSS_SIDE_B + 2 * k) & 3;
  }
  return body ? 1 : 2;
}

// ---- groups -------------------------------------------------------------------------------------

static int root(int *group, int v)
{
  while (group[v] != v) v = group[v] = group[group[v]];
  return v;
}

int cloth_group_of(const cloth_sim *sim, int vertex) { return root(sim->tangles.group, vertex); }

// join what is joined by edges that nothing pierces (bodies: 1 by bodies, 0 by cloth)
static void join_groups(cloth_sim *sim, bool bodies)
{
  cloth_tangle_list *t = &sim->tangles;
  memset(t->cut, 0, sizeof(int) * (size_t)sim->edge_count);
  memset(t->inside, 0, sizeof(int) * (size_t)sim->vertex_count);
  memset(t->size, 0, sizeof(int) * (size_t)sim->vertex_count);
  for (int i = 0; i < t->count; i++) {
    cloth_role r[2];
    int n = cloth_roles_of(sim, &t->list[i], r);
    for (int k = 0; k < n; k++)
      for (int e = 0; e < 3; e++)
        if ((r[k].body >= 0) == bodies && r[k].pierces >> e & 1)
          t->cut[sim->triangle_edge[3 * r[k].triangle + e]] = bodies ? 1 + r[k].body : -1;
  }
  for (int v = 0; v < sim->vertex_count; v++)
    t->group[v] = v, t->depth[v] = INT_MAX, t->body[v] = t->exit[v] = 0;
  for (int e = 0; e < sim->edge_count; e++) {
    if (t->cut[e]) continue;
    int a = root(t->group, sim->edge[2 * e]), b = root(t->group, sim->edge[2 * e + 1]);
    t->group[a < b ? b : a] = a < b ? a : b;
  }
  for (int v = 0; v < sim->vertex_count; v++) t->size[root(t->group, v)]++;
  for (int i = 0; i < t->count && bodies; i++) {
    cloth_role r[2];
    cloth_roles_of(sim, &t->list[i], r);
    for (int k = 0; k < 3 && r[0].body >= 0; k++) {
      int *in = &t->inside[root(t->group, sim->triangle[3 * r[0].triangle + k])];
      *in += r[0].side[k] == 2 ? 1 : r[0].side[k] == 1 ? -1 : 0;
    }
  }
}

static bool better(const cloth_tangle_list *t, int a, int b)
{
  bool in_a = t->inside[a] > 0, in_b = t->inside[b] > 0;
  if (in_a != in_b) return !in_a;
  return t->size[a] != t->size[b] ? t->size[a] > t->size[b] : a < b;
}

// how many cuts each group lies beyond the best one that it is joined to across cuts
static void find_depths(cloth_sim *sim)
{
  cloth_tangle_list *t = &sim->tangles;
  for (;;) {
    int best = -1;
    for (int e = 0; e < sim->edge_count; e++)
      for (int k = 0; t->cut[e] && k < 2; k++) {
        int g = root(t->group, sim->edge[2 * e + k]);
        if (t->depth[g] == INT_MAX && (best < 0 || better(t, g, best))) best = g;
      }
    if (best < 0) return;
    t->depth[best] = 0;
    for (bool more = true; more;) {
      more = false;
      for (int e = 0; e < sim->edge_count; e++) {
        if (!t->cut[e]) continue;
        int a = root(t->group, sim->edge[2 * e]), b = root(t->group, sim->edge[2 * e + 1]);
        if (t->depth[b] < t->depth[a]) {
          int c = a;
          a = b, b = c;
        }
        if (t->depth[a] == INT_MAX || t->depth[b] <= t->depth[a] + 1) continue;
        t->depth[b] = t->depth[a] + 1, more = true;
      }
    }
  }
}

// each group beyond a cut knows the body that it came through; -1: several
static void find_bodies(cloth_sim *sim)
{
  cloth_tangle_list *t = &sim->tangles;
  for (int e = 0; e < sim->edge_count; e++) {
    if (t->cut[e] <= 0) continue;
    int a = root(t->group, sim->edge[2 * e]), b = root(t->group, sim->edge[2 * e + 1]);
    if (t->depth[a] == t->depth[b]) continue;
    int *body = &t->body[t->depth[a] > t->depth[b] ? a : b];
    *body = *body == 0 || *body == t->cut[e] ? t->cut[e] : -1;
  }
}

static void mark_body(cloth_tangle_list *t, int v, int of)
{
  int now = t->mark[v] >> CLOTH_STRAY_OF;
  if (t->mark[v] & CLOTH_STRAY_BODY && now != of) of = 0; // of several: any
  t->mark[v] = (t->mark[v] & ((1 << CLOTH_STRAY_OF) - 1)) | CLOTH_STRAY_BODY | of << CLOTH_STRAY_OF;
}

// depth of each vertex into t->depth, marks of those beyond a cut
static void spread(cloth_sim *sim, bool bodies)
{
  cloth_tangle_list *t = &sim->tangles;
  for (int v = sim->vertex_count - 1; v >= 0; v--) { // a root is the first of its group: comes last
    int g = root(t->group, v);
    t->depth[v] = t->depth[g] == INT_MAX ? 0 : t->depth[g];
    if (t->depth[v] == 0) continue;
    if (bodies)
      mark_body(t, v, t->body[g] > 0 ? t->body[g] : 0);
    else
      t->mark[v] |= CLOTH_STRAY_CLOTH;
  }
}

// ---- pulls --------------------------------------------------------------------------------------

// corners beyond more cuts than the others go through the face to where those are
static cloth_status pull_back(cloth_sim *sim, const cloth_role *r, cloth_error *err)
{
  const int *v = sim->triangle + 3 * r->triangle, *depth = sim->tangles.depth;
  int least = INT_MAX, side = 0;
  for (int k = 0; k < 3; k++) least = depth[v[k]] < least ? depth[v[k]] : least;
  for (int k = 0; k < 3; k++)
    if (depth[v[k]] == least && side == 0) side = r->side[k];
  for (int k = 0; k < 3; k++) {
    if (depth[v[k]] == least || side == 0 || r->side[k] == side) continue;
    CLOTH_TRY(
        cloth_pull_add(sim, side == 1 ? CLOTH_PULL_FRONT : CLOTH_PULL_BACK, v[k], r->face, err));
  }
  return CLOTH_OK;
}

// no cut tells: out is in front of the body. What only touches is pushed off in any case.
static cloth_status pull_out(cloth_sim *sim, const cloth_role *r, bool let, cloth_error *err)
{
  const int *v = sim->triangle + 3 * r->triangle;
  for (int k = 0; k < 3; k++) {
    if (r->side[k] == 1) continue;
    mark_body(&sim->tangles, v[k], 1 + r->body);
    if (let || r->side[k] == 0)
      CLOTH_TRY(cloth_pull_add(sim, CLOTH_PULL_FRONT, v[k], r->face, err));
  }
  return CLOTH_OK;
}

// two layers in one plane go apart along the normal of the first
static cloth_status pull_flat(cloth_sim *sim, const cloth_role r[2], uint32_t how, cloth_error *err)
{
  bool opposite = how & CLOTH_CROSS_OPPOSITE;
  for (int n = 0; n < 2; n++)
    for (int k = 0; k < 3; k++) {
      int v = sim->triangle[3 * r[n].triangle + k];
      int type = n == 0 && !opposite ? CLOTH_PULL_FRONT : CLOTH_PULL_BACK;
      sim->tangles.mark[v] |= CLOTH_STRAY_CLOTH;
      CLOTH_TRY(cloth_pull_add(sim, type, v, r[n].face, err));
    }
  return CLOTH_OK;
}

// the group beyond the cut of the role's triangle; -1: its depths do not tell
static int group_beyond(const cloth_sim *sim, const cloth_role *r)
{
  const int *v = sim->triangle + 3 * r->triangle, *depth = sim->tangles.depth;
  int deep = 0;
  for (int k = 1; k < 3; k++)
    if (depth[v[k]] > depth[v[deep]]) deep = k;
  bool tells = depth[v[0]] != depth[v[1]] || depth[v[0]] != depth[v[2]];
  return tells ? cloth_group_of(sim, v[deep]) : -1;
}

// how many vertices that group has; 0: there is none
static int beyond(const cloth_sim *sim, const cloth_role *r)
{
  int group = group_beyond(sim, r);
  return group < 0 ? 0 : sim->tangles.size[group];
}

// cloth with cloth: of two pieces that strayed the smaller one goes back
static cloth_status pull_cloth(cloth_sim *sim, const cloth_tangle *tangle, bool let,
                               unsigned char *untold, cloth_error *err)
{
  cloth_role r[2];
  cloth_roles_of(sim, tangle, r);
  int n[2] = {beyond(sim, &r[0]), beyond(sim, &r[1])};
  for (int k = 0; k < 2; k++)
    for (int c = 0; c < 3; c++)
      sim->tangles.mark[sim->triangle[3 * r[k].triangle + c]] |= CLOTH_TANGLED;
  if (tangle->how & CLOTH_CROSS_FLAT) return pull_flat(sim, r, tangle->how, err);
  *untold = n[0] == 0 && n[1] == 0;
  if (*untold || !let) return CLOTH_OK;
  return pull_back(sim, &r[n[0] > 0 && (n[0] <= n[1] || n[1] == 0) ? 0 : 1], err);
}

static cloth_status pull_body(cloth_sim *sim, const cloth_tangle *tangle, bool let,
                              cloth_error *err)
{
  cloth_role r[2];
  cloth_roles_of(sim, tangle, r);
  int group = group_beyond(sim, r);
  if (group < 0) return pull_out(sim, r, let, err);
  return let && !sim->tangles.exit[group] ? pull_back(sim, r, err) : CLOTH_OK;
}

static cloth_status pull_all(cloth_sim *sim, bool bodies, unsigned char *untold, cloth_error *err)
{
  const cloth_tangle_list *t = &sim->tangles;
  bool let = cloth_untangles(sim, bodies);
  memset(untold, 0, (size_t)t->count);
  if (bodies && let) CLOTH_TRY(cloth_exits_pull(sim, err));
  for (int i = 0; i < t->count; i++) {
    bool body = cloth_pair_unpack(sim->format, t->list[i].key).b >= sim->triangle_count;
    if (body != bodies) continue;
    CLOTH_TRY(bodies ? pull_body(sim, &t->list[i], let, err)
                     : pull_cloth(sim, &t->list[i], let, &untold[i], err));
  }
  return bodies ? CLOTH_OK : cloth_contours_pull(sim, untold, let, err);
}

cloth_status cloth_stray_find(cloth_sim *sim, cloth_error *err)
{
  cloth_tangle_list *t = &sim->tangles;
  CLOTH_TRY(take_scratch(sim, err));
  unsigned char *untold = malloc((size_t)t->count + 1);
  if (untold == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d pairs", t->count);
  cloth_status status = CLOTH_OK;
  memset(t->mark, 0, sizeof(int) * (size_t)sim->vertex_count);
  for (int bodies = 0; bodies < 2 && status == CLOTH_OK; bodies++) {
    join_groups(sim, bodies);
    find_depths(sim);
    find_bodies(sim);
    spread(sim, bodies);
    status = pull_all(sim, bodies, untold, err);
  }
  free(untold);
  sort_pulls(t);
  return status;
}
