// The springs of a cloth: which there are, that they are as stiff as the fabric, and the largest
// sub-step, against counts and energies by hand and against runs on both sides of the limit.
#include "solve/sim.h"

static sheet cloth;

static cloth_material fabric(void)
{
  cloth_material m = cloth_material_default();
  m.density = 1, m.stretch_warp = 100, m.stretch_weft = 60, m.shear = 20, m.poisson = 0.2;
  m.bend_warp = m.bend_weft = 1e-6;
  m.damping_stretch = m.damping_bend = m.damping_mass = 0;
  return m;
}

static cloth_def *def_of(double width, double height, int columns, int rows, cloth_material m)
{
  sheet_make(&cloth, width, height, columns, rows);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "integrator", "mass_spring");
  def_set(def, "spring_step", "0");
  def_set(def, "gravity", "0 0 0");
  def_set(def, "effects.self_contact", "off");
  def_cloth(def, "sheet", &cloth, m, pose_at(0, 0, 0));
  return def;
}

static int counts(void)
{
  enum { NX = 7, NY = 5 };
  cloth_def *def = def_of(0.12, 0.06, NX, NY, fabric());
  cloth_sim *sim = sim_new(def);
  const int *n = sim->springs.of_kind;
  CHECK(n[CLOTH_SPRING_STRETCH] == NX * (NY - 1) + NY * (NX - 1));
  CHECK(n[CLOTH_SPRING_SHEAR] == 2 * (NX - 1) * (NY - 1));
  CHECK(n[CLOTH_SPRING_BEND] == (NX - 2) * NY + (NY - 2) * NX);
  // quarters of rectangles: inner particles have one, those of sides a half, of corners a quarter
  double cell = 0.12 / (NX - 1) * 0.06 / (NY - 1), all = 0;
  for (int v = 0; v < sim->vertex_count; v++) {
    int file = sim->order[v], column = file % NX, row = file / NX;
    double share = (column % (NX - 1) ? 1 : 0.5) * (row % (NY - 1) ? 1 : 0.5);
    CHECK_NEAR(sim->mass[v], share * cell, 1e-12);
    all += sim->mass[v];
  }
  CHECK_NEAR(all, 0.12 * 0.06, 1e-12);
  for (int i = 0; i < sim->springs.count; i++) { // at rest
    const cloth_spring *s = &sim->springs.list[i];
    double d = 0;
    for (int k = 0; k < 3; k++) d += pow(sim->rest[3 * s->a + k] - sim->rest[3 * s->b + k], 2);
    CHECK_NEAR(s->rest, sqrt(d), 1e-12);
  }
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// energy of all springs [J] when the cloth is at x = F X
static double energy(const cloth_sim *sim, const double F[2][2])
{
  double sum = 0;
  for (int i = 0; i < sim->springs.count; i++) {
    const cloth_spring *s = &sim->springs.list[i];
    double dx = sim->rest[3 * s->a] - sim->rest[3 * s->b];
    double dy = sim->rest[3 * s->a + 1] - sim->rest[3 * s->b + 1];
    double l = hypot(F[0][0] * dx + F[0][1] * dy, F[1][0] * dx + F[1][1] * dy);
    sum += s->stiffness / 2 * (l - s->rest) * (l - s->rest);
  }
  return sum;
}

// stretched along one axis and free along the other the net has E of the fabric, sheared it has G:
// the least energy over the free width, by bisection of its slope
static double free_energy(const cloth_sim *sim, int axis, double strain)
{
  double lo = 1 - strain, hi = 1, best = 0;
  for (int i = 0; i < 60; i++) {
    double mid = (lo + hi) / 2, step = 1e-5, e[3];
    for (int k = 0; k < 3; k++) {
      double F[2][2] = {{1, 0}, {0, 1}};
      F[axis][axis] = 1 + strain, F[1 - axis][1 - axis] = mid + (k - 1) * step;
      e[k] = energy(sim, (const double(*)[2])F);
    }
    best = e[1];
    if (e[2] > e[0])
      hi = mid;
    else
      lo = mid;
  }
  return best;
}

static int stiffness(void)
{
  const double strain = 1e-3, width = 0.12, height = 0.05; // cells of 15 mm by 10 mm
  cloth_material m = fabric();
  cloth_def *def = def_of(width, height, 9, 6, m);
  cloth_sim *sim = sim_new(def);
  double whole = width * height * strain * strain / 2;
  // the springs are not quite linear: a share of the strain
  CHECK_NEAR(free_energy(sim, 0, strain) / whole, m.stretch_warp, 5e-3 * m.stretch_warp);
  CHECK_NEAR(free_energy(sim, 1, strain) / whole, m.stretch_weft, 5e-3 * m.stretch_weft);
  double shear[2][2] = {{1, strain / 2}, {strain / 2, 1}};
  CHECK_NEAR(energy(sim, (const double(*)[2])shear) / whole, m.shear, 5e-3 * m.shear);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// a mesh without rectangles: equilateral triangles have the stiffness E and the Poisson number 1/3
// of Van Gelder's springs
static int triangles(void)
{
  enum { NX = 9, NY = 8 };
  const double a = 0.01, strain = 1e-3;
  sheet_make(&cloth, a * (NX - 1), a * (NY - 1), NX, NY);
  int t = 0;
  for (int r = 0; r < NY; r++)
    for (int c = 0; c < NX; c++) {
      double *x = cloth.x + 3 * (r * NX + c);
      x[0] = a * (c + (r % 2 ? 0.5 : 0)), x[1] = a * sqrt(3) / 2 * r, x[2] = 0;
      if (r + 1 == NY || c + 1 == NX) continue;
      int v = r * NX + c, up = v + NX;
      int odd[6] = {v, v + 1, up + 1, v, up + 1, up}, even[6] = {v, v + 1, up, v + 1, up + 1, up};
      memcpy(cloth.triangle + 3 * t, r % 2 ? odd : even, sizeof odd);
      t += 2;
    }
  cloth_material m = fabric();
  m.stretch_warp = m.stretch_weft = 80, m.bend_warp = m.bend_weft = 0;
  cloth_def *def = def_new(PRECISION);
  def_set(def, "integrator", "mass_spring");
  def_set(def, "spring_step", "0");
  def_cloth(def, "sheet", &cloth, m, pose_at(0, 0, 0));
  cloth_sim *sim = sim_new(def);
  CHECK(sim->springs.of_kind[CLOTH_SPRING_STRETCH] == sim->edge_count);
  CHECK(sim->springs.of_kind[CLOTH_SPRING_SHEAR] == 0);
  double area = t * a * a * sqrt(3) / 4, whole = area * strain * strain / 2;
  CHECK_NEAR(free_energy(sim, 0, strain) / whole, 80, 0.4);
  CHECK_NEAR(free_energy(sim, 1, strain) / whole, 80, 0.4);
  double shear[2][2] = {{1, strain / 2}, {strain / 2, 1}}; // E / (2 + 2/3)
  CHECK_NEAR(energy(sim, (const double(*)[2])shear) / whole, 30, 0.2);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

// ---- the largest sub-step -----------------------------------------------------------------------

// does the sheet blow up at this sub-step? Velocities start as small noise
static bool blows_up(cloth_sim *sim, double step)
{
  cloth_error err = {0};
  cloth_step_report r = {0};
  uint32_t seed = 7;
  sim->springs.step = step;
  must(cloth_sim_reset(sim, &err), &err);
  for (int i = 0; i < 3 * sim->vertex_count; i++)
    sim->part[0].v[i] = (cloth_real)(1e-3 * roll_real(&seed));
  for (int i = 0; i < 20; i++) {
    cloth_status status = cloth_sim_step(sim, 50 * step, &r, &err);
    if (status != CLOTH_OK || r.speed_max > 1) return true;
  }
  return false;
}

// where it begins to, by bisection; as a share of the reported limit
static double edge_of(cloth_sim *sim)
{
  double lo = 0.3, hi = 3;
  for (int i = 0; i < 12; i++) {
    double mid = (lo + hi) / 2;
    if (blows_up(sim, mid * sim->springs.limit))
      hi = mid;
    else
      lo = mid;
  }
  return lo;
}

static int limit_of_chains(void)
{
  for (int damped = 0; damped < 2; damped++) {
    cloth_material m = fabric();
    m.stretch_weft = m.shear = m.bend_warp = m.bend_weft = 0; // chains along the warp
    if (damped) m.damping_stretch = 2e-3;
    cloth_def *def = def_of(0.2, 0.02, 21, 3, m);
    def_set(def, "bounds", "1000");
    cloth_sim *sim = sim_new(def);
    double k = m.stretch_warp, mass = 0.01 * 0.01, w = 2 * sqrt(k / mass), g = 0;
    if (damped) g = 4 * k * m.damping_stretch / mass;
    double expected = (sqrt(g * g + 4 * w * w) - g) / (w * w);
    CHECK_NEAR(sim->springs.limit / expected, 1, 1e-6);
    double edge = edge_of(sim);
    printf("  chain%s: unstable from %.3f of the limit\n", damped ? ", damped" : "", edge);
    CHECK(edge > 0.99 && edge < 1.05);
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return 0;
}

// the rows hold for any shape of the cloth; for a flat one they ask for more than it needs
static int limit_of_sheets(void)
{
  cloth_material m = fabric();
  m.stretch_weft = m.stretch_warp;
  cloth_def *def = def_of(0.15, 0.15, 16, 16, m);
  def_set(def, "bounds", "1000");
  cloth_sim *sim = sim_new(def);
  double edge = edge_of(sim);
  printf("  flat sheet: unstable from %.3f of the limit\n", edge);
  CHECK(edge > 1 && edge < 1.6);
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(counts);
  RUN(stiffness);
  RUN(triangles);
  RUN(limit_of_chains);
  RUN(limit_of_sheets);
  return failures > 0;
}
