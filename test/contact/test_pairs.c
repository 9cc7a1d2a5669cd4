// The broad phase against brute force: every vertex and face, and every two edges, whose swept
// boxes come within the gap, on crumpled cloth with bodies of large and of small triangles. Each is
// found exactly once, or is proven to be apart; nothing else is found, and the parts together find
// what one finds. What a part has nothing to do with it leaves out.
#include "contact/pairs.h"
#include "solve/sim.h"
#include "vertex_box.h"

enum { N = 11, MOST = 400000 };

static sheet cloth;
static solid table, ball;
static uint64_t brute[MOST], found[MOST];

static cloth_def *def_of(const char *devices)
{
  sheet_make(&cloth, 0.25, 0.25, N, N);
  solid_box(&table, 1, 1, 1); // two triangles a side: far larger than a cloth triangle
  solid_sphere(&ball, 0.06, 24, 12);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", devices);
  def_set(def, "threads", "2");
  def_set(def, "flat_culling", "off"); // test_flat.c is about that
  def_cloth(def, "one", &cloth, cloth_material_default(), pose_at(0, 0, 0.05));
  def_cloth(def, "two", &cloth, cloth_material_default(), pose_turned(0.05, 0, 0.08, 0, 0.3));
  def_body(def, "table", &table, 0.5, pose_turned(0, 0, -0.5, 2, 0.3));
  def_body(def, "ball", &ball, 0.5, pose_at(0, 0, 0.06));
  return def;
}

// fold and jitter: x_t0 in a heap of `size` [m], x up to `motion` [m] from it; no velocity, which
// would only widen the region in which a vertex may stray
static void crumple(cloth_sim *sim, double size, double motion, uint32_t seed)
{
  for (int p = 0; p < sim->part_count; p++) {
    uint32_t s = seed; // the same for every part
    for (int i = 0; i < 3 * sim->vertex_count; i++) {
      double rest = sim->rest[i], at = size * sin(rest / size) + 0.2 * size * roll_real(&s);
      sim->part[p].x_t0[i] = (cloth_real)at, sim->part[p].v[i] = 0;
      sim->part[p].x[i] = (cloth_real)(at + motion * roll_real(&s));
    }
  }
}

static int compare(const void *a, const void *b)
{
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return x < y ? -1 : x > y;
}

// up to which distance the last search had to find pairs, m: free cloth may fall onto a body
static cloth_real gap_of(const cloth_sim *sim, bool with_body)
{
  return (cloth_real)(sim->params.thickness + (with_body ? sim->pairs_reach : 0));
}

static cloth_box box_of(const cloth_sim *sim, const int *vertex, int n)
{
  const cloth_part *p = &sim->part[0];
  cloth_real slack = (cloth_real)sim->params.pair_slack;
  cloth_box out = {{0, 0, 0}, {0, 0, 0}};
  for (int k = 0; k < n; k++) {
    cloth_box b =
        cloth_box_swept(cloth_v3_load(p->x_t0, vertex[k]), cloth_v3_load(p->x, vertex[k]), slack);
    out = k ? cloth_box_union(out, b) : b;
  }
  return out;
}

static bool shares(const int *a, int na, const int *b, int nb)
{
  for (int i = 0; i < na; i++)
    for (int j = 0; j < nb; j++)
      if (a[i] == b[j]) return true;
  return false;
}

// every pair whose boxes come near, sorted
static int brute_force(const cloth_sim *sim)
{
  int n = 0;
  for (int v = 0; v < sim->all_vertices; v++)
    for (int t = 0; t < sim->all_triangles; t++) {
      const int *tri = sim->triangle + 3 * t;
      if (v >= sim->vertex_count && t >= sim->triangle_count) continue; // body with body
      if (shares(&v, 1, tri, 3)) continue;
      bool body = v >= sim->vertex_count || t >= sim->triangle_count;
      if (cloth_box_near(box_of(sim, &v, 1), box_of(sim, tri, 3), gap_of(sim, body)) && n < MOST)
        brute[n++] = cloth_pair_pack(sim->format, CLOTH_VERTEX_FACE, v, t);
    }
  for (int a = 0; a < sim->all_edges; a++) {
    cloth_box box = box_of(sim, sim->edge + 2 * a, 2);
    for (int b = a + 1; b < sim->all_edges; b++) {
      if (a >= sim->edge_count) break; // both of bodies
      if (shares(sim->edge + 2 * a, 2, sim->edge + 2 * b, 2)) continue;
      cloth_real gap = gap_of(sim, b >= sim->edge_count);
      if (cloth_box_near(box, box_of(sim, sim->edge + 2 * b, 2), gap) && n < MOST)
        brute[n++] = cloth_pair_pack(sim->format, CLOTH_EDGE_EDGE, a, b);
    }
  }
  qsort(brute, (size_t)n, sizeof *brute, compare);
  return n;
}

// ---- apart? -------------------------------------------------------------------------------------

// where features may be: the hull of the corners of their vertices' boxes
typedef struct region {
  double point[24][3];
  int count;
} region;

static region region_of(const cloth_sim *sim, const int *vertex, int n)
{
  region r = {.count = 8 * n};
  for (int k = 0; k < n; k++) {
    cloth_box b = box_of(sim, vertex + k, 1);
    const cloth_real *lo = &b.lo.x, *hi = &b.hi.x;
    for (int i = 0; i < 8; i++)
      for (int c = 0; c < 3; c++) r.point[8 * k + i][c] = (double)(i >> c & 1 ? hi[c] : lo[c]);
  }
  return r;
}

static double dot(const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// the point farthest along d
static const double *farthest(const region *r, const double *d)
{
  const double *best = r->point[0];
  for (int i = 1; i < r->count; i++)
    if (dot(d, r->point[i]) > dot(d, best)) best = r->point[i];
  return best;
}

// Is the distance of two hulls above `gap`? A direction proves it in which all of one lies that far
// before the other; such directions are sought where Gilbert's algorithm (1966) looks for the point
// of their difference that is nearest to the origin.
static bool are_apart(const region *a, const region *b, double gap)
{
  double w[3];
  for (int c = 0; c < 3; c++) w[c] = a->point[0][c] - b->point[0][c];
  for (int n = 0; n < 20000; n++) {
    double back[3] = {-w[0], -w[1], -w[2]}, to[3], size_sq = dot(w, w);
    const double *p = farthest(a, back), *q = farthest(b, w);
    for (int c = 0; c < 3; c++) to[c] = p[c] - q[c] - w[c];
    double nearest = size_sq + dot(w, to), along = dot(to, to); // nearest: w . (p - q)
    if (nearest > 0 && nearest * nearest > gap * gap * size_sq) return true;
    if (!(along > 0) || !(size_sq > 0)) return false;
    double share = fmin(1, -dot(w, to) / along);
    if (!(share > 0)) return false;
    for (int c = 0; c < 3; c++) w[c] += share * to[c];
  }
  return false;
}

static bool is_apart(const cloth_sim *sim, uint64_t key)
{
  cloth_pair p = cloth_pair_unpack(sim->format, key);
  bool face = p.type == CLOTH_VERTEX_FACE;
  bool body =
      face ? p.a >= sim->vertex_count || p.b >= sim->triangle_count : p.b >= sim->edge_count;
  double gap = 0.999 * (double)gap_of(sim, body);
  region a = face ? region_of(sim, &p.a, 1) : region_of(sim, sim->edge + 2 * p.a, 2);
  region b =
      face ? region_of(sim, sim->triangle + 3 * p.b, 3) : region_of(sim, sim->edge + 2 * p.b, 2);
  return are_apart(&a, &b, gap);
}

// Those of the m pairs of brute force that are not among the n found: is each of them apart? What
// is found and not of brute force, or not found and not apart, is told.
static bool rest_is_apart(const cloth_sim *sim, int n, int m, const char *what)
{
  for (int i = 0, j = 0; i < m || j < n;) {
    if (i < m && j < n && brute[i] == found[j]) {
      i++, j++;
      continue;
    }
    bool left_out = j >= n || (i < m && brute[i] < found[j]);
    uint64_t key = left_out ? brute[i++] : found[j++];
    if (left_out && is_apart(sim, key)) continue;
    cloth_pair p = cloth_pair_unpack(sim->format, key);
    printf("  %s: %s %d with %d was %s\n", what,
           p.type == CLOTH_VERTEX_FACE ? "vertex-face" : "edge-edge", p.a, p.b,
           left_out ? "missed" : "reported though far");
    return false;
  }
  return true;
}

// ---- the search ---------------------------------------------------------------------------------

// what the parts found together, sorted; a pair on a border may come from several parts
static int search(cloth_sim *sim)
{
  static cloth_step_report report;
  cloth_error err = {0};
  int n = 0;
  sim->report = &report;
  must(cloth_freeze_bodies(sim, &err), &err);
  must(cloth_pairs_search(sim, &err), &err);
  for (int p = 0; p < sim->part_count; p++) {
    const cloth_part *part = &sim->part[p];
    uint64_t *own = found + n;
    if (n + part->pair_count > MOST) abort();
    memcpy(own, part->pair, sizeof *own * (size_t)part->pair_count);
    qsort(own, (size_t)part->pair_count, sizeof *own, compare);
    for (int i = 1; i < part->pair_count; i++)
      if (own[i] == own[i - 1]) return -1; // twice in one part
    n += part->pair_count;
  }
  qsort(found, (size_t)n, sizeof *found, compare);
  int unique = 0;
  for (int i = 0; i < n; i++)
    if (i == 0 || found[i] != found[i - 1]) found[unique++] = found[i];
  return unique;
}

// how many levels larger regions are (vertex_box.h): none, or each vertex's its own
static void set_levels(cloth_sim *sim, uint32_t seed)
{
  for (int p = 0; p < sim->part_count; p++) {
    uint32_t s = seed; // the same for every part
    for (int v = 0; v < sim->all_vertices; v++)
      sim->part[p].vertex_level[v] =
          (unsigned char)(seed == 0 ? 0 : (CLOTH_REGION_LEVELS + 0.99) * fabs(roll_real(&s)));
  }
}

// pairs with a body that would not count if both were cloth
static int farther_than_cloth(const cloth_sim *sim, int n)
{
  int farther = 0;
  for (int i = 0; i < n; i++) {
    cloth_pair p = cloth_pair_unpack(sim->format, found[i]);
    if (p.type != CLOTH_VERTEX_FACE) continue;
    farther += !cloth_box_near(box_of(sim, &p.a, 1), box_of(sim, sim->triangle + 3 * p.b, 3),
                               gap_of(sim, false));
  }
  return farther;
}

static int matches(const char *devices, double size, double motion, uint32_t seed)
{
  cloth_def *def = def_of(devices);
  cloth_sim *sim = sim_new(def);
  sim_step(sim, 1); // once warm, as in use: buffers hold what an earlier search left
  crumple(sim, size, motion, seed);
  set_levels(sim, 0);
  int n = search(sim);
  if (n < 0) printf("  a pair was reported twice by one part\n");
  CHECK(n >= 0);
  int m = brute_force(sim);
  CHECK(m < MOST && m > 100);
  char what[100];
  snprintf(what, sizeof what, "devices %s, size %g, motion %g, seed %u", devices, size, motion,
           seed);
  CHECK(rest_is_apart(sim, n, m, what));
  int faces = 0;
  for (int i = 0; i < n; i++)
    faces += cloth_pair_unpack(sim->format, found[i]).type == CLOTH_VERTEX_FACE;
  CHECK(faces > 50 && faces < n); // both kinds
  CHECK(farther_than_cloth(sim, n) > 0);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int pairs_are_those_of_brute_force(void)
{
  static const double size[] = {0.02, 0.06, 0.15}, motion[] = {0, 0.002, 0.03};
  uint32_t seed = 1;
  for (int s = 0; s < 3; s++)
    for (int m = 0; m < 3; m++)
      if (matches("cpu", size[s], motion[m], seed++)) return 1;
  return 0;
}

static bool is_found(uint64_t key, int n)
{
  return bsearch(&key, found, (size_t)n, sizeof *found, compare) != NULL;
}

// what is found beyond brute force's is of vertices whose region is larger
static int larger_regions_miss_none(void)
{
  cloth_def *def = def_of("cpu,cpu");
  cloth_sim *sim = sim_new(def);
  sim_step(sim, 1);
  crumple(sim, 0.06, 0.002, 79);
  set_levels(sim, 0);
  int plain = search(sim);
  set_levels(sim, 3);
  int n = search(sim), m = brute_force(sim);
  CHECK(plain > 100 && n > plain);
  for (int i = 0; i < m; i++) CHECK(is_found(brute[i], n) || is_apart(sim, brute[i]));
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int parts_together_find_the_pairs_of_one(void)
{
  static const char *const devices[] = {"cpu,cpu", "cpu,cpu,cpu", "cpu,cpu,cpu,cpu"};
  for (int i = 0; i < 3; i++)
    if (matches(devices[i], 0.06, 0.002, 77) || matches(devices[i], 0.15, 0.03, 78)) return 1;
  return 0;
}

// a long strip around a drum, so that its ends meet: the middle has nothing to do with them
static void wind(cloth_sim *sim, double length)
{
  const double r = length / (2 * 3.14159265358979);
  for (int p = 0; p < sim->part_count; p++) {
    uint32_t s = 5;
    for (int v = 0; v < sim->vertex_count; v++) {
      const double *u = sim->rest + 3 * v;
      double at[3] = {u[0], r * sin(u[1] / r), r * cos(u[1] / r) + 0.002 * u[1] / length};
      for (int k = 0; k < 3; k++) {
        sim->part[p].x_t0[3 * v + k] = (cloth_real)at[k], sim->part[p].v[3 * v + k] = 0;
        sim->part[p].x[3 * v + k] = (cloth_real)(at[k] + 0.001 * roll_real(&s));
      }
    }
  }
}

static int ghosts_are_those_that_may_meet(void)
{
  const double length = 4.1875;
  sheet_make(&cloth, 0.05, length, 5, 336);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", "cpu, cpu, cpu");
  def_set(def, "threads", "2");
  def_set(def, "flat_culling", "off");
  def_cloth(def, "strip", &cloth, cloth_material_default(), pose_at(0, 0, 0));
  cloth_sim *sim = sim_new(def);
  wind(sim, length);
  int n = search(sim), m = brute_force(sim), across = 0;
  CHECK(rest_is_apart(sim, n, m, "strip"));
  for (int i = 0; i < n; i++) { // of one end with the other
    cloth_pair pair = cloth_pair_unpack(sim->format, found[i]);
    int t = pair.type == CLOTH_VERTEX_FACE ? pair.b : -1;
    across += t >= 0 && fabs(sim->rest[3 * pair.a + 1] - sim->rest[3 * sim->triangle[3 * t] + 1]) >
                            length / 2;
  }
  CHECK(across > 10);
  int chunks = (sim->triangle_count + 63) / 64, near[3] = {0, 0, 0};
  for (int p = 0; p < 3; p++)
    for (int c = 0; c < chunks; c++) near[p] += sim->part[p].ghost_near[c];
  bool few = 3 * near[0] < 2 * chunks && 3 * near[1] < 2 * chunks && 3 * near[2] < 2 * chunks;
  if (!few) printf("  near: %d, %d, %d of %d chunks\n", near[0], near[1], near[2], chunks);
  CHECK(few && near[0] > chunks / 3);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// Two sheets one above the other, slanted by 45 degrees, where boxes of their triangles overlap up
// to an edge's length: of what lies farther apart than the gap little is left.
static int slanted_layers_are_told_apart_by_planes(void)
{
  cloth_def *def = def_new(PRECISION);
  sheet_make(&cloth, 0.25, 0.25, N, N);
  def_set(def, "flat_culling", "off");
  def_set(def, "thickness", "0.002");
  def_set(def, "pair_slack", "0.0005");
  def_cloth(def, "one", &cloth, cloth_material_default(), pose_turned(0, 0, 0, 0, 0.785398));
  def_cloth(def, "two", &cloth, cloth_material_default(), pose_turned(0, 0, 0.012, 0, 0.785398));
  cloth_sim *sim = sim_new(def);
  for (int i = 0; i < 3 * sim->vertex_count; i++)
    sim->part[0].x[i] = sim->part[0].x_t0[i], sim->part[0].v[i] = 0;
  int n = search(sim), m = brute_force(sim), of[2] = {0, 0};
  CHECK(rest_is_apart(sim, n, m, "layers"));
  for (int k = 0; k < 2; k++) // between the two
    for (int i = 0; i < (k ? m : n); i++) {
      cloth_pair p = cloth_pair_unpack(sim->format, (k ? brute : found)[i]);
      const int *other =
          p.type == CLOTH_VERTEX_FACE ? sim->triangle + 3 * p.b : sim->edge + 2 * p.b;
      int first = p.type == CLOTH_VERTEX_FACE ? p.a : sim->edge[2 * p.a];
      of[k] += (first < sim->cloth_first[1]) != (other[0] < sim->cloth_first[1]);
    }
  if (!(of[1] > 500 && 20 * of[0] < of[1])) printf("  %d of %d pairs are left\n", of[0], of[1]);
  CHECK(of[1] > 500 && 20 * of[0] < of[1]);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(pairs_are_those_of_brute_force);
  RUN(larger_regions_miss_none);
  RUN(slanted_layers_are_told_apart_by_planes);
  RUN(parts_together_find_the_pairs_of_one);
  RUN(ghosts_are_those_that_may_meet);
  return failures > 0;
}
