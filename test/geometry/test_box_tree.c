// Tests of src/geometry/box_tree.c and mesh_impacts.c against all pairs.
#include "check.h"
#include "geometry/box_tree.h"
#include "geometry/impact.h"
#include "geometry/mesh_impacts.h"

#include <stdint.h>

static uint64_t state = 88172645463325252u;

static int below(int n)
{
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return (int)(state % (uint64_t)n);
}

// small whole numbers, so that many boxes touch, are equal, or have no extent
static cloth_box random_box(int range, int size)
{
  cloth_box b;
  for (int k = 0; k < 3; k++) {
    b.min[k] = below(range);
    b.max[k] = b.min[k] + (below(30) ? below(size + 1) : range);
  }
  return b;
}

static int every_overlap_is_found_once(void)
{
  enum { MOST = 700 };
  static cloth_box box[MOST];
  static int seen[MOST];
  const int counts[] = {0, 1, 2, 4, 5, 8, 9, 63, 64, 65, MOST};
  cloth_error err = {0};
  for (size_t n = 0; n < sizeof counts / sizeof counts[0]; n++) {
    int count = counts[n];
    cloth_box_tree tree;
    for (int i = 0; i < count; i++) box[i] = n % 4 == 3 ? random_box(1, 0) : random_box(40, 3);
    CHECK_OK(cloth_box_tree_make(box, count, &tree, &err), err);
    for (int q = 0; q < 100; q++) {
      cloth_box ask = q < count ? box[q] : random_box(40, 3);
      memset(seen, 0, sizeof seen);
      cloth_box_walk walk = cloth_box_walk_start(&tree, &ask);
      for (int i; (i = cloth_box_walk_next(&walk)) >= 0;) seen[i]++;
      for (int i = 0; i < count; i++) {
        int overlap = 1;
        for (int k = 0; k < 3; k++)
          overlap = overlap && fmax(ask.min[k], box[i].min[k]) <= fmin(ask.max[k], box[i].max[k]);
        CHECK(seen[i] == overlap);
      }
    }
    cloth_box_tree_free(&tree);
  }
  return 0;
}

// ---- a step of a mesh --------------------------------------------------------------------------

enum { VERTICES = 40, TRIANGLES = 60 };

typedef struct step {
  double x[2][3 * VERTICES];
  int triangle[3 * TRIANGLES];
  int edge[3 * TRIANGLES][2], edges;
} step;

static void list_edges(step *s)
{
  s->edges = 0;
  for (int a = 0; a < VERTICES; a++)
    for (int b = a + 1; b < VERTICES; b++) {
      int there = 0;
      for (int t = 0; t < 3 * TRIANGLES; t++) {
        int p = s->triangle[t], q = s->triangle[t % 3 == 2 ? t - 2 : t + 1];
        there = there || (p == a && q == b) || (p == b && q == a);
      }
      if (there) s->edge[s->edges][0] = a, s->edge[s->edges++][1] = b;
    }
}

// any three vertices are a triangle: repeated, without area, many on an edge. The last vertex has
// none.
static void random_step(step *s, int range)
{
  for (int t = 0; t < 3 * TRIANGLES; t++) s->triangle[t] = below(VERTICES - 1);
  for (int i = 0; i < 3 * VERTICES; i++) {
    s->x[0][i] = below(range);
    s->x[1][i] = s->x[0][i] + below(5) - 2 + (below(2) ? 0.1 * below(10) : 0);
  }
  list_edges(s);
}

static int boxes_overlap(const step *s, const int *p, int np, const int *q, int nq, double inflate)
{
  for (int k = 0; k < 3; k++) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int side = 0; side < 2; side++)
      for (int i = 0; i < (side ? nq : np); i++)
        for (int t = 0; t < 2; t++) {
          double at = s->x[t][3 * (side ? q : p)[i] + k];
          low[side] = fmin(low[side], at - inflate), high[side] = fmax(high[side], at + inflate);
        }
    if (low[0] > high[1] || low[1] > high[0]) return 0;
  }
  return 1;
}

static int share(const int *p, int np, const int *q, int nq)
{
  for (int i = 0; i < np; i++)
    for (int j = 0; j < nq; j++)
      if (p[i] == q[j]) return 1;
  return 0;
}

static void test(const step *s, cloth_impact_kind kind, const int *p, const int *q, int *hits,
                 double *first)
{
  double x[8][3];
  int v[4] = {p[0], kind == CLOTH_IMPACT_EDGE_EDGE ? p[1] : q[0], 0, 0};
  for (int k = (int)kind; k < 4; k++) v[k] = q[k - (int)kind];
  for (int k = 0; k < 8; k++) memcpy(x[k], s->x[k / 4] + 3 * v[k % 4], sizeof x[k]);
  cloth_impact_result r = cloth_impact_test(kind, CLOTH_IMPACT_DOUBLE, (const double(*)[3])x);
  *hits += r.hit;
  if (r.hit) *first = fmin(*first, r.toi);
}

static int a_mesh_step_has_the_pairs_of_brute_force(void)
{
  cloth_error err = {0};
  for (int n = 0; n < 12; n++) {
    static step s;
    random_step(&s, 4 << n % 4);
    double inflate = n % 3 * 0.35, first[2] = {2, 2};
    int64_t candidates[2] = {0, 0};
    int hits[2] = {0, 0};
    for (int i = 0; i < s.edges; i++)
      for (int j = i + 1; j < s.edges; j++) {
        if (share(s.edge[i], 2, s.edge[j], 2)) continue;
        if (!boxes_overlap(&s, s.edge[i], 2, s.edge[j], 2, inflate)) continue;
        candidates[0]++;
        test(&s, CLOTH_IMPACT_EDGE_EDGE, s.edge[i], s.edge[j], &hits[0], &first[0]);
      }
    for (int v = 0; v < VERTICES; v++)
      for (int t = 0; t < TRIANGLES; t++) {
        const int *face = s.triangle + 3 * t;
        if (share(&v, 1, face, 3) || !boxes_overlap(&s, &v, 1, face, 3, inflate)) continue;
        candidates[1]++;
        test(&s, CLOTH_IMPACT_VERTEX_FACE, &v, face, &hits[1], &first[1]);
      }
    cloth_mesh_view view = {VERTICES, TRIANGLES, s.x[0], s.triangle, NULL};
    for (int precision = 0; precision < 2; precision++) {
      cloth_mesh_impacts r;
      CHECK_OK(cloth_mesh_impacts_find(&view, s.x[1], inflate, (cloth_impact_precision)precision,
                                       &r, &err),
               err);
      CHECK(r.edges == s.edges && r.unreferenced >= 1);
      for (int k = 0; k < 2; k++) {
        CHECK(r.candidates[k] == candidates[k] && r.colliding[k] == hits[k]);
        CHECK(candidates[k] > 0);
        // in float the time is rounded down to float
        CHECK_NEAR(r.first[k], first[k], precision ? 1e-7 : 0);
        CHECK(r.first[k] <= first[k]);
      }
    }
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(every_overlap_is_found_once);
  RUN(a_mesh_step_has_the_pairs_of_brute_force);
  return failures != 0;
}
