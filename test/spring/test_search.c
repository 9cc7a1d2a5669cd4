// Candidates of particles against brute force: the same sets in the same order, for crumpled cloth,
// far from the origin, and on several parts.
#include "solve/sim.h"

enum { N = 17 };

static sheet cloth;

static cloth_def *def_of(const char *devices)
{
  sheet_make(&cloth, 0.16, 0.16, N, N);
  cloth_def *def = def_new(PRECISION);
  def_set(def, "integrator", "mass_spring");
  def_set(def, "spring_step", "0");
  def_set(def, "devices", devices);
  def_cloth(def, "one", &cloth, cloth_material_default(), pose_at(0, 0, 0.05));
  def_cloth(def, "two", &cloth, cloth_material_default(), pose_turned(0.05, 0, 0.08, 0, 0.3));
  return def;
}

static void crumple(cloth_sim *sim, double size, double away, uint32_t seed)
{
  for (int p = 0; p < sim->part_count; p++) {
    uint32_t s = seed;
    for (int i = 0; i < 3 * sim->vertex_count; i++)
      sim->part[p].x_t0[i] = (cloth_real)(away + size * roll_real(&s));
  }
}

static int check_part(cloth_sim *sim, cloth_part *p)
{
  cloth_error err = {0};
  cloth_spring_verdict v = {.room = true};
  do { // until there is room
    v.room = true;
    CHECK_OK(cloth_spring_search(sim, p, &err), err);
    CHECK_OK(cloth_spring_searched(sim, p, &v, &err), err);
  } while (!v.room);
  cloth_real reach = (cloth_real)(2 * sim->springs.radius + 2 * cloth_spring_stray(sim));
  const cloth_spring_part *s = &p->spring;
  for (int i = p->v0; i < p->v1; i++) {
    uint32_t n = 0, row = (uint32_t)(i - p->v0);
    for (int j = 0; j < sim->vertex_count; j++) {
      cloth_v3 d = cloth_v3_sub(cloth_v3_load(p->x_t0, i), cloth_v3_load(p->x_t0, j));
      if (i == j || !(cloth_v3_dot(d, d) < reach * reach)) continue;
      CHECK(n < s->listed[row] && s->candidate[row * s->candidate_room + n] == (uint32_t)j);
      n++;
    }
    CHECK(n == s->listed[row]);
  }
  return 0;
}

static int check(const char *devices, double size, double away)
{
  cloth_def *def = def_of(devices);
  cloth_sim *sim = sim_new(def);
  cloth_step_report report = {0};
  sim->report = &report;
  crumple(sim, size, away, 3);
  for (int i = 0; i < sim->part_count; i++)
    if (check_part(sim, &sim->part[i])) return 1;
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

static int candidates_are_those_of_brute_force(void)
{
  static const double size[] = {0.005, 0.05, 0.5, 5, 90};
  for (int i = 0; i < 5; i++)
    if (check("cpu", size[i], 0)) return 1;
  return 0;
}

static int also_far_from_the_origin(void)
{
  return check("cpu", 0.1, 37) || check("cpu", 0.1, -80);
}

static int also_on_parts(void) { return check("cpu,cpu,cpu", 0.1, 0); }

// what is not finite is nobody's candidate, and does not stop the search
static int lost_particles_are_left_out(void)
{
  cloth_def *def = def_of("cpu");
  cloth_sim *sim = sim_new(def);
  cloth_step_report report = {0};
  sim->report = &report;
  crumple(sim, 0.1, 0, 5);
  for (int i = 0; i < sim->vertex_count; i += 3) sim->part[0].x_t0[3 * i + i % 2] = (cloth_real)NAN;
  sim->part[0].x_t0[4] = (cloth_real)INFINITY, sim->part[0].x_t0[11] = (cloth_real)1e30;
  if (check_part(sim, &sim->part[0])) return 1;
  cloth_sim_free(sim), cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(candidates_are_those_of_brute_force);
  RUN(also_far_from_the_origin);
  RUN(also_on_parts);
  RUN(lost_particles_are_left_out);
  return failures > 0;
}
