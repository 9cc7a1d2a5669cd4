// Friction: a strip that is pressed on a rough floor, and one that runs over a bar.
#include "validate/cases.h"
#include "validate/strip.h"

static strip s;
static solid body;
static double x[3 * STRIP_MAX];

// ---- stick and slip -----------------------------------------------------------------------------

// A strip along x whose end stands on a floor that faces -x; thick enough that the contact's spring
// gives way little.
static cloth_scene *standing(double length, double mu)
{
  cloth_material m = cloth_material_default();
  m.density = 2, m.stretch_warp = m.stretch_weft = 2e5, m.shear = 8e4, m.poisson = 0;
  m.bend_warp = m.bend_weft = 0.01, m.damping_mass = 2;
  m.damping_stretch = m.damping_bend = 0;
  cloth_error err = {0};
  cloth_def *def = def_new("double");
  def_set(def, "time_step", "0.005"), def_set(def, "gravity", "0 0 0");
  def_set(def, "newton_iterations_max", "10"), def_set(def, "newton_tolerance", "1e-4");
  def_set(def, "pcg_tolerance", "1e-5"), def_set(def, "pcg_iterations_max", "5000");
  def_set(def, "contact_stiffness", "100"), def_set(def, "thickness", "0.001");
  def_set(def, "effects.self_contact", "off");
  cloth_cloth_view v = {.name = "strip",
                        .mesh = {s.vertices, s.triangles, s.x, s.triangle, NULL},
                        .material = m,
                        .pose = cloth_pose_identity()};
  must(cloth_def_add_cloth(def, &v, NULL, &err), &err);
  solid_box(&body, 0.04, 0.4, 0.4);
  def_body(def, "floor", &body, mu, pose_at(length + 0.001 + 0.02, 0, 0));
  return scene_new(def);
}

// The clamp is lowered until the end slips; what friction the elastica needs there is mu.
void case_stick_slip(int mesh, double mu, const double *curve, int rows)
{
  const double length = 0.2, h = 0.005;
  cloth_error err = {0};
  strip_make(&s, (strip_mesh)mesh, length, 30, 3, 0);
  for (int v = 0; v < s.vertices; v++) // it bends to one side
    s.x[3 * v + 2] = s.x[3 * v] > 0 ? 2e-3 * length * pow(sin(2 * s.x[3 * v] / length), 2) : 0;
  cloth_scene *scene = standing(length, mu);
  static const cloth_grasp_view rigid = {.frame = {{0, 0, 0}, {0, 0, 0, 1}}};
  cloth_grasp_id clamp = strip_hold(&s, scene, 0, 1, &rigid);
  double eps = 0, start = s.x[3 * (s.vertices - 1) + 2], aside = 0;
  for (int n = 1; n < 3000 && fabs(aside) < 0.001 * length; n++) {
    // how far it bulges grows as the root of eps: evenly, or it would snap through and slip
    cloth_pose p = pose_at(0.4 * length * pow(n * h / 12, 2), 0, 0);
    must(cloth_grasp_move(scene, clamp, &p, &err), &err);
    must(cloth_step(scene, 0, NULL, &err), &err);
    scene_positions(scene, 0, x);
    double reach = strip_mean(&s, x, s.columns - 1, 0) - p.position[0];
    aside = strip_mean(&s, x, s.columns - 1, 2) - start;
    eps = 1 - reach / length;
  }
  int i = 0;
  while (i + 2 < rows && curve[6 * (i + 1)] < eps) i++;
  double f = (eps - curve[6 * i]) / (curve[6 * (i + 1)] - curve[6 * i]);
  double needed = curve[6 * i + 3] + f * (curve[6 * (i + 1) + 3] - curve[6 * i + 3]);
  result("stick-slip", strip_mesh_name[mesh], "mu where it slips", mu, needed, mu, 0.05);
  cloth_scene_free(scene);
}

// ---- capstan ------------------------------------------------------------------------------------

static void prism(double radius, double length, int sides)
{
  const double pi = acos(-1);
  body.vertices = 2 * sides, body.triangles = 2 * sides; // open at its ends; axis y
  for (int i = 0; i < 2 * sides; i++) {
    double a = 2 * pi * (i / 2) / sides;
    body.x[3 * i] = radius * cos(a), body.x[3 * i + 2] = radius * sin(a);
    body.x[3 * i + 1] = (i % 2 - 0.5) * length;
  }
  for (int i = 0; i < sides; i++) {
    int a = 2 * i, b = a + 1, c = 2 * ((i + 1) % sides), d = c + 1;
    const int quad[6] = {a, b, c, b, d, c};
    memcpy(body.triangle + 6 * i, quad, sizeof quad);
  }
}

// A strip over a round bar, half a turn. One end is drawn down, the other held by a spring.
void case_capstan(int mesh, double mu)
{
  const double pi = acos(-1), radius = 0.1, at = radius + 0.0027, leg = 0.15;
  const double length = 2 * leg + pi * at;
  cloth_error err = {0};
  strip_make(&s, (strip_mesh)mesh, length, 90, 3, 0);
  for (int i = 0; i < s.vertices; i++) {
    double *p = s.x + 3 * i, along = p[0] - leg, across = p[1];
    double angle = fmin(fmax(along / at, 0), pi), down = along - angle * at;
    p[0] = -at * cos(angle), p[1] = -across, p[2] = at * sin(angle) - fabs(down);
  }
  prism(radius, 0.1, 64);
  cloth_def *def = def_new("double");
  def_set(def, "pcg_tolerance", "1e-4"), def_set(def, "gravity", "0 0 0");
  def_set(def, "effects.self_contact", "off"), def_set(def, "effects.bending", "off");
  def_body(def, "bar", &body, mu, pose_at(0, 0, 0));
  cloth_cloth_view v = {.name = "strip",
                        .mesh = {s.vertices, s.triangles, s.x, s.triangle, NULL},
                        .material = cloth_material_default(),
                        .pose = cloth_pose_identity()};
  must(cloth_def_add_cloth(def, &v, NULL, &err), &err);
  cloth_scene *scene = scene_new(def);
  cloth_grasp_view rigid = {.frame = cloth_pose_identity()}, soft = rigid;
  soft.stiffness = 5;
  cloth_grasp_id pull = strip_hold(&s, scene, 0, 0, &rigid);
  cloth_grasp_id hold = strip_hold(&s, scene, s.columns - 1, s.columns - 1, &soft);
  for (int n = 1; n <= 120; n++) {
    cloth_pose p = pose_at(0, 0, -0.03 * n / 60.0);
    must(cloth_grasp_move(scene, pull, &p, &err), &err);
    scene_step(scene, 1);
  }
  double drawn[3], held[3], torque[3];
  must(cloth_grasp_wrench(scene, pull, drawn, torque, &err), &err);
  must(cloth_grasp_wrench(scene, hold, held, torque, &err), &err);
  result("capstan", strip_mesh_name[mesh], "T2/T1", mu, drawn[2] / held[2], exp(mu * pi), 0.05);
  cloth_scene_free(scene);
}

// ---- slope --------------------------------------------------------------------------------------

// a sheet on a slope of tan 0.5 for a second: how far it slid, and how far a block would
// have in steps of backward Euler
void case_slope(int mesh, double mu)
{
  const double angle = atan(0.5), seconds = 1, h = 0.01,
               g_along = G * (sin(angle) - mu * cos(angle));
  strip_make(&s, (strip_mesh)mesh, 0.1, 10, 9, 0);
  cloth_error err = {0};
  cloth_def *def = def_new("double");
  def_set(def, "time_step", "0.01"), def_set(def, "pcg_tolerance", "1e-4");
  def_set(def, "effects.self_contact", "off");
  cloth_pose tilt = pose_turned(0, 0, 0, 1, angle), pose = tilt;
  pose.position[0] = 0.00295 * sin(angle), pose.position[2] = 0.00295 * cos(angle);
  solid_box(&body, 8, 2, 0.1);
  cloth_pose floor = tilt;
  floor.position[0] = -0.05 * sin(angle), floor.position[2] = -0.05 * cos(angle);
  def_body(def, "slope", &body, mu, floor);
  cloth_cloth_view v = {.name = "sheet",
                        .mesh = {s.vertices, s.triangles, s.x, s.triangle, NULL},
                        .material = cloth_material_default(),
                        .pose = pose};
  must(cloth_def_add_cloth(def, &v, NULL, &err), &err);
  cloth_scene *scene = scene_new(def);
  static double x0[3 * STRIP_MAX];
  if (!(mu < 0.5)) scene_step(scene, 30); // it lies down first
  scene_positions(scene, 0, x0);
  scene_step(scene, (int)(seconds / h + 0.5));
  scene_positions(scene, 0, x);
  double way = 0, expected = mu < 0.5 ? g_along * seconds * (seconds + h) / 2 : 0;
  for (int i = 0; i < s.vertices; i++)
    way += ((x[3 * i] - x0[3 * i]) * cos(angle) - (x[3 * i + 2] - x0[3 * i + 2]) * sin(angle)) /
           s.vertices;
  result("slope of tan 0.5", strip_mesh_name[mesh],
         expected > 0 ? "way in 1 s [m]" : "creep in 1 s [m]", mu, way, expected,
         expected > 0 ? 0.05 : 1e-4);
  cloth_scene_free(scene);
}
