// The failsafe alone, without impact zones: what a body or a hold runs into is taken along, so
// that nothing passes through it, however fast it comes, and whatever the cloth was about to do.
// Judged by edges that pierce faces at any time of the substep, worked out in double (pierce.h).
#include "ccd/impacts.h"
#include "ccd/pierce.h"
#include "solve/sim.h"

enum { N = 9, TIMES = 16 };

static sheet cloth;
static solid body;
static cloth_step_report report;

// a pyramid over a triangle, its point down at the origin
static void solid_spike(solid *s, double radius, double height)
{
  static const int faces[12] = {0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3};
  s->vertices = 4, s->triangles = 4;
  memset(s->x, 0, sizeof(double) * 3);
  for (int k = 0; k < 3; k++) {
    double turn = 2 * acos(-1) * k / 3, *x = s->x + 3 * (1 + k);
    x[0] = radius * cos(turn), x[1] = radius * sin(turn), x[2] = height;
  }
  memcpy(s->triangle, faces, sizeof faces);
}

// sheets below each other, 10 mm apart, the first in z = 0
static cloth_def *def_of(const char *backend, const char *devices, int sheets)
{
  static const char *const name[] = {"one", "two", "three"};
  sheet_make(&cloth, 0.2, 0.2, N, N);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "backend", backend);
  def_set(def, "devices", devices);
  def_set(def, "gravity", "0 0 0");
  def_set(def, "zone_iterations_max", "0");
  for (int i = 0; i < sheets; i++)
    def_cloth(def, name[i], &cloth, cloth_material_default(), pose_at(0, 0, -0.01 * i));
  return def;
}

// Bodies and holds go to their targets in one substep; vertices of free cloth up to `motion` [m],
// neighbours not alike. What the failsafe leaves, or -1: nothing to do.
static int run(cloth_sim *sim, double motion, uint32_t seed)
{
  cloth_error err = {0};
  int impacts, left;
  memset(&report, 0, sizeof report);
  sim->report = &report;
  sim->h = sim->gamma = 1.0 / 60;
  must(cloth_predict_stage(sim, 0, 1, &err), &err);
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    uint32_t s = seed;
    for (int i = 0; i < 3 * sim->vertex_count; i++) {
      double stray = motion * roll_real(&s);
      if (part->free[i / 3] > 0) part->x[i] = part->x_t0[i] + (cloth_real)stray;
    }
  }
  must(cloth_pairs_search(sim, &err), &err);
  must(cloth_ccd_detect(sim, &impacts, &err), &err);
  must(cloth_ccd_resolve(sim, &left, &err), &err);
  return impacts > 0 ? left : -1;
}

static int worst_piercings(const cloth_sim *sim)
{
  int worst = 0;
  for (int k = 1; k <= TIMES; k++) {
    int n = piercings(sim, (double)k / TIMES);
    if (n > worst) worst = n;
  }
  return worst;
}

static bool stays(const cloth_sim *sim, int v)
{
  const cloth_part *p = &sim->part[0];
  return memcmp(p->x + 3 * v, p->x_t0 + 3 * v, 3 * sizeof *p->x) == 0;
}

// ---- sentences ----------------------------------------------------------------------------------

// 0.1 mm above the middle vertex and 30 mm down in one substep
static int a_tip_on_a_vertex_takes_the_cloth_along(void)
{
  for (int sheets = 1; sheets <= 3; sheets++) { // layers behind the first are carried too
    cloth_def *def = def_of("cpu", "cpu", sheets);
    solid_spike(&body, 0.01, 0.1);
    def_body(def, "spike", &body, 0.5, pose_at(0, 0, 1e-4));
    cloth_sim *sim = sim_new(def);
    sim->body[0].target = pose_at(0, 0, -0.03);
    int left = run(sim, 0, 1);
    CHECK(left == 0);
    CHECK(worst_piercings(sim) == 0);
    const cloth_real *x = sim->part[0].x;
    for (int i = 0; i < sheets; i++) { // the middle goes along, the border stays
      int middle = sim->internal[sim->cloth_first[i] + N * N / 2];
      CHECK((double)x[3 * middle + 2] < -0.029 && stays(sim, sim->internal[sim->cloth_first[i]]));
    }
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return 0;
}

// one end of it sweeps through the sheet
static int a_blade_that_turns_takes_the_cloth_along(void)
{
  cloth_def *def = def_of("cpu", "cpu", 2);
  solid_box(&body, 0.16, 0.05, 0.01);
  def_body(def, "blade", &body, 0.5, pose_at(0.01, 0.003, 0.02));
  cloth_sim *sim = sim_new(def);
  sim->body[0].target = pose_turned(0.01, 0.003, 0.02, 1, 0.6);
  int left = run(sim, 0, 1);
  CHECK(left == 0);
  CHECK(worst_piercings(sim) == 0);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// one body alone always finds room, also where the cloth is about to go anywhere
static int random_motions_around_one_body_leave_nothing(void)
{
  int would = 0;
  for (uint32_t seed = 1; seed <= 12; seed++) {
    cloth_def *def = def_of("cpu", "cpu", 3);
    solid_sphere(&body, 0.04, 12, 6);
    def_body(def, "ball", &body, 0.5, pose_at(0, 0, 0.05));
    cloth_sim *sim = sim_new(def);
    sim->body[0].target = pose_turned(0.01, 0, 0.02, (int)(seed % 3), 0.3);
    int left = run(sim, 0.004 * (1 + seed % 4), seed);
    CHECK(left == 0);
    CHECK(worst_piercings(sim) == 0);
    would += report.impacts;
    cloth_sim_free(sim), cloth_def_free(def);
  }
  printf("  %d impacts to come\n", would);
  CHECK(would > 1000);
  return 0;
}

static int a_hold_takes_along_what_it_is_moved_into(void)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu", "cpu", 2);
  cloth_sim *sim = sim_new(def);
  int all[N * N];
  for (int v = 0; v < N * N; v++) all[v] = v;
  cloth_grasp_view g = {
      .cloth = 0, .count = N * N, .vertex = all, .body = -1, .frame = cloth_pose_identity()};
  cloth_grasp_id id;
  must(cloth_sim_grasp(sim, &g, &id, &err), &err);
  sim->hold[0].target = pose_at(0, 0.002, -0.03); // through the sheet below
  int left = run(sim, 0.002, 7);
  CHECK(left == 0);
  CHECK(worst_piercings(sim) == 0);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// the work ends, and what is left is the second body's
static int two_bodies_that_close_leave_no_room(void)
{
  cloth_def *def = def_of("cpu", "cpu", 2);
  solid_box(&body, 0.05, 0.05, 0.01);
  def_body(def, "upper", &body, 0.5, pose_at(0, 0, 0.008));
  def_body(def, "lower", &body, 0.5, pose_at(0, 0, -0.018));
  cloth_sim *sim = sim_new(def);
  sim->body[0].target = pose_at(0, 0, -0.005);
  sim->body[1].target = pose_at(0, 0, -0.005);
  CHECK(run(sim, 0.001, 3) > 0);
  for (int i = 0; i < sim->zones.found_count; i++) {
    int v[4], of = -1;
    cloth_pair_corners(sim, sim->zones.found[i].key, v);
    for (int k = 0; k < 4; k++)
      if (v[k] >= sim->vertex_count) of = cloth_body_of_vertex(sim, v[k]);
    CHECK(of == 1);
  }
  for (int i = 0; i < 3 * sim->vertex_count; i++)
    CHECK(fabs((double)(sim->part[0].x[i] - sim->part[0].x_t0[i])) < 0.02);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// A sheet whose border is held; a tip presses its middle down by 30 mm in 30 steps, with contacts
// far too soft to carry it. What all vertices come to, and how many pairs were held back.
static int press(double x[3 * N * N], bool by_tip)
{
  cloth_error err = {0};
  cloth_def *def = def_of("cpu", "cpu", 1);
  def_set(def, "contact_stiffness", "0.01");
  solid_spike(&body, 0.01, 0.1);
  def_body(def, "spike", &body, 0, pose_at(0, 0, by_tip ? 1e-4 : 1));
  cloth_sim *sim = sim_new(def);
  int border[4 * N], held_back = 0, n = 0, middle = N * N / 2;
  for (int v = 0; v < N * N; v++)
    if (v % N == 0 || v % N == N - 1 || v / N == 0 || v / N == N - 1) border[n++] = v;
  cloth_grasp_view g = {.count = n, .vertex = border, .body = -1, .frame = cloth_pose_identity()};
  cloth_grasp_id id;
  must(cloth_sim_grasp(sim, &g, &id, &err), &err);
  g.count = 1, g.vertex = &middle;
  if (!by_tip) must(cloth_sim_grasp(sim, &g, &id, &err), &err);
  for (int i = 1; i <= 30; i++) {
    if (by_tip)
      sim->body[0].target = pose_at(0, 0, 1e-4 - 0.001 * i);
    else
      sim->hold[1].target = pose_at(0, 0, -0.001 * i);
    held_back += sim_step(sim, 1).held_back;
  }
  for (int v = 0; v < N * N; v++)
    for (int k = 0; k < 3; k++)
      x[3 * v + k] = (double)sim->part[0].x[3 * sim->internal[sim->cloth_first[0] + v] + k];
  cloth_sim_free(sim), cloth_def_free(def);
  return held_back;
}

// judged by the same sheet with its middle held: the solver knows where that goes
static int the_cloth_around_what_is_held_back_comes_along(void)
{
  static double tip[3 * N * N], held[3 * N * N];
  int pairs = press(tip, true);
  CHECK(pairs > 0 && press(held, false) == 0);
  double apart = 0;
  for (int i = 0; i < 3 * N * N; i++) apart = fmax(apart, fabs(tip[i] - held[i]));
  printf("  %d pairs held back; %.2f mm apart at a depth of 30 mm\n", pairs, 1e3 * apart);
  CHECK(apart < 0.0003);
  return 0;
}

static int parts_hold_back_to_the_same_bits(void)
{
  static const char *const devices[] = {"cpu", "cpu,cpu", "cpu,cpu,cpu", "cpu,cpu"};
  static cloth_real first[3 * 3 * N * N];
  for (int d = 0; d < 4; d++) {
    cloth_def *def = def_of(d < 3 ? "cpu" : "shuffle", devices[d], 3);
    solid_spike(&body, 0.03, 0.1);
    def_body(def, "one", &body, 0.5, pose_at(0, 0, 1e-4));
    def_body(def, "two", &body, 0.5, pose_at(0.06, 0.05, 1e-4));
    cloth_sim *sim = sim_new(def);
    sim->body[0].target = pose_turned(0, 0.01, -0.03, 2, 0.2);
    sim->body[1].target = pose_turned(0.06, 0.05, -0.04, 0, 0.2);
    run(sim, 0.012, 9);
    CHECK(same_positions(sim, first, d == 0));
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_tip_on_a_vertex_takes_the_cloth_along);
  RUN(a_blade_that_turns_takes_the_cloth_along);
  RUN(random_motions_around_one_body_leave_nothing);
  RUN(a_hold_takes_along_what_it_is_moved_into);
  RUN(two_bodies_that_close_leave_no_room);
  RUN(the_cloth_around_what_is_held_back_comes_along);
  RUN(parts_hold_back_to_the_same_bits);
  return failures > 0;
}
