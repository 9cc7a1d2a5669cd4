// The way out of a convex body. Cloth that a box appeared in pierces its sides; through these it
// would have to be gathered up into itself, and cloth that is held taut around the box does not. So
// a group of vertices beyond a cut leaves through that face of the body behind which it, and what
// it hangs on across the cut, is the least deep: then the plane of that face parts cloth and body.
// Cloth across the cut may come along only past the body, not through it.
#include "contact/stray.h"

#include <math.h>
#include <stdlib.h>

// a vertex of a group, or one that a cut parts from it
typedef struct member {
  int group, vertex, across;
} member;

// what is known of one body
typedef struct solid {
  int body, first, count; // -1: none yet; its triangles
  bool convex;
  double (*plane)[4]; // [count] unit normal, distance from the origin [m]; zero: no area
  size_t room;
} solid;

static int compare(const void *pa, const void *pb)
{
  const member *a = pa, *b = pb;
  const int ka[3] = {a->group, a->vertex, a->across}, kb[3] = {b->group, b->vertex, b->across};
  for (int k = 0; k < 3; k++)
    if (ka[k] != kb[k]) return ka[k] < kb[k] ? -1 : 1;
  return 0;
}

static bool leaves(const cloth_sim *sim, int v)
{
  const cloth_tangle_list *t = &sim->tangles;
  return t->depth[v] > 0 && t->body[cloth_group_of(sim, v)] > 0;
}

// members of all groups beyond a cut of one body, sorted; [2 edges + vertices] is room enough
static int list_members(const cloth_sim *sim, member *out)
{
  const cloth_tangle_list *t = &sim->tangles;
  int n = 0;
  for (int v = 0; v < sim->vertex_count; v++)
    if (leaves(sim, v)) out[n++] = (member){cloth_group_of(sim, v), v, 0};
  for (int e = 0; e < sim->edge_count; e++)
    for (int k = 0; t->cut[e] && k < 2; k++) {
      int deep = sim->edge[2 * e + k], other = sim->edge[2 * e + 1 - k];
      if (t->depth[deep] > t->depth[other] && leaves(sim, deep))
        out[n++] = (member){cloth_group_of(sim, deep), other, 1};
    }
  qsort(out, (size_t)n, sizeof *out, compare);
  return n;
}

// how far x is behind the plane [m]
static double behind(const double plane[4], const cloth_real *x)
{
  return plane[3] - plane[0] * (double)x[0] - plane[1] * (double)x[1] - plane[2] * (double)x[2];
}

static void plane_of(const cloth_sim *sim, int triangle, double out[4])
{
  const int *v = sim->triangle + 3 * triangle;
  const cloth_real *a = sim->host + 3 * v[0], *b = sim->host + 3 * v[1], *c = sim->host + 3 * v[2];
  double length = 0;
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    out[k] = ((double)b[i] - (double)a[i]) * ((double)c[j] - (double)a[j]) -
             ((double)b[j] - (double)a[j]) * ((double)c[i] - (double)a[i]);
    length += out[k] * out[k];
  }
  length = sqrt(length), out[3] = 0;
  for (int k = 0; k < 3; k++) {
    out[k] = length > 0 ? out[k] / length : 0;
    out[3] += out[k] * (double)a[k];
  }
}

static cloth_status look_at(cloth_sim *sim, int body, solid *s, cloth_error *err)
{
  const cloth_body *b = &sim->body[body];
  if (s->body == body) return CLOTH_OK;
  if (s->room < (size_t)b->triangle_count) {
    void *plane = realloc(s->plane, sizeof *s->plane * (size_t)b->triangle_count);
    if (plane == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d planes", b->triangle_count);
    s->plane = plane, s->room = (size_t)b->triangle_count;
  }
  s->body = body, s->first = b->triangle_first, s->count = b->triangle_count, s->convex = true;
  for (int f = 0; f < s->count; f++) {
    plane_of(sim, s->first + f, s->plane[f]);
    for (int v = 0; v < b->vertex_count && s->convex; v++)
      s->convex = behind(s->plane[f], sim->host + 3 * (b->vertex_first + v)) > -1e-4 * b->radius;
  }
  return CLOTH_OK;
}

// the face that the vertex is most in front of, or least behind
static int face_towards(const solid *s, const cloth_real *x)
{
  int face = 0;
  for (int f = 1; f < s->count; f++)
    if (behind(s->plane[f], x) < behind(s->plane[face], x)) face = f;
  return face;
}

// How deep the deepest of n members is behind face f; infinite if one across the cut would have to
// go through the body.
static double depth_behind(const cloth_sim *sim, const solid *s, const member *m,
                           const int *towards, int n, int f)
{
  const double *p = s->plane[f];
  double most = 0;
  for (int i = 0; i < n; i++) {
    double depth = behind(p, sim->host + 3 * m[i].vertex);
    const double *q = s->plane[towards[i]];
    if (!(depth > most)) continue;
    if (m[i].across && p[0] * q[0] + p[1] * q[1] + p[2] * q[2] < -0.1) return INFINITY;
    most = depth;
  }
  return most;
}

// the face through which n members of one group leave, or -1
static int choose(const cloth_sim *sim, const solid *s, const member *m, int n, int *towards)
{
  double least = INFINITY;
  int face = -1;
  for (int i = 0; i < n; i++) towards[i] = face_towards(s, sim->host + 3 * m[i].vertex);
  for (int f = 0; f < s->count; f++) {
    if (s->plane[f][0] == 0 && s->plane[f][1] == 0 && s->plane[f][2] == 0) continue;
    double depth = depth_behind(sim, s, m, towards, n, f);
    if (depth < least) least = depth, face = f;
  }
  return face;
}

static cloth_status pull_group(cloth_sim *sim, solid *s, const member *m, int n, int *towards,
                               cloth_error *err)
{
  cloth_tangle_list *t = &sim->tangles;
  CLOTH_TRY(look_at(sim, t->body[m[0].group] - 1, s, err));
  int face = s->convex ? choose(sim, s, m, n, towards) : -1;
  if (face < 0) return CLOTH_OK;
  t->exit[m[0].group] = 1;
  for (int i = 0; i < n; i++)
    if (behind(s->plane[face], sim->host + 3 * m[i].vertex) > -sim->params.thickness)
      CLOTH_TRY(cloth_pull_add(sim, CLOTH_PULL_FRONT, m[i].vertex, s->first + face, err));
  return CLOTH_OK;
}

static cloth_status pull_groups(cloth_sim *sim, member *m, int *towards, cloth_error *err)
{
  solid s = {.body = -1};
  cloth_status status = CLOTH_OK;
  int n = list_members(sim, m);
  for (int i = 0, end; i < n && status == CLOTH_OK; i = end) {
    for (end = i + 1; end < n && m[end].group == m[i].group;) end++;
    status = pull_group(sim, &s, m + i, end - i, towards, err);
  }
  free(s.plane);
  return status;
}

cloth_status cloth_exits_pull(cloth_sim *sim, cloth_error *err)
{
  size_t n = (size_t)sim->vertex_count + 2 * (size_t)sim->edge_count,
         reals = 3 * (size_t)sim->all_vertices;
  CLOTH_TRY(cloth_staging(sim, reals, err));
  CLOTH_TRY(sim->backend->read(sim->part[0].device, sim->host, sim->part[0].x_t0,
                               sizeof(cloth_real) * reals, err));
  member *m = malloc(sizeof *m * n);
  int *towards = malloc(sizeof *towards * n);
  cloth_status status = m && towards
                            ? pull_groups(sim, m, towards, err)
                            : cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "exits");
  free(m), free(towards);
  return status;
}
