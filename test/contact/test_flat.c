// Culling of flat patches against brute force: of all pairs of features of sheets that are bent,
// spun, squeezed, folded, torn, slit or full of holes, none is lost that comes as near as the
// distance it keeps, at the start, on its way or ahead of where it starts; and flat cloth has no
// pairs left. Several parts, which each judge what their own pairs need, find what one finds.
#include "contact/contact.h"
#include "contact/pairs.h"
#include "contact_find.h"
#include "solve/sim.h"

enum { N = 17, MOST = 2000000 };
#define SIDE 0.16 // m, so 1 cm a quad

static sheet cloth;
static uint64_t found[MOST];

// ---- meshes: how the sheet is at rest ----------------------------------------------------------

typedef enum kind { WHOLE, UNEVEN, SLIT, HOLE, KINDS } kind;

// a slot one quad wide
static void cut_hole(sheet *s)
{
  int n = 0;
  for (int t = 0; t < s->triangles; t++) {
    double c[2] = {0, 0};
    for (int k = 0; k < 6; k++) c[k % 2] += s->x[3 * s->triangle[3 * t + k / 2] + k % 2] / 3;
    if (c[0] > 0 && c[0] < SIDE / (N - 1) && fabs(c[1]) < SIDE / 5) continue;
    memmove(s->triangle + 3 * n++, s->triangle + 3 * t, sizeof(int) * 3);
  }
  s->triangles = n;
}

// two halves side by side that share no vertex: their borders at x = 0 coincide
static void make_slit(sheet *s)
{
  sheet_make(s, SIDE / 2, SIDE, (N + 1) / 2, N);
  int n = s->columns * s->rows, t = s->triangles;
  for (int v = 0; v < n; v++) {
    memcpy(s->x + 3 * (n + v), s->x + 3 * v, sizeof(double) * 3);
    s->x[3 * v] -= SIDE / 4, s->x[3 * (n + v)] += SIDE / 4;
  }
  for (int i = 0; i < 3 * t; i++) s->triangle[3 * t + i] = s->triangle[i] + n;
  s->rows *= 2, s->triangles *= 2;
}

static void make_sheet(kind k)
{
  sheet_make(&cloth, SIDE, SIDE, N, N);
  uint32_t seed = 5;
  if (k == SLIT) make_slit(&cloth);
  for (int v = 0; k == UNEVEN && v < N * N; v++) {
    bool inside = v % N > 0 && v % N < N - 1 && v / N > 0 && v / N < N - 1;
    for (int d = 0; d < 2 && inside; d++) cloth.x[3 * v + d] += 0.003 * roll_real(&seed);
  }
  if (k == HOLE) cut_hole(&cloth);
}

// ---- motions: where a point at rest is ---------------------------------------------------------

typedef struct motion {
  const char *name;
  void (*at)(const double u[3], double t, double size, double x[3]); // t: 0 start, 1 end, 2 flight
  double size;
  bool flat; // nothing may be left
} motion;

static void rigid(const double u[3], double t, double size, double x[3])
{
  double a = size * t, c = cos(a), s = sin(a);
  x[0] = c * u[0] + 0.03 * t, x[1] = u[1] - 0.02 * t, x[2] = s * u[0] + 0.05 * t;
}

static void rolled(const double u[3], double t, double size, double x[3])
{
  double r = size * (1 + 0.1 * t);
  x[0] = r * sin(u[0] / r), x[1] = u[1], x[2] = r * cos(u[0] / r) + 0.02 * t;
}

static void waved(const double u[3], double t, double size, double x[3])
{
  x[0] = 0.7 * u[0], x[1] = u[1] + 0.1 * t * u[0];
  x[2] = size * sin(180 * u[0] + 0.5 * t) * (1 - 0.2 * t);
}

static void squeezed(const double u[3], double t, double size, double x[3])
{
  double s = 1 - (1 - size) * (t > 0);
  x[0] = s * u[0], x[1] = s * u[1], x[2] = 0;
}

static void sheared(const double u[3], double t, double size, double x[3])
{
  x[0] = u[0] + size * t * u[1], x[1] = u[1], x[2] = 0.01 * t;
}

static void folded(const double u[3], double t, double size, double x[3])
{
  double a = u[0] > 0 ? size * t : 0;
  x[0] = u[0] * cos(a), x[1] = u[1], x[2] = u[0] * sin(a);
}

// the half at x > 0 slides over the other: every triangle stays as it was at rest
static void slid(const double u[3], double t, double size, double x[3])
{
  x[0] = u[0] - (u[0] > 0 ? size * t : 0), x[1] = u[1], x[2] = u[0] > 0 ? 0.001 * t : 0;
}

static const motion motions[] = {
    {"lies", rigid, 0, true},
    {"spins a little", rigid, 0.15, true},
    {"spins", rigid, 1.3, false},
    {"spins round", rigid, 3.1, false},
    {"hangs in a wide bow", rolled, 0.5, true},
    {"is rolled", rolled, 0.03, false},
    {"is rolled tight", rolled, 0.008, false},
    {"waves", waved, 0.004, false},
    {"is crumpled", waved, 0.02, false},
    {"is squeezed", squeezed, 0.6, false},
    {"is squeezed hard", squeezed, 0.2, false},
    {"is turned over", squeezed, -1, false},
    {"is sheared", sheared, 0.4, false},
    {"is sheared far", sheared, 2, false},
    {"is folded", folded, 3.1, false},
    {"is half folded", folded, 1, false},
    {"slides over itself", slid, 0.012, false},
};
enum { MOTIONS = sizeof motions / sizeof *motions };

static void place(cloth_sim *sim, const motion *m, double jitter)
{
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    cloth_real *to[3] = {part->x_t0, part->x, part->x_pred};
    uint32_t seed = 9;
    for (int v = 0; v < sim->vertex_count; v++)
      for (int t = 0; t < 3; t++) {
        double u[3], x[3];
        memcpy(u, sim->rest + 3 * v, sizeof u);
        m->at(u, t == 2 ? 1.1 : t, m->size, x);
        for (int k = 0; k < 3; k++)
          to[t][3 * v + k] = (cloth_real)(x[k] + jitter * roll_real(&seed));
      }
    memset(part->v, 0, sizeof(cloth_real) * 3 * (size_t)sim->vertex_count);
  }
}

// ---- brute force --------------------------------------------------------------------------------

static int compare(const void *a, const void *b)
{
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return x < y ? -1 : x > y;
}

static int search(cloth_sim *sim)
{
  static cloth_step_report report;
  cloth_error err = {0};
  sim->report = &report;
  must(cloth_pairs_search(sim, &err), &err);
  const cloth_part *p = &sim->part[0];
  if (p->pair_count > MOST) abort();
  if (p->pair_count == 0) return 0; // there may be no list yet
  memcpy(found, p->pair, sizeof *found * (size_t)p->pair_count);
  qsort(found, (size_t)p->pair_count, sizeof *found, compare);
  return p->pair_count;
}

// does the pair come as near as it keeps, at the start, on the straight way or ahead?
static bool comes_near(const cloth_contact_scene *s, uint64_t key)
{
  cloth_contact_geometry g;
  cloth_pair_vertices(s, key, &g);
  if (!cloth_pair_near(s, &g, s->thickness)) return false; // not asked for
  cloth_real way[12];
  cloth_contact_measure(s->x_t0, &g);
  cloth_real keeps = cloth_contact_thickness(s, &g);
  cloth_real ahead = g.distance + cloth_v3_dot(g.normal, cloth_contact_motion(&g, s->x_t0, s->x));
  cloth_real flight = g.distance + cloth_v3_dot(g.normal, cloth_contact_flight(s, &g));
  if (g.proper && (g.distance < keeps || ahead < keeps || flight < keeps)) return true;
  cloth_contact_geometry along = g;
  for (int k = 0; k < 4; k++) along.vertex[k] = k;
  for (int n = 0; n <= 8; n++) {
    for (int k = 0; k < 12; k++) {
      int at = 3 * g.vertex[k / 3] + k % 3;
      way[k] = s->x_t0[at] + (cloth_real)n / 8 * (s->x[at] - s->x_t0[at]);
    }
    cloth_contact_measure(way, &along);
    if (along.distance < keeps) return true;
  }
  return false;
}

static bool shares(const int *a, int na, const int *b, int nb)
{
  for (int i = 0; i < na * nb; i++)
    if (a[i / nb] == b[i % nb]) return true;
  return false;
}

// pairs that come near and were not found
static int count_lost(const cloth_sim *sim, int n, int *near)
{
  cloth_contact_scene s = cloth_contact_scene_of(sim, &sim->part[0]);
  int lost = 0;
  *near = 0;
  for (int type = 0; type < 2; type++) {
    int na = type ? sim->edge_count : sim->vertex_count;
    int nb = type ? sim->edge_count : sim->triangle_count;
    for (int a = 0; a < na; a++)
      for (int b = type ? a + 1 : 0; b < nb; b++) {
        const int *va = type ? sim->edge + 2 * a : &a;
        const int *vb = type ? sim->edge + 2 * b : sim->triangle + 3 * b;
        if (shares(va, 1 + type, vb, 3 - type)) continue;
        uint64_t key = cloth_pair_pack(s.format, type, a, b);
        if (!comes_near(&s, key)) continue;
        ++*near;
        lost += bsearch(&key, found, (size_t)n, sizeof key, compare) == NULL;
      }
  }
  return lost;
}

static const char *devices = "cpu";

static cloth_sim *sim_of(cloth_def **def, const char *culling)
{
  *def = def_new(PRECISION);
  def_set(*def, "devices", devices);
  def_set(*def, "threads", "2");
  def_set(*def, "flat_culling", culling);
  def_cloth(*def, "sheet", &cloth, cloth_material_default(), pose_turned(0.3, -0.2, 0.5, 1, 0.7));
  cloth_sim *sim = sim_new(*def);
  // motions start from the sheet in its own plane
  for (int v = 0; v < sim->vertex_count; v++)
    memcpy(sim->rest + 3 * v, cloth.x + 3 * sim->order[v], sizeof(double) * 3);
  sim->h = 1.0 / 60;
  return sim;
}

static int check_motion(kind k, const motion *m, double jitter, int *culled)
{
  cloth_def *def;
  int count[2], near = 0;
  for (int on = 0; on < 2; on++) {
    cloth_sim *sim = sim_of(&def, on ? "on" : "off");
    place(sim, m, jitter);
    count[on] = search(sim);
    int lost = on ? count_lost(sim, count[on], &near) : 0;
    if (lost > 0) printf("  sheet %d that %s: %d of %d pairs lost\n", k, m->name, lost, near);
    CHECK(lost == 0);
    cloth_sim_free(sim), cloth_def_free(def);
  }
  CHECK(count[1] <= count[0]);
  if (k <= UNEVEN && m->flat && count[1] > 0)
    printf("  sheet %d that %s: %d of %d pairs left\n", k, m->name, count[1], count[0]);
  CHECK(!(k <= UNEVEN && m->flat) || count[1] == 0);
  *culled += count[0] - count[1];
  return 0;
}

static int no_pair_that_comes_near_is_lost(void)
{
  for (int k = 0; k < KINDS; k++) {
    int culled = 0;
    make_sheet((kind)k);
    for (int m = 0; m < MOTIONS; m++)
      if (check_motion((kind)k, &motions[m], 0, &culled)) return 1;
    CHECK(culled > 1000); // else nothing was tested
  }
  return 0;
}

static int nor_with_every_vertex_shaken(void)
{
  int culled = 0;
  make_sheet(WHOLE);
  for (int m = 0; m < MOTIONS; m++)
    for (int n = 1; n <= 2; n++) {
      motion shaken = motions[m];
      shaken.flat = false;
      if (check_motion(WHOLE, &shaken, 0.0004 * n * n, &culled)) return 1;
    }
  CHECK(culled > 1000);
  return 0;
}

static int cloth_that_bends_is_searched_again(void)
{
  cloth_def *def;
  cloth_error err = {0};
  bool escaped;
  make_sheet(WHOLE);
  cloth_sim *sim = sim_of(&def, "on");
  sim->params.pair_slack = 1; // no vertex leaves its region
  place(sim, &motions[0], 0);
  CHECK(search(sim) == 0);
  CHECK_OK(cloth_pairs_escaped(sim, &escaped, &err), err);
  CHECK(!escaped);
  const motion fold = {"is folded", folded, 3.1, false};
  place(sim, &fold, 0);
  CHECK_OK(cloth_pairs_escaped(sim, &escaped, &err), err);
  CHECK(escaped);
  CHECK(search(sim) > 100);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// ---- several parts ------------------------------------------------------------------------------

// the pairs of all parts, each once, into `found`
static int search_all(cloth_sim *sim)
{
  int n = 0, unique = 0;
  search(sim);
  for (int p = 0; p < sim->part_count; p++) {
    const cloth_part *part = &sim->part[p];
    if (n + part->pair_count > MOST) abort();
    if (part->pair_count == 0) continue; // there may be no list yet
    memcpy(found + n, part->pair, sizeof *found * (size_t)part->pair_count);
    n += part->pair_count;
  }
  qsort(found, (size_t)n, sizeof *found, compare);
  for (int i = 0; i < n; i++)
    if (unique == 0 || found[i] != found[unique - 1]) found[unique++] = found[i];
  return unique;
}

static uint64_t digest(int n)
{
  uint64_t h = 14695981039346656037u; // FNV-1a
  for (int i = 0; i < n; i++) h = (h ^ found[i]) * 1099511628211u;
  return h;
}

// the pairs at `from`, and whether `to` asks for another search
typedef struct answer {
  int count;
  uint64_t pairs;
  bool escaped;
} answer;

static answer ask(const char *parts, const motion *from, const motion *to)
{
  cloth_def *def;
  cloth_error err = {0};
  answer a;
  devices = parts;
  cloth_sim *sim = sim_of(&def, "on");
  devices = "cpu";
  sim->params.pair_slack = 0.002;
  place(sim, from, 0.0002);
  a.count = search_all(sim), a.pairs = digest(a.count);
  sim->params.pair_slack = 1; // else a vertex leaves its region
  search(sim);
  place(sim, to, 0.0002);
  must(cloth_pairs_escaped(sim, &a.escaped, &err), &err);
  cloth_sim_free(sim), cloth_def_free(def);
  return a;
}

static int parts_find_what_one_finds(void)
{
  int escaped = 0, pairs = 0;
  for (int k = 0; k < KINDS; k++) {
    make_sheet((kind)k);
    for (int m = 0; m < MOTIONS; m++) {
      const motion *to = &motions[(m + 1) % MOTIONS];
      answer one = ask("cpu", &motions[m], to), three = ask("cpu, cpu, cpu", &motions[m], to);
      CHECK(three.count == one.count && three.pairs == one.pairs);
      CHECK(three.escaped == one.escaped);
      escaped += one.escaped, pairs += one.count > 0;
    }
  }
  CHECK(pairs > 20 && escaped > 5 && escaped < KINDS * MOTIONS - 5); // else nothing was tested
  return 0;
}

static long elements; // of the kernels on flat patches
static const cloth_backend *below;

static cloth_status count_launch(cloth_device *device, cloth_kernel k, int n, const void *args,
                                 cloth_error *err)
{
  if (k >= CLOTH_KERNEL_flat_triangle && k <= CLOTH_KERNEL_flat_square) elements += n;
  return below->launch(device, k, n, args, err);
}

// a long strip, so that its end is farther from the other part than a square is wide
static long work_of(const char *parts)
{
  cloth_def *def;
  devices = parts;
  cloth_sim *sim = sim_of(&def, "on");
  devices = "cpu";
  place(sim, &motions[0], 0);
  below = sim->backend, elements = 0;
  cloth_backend counting = *sim->backend;
  counting.launch = count_launch;
  sim->backend = &counting;
  search(sim);
  sim->backend = below;
  cloth_sim_free(sim), cloth_def_free(def);
  return elements;
}

static int two_parts_share_the_work(void)
{
  sheet_make(&cloth, 0.05, 4.1875, 5, 336);
  long one = work_of("cpu"), two = work_of("cpu, cpu");
  if (two > 1.5 * (double)one) printf("  %ld elements on one part, %ld on two\n", one, two);
  CHECK(one > cloth.triangles && two >= one && (double)two < 1.5 * (double)one);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(no_pair_that_comes_near_is_lost);
  RUN(nor_with_every_vertex_shaken);
  RUN(cloth_that_bends_is_searched_again);
  RUN(parts_find_what_one_finds);
  RUN(two_parts_share_the_work);
  return failures > 0;
}
