// Close and watched pairs against all candidates: looking at close pairs alone finds the same
// impacts, at the same times, and the same driven pairs, wherever within its bound each vertex
// ends; looking at watched pairs alone finds the same contacts and close pairs, wherever within its
// bounds each vertex goes in the substeps for which they were chosen. Where one leaves them, all
// candidates are looked at. Sheets between the layers of each other, over a floor of two triangles
// and a ball, near the origin and far from it, on one part and on several.
#include "ccd/impacts.h"
#include "contact/close.h"
#include "solve/sim.h"

enum { N = 9, SHEETS = 3, MOST = 100000 };

static sheet cloth;
static solid floor_box, ball;
static cloth_impact_pair found[MOST];
static uint64_t driven[MOST];

static cloth_def *def_of(const char *devices, double floor_size)
{
  static const char *const name[] = {"one", "two", "three"};
  sheet_make(&cloth, 0.2, 0.2, N, N);
  solid_box(&floor_box, floor_size, floor_size, 1);
  solid_sphere(&ball, 0.04, 12, 6);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", devices);
  def_set(def, "threads", "2");
  def_set(def, "close_pairs_from", "1");
  def_set(def, "flat_culling", "off"); // or squares would be flat no more, and all searched again
  for (int i = 0; i < SHEETS; i++)
    def_cloth(def, name[i], &cloth, cloth_material_default(),
              pose_turned(0, 0, 0.02 + 0.01 * i, 2, 0.2 * i));
  def_body(def, "floor", &floor_box, 0.5, pose_at(0.01, 0.02, -0.5));
  def_body(def, "ball", &ball, 0.5, pose_at(0, 0, 0.08));
  return def;
}

typedef struct trial {
  double gap;    // m, between layers, and of the lowest from the floor
  double rough;  // m, of each layer
  double motion; // m, of the first guess, all alike and each for itself
  double stray;  // m, how far ends are off the guess: up, down, up in turn, or in any direction
  double away;   // m, of the whole scene from the origin
  bool turn;     // towards and away from each other in turn
  uint32_t seed;
  double approach; // m, the second layer goes up in the first guess, the others down
  bool tilted;     // the layers are, and what is said of them: boxes tell less of distances
} trial;

// from the frame of the layers
static void tilt(const trial *t, double v[3])
{
  const double r = sqrt(0.5);
  if (!t->tilted) return;
  double y = r * (v[1] - v[2]), z = r * (v[1] + v[2]), x = r * (v[0] + z);
  v[2] = r * (z - v[0]), v[0] = x, v[1] = y;
}

// The start and the first guess. The scene is moved after the bodies were told where they are.
static void place(cloth_sim *sim, const trial *t)
{
  static cloth_step_report report;
  cloth_error err = {0};
  memset(&report, 0, sizeof report);
  sim->report = &report;
  must(cloth_freeze_bodies(sim, &err), &err);
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    uint32_t s = t->seed;
    for (int v = 0; v < sim->all_vertices; v++) {
      bool moves = v < sim->vertex_count;
      int layer = moves ? v * SHEETS / sim->vertex_count : 0;
      double at[3], to[3] = {0, 0, 0};
      for (int k = 0; k < 3; k++) at[k] = (double)part->x_t0[3 * v + k];
      for (int k = 0; k < 3 && moves; k++) {
        at[k] = (k == 2 ? (1 + layer) * t->gap : sim->rest[3 * v + k]) + t->rough * roll_real(&s);
        to[k] = t->motion * (roll_real(&s) - (k == 2 ? 2 : 0));
      }
      if (moves) to[2] += layer == 1 ? t->approach : -t->approach;
      if (moves) tilt(t, at), tilt(t, to);
      for (int k = 0; k < 3; k++) {
        part->x_t0[3 * v + k] = (cloth_real)(at[k] + t->away);
        part->x[3 * v + k] = (cloth_real)(at[k] + t->away + to[k]);
        if (moves) part->x_pred[3 * v + k] = part->x[3 * v + k], part->v[3 * v + k] = 0;
      }
      if (moves) part->free[v] = v % 5 > 0; // the others are held
    }
  }
  must(cloth_box_update(sim, 0, &err), &err);
  must(cloth_pairs_search(sim, &err), &err);
}

static void end_elsewhere(cloth_sim *sim, const trial *t)
{
  for (int p = 0; p < sim->part_count; p++) {
    uint32_t s = t->seed + 1;
    for (int v = 0; v < sim->vertex_count; v++) {
      int layer = v * SHEETS / sim->vertex_count;
      double off[3] = {0, 0, layer % 2 ? 1 : -1};
      for (int k = 0; k < 3 && !t->turn; k++) off[k] = roll_real(&s);
      tilt(t, off);
      double length = sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
      for (int k = 0; k < 3; k++)
        sim->part[p].x[3 * v + k] += (cloth_real)(0.99 * t->stray * off[k] / length);
    }
  }
}

// -1 where close pairs give another answer than all of them
static int compare_impacts(cloth_sim *sim, int *drives)
{
  cloth_error err = {0};
  must(cloth_impacts_find(sim, false, &err), &err);
  int n = sim->zones.found_count, m = sim->zones.driven_count;
  if (n > MOST || m > MOST) abort();
  if (n > 0) memcpy(found, sim->zones.found, sizeof *found * (size_t)n);
  if (m > 0) memcpy(driven, sim->zones.driven, sizeof *driven * (size_t)m);
  sim->close_covers = false;
  must(cloth_impacts_find(sim, false, &err), &err);
  bool same = n == sim->zones.found_count && m == sim->zones.driven_count;
  for (int i = 0; same && i < n; i++)
    same = found[i].key == sim->zones.found[i].key && found[i].toi == sim->zones.found[i].toi;
  same = same && (m == 0 || memcmp(driven, sim->zones.driven, sizeof *driven * (size_t)m) == 0);
  if (!same)
    printf("  %d impacts and %d driven pairs among close pairs, %d and %d among all\n", n, m,
           sim->zones.found_count, sim->zones.driven_count);
  *drives += m;
  return same ? n : -1;
}

static int trials(const char *devices, double floor_size, double away, int *impacts, int *drives,
                  int *used)
{
  static const double gap[] = {0.2, 0.6, 0.86, 1.2}, rough[] = {0, 0.02, 0.3};
  cloth_error err = {0};
  cloth_def *def = def_of(devices, floor_size);
  cloth_sim *sim = sim_new(def);
  sim_step(sim, 1);
  sim->params.pair_slack = 0.003; // no end leaves the region of its vertex
  sim->h = 1.0 / 2000;
  double thick = sim->params.thickness, stray = cloth_close_stray(sim);
  CHECK_NEAR(stray, 0.4 * thick, 1e-9);
  for (uint32_t n = 0; n < 48; n++) {
    trial t = {.gap = gap[n % 4] * thick,
               .rough = rough[n / 4 % 3] * thick,
               .motion = n / 12 % 2 ? 0.3 * thick : 0,
               .stray = stray,
               .away = away,
               .turn = n / 24 % 2 > 0,
               .tilted = n / 3 % 2 > 0,
               .seed = 100 * n};
    place(sim, &t);
    must(cloth_contact_build_stage(sim, &err), &err);
    if (!sim->close_known) continue; // too many are
    end_elsewhere(sim, &t);
    must(cloth_impacts_cover(sim, &err), &err);
    CHECK(sim->close_covers);
    for (int p = 0; p < sim->part_count; p++)
      CHECK(3 * sim->part[p].close_count <= sim->part[p].pair_count);
    int some = compare_impacts(sim, drives);
    if (some < 0)
      printf("  devices %s, floor %g m, %g m away, trial %u\n", devices, floor_size, away, n);
    CHECK(some >= 0);
    *impacts += some, *used += 1;
  }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int close_pairs_find_what_all_find(void)
{
  static const double size[] = {0.3, 2, 40}, away[] = {0, 1, 30};
  static const char *const devices[] = {"cpu", "cpu,cpu", "cpu,cpu,cpu"};
  int impacts = 0, drives = 0, used = 0;
  for (int i = 0; i < 3; i++)
    if (trials(devices[i], size[i], away[2 - i], &impacts, &drives, &used)) return 1;
  printf("  %d impacts, %d driven pairs in %d trials\n", impacts, drives, used);
  CHECK(impacts > 5000 && drives > 10 && used > 70);
  return 0;
}

static int a_vertex_that_strays_too_far_has_all_looked_at(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu,cpu", 1);
  cloth_sim *sim = sim_new(def);
  sim_step(sim, 1);
  sim->params.pair_slack = 0.005;
  trial t = {.gap = 0.9 * sim->params.thickness, .seed = 1};
  for (int v = 0; v < sim->vertex_count; v += 50) {
    place(sim, &t);
    must(cloth_contact_build_stage(sim, &err), &err);
    must(cloth_impacts_cover(sim, &err), &err);
    CHECK(sim->close_known && sim->close_covers);
    for (int p = 0; p < 2; p++)
      sim->part[p].x[3 * v] += (cloth_real)(1.01 * cloth_close_stray(sim));
    must(cloth_impacts_cover(sim, &err), &err);
    CHECK(sim->close_known && !sim->close_covers);
    int64_t looked = sim->report->pairs_looked;
    must(cloth_impacts_find(sim, false, &err), &err);
    CHECK(sim->report->pairs_looked - looked == sim->report->pairs);
    for (int p = 0; p < 2; p++) sim->part[p].x[3 * v] = (cloth_real)NAN;
    must(cloth_pairs_escaped(sim, &(bool){false}, &err), &err);
    CHECK(!sim->close_covers);
  }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// ---- over several substeps ----------------------------------------------------------------------

static cloth_real from[3 * 4096], way[3 * 4096];

// Start and end of substep n: at the bounds of what watched pairs are chosen for, towards and away
// from each other in turn or anywhere.
static void follow(cloth_sim *sim, const trial *t, int n)
{
  double slack = 0.98 * sim->watch.slack; // float is coarse far away
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    uint32_t s = t->seed + 7 * (uint32_t)n;
    for (int v = 0; v < sim->all_vertices; v++) {
      bool moves = v < sim->vertex_count;
      double off[3] = {0, 0, v * SHEETS / sim->vertex_count % 2 ? 1 : -1}, step[3], far_sq = 0;
      for (int k = 0; k < 3 && !t->turn; k++) off[k] = roll_real(&s) / sqrt(3);
      tilt(t, off);
      for (int k = 0; k < 3; k++) {
        step[k] = t->turn ? off[k] / 2 : roll_real(&s) / sqrt(12);
        far_sq += (off[k] + step[k]) * (off[k] + step[k]);
      }
      for (int k = 0; k < 3; k++) {
        int i = 3 * v + k;
        double at = (double)from[i] + n * (double)way[i], by = moves ? slack : 0;
        part->x_t0[i] = (cloth_real)(at + by * off[k]);
        part->x[i] = (cloth_real)(at + (double)way[i] + by * (off[k] + (far_sq < 1 ? step[k] : 0)));
        if (moves) part->x_pred[i] = (cloth_real)(at + (double)way[i] + by * (off[k] + step[k]));
      }
    }
  }
  sim->time_t0 = n * sim->h;
}

static int gather(const cloth_sim *sim, uint64_t *key)
{
  int n = 0;
  for (int p = 0; p < sim->part_count; p++) {
    int count = sim->part[p].contact_count;
    if (n + count > MOST) abort();
    if (count > 0) memcpy(key + n, sim->part[p].contact, sizeof *key * (size_t)count); // else NULL
    n += count;
  }
  return n;
}

// contacts of one substep among watched pairs and among all, then impacts; -1 if they differ
static int compare_watched(cloth_sim *sim, const trial *t, int *drives)
{
  static uint64_t some[MOST], all[MOST];
  cloth_error err = {0};
  must(cloth_contact_build_stage(sim, &err), &err);
  int n = gather(sim, some);
  bool close = sim->close_known;
  if (close) {
    end_elsewhere(sim, t);
    must(cloth_impacts_cover(sim, &err), &err);
    if (!sim->close_covers || compare_impacts(sim, drives) < 0) return -1;
    for (int p = 0; p < sim->part_count; p++)
      memcpy(sim->part[p].x, sim->part[p].x_guess,
             sizeof(cloth_real) * 3 * (size_t)sim->vertex_count);
  }
  sim->watch.covers = false;
  must(cloth_contact_build_stage(sim, &err), &err);
  int m = gather(sim, all);
  bool same = n == m && memcmp(some, all, sizeof *some * (size_t)n) == 0;
  if (!same) printf("  %d contacts among watched pairs, %d among all\n", n, m);
  return same ? n : -1;
}

// every third of the trials
static int watch(uint32_t third, const char *devices, double floor_size, double away, int counts[3])
{
  static const double gap[] = {1.2, 1.7, 1.8, 1.95, 4.7}, rough[] = {0, 0.3};
  cloth_error err = {0};
  cloth_def *def = def_of(devices, floor_size);
  cloth_sim *sim = sim_new(def);
  sim_step(sim, 1);
  sim->params.pair_slack = 0.015; // no end leaves the region of its vertex
  sim->h = 1.0 / 2000;
  double thick = sim->params.thickness;
  size_t all = sizeof(cloth_real) * 3 * (size_t)sim->all_vertices;
  CHECK(all <= sizeof from);
  for (uint32_t n = third; n < 40; n += 3) {
    trial t = {.gap = gap[n % 5] * thick,
               .rough = rough[n / 5 % 2] * thick,
               .motion = n / 10 % 2 ? 0.1 * thick : 0,
               .stray = cloth_close_stray(sim),
               .away = away,
               .turn = n % 10 < 5,
               .approach = n % 5 == 4 ? 0.25 * thick : 0,
               .tilted = n >= 20,
               .seed = 100 * n};
    sim->time_t0 = 0, sim->watch = (cloth_watch){.lasted = true};
    place(sim, &t);
    must(cloth_pairs_find(sim, &err), &err);
    if (!sim->watch.covers) continue; // too many are
    memcpy(from, sim->part[0].x_t0, all);
    for (int i = 0; i < 3 * sim->all_vertices; i++) way[i] = sim->part[0].x[i] - from[i];
    for (int k = 1; k < 8; k += 3) {
      follow(sim, &t, k);
      must(cloth_pairs_find(sim, &err), &err);
      CHECK(sim->watch.known && sim->watch.covers && sim->watch.used > 0);
      int some = compare_watched(sim, &t, &counts[1]);
      if (some < 0)
        printf("  devices %s, floor %g m, %g m away, trial %u, %d\n", devices, floor_size, away, n,
               k);
      CHECK(some >= 0);
      counts[0] += some, counts[2]++;
    }
  }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int watched_pairs_touch_as_all_do(void)
{
  static const double size[] = {0.3, 2, 40}, away[] = {0, 1, 30};
  static const char *const devices[] = {"cpu", "cpu,cpu", "cpu,cpu,cpu"};
  int counts[3] = {0, 0, 0};
  for (uint32_t i = 0; i < 3; i++)
    if (watch(i, devices[i], size[i], away[2 - i], counts)) return 1;
  printf("  %d contacts in %d substeps\n", counts[0], counts[2]);
  CHECK(counts[0] > 1000 && counts[2] > 60);
  return 0;
}

static int a_vertex_off_its_way_has_pairs_chosen_anew(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu,cpu", 1);
  cloth_sim *sim = sim_new(def);
  sim_step(sim, 1);
  sim->params.pair_slack = 0.01, sim->h = 1.0 / 2000;
  trial t = {.gap = 2 * sim->params.thickness, .turn = true, .seed = 1};
  for (int v = 0; v < sim->vertex_count; v += 50)
    for (int how = 0; how < 5; how++) {
      sim->time_t0 = 0, sim->watch = (cloth_watch){.lasted = true};
      place(sim, &t);
      must(cloth_pairs_find(sim, &err), &err);
      memcpy(from, sim->part[0].x_t0, sizeof(cloth_real) * 3 * (size_t)sim->all_vertices);
      for (int i = 0; i < 3 * sim->all_vertices; i++) way[i] = sim->part[0].x[i] - from[i];
      follow(sim, &t, 1);
      must(cloth_pairs_find(sim, &err), &err);
      CHECK(sim->watch.covers && sim->watch.used == 1);
      double off = 1.01 * sim->watch.slack;
      for (int p = 0; p < 2 && how < 4; p++) {
        cloth_part *part = &sim->part[p];
        double begin = how == 0 ? off : 0, end = how == 1 ? off : how == 2 ? off / 2 : 0;
        cloth_real at = from[3 * v + 2] + way[3 * v + 2], to = at + way[3 * v + 2];
        part->x_t0[3 * v + 2] = at + (cloth_real)begin;
        part->x[3 * v + 2] = to + (cloth_real)(how == 0 ? begin : end);
        part->x_pred[3 * v + 2] = to + (cloth_real)(how == 3 ? off / 2 : how == 0 ? begin : 0);
      }
      if (how == 4) sim->time_t0 = 8 * sim->h; // for which they were not chosen
      must(cloth_pairs_find(sim, &err), &err);
      CHECK(sim->watch.used == 0);
    }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(close_pairs_find_what_all_find);
  RUN(a_vertex_that_strays_too_far_has_all_looked_at);
  RUN(watched_pairs_touch_as_all_do);
  RUN(a_vertex_off_its_way_has_pairs_chosen_anew);
  return failures > 0;
}
