// A scene pays only for the effects it calls for: what is not active holds no byte and launches no
// kernel, and a stage that has nothing to do is skipped and says so.
#include "scene.h"

static sheet cloth;
static solid body;

typedef struct wish {
  const char *effect;
  const char *needs; // effects that cannot be without
  bool kernels;      // launches kernels of its own
  bool memory;       // holds memory of its own
} wish;

static const wish wishes[] = {
    {"none", "", false, false},
    {"gravity", "", true, false},
    {"membrane", "", true, true},
    {"bending", "", true, true},
    {"springs", "", true, true},
    {"damping", "membrane bending", false, false}, // numbers that the two others read
    {"damping of mass", "damping", false, false},
    {"air", "", true, true},
    {"pins", "", true, true},
    {"self_contact", "", true, true},
    {"body_contact", "", true, true},
    {"friction", "body_contact", false, false}, // inside the contact kernels
};
enum { WISHES = sizeof wishes / sizeof *wishes };

static bool has(const wish *w, const char *effect)
{
  return strcmp(w->effect, effect) == 0 || strstr(w->needs, effect) != NULL;
}

// a sheet in space without weight, stiffness or company, but for what is wished
static cloth_scene *scene_with(const char *precision, const wish *w)
{
  sheet_make(&cloth, 0.3, 0.3, 12, 12);
  solid_box(&body, 0.2, 0.2, 0.02);
  cloth_material m = cloth_material_default();
  bool springs = has(w, "springs");
  if (!has(w, "membrane") && !springs) m.stretch_warp = m.stretch_weft = m.shear = 0;
  if (!has(w, "bending") && !springs) m.bend_warp = m.bend_weft = 0;
  m.damping_stretch = m.damping_bend = m.damping_mass = 0;
  if (strcmp(w->effect, "damping") == 0) m.damping_stretch = m.damping_bend = 1e-3;
  if (strcmp(w->effect, "damping of mass") == 0) m.damping_mass = 1;
  cloth_def *def = def_new(precision);
  if (springs) def_set(def, "integrator", "mass_spring"), def_set(def, "spring_step", "0");
  if (!has(w, "gravity")) def_set(def, "gravity", "0 0 0");
  if (has(w, "air")) def_set(def, "air_density", "1.2"), def_set(def, "wind", "1 0 0");
  if (strcmp(w->effect, "friction") != 0) def_set(def, "friction", "0");
  if (!has(w, "self_contact")) def_set(def, "effects.self_contact", "off");
  def_cloth(def, "sheet", &cloth, m, pose_at(0, 0, 0));
  double friction = strcmp(w->effect, "friction") == 0 ? 0.5 : 0;
  if (has(w, "body_contact")) def_body(def, "box", &body, friction, pose_at(0, 0, -0.012));
  cloth_scene *scene = scene_new(def);
  static const int corner[1] = {0};
  if (has(w, "pins")) scene_hold(scene, 0, corner, 1, cloth_pose_identity());
  return scene;
}

static int check_wish(const char *precision, const wish *w)
{
  cloth_scene *scene = scene_with(precision, w);
  scene_step(scene, 10);
  for (int e = 0; e < cloth_effect_count(); e++) {
    cloth_effect_info info;
    cloth_error err = {0};
    CHECK_OK(cloth_effect_describe(scene, e, &info, &err), err);
    CHECK(info.name[0] != 0 && info.source[0] != 0 && info.why[0] != 0);
    bool wanted = strcmp(w->effect, info.name) == 0 || strstr(w->needs, info.name) != NULL;
    if (info.active != wanted || (!wanted && (info.memory_bytes > 0 || info.launches > 0)))
      printf("  wish %s: %s is %s: %s; %llu bytes, %lld launches\n", w->effect, info.name,
             info.active ? "active" : "not active", info.why, (unsigned long long)info.memory_bytes,
             (long long)info.launches);
    CHECK(info.active == wanted);
    CHECK(wanted || (info.memory_bytes == 0 && info.launches == 0));
    if (strcmp(w->effect, info.name) != 0) continue;
    CHECK(!w->kernels || info.launches >= 10); // each step
    CHECK(!w->memory || info.memory_bytes > 0);
  }
  cloth_scene_free(scene);
  return 0;
}

static int effects(const char *precision)
{
  for (int i = 0; i < WISHES; i++)
    if (check_wish(precision, &wishes[i])) return 1;
  return 0;
}
BOTH(what_is_not_wanted_holds_no_byte_and_launches_no_kernel, effects)

static int every_effect_is_tested(void)
{
  cloth_scene *scene = scene_with("double", &wishes[0]);
  for (int e = 0; e < cloth_effect_count(); e++) {
    cloth_effect_info info;
    cloth_error err = {0};
    bool found = false;
    CHECK_OK(cloth_effect_describe(scene, e, &info, &err), err);
    for (int i = 0; i < WISHES; i++) found |= strcmp(wishes[i].effect, info.name) == 0;
    if (!found) printf("  no test of effect %s\n", info.name);
    CHECK(found);
  }
  cloth_scene_free(scene);
  return 0;
}

static int switched_off(const char *precision)
{
  static const char *const names[] = {"gravity", "membrane", "bending",      "damping",
                                      "air",     "friction", "self_contact", "body_contact"};
  sheet_make(&cloth, 0.3, 0.3, 8, 8);
  solid_box(&body, 0.2, 0.2, 0.02);
  cloth_def *def = def_new(precision);
  def_set(def, "air_density", "1.2");
  def_cloth(def, "sheet", &cloth, cloth_material_default(), pose_at(0, 0, 0));
  def_body(def, "box", &body, 0.5, pose_at(0, 0, -0.012));
  for (int i = 0; i < 8; i++) {
    char key[64];
    snprintf(key, sizeof key, "effects.%s", names[i]);
    def_set(def, key, "off");
  }
  cloth_scene *scene = scene_new(def);
  scene_step(scene, 5);
  for (int e = 0; e < cloth_effect_count(); e++) {
    cloth_effect_info info;
    cloth_error err = {0};
    CHECK_OK(cloth_effect_describe(scene, e, &info, &err), err);
    CHECK(!info.active && info.memory_bytes == 0 && info.launches == 0);
  }
  cloth_scene_free(scene);
  return 0;
}
BOTH(an_effect_that_is_switched_off_costs_nothing, switched_off)

static bool skipped(const cloth_step_report *r, cloth_stage stage)
{
  return r->stages_skipped >> stage & 1;
}

static int stages(const char *precision)
{
  static const wish gravity = {"gravity", "", true, false};
  cloth_scene *scene = scene_with(precision, &gravity);
  cloth_step_report r = scene_step(scene, 3);
  CHECK(skipped(&r, CLOTH_STAGE_pairs) && skipped(&r, CLOTH_STAGE_contact) &&
        skipped(&r, CLOTH_STAGE_ccd));
  CHECK(skipped(&r, CLOTH_STAGE_effects) && skipped(&r, CLOTH_STAGE_assemble) &&
        skipped(&r, CLOTH_STAGE_solve)); // nothing couples vertices
  CHECK(!skipped(&r, CLOTH_STAGE_predict) && !skipped(&r, CLOTH_STAGE_commit));
  CHECK(r.stages_skipped >> CLOTH_STAGE_COUNT == 0); // no bit that means nothing
  cloth_scene_free(scene);
  return 0;
}
BOTH(free_fall_skips_the_stages_of_contact, stages)

// ---- where nothing couples vertices -------------------------------------------------------------

typedef struct pull {
  double x[3 * 12 * 12], v[3 * 12 * 12], force[2][3], torque[2][3], speed, energy, change;
} pull;

static int held_rigidly[2] = {0, 5}, held_softly[3] = {70, 71, 143};

// 12 steps under a rigid and a soft grasp that move; with a mass damping too weak to be seen the
// general path is taken: a linear system, assembled and solved
static int pulled(const char *precision, bool solve, pull *out)
{
  sheet_make(&cloth, 0.3, 0.3, 12, 12);
  cloth_material m = cloth_material_default();
  m.stretch_warp = m.stretch_weft = m.shear = m.bend_warp = m.bend_weft = 0;
  m.damping_stretch = m.damping_bend = 0, m.damping_mass = solve ? 1e-14 : 0;
  cloth_def *def = def_new(precision);
  def_set(def, "effects.self_contact", "off"), def_set(def, "substeps", "2");
  def_set(def, "pcg_tolerance", "1e-12"), def_set(def, "newton_tolerance", "1e-9");
  def_cloth(def, "sheet", &cloth, m, pose_at(0, 0, 0));
  cloth_scene *scene = scene_new(def);
  cloth_error err = {0};
  cloth_grasp_id id[2] = {scene_hold(scene, 0, held_rigidly, 2, cloth_pose_identity()), {0, 0}};
  cloth_grasp_view soft = {.vertex = held_softly, .count = 3, .body = -1, .stiffness = 3};
  soft.frame = pose_at(0, 0, 0);
  CHECK_OK(cloth_grasp(scene, &soft, &id[1], &err), err);
  cloth_step_report r = {0};
  for (int step = 1; step <= 12; step++) {
    cloth_pose to = pose_at(2e-3 * step, 1e-4 * step * step, 0);
    for (int g = 0; g < 2; g++) CHECK_OK(cloth_grasp_move(scene, id[g], &to, &err), err);
    r = scene_step(scene, 1);
  }
  CHECK(solve == (r.newton_iterations > 0) && r.substeps == 2);
  CHECK_OK(cloth_positions(scene, 0, out->x, 144, &err), err);
  CHECK_OK(cloth_velocities(scene, 0, out->v, 144, &err), err);
  for (int g = 0; g < 2; g++)
    CHECK_OK(cloth_grasp_wrench(scene, id[g], out->force[g], out->torque[g], &err), err);
  out->speed = r.speed_max, out->energy = r.energy_kinetic, out->change = r.error_estimate;
  cloth_scene_free(scene);
  return 0;
}

static int flight(const char *precision)
{
  static pull a, b;
  double eps = strcmp(precision, "float") == 0 ? 2e-5 : 1e-12;
  if (pulled(precision, false, &a) || pulled(precision, true, &b)) return 1;
  for (int k = 0; k < 3 * 144; k++) {
    CHECK_NEAR(a.x[k], b.x[k], eps);
    CHECK_NEAR(a.v[k], b.v[k], 100 * eps);
  }
  for (int g = 0; g < 2; g++)
    for (int k = 0; k < 3; k++) {
      CHECK_NEAR(a.force[g][k], b.force[g][k], eps); // of 0.1 N
      CHECK_NEAR(a.torque[g][k], b.torque[g][k], eps);
    }
  CHECK(fabs(a.force[0][2]) > 1e-3 && fabs(a.force[1][2]) > 1e-3);
  CHECK_NEAR(a.speed, b.speed, 100 * eps);
  CHECK_NEAR(a.energy, b.energy, 10 * eps);
  CHECK_NEAR(a.change, b.change, eps);
  return 0;
}
BOTH(what_nothing_couples_moves_as_the_solver_would_have_it, flight)

static int out_of_bounds(const char *precision)
{
  sheet_make(&cloth, 0.3, 0.3, 12, 12);
  cloth_def *def = def_new(precision);
  static const char *const off[] = {"membrane", "bending", "damping", "self_contact"};
  for (int i = 0; i < 4; i++) {
    char key[64];
    snprintf(key, sizeof key, "effects.%s", off[i]);
    def_set(def, key, "off");
  }
  def_set(def, "substeps", "3"), def_set(def, "bounds", "150");
  def_cloth(def, "sheet", &cloth, cloth_material_default(), pose_at(0, 0, 0));
  cloth_scene *scene = scene_new(def);
  cloth_error err = {0};
  static double v[3 * 144];
  uint64_t before, after;
  v[3 * 77] = 5900; // 98 m in a step
  CHECK_OK(cloth_state_set(scene, 0, NULL, v, 144, &err), err);
  scene_step(scene, 1);
  CHECK_OK(cloth_state_hash(scene, &before, &err), err);
  for (int i = 0; i < 2; i++) { // the first of its substeps ends within the bounds
    CHECK(cloth_step(scene, 0, NULL, &err) == CLOTH_UNSTABLE);
    CHECK_OK(cloth_state_hash(scene, &after, &err), err);
    CHECK(before == after);
  }
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_flight_out_of_bounds_is_undone, out_of_bounds)

static int near_and_far(const char *precision)
{
  static const wish contact = {"body_contact", "", true, true};
  cloth_scene *scene = scene_with(precision, &contact);
  cloth_step_report r = scene_step(scene, 1);
  CHECK(r.bodies_near == 1 && r.contacts_body > 0 && !skipped(&r, CLOTH_STAGE_pairs));
  cloth_pose away = pose_at(0, 0, -5);
  cloth_error err = {0};
  CHECK_OK(cloth_body_place(scene, 0, &away, &err), err);
  r = scene_step(scene, 1);
  CHECK(r.bodies_near == 0 && r.contacts_body == 0 && r.pairs == 0);
  CHECK(skipped(&r, CLOTH_STAGE_pairs) && skipped(&r, CLOTH_STAGE_contact) &&
        skipped(&r, CLOTH_STAGE_ccd));
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_body_that_goes_away_takes_its_stages_along, near_and_far)

// the time of the products is part of the solves', on one part and on two, and nobody looks at a
// clock for it unasked
static int timed(const char *precision)
{
  for (int n = 0; n < 4; n++) {
    bool asked = n % 2 > 0;
    sheet_make(&cloth, 0.3, 0.3, 12, 12);
    cloth_def *def = def_new(precision);
    def_set(def, "profile", asked ? "1" : "0");
    def_set(def, "devices", n < 2 ? "cpu" : "cpu, cpu");
    def_cloth(def, "sheet", &cloth, cloth_material_default(), pose_at(0, 0, 0));
    cloth_scene *scene = scene_new(def);
    static const int corner[1] = {0};
    scene_hold(scene, 0, corner, 1, cloth_pose_identity());
    cloth_step_report r = scene_step(scene, 3);
    CHECK(r.pcg_iterations > 0);
    CHECK(asked ? r.product_ms > 0 && r.product_ms <= r.ms[CLOTH_STAGE_solve] : r.product_ms == 0);
    cloth_scene_free(scene);
  }
  return 0;
}
BOTH(products_are_timed_where_a_profile_is_asked_for, timed)

// ---- many cloths --------------------------------------------------------------------------------

enum { MANY = 70, SIDE = 3, VERTICES = SIDE * SIDE };

// as many sheets as asked for, each in the wind, held at one side, with a material of its own
static cloth_scene *sheets(const char *precision, int first, int count, bool stiff)
{
  static const int side[SIDE] = {0, 1, 2};
  sheet_make(&cloth, 0.1, 0.1, SIDE, SIDE);
  cloth_def *def = def_new(precision);
  def_set(def, "effects.self_contact", "off"), def_set(def, "pcg_tolerance", "1e-6");
  def_set(def, "newton_iterations_max", "30"), def_set(def, "newton_tolerance", "1e-4");
  def_set(def, "air_density", "1.2"), def_set(def, "wind", "3 1 2");
  if (!stiff) def_set(def, "effects.membrane", "off"), def_set(def, "effects.bending", "off");
  if (!stiff) def_set(def, "effects.damping", "off");
  for (int c = first; c < first + count; c++) {
    char name[16];
    cloth_material m = cloth_material_default();
    m.stretch_warp = 20 + 2 * c, m.poisson = 0, m.drag = 0.02 * c;
    m.strain_limit = c % 2 ? 0.01 : 0;
    snprintf(name, sizeof name, "c%d", c);
    def_cloth(def, name, &cloth, m, pose_at(0, 0, 0));
  }
  cloth_scene *scene = scene_new(def);
  for (int c = 0; c < count; c++) scene_hold(scene, c, side, SIDE, cloth_pose_identity());
  return scene;
}

static int many(const char *precision, bool stiff)
{
  static const int looked_at[] = {0, 63, 64, MANY - 1};
  static double together[3 * VERTICES], alone[3 * VERTICES];
  cloth_scene *all = sheets(precision, 0, MANY, stiff);
  scene_step(all, 5);
  for (int i = 0; i < 4; i++) {
    cloth_scene *one = sheets(precision, looked_at[i], 1, stiff);
    scene_step(one, 5);
    scene_positions(all, looked_at[i], together);
    scene_positions(one, 0, alone);
    // what the solver's tolerance leaves; sheets differ by millimetres
    for (int k = 0; k < 3 * VERTICES; k++) CHECK_NEAR(together[k], alone[k], 1e-5);
    cloth_scene_free(one);
  }
  cloth_scene_free(all);
  return 0;
}

static int many_cloths(const char *precision)
{
  return many(precision, true) || many(precision, false);
}
BOTH(every_one_of_seventy_cloths_has_its_own_material, many_cloths)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(what_is_not_wanted_holds_no_byte_and_launches_no_kernel);
  RUN(every_effect_is_tested);
  RUN(an_effect_that_is_switched_off_costs_nothing);
  RUN(free_fall_skips_the_stages_of_contact);
  RUN(what_nothing_couples_moves_as_the_solver_would_have_it);
  RUN(a_flight_out_of_bounds_is_undone);
  RUN(a_body_that_goes_away_takes_its_stages_along);
  RUN(every_one_of_seventy_cloths_has_its_own_material);
  RUN(products_are_timed_where_a_profile_is_asked_for);
  return failures > 0;
}
