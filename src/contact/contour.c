// Where a contour cuts nothing off (it ends inside one of the two sheets), the nearer border tells:
// of the vertices on both sides of the contour each one goes with the side from which fewer edges
// lead to it, and the smaller of the two crowds is taken to have strayed.
#include "contact/stray.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

// an edge that pierces a face, and the pair and role in which it was found
typedef struct pierce {
  int edge, face, tangle, role;
} pierce;

typedef struct contours {
  int n; // of pierces
  pierce *pierce;
  int *parent; // [2 tangles] union-find over roles; the role of a triangle in a pair is 2 pair +
               // role
  int *vertex; // [vertices] 2 contour + side of the nearest contour; -1: none yet
  int *far;    // [vertices] edges from it
  int *crowd;  // [4 tangles] vertices that go with 2 contour + side
} contours;

static int compare(const void *pa, const void *pb)
{
  const pierce *a = pa, *b = pb;
  const int ka[4] = {a->edge, a->face, a->tangle, a->role};
  const int kb[4] = {b->edge, b->face, b->tangle, b->role};
  for (int k = 0; k < 4; k++)
    if (ka[k] != kb[k]) return ka[k] < kb[k] ? -1 : 1;
  return 0;
}

static int root(int *parent, int c)
{
  while (parent[c] != c) c = parent[c] = parent[parent[c]];
  return c;
}

static void join(int *parent, int a, int b)
{
  a = root(parent, a), b = root(parent, b);
  parent[a < b ? b : a] = a < b ? a : b;
}

// the contour goes on where an edge pierces: in both triangles at that edge, and in the face
static void join_roles(const cloth_sim *sim, contours *c, const unsigned char *untold)
{
  const cloth_tangle_list *t = &sim->tangles;
  c->n = 0;
  for (int i = 0; i < t->count; i++) {
    cloth_role r[2];
    int n = cloth_roles_of(sim, &t->list[i], r);
    for (int k = 0; k < n && untold[i]; k++)
      for (int e = 0; e < 3; e++)
        if (r[k].pierces >> e & 1)
          c->pierce[c->n++] = (pierce){sim->triangle_edge[3 * r[k].triangle + e], r[k].face, i, k};
  }
  qsort(c->pierce, (size_t)c->n, sizeof *c->pierce, compare);
  for (int i = 0; i < 2 * t->count; i++) c->parent[i] = i;
  for (int i = 1; i < c->n; i++) {
    const pierce *p = &c->pierce[i - 1], *q = &c->pierce[i];
    if (p->edge != q->edge || p->face != q->face) continue;
    join(c->parent, 2 * p->tangle + p->role, 2 * q->tangle + q->role);
    join(c->parent, 2 * p->tangle + !p->role, 2 * q->tangle + !q->role);
  }
}

// the ends of the edges that pierce, each with its contour and side
static void seed(const cloth_sim *sim, contours *c)
{
  for (int v = 0; v < sim->vertex_count; v++) c->vertex[v] = -1, c->far[v] = INT_MAX;
  for (int i = 0; i < c->n; i++) {
    const pierce *p = &c->pierce[i];
    cloth_role r[2];
    cloth_roles_of(sim, &sim->tangles.list[p->tangle], r);
    int contour = root(c->parent, 2 * p->tangle + p->role);
    for (int k = 0; k < 3; k++) {
      int v = sim->triangle[3 * r[p->role].triangle + k], side = r[p->role].side[k];
      if (v != sim->edge[2 * p->edge] && v != sim->edge[2 * p->edge + 1]) continue;
      if (side == 0 || c->vertex[v] >= 0) continue;
      c->vertex[v] = 2 * contour + side - 1, c->far[v] = 0;
    }
  }
}

static void spread(const cloth_sim *sim, contours *c)
{
  bool more = true;
  for (int far = 0; more; far++) {
    more = false;
    for (int e = 0; e < sim->edge_count; e++) {
      if (sim->tangles.cut[e]) continue;
      for (int k = 0; k < 2; k++) {
        int a = sim->edge[2 * e + k], b = sim->edge[2 * e + !k];
        if (c->far[a] != far || c->far[b] <= far + 1) continue;
        c->far[b] = far + 1, c->vertex[b] = c->vertex[a], more = true;
      }
    }
  }
}

// the side of a contour that has fewer vertices: 1 front, 2 behind; *size: how many
static int smaller_side(contours *c, int role, int *size)
{
  int contour = root(c->parent, role), *n = c->crowd + 2 * contour;
  *size = n[0] <= n[1] ? n[0] : n[1];
  return n[0] <= n[1] ? 1 : 2;
}

static cloth_status pull(cloth_sim *sim, contours *c, int tangle, bool let, cloth_error *err)
{
  cloth_role r[2];
  int size[2], side[2];
  cloth_roles_of(sim, &sim->tangles.list[tangle], r);
  for (int k = 0; k < 2; k++) side[k] = smaller_side(c, 2 * tangle + k, &size[k]);
  int k = size[0] > 0 && (size[0] <= size[1] || size[1] == 0) ? 0 : 1, stray = side[k];
  int label = 2 * root(c->parent, 2 * tangle + k) + stray - 1;
  for (int i = 0; i < 3; i++) {
    int v = sim->triangle[3 * r[k].triangle + i];
    if (r[k].side[i] != stray || c->vertex[v] != label) continue;
    sim->tangles.mark[v] |= CLOTH_STRAY_CLOTH;
    if (let)
      CLOTH_TRY(
          cloth_pull_add(sim, stray == 1 ? CLOTH_PULL_BACK : CLOTH_PULL_FRONT, v, r[k].face, err));
  }
  return CLOTH_OK;
}

cloth_status cloth_contours_pull(cloth_sim *sim, const unsigned char *untold, bool let,
                                 cloth_error *err)
{
  const size_t n = (size_t)sim->tangles.count, v = (size_t)sim->vertex_count;
  contours c = {0,
                malloc(sizeof(pierce) * (6 * n + 1)),
                malloc(sizeof(int) * (2 * n + 1)),
                malloc(sizeof(int) * (v + 1)),
                malloc(sizeof(int) * (v + 1)),
                calloc(4 * n + 1, sizeof(int))};
  cloth_status status = CLOTH_OK;
  if (!c.pierce || !c.parent || !c.vertex || !c.far || !c.crowd) {
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "contours of %zu pairs", n);
    goto done;
  }
  join_roles(sim, &c, untold);
  seed(sim, &c);
  spread(sim, &c);
  for (int i = 0; i < sim->vertex_count; i++)
    if (c.vertex[i] >= 0) c.crowd[c.vertex[i]]++;
  for (int i = 0; i < sim->tangles.count; i++)
    if (untold[i]) CLOTH_TRY_GOTO(pull(sim, &c, i, let, err), status, done);
done:
  free(c.pierce), free(c.parent), free(c.vertex), free(c.far), free(c.crowd);
  return status;
}
