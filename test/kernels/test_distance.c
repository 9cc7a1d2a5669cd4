// Tests of kernels/physics/distance.h. Oracles, both with 113 bits: the least over every feature
// (corners, feet on edges, the foot on the plane or on the common normal), and, where the features
// are apart, the separating plane through the nearest points, which proves that nothing is nearer.
#include "check.h"
#include "derivative.h"
#include "distance.h"

#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 real_t;
#else
typedef long double real_t; // is as wide where there is no other
#endif
typedef struct point {
  real_t c[3];
} point;

static point minus(point a, point b)
{
  for (int k = 0; k < 3; k++) a.c[k] -= b.c[k];
  return a;
}

static point plus_scaled(point a, real_t s, point b)
{
  for (int k = 0; k < 3; k++) a.c[k] += s * b.c[k];
  return a;
}

static real_t dot(point a, point b) { return a.c[0] * b.c[0] + a.c[1] * b.c[1] + a.c[2] * b.c[2]; }

static real_t length(point a)
{
  real_t sq = dot(a, a), root = (real_t)sqrtl((long double)sq);
  return root > 0 ? (root + sq / root) / 2 : 0;
}

static real_t least(real_t a, real_t b) { return a < b ? a : b; }

static real_t vertex_edge(point v, point a, point b)
{
  point e = minus(b, a), d = minus(v, a);
  real_t ee = dot(e, e), s = ee > 0 ? dot(d, e) / ee : 0;
  real_t best = least(length(d), length(minus(v, b)));
  return s > 0 && s < 1 ? least(best, length(plus_scaled(d, -s, e))) : best;
}

// s, t of the point s e + t f nearest to d, and d without it; 0 where e, f span no plane. The
// normal equations lose digits where e, f are nearly parallel: what is left of d is projected
// again.
static int foot(point e, point f, point *d, real_t *s, real_t *t)
{
  real_t ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), det = ee * ff - ef * ef;
  *s = *t = 0;
  if (!(det > 0)) return 0;
  for (int k = 0; k < 5; k++) {
    real_t de = dot(*d, e), df = dot(*d, f);
    real_t ds = (de * ff - df * ef) / det, dt = (df * ee - de * ef) / det;
    *d = plus_scaled(plus_scaled(*d, -ds, e), -dt, f);
    *s += ds, *t += dt;
  }
  return 1;
}

static real_t vertex_face(const point x[4])
{
  real_t best = least(vertex_edge(x[0], x[1], x[2]), vertex_edge(x[0], x[2], x[3]));
  best = least(best, vertex_edge(x[0], x[3], x[1]));
  real_t s, t;
  point d = minus(x[0], x[1]);
  if (!foot(minus(x[2], x[1]), minus(x[3], x[1]), &d, &s, &t)) return best;
  return s >= 0 && t >= 0 && s + t <= 1 ? least(best, length(d)) : best;
}

static real_t edge_edge(const point x[4])
{
  real_t best = least(vertex_edge(x[0], x[2], x[3]), vertex_edge(x[1], x[2], x[3]));
  best = least(best, least(vertex_edge(x[2], x[0], x[1]), vertex_edge(x[3], x[0], x[1])));
  real_t s, t;
  point d = minus(x[2], x[0]);
  if (!foot(minus(x[1], x[0]), minus(x[2], x[3]), &d, &s, &t)) return best;
  return s >= 0 && s <= 1 && t >= 0 && t <= 1 ? least(best, length(d)) : best;
}

static cloth_v3 narrow(point p)
{
  return cloth_v3_make((cloth_real)p.c[0], (cloth_real)p.c[1], (cloth_real)p.c[2]);
}

// Four points with coordinates of order 1, as they are in cloth_real: random, then with what makes
// closest points hard. `split` is 1 for a vertex and a face, 2 for two edges.
static void hard_points(int number, int split, point x[4])
{
  point u, v;
  for (int p = 0; p < 4; p++)
    for (int c = 0; c < 3; c++) x[p].c[c] = test_random();
  for (int c = 0; c < 3; c++) u.c[c] = test_random(), v.c[c] = test_random();
  real_t small = pow(10, -(double)(number / 8 % 17));
  point along = split == 1 ? minus(x[2], x[1]) : minus(x[1], x[0]);
  switch (number % 8) {
  case 0:
    break;
  case 1: // a sliver; two edges nearly parallel
    x[3] = plus_scaled(plus_scaled(split == 1 ? x[1] : x[2], test_random(), along), small, u);
    break;
  case 2: // near the face or the other edge
    x[0] = plus_scaled(plus_scaled(x[3], (1 + test_random()) / 2, minus(x[2], x[3])), small, u);
    break;
  case 3: // all in one plane, or nearly
    for (int p = 0; p < 4; p++) x[p].c[2] = x[p].c[2] * small + x[p].c[0] / 2;
    break;
  case 4: // all on one line, or nearly
    for (int p = 1; p < 4; p++)
      x[p] = plus_scaled(plus_scaled(x[0], test_random(), v), small, x[p]);
    break;
  case 5: // no extent in one direction, or a needle whose short side is any of the three
    x[3] = x[2];
    if (number % 32 == 13) x[3] = plus_scaled(x[2], small, u);
    if (number % 32 == 21) x[2] = plus_scaled(x[1], small, u);
    if (number % 32 == 29) x[3] = plus_scaled(x[1], small, u);
    if (number % 64 > 32) x[0] = plus_scaled(x[number % 3 + 1], small, v);
    break;
  case 6:
    x[3] = x[2], x[1] = split == 1 ? x[2] : x[0];
    break;
  default:
    x[0] = plus_scaled(x[2], small, u); // near a corner
  }
  for (int p = 0; p < 4; p++)
    for (int c = 0; c < 3; c++) x[p].c[c] = (real_t)(cloth_real)x[p].c[c];
}

// coordinates reach 3: each difference, product and sum below rounds quantities of that size
static const double rounding = 32 * CLOTH_REAL_EPSILON;

// the weights w of the four points give points of the features, as far apart as was said, and no
// two points are nearer
static int check_nearest(const point x[4], int split, const cloth_real w[4], cloth_real distance_sq,
                         real_t oracle)
{
  point p = {{0}}, q = {{0}};
  real_t sum_p = 0, sum_q = 0;
  for (int k = 0; k < 4; k++) {
    CHECK(w[k] >= 0 && w[k] <= 1);
    if (k < split) p = plus_scaled(p, w[k], x[k]), sum_p += w[k];
    if (k >= split) q = plus_scaled(q, w[k], x[k]), sum_q += w[k];
  }
  point d = minus(q, p);
  CHECK_NEAR((double)sum_p, 1, rounding);
  CHECK_NEAR((double)sum_q, 1, rounding);
  CHECK_NEAR(sqrt((double)distance_sq), (double)oracle, rounding);
  CHECK_NEAR((double)length(d), (double)oracle, rounding);

  // an error of eps in the points turns the plane by eps / distance, more where a face is a sliver
  if ((double)oracle < 0.01) return 0;
  for (int i = 0; i < split; i++)
    for (int j = split; j < 4; j++)
      CHECK((double)(dot(d, minus(x[j], x[i])) / length(d)) >= (double)oracle - 300 * rounding);
  return 0;
}

static int vertex_face_is_the_least_over_all_features(void)
{
  for (int k = 0; k < 40000; k++) {
    point x[4];
    cloth_real w[4] = {1, 0, 0, 0};
    hard_points(k, 1, x);
    cloth_real sq = cloth_distance_vertex_face_sq(narrow(x[0]), narrow(x[1]), narrow(x[2]),
                                                  narrow(x[3]), w + 1);
    if (check_nearest(x, 1, w, sq, vertex_face(x))) return 1;
  }
  return 0;
}

static int edge_edge_is_the_least_over_all_features(void)
{
  for (int k = 0; k < 40000; k++) {
    point x[4];
    cloth_real s, t;
    hard_points(k, 2, x);
    cloth_real sq =
        cloth_distance_edge_edge_sq(narrow(x[0]), narrow(x[1]), narrow(x[2]), narrow(x[3]), &s, &t);
    const cloth_real w[4] = {1 - s, s, 1 - t, t};
    if (check_nearest(x, 2, w, sq, edge_edge(x))) return 1;
  }
  return 0;
}

// the seven regions of a face and what its weights are there
static int vertex_face_regions(void)
{
  cloth_v3 a = cloth_v3_make(0, 0, 0), b = cloth_v3_make(4, 0, 0), c = cloth_v3_make(0, 4, 0);
  const cloth_real cases[7][7] = {
      {1, 1, 2, 4, 0.5f, 0.25f, 0.25f}, {-1, -2, 2, 9, 1, 0, 0},       {6, 0, 0, 4, 0, 1, 0},
      {-1, 5, 1, 3, 0, 0, 1},           {2, -3, 4, 25, 0.5f, 0.5f, 0}, {3, 3, 1, 3, 0, 0.5f, 0.5f},
      {-2, 1, 0, 4, 0.75f, 0, 0.25f}};
  for (int k = 0; k < 7; k++) {
    cloth_real w[3];
    const cloth_real *p = cases[k];
    cloth_real sq = cloth_distance_vertex_face_sq(cloth_v3_make(p[0], p[1], p[2]), a, b, c, w);
    CHECK_NEAR((double)sq, (double)p[3], 16 * rounding);
    for (int i = 0; i < 3; i++) CHECK_NEAR((double)w[i], (double)p[4 + i], rounding);
    for (int i = 0; i < 3; i++) CHECK(p[4 + i] > 0 || w[i] == 0);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(vertex_face_is_the_least_over_all_features);
  RUN(edge_edge_is_the_least_over_all_features);
  RUN(vertex_face_regions);
  return failures != 0;
}
