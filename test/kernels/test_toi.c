// Tests of kernels/physics/toi.h, toi_close.h and toi_signs.h. An answer may be early, never late.
// Oracles: exact truth of the query sets of Wang et al. 2021 where ../shared/data (or
// $CLOTH_SHARED_DATA) has them, and for random motion the roots of the cubic at which the four
// points share a plane, in long double.
#include "check.h"
#include "derivative.h"
#include "toi.h"

typedef long double real_t;

enum { VERTEX_FACE = 1, EDGE_EDGE = 2 }; // how many points the first feature has

typedef struct query {
  cloth_v3 t0[4], t1[4];
} query;

// -1 if there is no impact
static double find(const query *q, int type, double gap, double share)
{
  cloth_real toi = -1;
  int hit = type == VERTEX_FACE
                ? cloth_toi_vertex_face(q->t0, q->t1, (cloth_real)gap, (cloth_real)share, &toi)
                : cloth_toi_edge_edge(q->t0, q->t1, (cloth_real)gap, (cloth_real)share, &toi);
  return hit ? (double)toi : -1;
}

// x, y, z of four points at t0, then of the same at t1
static query make(const double c[24])
{
  query q;
  for (int p = 0; p < 8; p++)
    (p < 4 ? q.t0 + p : q.t1 + p - 4)[0] =
        cloth_v3_make((cloth_real)c[3 * p], (cloth_real)c[3 * p + 1], (cloth_real)c[3 * p + 2]);
  return q;
}

static double distance_at(const query *q, int type, double t)
{
  cloth_v3 x[4];
  cloth_real w[3];
  for (int p = 0; p < 4; p++)
    x[p] = cloth_v3_add_scaled(q->t0[p], (cloth_real)t, cloth_v3_sub(q->t1[p], q->t0[p]));
  cloth_real sq = type == VERTEX_FACE
                      ? cloth_distance_vertex_face_sq(x[0], x[1], x[2], x[3], w)
                      : cloth_distance_edge_edge_sq(x[0], x[1], x[2], x[3], w, w + 1);
  return sqrt((double)sq);
}

// the rounding that toi.h allows for when coordinates and their differences are below `size`
static double rounding(double size) { return 68 * size * (double)CLOTH_REAL_EPSILON; }

static int known_impacts_are_met_in_time(void)
{
  // a vertex falls from 1 to -1 on a face at 0; an edge on an edge; both at t = 1/2
  query fall = make(
      (double[24]){.2, .2, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, .2, .2, -1, 0, 0, 0, 1, 0, 0, 0, 1, 0});
  query cross = make(
      (double[24]){-1, 0, 1, 1, 0, 1, 0, -1, 0, 0, 1, 0, -1, 0, -1, 1, 0, -1, 0, -1, 0, 0, 1, 0});
  CHECK_NEAR(find(&fall, VERTEX_FACE, 0, 0), 0.5, rounding(2) * 2);
  CHECK_NEAR(find(&cross, EDGE_EDGE, 0, 0), 0.5, rounding(2) * 2);
  CHECK(find(&fall, VERTEX_FACE, 0, 0) <= 0.5 && find(&cross, EDGE_EDGE, 0, 0) <= 0.5);
  // just reached at the end
  query end = fall;
  end.t1[0].z = 0;
  CHECK_NEAR(find(&end, VERTEX_FACE, 0, 0), 1, rounding(2) * 2);
  // beside the face; past the end of the edge
  fall.t0[0].x = fall.t1[0].x = (cloth_real)-0.01;
  CHECK(find(&fall, VERTEX_FACE, 0, 0) < 0);
  for (int p = 0; p < 2; p++) cross.t0[p].y += (cloth_real)1.01, cross.t1[p].y += (cloth_real)1.01;
  CHECK(find(&cross, EDGE_EDGE, 0, 0) < 0);
  return 0;
}

static int contact_at_the_start_has_toi_zero(void)
{
  query rest = make(
      (double[24]){.2, .2, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, .2, .2, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0});
  query edges = make(
      (double[24]){-1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, -1, 0, 1, 1, 0, 1, 0, -1, 0, 0, 1, 0});
  CHECK_NEAR(find(&rest, VERTEX_FACE, 0, 0), 0, 0);
  CHECK_NEAR(find(&edges, EDGE_EDGE, 0, 0), 0, 0);
  CHECK_NEAR(find(&rest, VERTEX_FACE, 0.1, 0.5), 0, 0);
  return 0;
}

static int not_a_number_is_an_impact(void)
{
  for (int c = 0; c < 24; c++) {
    double x[24] = {.2, .2, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, .2, .2, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    x[c] = NAN;
    query q = make(x);
    CHECK_NEAR(find(&q, VERTEX_FACE, 0, 0), 0, 0);
    CHECK_NEAR(find(&q, EDGE_EDGE, 0.1, 0.1), 0, 0);
  }
  return 0;
}

#ifndef CLOTH_SINGLE_PRECISION
// what passes at 1e-17 of the size of things is told from what touches
static int near_misses_are_no_impacts_in_double(void)
{
  double small = ldexp(1, -56);
  query slide = make((double[24]){-1, .2, small, 0, 0, 0, 1, 0, 0, 0, 1, 0,
                                  2,  .3, small, 0, 0, 0, 1, 0, 0, 0, 1, 0});
  CHECK(find(&slide, VERTEX_FACE, 0, 0) < 0);
  slide.t0[0].z = -small; // through it now
  CHECK(find(&slide, VERTEX_FACE, 0, 0) >= 0);
  // a vertex passes the corner of a face; two edges pass end to end, and nearly parallel
  query corner = make((double[24]){-small, -small, 1,  0, 0, 0, 1, 0, 0, 0, 1, 0,
                                   -small, -small, -1, 0, 0, 0, 1, 0, 0, 0, 1, 0});
  CHECK(find(&corner, VERTEX_FACE, 0, 0) < 0);
  query ends = make((double[24]){-1, 0, 1,  -small, 0, 1,  0, 0, 0, 0, 1, 0,
                                 -1, 0, -1, -small, 0, -1, 0, 0, 0, 0, 1, 0});
  CHECK(find(&ends, EDGE_EDGE, 0, 0) < 0);
  query parallel = make((double[24]){0, small, 1,  1, small, 1,  0, 0, 0, 1, 0, 0,
                                     0, small, -1, 1, small, -1, 0, 0, 0, 1, 0, 0});
  CHECK(find(&parallel, EDGE_EDGE, 0, 0) < 0);
  parallel.t0[0].y = parallel.t0[1].y = 0;
  parallel.t1[0].y = parallel.t1[1].y = 0;
  CHECK(find(&parallel, EDGE_EDGE, 0, 0) >= 0);
  return 0;
}

// Edges that roll over a corner, or faces that turn about it, some 1e-9 away: planes come on in
// steps that shrink for hundreds. Truth from exact arithmetic.
static int what_turns_about_a_corner_is_told_from_what_meets_it_in_double(void)
{
  const double apart[][25] = {
      {2, 0, 1, 1, 0, 1.000000001, -2, -2, 1, -2, 1, 1, -2, 0, 2, 1, 0, 0, -1, -1, 2, 2, 2, -1, 1},
      {2, 2.00000001, 3, -3, 3, -4, 0, 2, -3, 3, 3, 0, -4, -1, 2, 1, 0, 4, -4, 3, 1, -3, -3, 2, 1},
      {2, 1, 0, 0, 0, 0, 2, -1, 1, 2, -1, -1, -2, -2, 2, 1e-6, 1, -2, 2, 1, -1, 0, 1, 2, 2},
      {1, -1, 2, -1, -2, -2, 1, 0, 0, 2, 2, 1, -2, 0, -1, 0, 0, 0, -1, 2, -1.99999999, 2, -1, 1, 0},
  };
  const struct {
    double x[25], time;
  } meet[] = {
      {{2, 1e-9, 1, -2, 2, 0, -1, 2, 0, -2, 0, 1, -2, -2, 0, 0, 0, 1, 0, 1, 2, 2, 0, -1, 0},
       0.46666666665215417},
      {{2,  0, 2, -2, -1.999999999, 0, 1,  2, 1, -1, -2, -1, -1, 2, -1, 0,
        -1, 0, 2, 0,  -1,           2, -1, 2, -2},
       0.7015621196207685},
      {{1, -2, 2.000000001, -1, -2, -1, 1, 1, -2, 1, -2, 2, 1,
        1, 0,  -1,          -2, -1, 2,  2, 2, 2,  1, 0,  -2},
       0.8017837260028543},
  };
  for (size_t k = 0; k < sizeof apart / sizeof apart[0]; k++) {
    query q = make(apart[k] + 1);
    CHECK(find(&q, (int)apart[k][0], 0, 0) < 0);
  }
  for (size_t k = 0; k < sizeof meet / sizeof meet[0]; k++) {
    query q = make(meet[k].x + 1);
    double toi = find(&q, (int)meet[k].x[0], 0, 0);
    CHECK(toi <= meet[k].time && toi > meet[k].time - 1e-8);
  }
  // they would meet 3e-17 of a step after its end
  query late = make((double[24]){
      -0.14834694595047454,  1.0646565962424617,     0.2577329182719498,   0.6715528258332044,
      0.6039042921745124,    -1.3528411322298288,    0.5789527703569186,   0.1081496142408418,
      1.3979358473005945,    -0.0053420263905450405, 0.5016943525959408,   0.13163925023044443,
      -0.054180994161880325, 0.13505678790771228,    0.47432267889881474,  0.03495874163836388,
      -0.2197850300567319,   -0.8451036374843921,    -0.08389423942862839, 0.2533373938958603,
      0.9141314510265504,    0.9009814153829809,     -0.05587055472851565, -0.5614663547699252});
  CHECK(find(&late, VERTEX_FACE, 0, 0) < 0);
  return 0;
}
#endif

static void position(const query *q, real_t t, real_t x[4][3])
{
  for (int p = 0; p < 4; p++) {
    const real_t a[3] = {q->t0[p].x, q->t0[p].y, q->t0[p].z},
                 b[3] = {q->t1[p].x, q->t1[p].y, q->t1[p].z};
    for (int c = 0; c < 3; c++) x[p][c] = a[c] + t * (b[c] - a[c]);
  }
}

// six times the volume of the tetrahedron
static real_t volume(const query *q, real_t t)
{
  real_t x[4][3], e[3][3];
  position(q, t, x);
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) e[k][c] = x[k + 1][c] - x[0][c];
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
         e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

// With the points in one plane: how far inside they meet, in shares of the features; negative is
// outside. Solves d = s u + t v in the plane by the largest minor.
static real_t inside(const query *q, int type, real_t time)
{
  real_t x[4][3], u[3], v[3], d[3], det = 0, s = 0, t = 0;
  position(q, time, x);
  for (int c = 0; c < 3; c++) {
    u[c] = type == VERTEX_FACE ? x[2][c] - x[1][c] : x[1][c] - x[0][c];
    v[c] = type == VERTEX_FACE ? x[3][c] - x[1][c] : x[2][c] - x[3][c];
    d[c] = type == VERTEX_FACE ? x[0][c] - x[1][c] : x[2][c] - x[0][c];
  }
  for (int c = 0; c < 3; c++) {
    int a = (c + 1) % 3, b = (c + 2) % 3;
    real_t minor = u[a] * v[b] - u[b] * v[a];
    if (fabsl(minor) <= fabsl(det)) continue;
    det = minor, s = (d[a] * v[b] - d[b] * v[a]) / det, t = (u[a] * d[b] - u[b] * d[a]) / det;
  }
  real_t least = fminl(s, t);
  return type == VERTEX_FACE ? fminl(least, 1 - s - t) : fminl(least, fminl(1 - s, 1 - t));
}

// First impact, 2 for none, -1 where it is too close to call for this method: a root or a border
// within 1e-9. The volume is cubic in t; a fine scan finds its roots, and where it comes near zero
// without one between two samples it is too close as well.
static real_t first_impact(const query *q, int type)
{
  enum { SAMPLES = 400 };
  real_t before = volume(q, 0);
  if (fabsl(before) < 1e-5L) return -1;
  for (int k = 1; k <= SAMPLES; k++) {
    real_t lo = (real_t)(k - 1) / SAMPLES, hi = (real_t)k / SAMPLES, after = volume(q, hi);
    if (fabsl(after) < 1e-5L) return -1; // second derivative below 20, so no double root hides
    if ((before > 0) != (after > 0)) {
      for (int n = 0; n < 70; n++) {
        real_t middle = (lo + hi) / 2;
        if ((volume(q, middle) > 0) == (before > 0))
          lo = middle;
        else
          hi = middle;
      }
      real_t depth = inside(q, type, lo);
      if (fabsl(depth) < 1e-9L) return -1;
      if (depth > 0) return lo;
    }
    before = after;
  }
  return 2;
}

static query random_query(int number)
{
  double c[24], move[3] = {test_random(), test_random(), test_random()};
  double far = number % 5 == 0 ? 100 : 0; // common motion of everything
  double turn = number % 3 == 0 ? 0.1 : 1;
  for (int k = 0; k < 12; k++) {
    c[k] = test_random();
    c[12 + k] = c[k] + turn * test_random() + (k < 3 ? move[k % 3] : 0);
    if (number % 7 == 0) c[k] = c[12 + k] - 2 * (c[12 + k] - c[k]);
    c[12 + k] += far * move[k % 3];
  }
  return make(c);
}

static int random_impacts_are_neither_missed_nor_late(void)
{
  int contacts[3] = {0}, extra = 0, known = 0, early = 0;
  for (int k = 0; k < 6000; k++) {
    int type = 1 + k % 2;
    query q = random_query(k);
    real_t truth = first_impact(&q, type);
    double toi = find(&q, type, 0, 0);
    CHECK(toi <= 1);
    if (truth < 0) continue;
    known++;
    if (truth > 1) {
      extra += toi >= 0;
      continue;
    }
    contacts[type]++;
    CHECK(toi >= 0);
    CHECK((real_t)toi <= truth);
    // and no earlier than rounding asks: by then they are all but touching
    double near = distance_at(&q, type, toi), asked = 4 * rounding(k % 5 == 0 ? 100 : 4);
    early += near > asked;
    CHECK(near <= asked + 1e-7);
  }
  CHECK(early * 50 <= contacts[1] + contacts[2]); // few run out of iterations
  CHECK(known > 4000 && contacts[1] > 100 && contacts[2] > 100);
  CHECK(extra <= (sizeof(cloth_real) == 8 ? 0 : known / 50));
  return 0;
}

// until toi, and through the whole step where there is no impact, the distance stays above the
// level
static int clearance_is_kept_until_the_impact(void)
{
  int hits = 0;
  for (int k = 0; k < 3000; k++) {
    int type = 1 + k % 2;
    query q = random_query(k);
    double gap = k % 3 ? 0.05 : 1e3, share = 0.25, near = rounding(k % 5 == 0 ? 100 : 4);
    double start = distance_at(&q, type, 0), level = fmin(gap, share * start),
           toi = find(&q, type, gap, share);
    if (start > 8 * near) CHECK(toi != 0); // what is apart can move
    double end = toi < 0 ? 1 : toi;
    for (int n = 0; n <= 100; n++) CHECK(distance_at(&q, type, end * n / 100) >= level - near);
    if (toi < 0) continue;
    hits++;
    if (start > 8 * near) CHECK(distance_at(&q, type, toi) <= level * 1.1 + 4 * near);
  }
  CHECK(hits > 300);
  return 0;
}

// Points within 2 um of each other, or 5 cm away from those, in the first feature or the second,
// that turn as one but for `stray` [m].
static query random_needles(int number, double stray)
{
  double c[24], axis[3] = {test_random(), test_random(), test_random()};
  double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  double angle = test_random(), go = 0.01 * test_random();
  for (int p = 0; p < 4; p++) {
    double x[3], cross[3], along = 0, size = p != number % 4 && (p + number / 4) % 2 ? 0.05 : 2e-6;
    for (int k = 0; k < 3; k++) x[k] = size * test_random();
    for (int k = 0; k < 3; k++) axis[k] /= p == 0 ? length : 1, along += axis[k] * x[k];
    for (int k = 0; k < 3; k++)
      cross[k] = axis[(k + 1) % 3] * x[(k + 2) % 3] - axis[(k + 2) % 3] * x[(k + 1) % 3];
    for (int k = 0; k < 3; k++) { // Rodrigues
      c[3 * p + k] = 0.45 + x[k];
      c[12 + 3 * p + k] = 0.45 + go + stray * test_random() + cos(angle) * x[k] +
                          sin(angle) * cross[k] + (1 - cos(angle)) * along * axis[k];
    }
  }
  return make(c);
}

// Points that turn as one by an angle below 1 go through an affine map of which no singular value
// is below cos(1/2) on the straight way: every distance keeps 87 % of what it was, however little
// that is.
static int what_turns_as_one_is_no_impact(void)
{
  int count = 0, extra = 0;
  for (int n = 0; n < 20000; n++) {
    int type = 1 + n % 2;
    query q = random_needles(n / 2, 0);
    if (!(distance_at(&q, type, 0) > 5e-7 && distance_at(&q, type, 1) > 5e-7)) continue;
    count++;
    extra += find(&q, type, 1.5e-4, 0.1) >= 0;
  }
  CHECK(count > 5000);
  // in float the turn is that of rounded points, and normals across 5 cm are known to 6 nm
  CHECK(extra <= (sizeof(cloth_real) == 8 ? 0 : count / 200));
  return 0;
}

static int needles_keep_clear_until_the_impact(void)
{
  const double gap = 1.5e-4, share = 0.1, strays[] = {1e-6, 1e-5, 1e-3};
  int hits = 0, count = 4000;
  for (int n = 0; n < count; n++) {
    int type = 1 + n % 2;
    query q = random_needles(n / 2, strays[n % 3]);
    double toi = find(&q, type, gap, share), end = toi < 0 ? 1 : toi;
    double level = fmin(gap, share * distance_at(&q, type, 0)) - rounding(1);
    for (int k = 0; k <= 500; k++) CHECK(distance_at(&q, type, end * k / 500) >= level);
    hits += toi >= 0;
  }
  CHECK(hits > 200 && count - hits > 200);
  return 0;
}

// ---- the shared queries
// ----------------------------------------------------------------------------

typedef struct tally {
  int queries, contacts, missed, extra, late;
} tally;

static void data_path(char path[1024], const char *set, int type, const char *file)
{
  const char *root = getenv("CLOTH_SHARED_DATA"),
             *kind = type == VERTEX_FACE ? "vertex-face" : "edge-edge";
  char here[512];
  snprintf(here, sizeof here, "%s", __FILE__); // <repository>/test/kernels/test_toi.c
  for (int up = 0; up < 3; up++) {
    char *slash = strrchr(here, '/');
    strcpy(slash ? slash : here, slash ? "" : ".");
  }
  if (root)
    snprintf(path, 1024, "%s/ccd/%s/%s/%s", root, set, kind, file);
  else
    snprintf(path, 1024, "%s/../shared/data/ccd/%s/%s/%s", here, set, kind, file);
}

// ends of the exact first contact's bracket, 2 where there is none or it is not known; NULL without
// a file
static double *read_brackets(const char *set, int type, int most)
{
  char path[1024];
  data_path(path, set, type, "toi_0_0.json");
  FILE *file = fopen(path, "r");
  if (!file) return NULL;
  double *hi = malloc((size_t)most * sizeof *hi);
  for (int k = 0; hi && k < most; k++) hi[k] = 2;
  int depth = 0, entry = 0, c;
  while (hi && (c = fgetc(file)) != EOF && entry < most) {
    double value;
    if (c == '[') depth++;
    if (c == ']') depth--;
    if (c == ',' && depth == 1) entry++;
    if (c == ',' && depth == 2 && fscanf(file, "%lf", &value) == 1) hi[entry] = value;
  }
  fclose(file);
  return hi;
}

static int count_file(const char *set, int type, const char *name, const double *bracket,
                      tally *sum)
{
  char path[1024], line[2048];
  data_path(path, set, type, name);
  FILE *file = fopen(path, "r");
  if (!file) return 0;
  double c[24];
  for (int row = 0; fgets(line, sizeof line, file); row = (row + 1) % 8) {
    double v[7];
    char *at = line;
    for (int k = 0; k < 7; k++) v[k] = strtod(at, &at), at += *at == ',';
    for (int k = 0; k < 3; k++) c[3 * row + k] = v[2 * k] / v[2 * k + 1];
    if (row < 7) continue;
    query q = make(c);
    double toi = find(&q, type, 0, 0);
    int truth = v[6] > 0;
    sum->contacts += truth, sum->missed += truth && toi < 0, sum->extra += !truth && toi >= 0;
    // the bracket ends are doubles; in float the coordinates, and with them the time, are rounded
    double slack = sizeof(cloth_real) == 8 ? 1e-15 : 1e-6;
    if (bracket) sum->late += toi > bracket[sum->queries] + slack;
    sum->queries++;
  }
  fclose(file);
  return 1;
}

static int shared_queries_are_never_missed(void)
{
  const char *sets[4] = {"unit-tests", "erleben-spikes", "erleben-cube-cliff-edges", "thick-cloth"};
  tally all = {0};
  for (int s = 0; s < 4; s++) {
    for (int type = 1; type <= 2; type++) {
      tally sum = {0};
      double *bracket = s == 3 ? read_brackets(sets[s], type, 4096) : NULL;
      int found = count_file(sets[s], type, "data_0_0.csv", bracket, &sum);
      count_file(sets[s], type, "data_0_1.csv", NULL, &sum);
      free(bracket);
      if (!found) {
        printf("skip: no queries of %s here; set CLOTH_SHARED_DATA to the folder that has ccd/\n",
               sets[s]);
        continue;
      }
      printf("     %s %s: %d queries, %d contacts, %d missed, %d late, %d extra\n", sets[s],
             type == VERTEX_FACE ? "vertex-face" : "edge-edge", sum.queries, sum.contacts,
             sum.missed, sum.late, sum.extra);
      CHECK(sum.missed == 0 && sum.late == 0);
      all.queries += sum.queries, all.extra += sum.extra;
    }
  }
  // in float two of these sets lie within rounding of contact throughout
  CHECK(sizeof(cloth_real) < 8 || all.extra * 50 <= all.queries);
  return 0;
}

// height of the vertex above the plane of the face, at t0 or t1, from the coordinates as they are
static real_t height(const cloth_v3 x[4])
{
  real_t u[3] = {(real_t)x[2].x - x[1].x, (real_t)x[2].y - x[1].y, (real_t)x[2].z - x[1].z};
  real_t v[3] = {(real_t)x[3].x - x[1].x, (real_t)x[3].y - x[1].y, (real_t)x[3].z - x[1].z};
  real_t d[3] = {(real_t)x[0].x - x[1].x, (real_t)x[0].y - x[1].y, (real_t)x[0].z - x[1].z};
  real_t n[3], nn = 0, above = 0;
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    n[k] = u[i] * v[j] - u[j] * v[i];
    nn += n[k] * n[k], above += n[k] * d[k];
  }
  return above / sqrtl(nn);
}

// A vertex a tenth of a millimetre above a floor of 100 m, which in float is less than what the
// search can tell: it may come as near as it is told, and slide, and not through.
static int what_lies_on_the_floor_of_a_hall_may_move(void)
{
  const double gap = 1e-4, share = 0.1;
  int hits = 0;
  for (int n = 0; n < 4000; n++) {
    double tilt = n % 3 * 0.3, c = cos(tilt), s = sin(tilt), at[24];
    double from = 1.2e-4 + 1e-4 * test_random(), to = from * (0.5 + test_random());
    const double floor[4][3] = {{0.3, -0.2, from}, {-50, -50, 0}, {50, -50, 0}, {50, 50, 0}};
    for (int p = 0; p < 8; p++) {
      const double *x = floor[p % 4];
      double y = x[1] + (p == 4 ? 0.01 * test_random() : 0), z = p == 4 ? to : x[2];
      at[3 * p] = x[0], at[3 * p + 1] = c * y - s * z, at[3 * p + 2] = s * y + c * z;
    }
    query q = make(at);
    real_t start = height(q.t0), end = height(q.t1), level = fminl(gap, share * start);
    double toi = find(&q, VERTEX_FACE, gap, share);
    hits += toi >= 0;
    if ((toi >= 0) != (end <= level)) // not where the level itself is a matter of rounding
      CHECK(toi >= 0 && end < level * 1.07L);
  }
  CHECK(hits > 500 && hits < 3000);
  return 0;
}

// A corner of a face lies all but on a vertex and goes with it; the others swing by a hundred times
// and more of what is between. Nearly nothing changes where they are near.
static int a_face_that_bends_over_a_tip_hardly_ever_meets_it(void)
{
  int apart = 0, extra = 0;
  for (int n = 0; n < 8000; n++) {
    double between = pow(10, -4 - 0.5 * (1 + test_random())), at[24]; // m
    const double face[3][3] = {
        {0, 0, 0}, {0.025, 0, 0.02 * test_random()}, {0, 0.025, 0.02 * test_random()}};
    double aside = 0.5 * between;
    const double tip[3] = {aside * test_random(), aside * test_random(), between};
    for (int p = 0; p < 8; p++)
      for (int c = 0; c < 3; c++) {
        double x = p % 4 ? face[p % 4 - 1][c] : tip[c], swing = 1e-3 * test_random();
        at[3 * p + c] = x + (p % 4 > 1 && p > 4 ? swing : 0) - (p > 3 && c == 2 ? 1e-3 : 0);
      }
    query q = make(at);
    double start = distance_at(&q, VERTEX_FACE, 0), least = start;
    for (int k = 1; k <= 200; k++) least = fmin(least, distance_at(&q, VERTEX_FACE, k / 200.0));
    if (!(least > 0.3 * start)) continue;
    apart++;
    extra += find(&q, VERTEX_FACE, 1.5e-4, 0.1) >= 0;
  }
  printf("  %d apart, %d of them taken for impacts\n", apart, extra);
  CHECK(apart > 1000 && 1000 * extra < apart);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(known_impacts_are_met_in_time);
  RUN(contact_at_the_start_has_toi_zero);
  RUN(not_a_number_is_an_impact);
#ifndef CLOTH_SINGLE_PRECISION
  RUN(near_misses_are_no_impacts_in_double);
  RUN(what_turns_about_a_corner_is_told_from_what_meets_it_in_double);
#endif
  RUN(random_impacts_are_neither_missed_nor_late);
  RUN(clearance_is_kept_until_the_impact);
  RUN(what_turns_as_one_is_no_impact);
  RUN(needles_keep_clear_until_the_impact);
  RUN(what_lies_on_the_floor_of_a_hall_may_move);
  RUN(a_face_that_bends_over_a_tip_hardly_ever_meets_it);
  RUN(shared_queries_are_never_missed);
  return failures != 0;
}
