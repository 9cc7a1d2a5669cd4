// Strips that bend: cantilever, load at the end, moment at the end, heart loop.
#include "validate/cases.h"
#include "validate/reference.h"
#include "validate/strip.h"

static const double length = 0.2, density = 0.2; // m, kg/m^2
static strip s;
static double x[3 * STRIP_MAX];

// weight and bending as wanted; stiff in its plane: density g L / (E h) < 1e-4
static cloth_material stiff(double rigidity, double least_stretch)
{
  cloth_material m = cloth_material_default();
  m.density = density;
  m.stretch_warp = m.stretch_weft = least_stretch, m.shear = 0.4 * least_stretch, m.poisson = 0.25;
  m.bend_warp = m.bend_weft = rigidity;
  m.damping_stretch = m.damping_bend = m.damping_mass = 0;
  return m;
}

static const cloth_grasp_view rigid = {.frame = {{0, 0, 0}, {0, 0, 0, 1}}};

// about six cells in the boundary layer L / sqrt(gamma)
static int cells_for(double gamma)
{
  int n = (int)(6 * sqrt(gamma));
  return n < 40 ? 40 : n > 190 ? 190 : n;
}

// measured and exact drop over reach of a strip under its own weight
static void sag(int mesh, double gamma, const char *model, int cells, double *measured,
                double *expected)
{
  double rigidity = density * G * length * length * length / gamma, drop, reach;
  strip_make(&s, (strip_mesh)mesh, length, cells > 0 ? cells : cells_for(gamma), 4, 0);
  cloth_scene *scene =
      strip_scene(&s, stiff(rigidity, 1.2e4 * density * G * length), "0 0 -9.81", model);
  strip_hold(&s, scene, 0, 1, &rigid);
  double energy = density * s.width * length * G * length;
  strip_settle(scene, 1e-11 * energy, 400);
  scene_positions(scene, 0, x);
  double H = -strip_mean(&s, x, s.columns - 1, 2), W = strip_mean(&s, x, s.columns - 1, 0);
  reference_cantilever(gamma, 0, &drop, &reach);
  *measured = H / W, *expected = drop / reach;
  cloth_scene_free(scene);
}

void case_cantilever(int mesh, double gamma, const char *model, int cells)
{
  double measured, expected;
  char name[64];
  sag(mesh, gamma, model, cells, &measured, &expected);
  snprintf(name, sizeof name, "cantilever %s", model);
  result(name, strip_mesh_name[mesh], "H/W", gamma, measured, expected, 0.03);
}

// halving the cells quarters the error
void case_mesh_order(int mesh, double gamma)
{
  double error[2], measured, expected;
  for (int i = 0; i < 2; i++) {
    sag(mesh, gamma, "shape", 8 << i, &measured, &expected);
    error[i] = fabs(measured - expected);
  }
  result("order in mesh size", strip_mesh_name[mesh], "order", gamma, log2(error[0] / error[1]), 2,
         0.2);
}

// a dead load: a soft spring to a far place
void case_tip_load(int mesh, double load, const char *model)
{
  const double rigidity = 1e-3, away = 50;
  strip_make(&s, (strip_mesh)mesh, length, 60, 4, 0);
  double force = load * rigidity / (length * length) * s.width, drop, reach;
  cloth_scene *scene = strip_scene(&s, stiff(rigidity, 1e4), "0 0 0", model);
  strip_hold(&s, scene, 0, 1, &rigid);
  int last = s.columns - 1, n = s.column_first[last + 1] - s.column_first[last];
  cloth_grasp_view soft = {.frame = {{0, 0, 0}, {0, 0, 0, 1}}, .stiffness = force / (n * away)};
  cloth_grasp_id id = strip_hold(&s, scene, last, last, &soft);
  cloth_error err = {0};
  cloth_pose far = pose_at(0, 0, -away);
  must(cloth_grasp_move(scene, id, &far, &err), &err);
  strip_settle(scene, 1e-11 * force * length, 400);
  scene_positions(scene, 0, x);
  double H = -strip_mean(&s, x, last, 2), W = strip_mean(&s, x, last, 0);
  reference_cantilever(0, load * (away - H) / away, &drop, &reach);
  char name[64];
  snprintf(name, sizeof name, "tip load %s", model);
  result(name, strip_mesh_name[mesh], "deflection/L", load, H / length, drop, 0.05);
  result(name, strip_mesh_name[mesh], "reach/L", load, W / length, reach, 0.05);
  cloth_scene_free(scene);
}

// The end is led round as a moment would lead it; it must then exert that moment, no force, and the
// strip between must lie on the circle.
void case_end_moment(int mesh, const char *model)
{
  const double rigidity = 1e-3, turn = 2 * acos(-1);
  enum { STEPS = 80 };
  strip_make(&s, (strip_mesh)mesh, length, 60, 4, 1);
  cloth_scene *scene = strip_scene(&s, stiff(rigidity, 1e4), "0 0 0", model);
  strip_hold(&s, scene, 0, 1, &rigid);
  cloth_grasp_view end = {.frame = pose_at(length, 0, 0)};
  cloth_grasp_id id = strip_hold(&s, scene, s.columns - 2, s.columns - 1, &end);
  cloth_error err = {0};
  char name[64];
  snprintf(name, sizeof name, "end moment %s", model);
  for (int n = 1; n <= STEPS; n++) {
    double phi = turn * n / STEPS, kappa = phi / length, force[3], torque[3], off = 0;
    cloth_pose to = pose_turned(sin(phi) / kappa, 0, (1 - cos(phi)) / kappa, 1, -phi);
    must(cloth_grasp_move(scene, id, &to, &err), &err);
    scene_step(scene, 1);
    if (n % 20) continue;
    strip_settle(scene, 1e-13, 200);
    must(cloth_grasp_wrench(scene, id, force, torque, &err), &err);
    scene_positions(scene, 0, x);
    for (int c = 1; c < s.columns - 1; c++) {
      double dx = strip_mean(&s, x, c, 0), dz = strip_mean(&s, x, c, 2) - 1 / kappa;
      off = fmax(off, fabs(sqrt(dx * dx + dz * dz) - 1 / kappa));
    }
    result(name, strip_mesh_name[mesh], "moment L/D", phi,
           fabs(torque[1]) / s.width * length / rigidity, phi, 0.05);
    result(name, strip_mesh_name[mesh], "off the circle/L", phi, off / length, 0, 0.01);
  }
  cloth_scene_free(scene);
}

void case_heart_loop(int mesh, double gamma, const char *model)
{
  enum { HALF = 30 };
  double rigidity = density * G * length * length * length / gamma;
  double depth, half_width, top, rx[HALF + 1], rz[HALF + 1];
  strip_make(&s, (strip_mesh)mesh, length, 2 * HALF, 4, 1);
  reference_heart_loop(0, &depth, &half_width, &top, HALF, rx, rz); // where it starts
  cloth_scene *scene =
      strip_scene(&s, stiff(rigidity, 1.2e4 * density * G * length), "0 0 -9.81", model);
  cloth_error err = {0};
  for (int v = 0; v < s.vertices; v++) { // strip coordinate to a place on the loop
    double at = s.x[3 * v] / length * 2 * HALF - HALF, a = fabs(at);
    int i = a < HALF ? (int)a : HALF - 1;
    double w = a - i, side = at < 0 ? -1 : 1;
    x[3 * v] = a > HALF ? 0 : side * length * (rx[i] + w * (rx[i + 1] - rx[i]));
    x[3 * v + 1] = s.x[3 * v + 1];
    x[3 * v + 2] = a > HALF ? -(a - HALF) * s.h : length * (rz[i] + w * (rz[i + 1] - rz[i]));
  }
  must(cloth_state_set(scene, 0, x, NULL, s.vertices, &err), &err);
  strip_hold(&s, scene, 0, 1, &rigid);
  strip_hold(&s, scene, s.columns - 2, s.columns - 1, &rigid);
  strip_settle(scene, 1e-11 * density * s.width * length * G * length, 400);
  scene_positions(scene, 0, x);
  double low = 0, high = 0, wide = 0;
  for (int c = 1; c < s.columns - 1; c++) {
    double px = strip_mean(&s, x, c, 0), pz = strip_mean(&s, x, c, 2);
    low = fmin(low, pz), high = fmax(high, pz), wide = fmax(wide, px);
  }
  reference_heart_loop(gamma, &depth, &half_width, &top, 0, NULL, NULL);
  char name[64];
  snprintf(name, sizeof name, "heart loop %s", model);
  result(name, strip_mesh_name[mesh], "depth/L", gamma, -low / length, depth, 0.05);
  result(name, strip_mesh_name[mesh], "half width/L", gamma, wide / length, half_width, 0.05);
  cloth_scene_free(scene);
}
