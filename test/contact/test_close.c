// Close pairs against all candidates: looking at these alone finds the same impacts, at the same
// times, and the same driven pairs, wherever within its bound each vertex ends; where one ends
// farther off, all candidates are looked at. Sheets between the layers of each other, over a floor
// of two triangles and a ball, near the origin and far from it, on one part and on several.
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
} trial;

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
    for (int i = 0; i < 3 * sim->all_vertices; i++) {
      int v = i / 3;
      bool up = i % 3 == 2;
      double at = (double)part->x_t0[i], to = 0;
      if (v < sim->vertex_count) {
        double layer = 1 + v * SHEETS / sim->vertex_count;
        at = up ? layer * t->gap : sim->rest[i];
        at += t->rough * roll_real(&s), to = t->motion * (roll_real(&s) - (up ? 2 : 0));
        part->v[i] = 0;
      }
      part->x_t0[i] = (cloth_real)(at + t->away);
      part->x[i] = (cloth_real)(at + t->away + to);
      if (v < sim->vertex_count) part->x_pred[i] = part->x[i];
      if (v < sim->vertex_count && !up) part->free[v] = v % 5 > 0; // the others are held
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
    trial t = {gap[n % 4] * thick,
               rough[n / 4 % 3] * thick,
               n / 12 % 2 ? 0.3 * thick : 0,
               stray,
               away,
               n / 24 % 2 > 0,
               100 * n};
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
  trial t = {0.9 * sim->params.thickness, 0, 0, 0, 0, false, 1};
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

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(close_pairs_find_what_all_find);
  RUN(a_vertex_that_strays_too_far_has_all_looked_at);
  return failures > 0;
}
