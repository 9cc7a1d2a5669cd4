// The mass-spring cloth through the public interface: each expected value is worked out here from
// the mesh, the material and the formulas of doc/mass_spring.md.
#include "scene.h"

static sheet cloth;
static solid solids;
static double x[3 * SHEET_MAX], v[3 * SHEET_MAX], mass[SHEET_MAX];

static const double H = 1.0 / 30; // s, a frame: 34 sub-steps of at most 1 ms

static cloth_material soft(void)
{
  cloth_material m = cloth_material_default();
  m.density = 1, m.stretch_warp = m.stretch_weft = 50, m.shear = 10, m.poisson = 0;
  m.bend_warp = m.bend_weft = 1e-6;
  m.damping_stretch = m.damping_bend = m.damping_mass = 0;
  return m;
}

static cloth_def *spring_def(const char *precision)
{
  cloth_def *def = def_new(precision);
  def_set(def, "integrator", "mass_spring");
  cloth_def_params(def)->time_step = H;
  return def;
}

// a quarter of each rectangle
static void masses(const sheet *s, double density)
{
  double dx = s->x[3] - s->x[0], dy = s->x[3 * s->columns + 1] - s->x[1];
  for (int i = 0; i < s->columns * s->rows; i++) {
    int c = i % s->columns, r = i / s->columns;
    mass[i] = density * dx * dy * (c % (s->columns - 1) ? 1 : 0.5) * (r % (s->rows - 1) ? 1 : 0.5);
  }
}

static void add_shape(cloth_def *def, const char *name, cloth_shape shape, double a, double b,
                      double c, double friction, cloth_pose pose)
{
  cloth_error err = {0};
  solid_box(&solids, 0.2, 0.2, 0.2); // what is drawn does not matter here
  cloth_body_view view = {.name = name,
                          .mesh = solid_view(&solids),
                          .pose = pose,
                          .friction = friction,
                          .shape = shape,
                          .size = {a, b, c}};
  must(cloth_def_add_body(def, &view, NULL, &err), &err);
}

// ---- flight -------------------------------------------------------------------------------------

// x after `frames` frames of free fall, by the sums of symplectic Euler
static double fall_of(int frames, bool last_short, double *speed)
{
  double z = 0, w = 0;
  for (int i = 0; i < frames; i++)
    for (int k = 0; k < 34; k++) {
      double h = !last_short ? H / 34 : k < 33 ? 1e-3 : H - 33e-3;
      w -= G * h, z += h * w;
    }
  *speed = w;
  return z;
}

static int fall_with(const char *precision, bool last_short)
{
  sheet_make(&cloth, 0.2, 0.2, 9, 9);
  cloth_def *def = spring_def(precision);
  def_set(def, "spring_cut", last_short ? "last_short" : "equal");
  def_cloth(def, "sheet", &cloth, soft(), pose_at(0, 0, 5));
  cloth_scene *scene = scene_new(def);
  for (int n = 1; n <= 20; n++) {
    cloth_step_report r = scene_step(scene, 1);
    double w, z = 5 + fall_of(n, last_short, &w), tolerance = 34 * n * 10 * epsilon_of(precision);
    scene_positions(scene, 0, x), scene_velocities(scene, 0, v);
    CHECK(r.substeps == 34);
    for (int i = 0; i < 81; i++) {
      CHECK_NEAR(x[3 * i + 2], z, tolerance);
      CHECK_NEAR(v[3 * i + 2], w, tolerance);
      // springs of a float sheet are at rest up to the rounding of their length
      CHECK_NEAR(x[3 * i], cloth.x[3 * i], tolerance + 300 * n * epsilon_of(precision));
    }
  }
  cloth_scene_free(scene);
  return 0;
}

static int fall(const char *precision)
{
  return fall_with(precision, false) || fall_with(precision, true);
}
BOTH(free_fall_is_that_of_symplectic_euler, fall)

// momentum and angular momentum about the origin
static void momenta(int n, double p[3], double l[3], double *size)
{
  for (int k = 0; k < 3; k++) p[k] = l[k] = 0;
  *size = 0;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      int a = (k + 1) % 3, b = (k + 2) % 3;
      p[k] += mass[i] * v[3 * i + k], *size += mass[i] * fabs(v[3 * i + k]);
      l[k] += mass[i] * (x[3 * i + a] * v[3 * i + b] - x[3 * i + b] * v[3 * i + a]);
    }
}

static cloth_material limp(void)
{
  cloth_material m = soft();
  m.stretch_warp = m.stretch_weft = 20, m.shear = 4, m.damping_stretch = 1e-4;
  m.bend_warp = m.bend_weft = 1e-7;
  return m;
}

// a sheet of n x n particles where nothing falls
static cloth_def *weightless(const char *precision, const char *friction, int n, cloth_material m)
{
  sheet_make(&cloth, 0.12, 0.12, n, n);
  cloth_def *def = spring_def(precision);
  def_set(def, "gravity", "0 0 0");
  def_set(def, "friction", friction);
  def_cloth(def, "one", &cloth, m, pose_at(0, 0, 0));
  return def;
}

// two crumpled sheets fly into each other: springs, dampers, particle collisions, friction
static int momentum(const char *precision)
{
  enum { N = 13 };
  double p0[3], l0[3], p1[3], l1[3], size;
  cloth_material m = limp();
  cloth_def *def = weightless(precision, "0.4", N, m);
  def_cloth(def, "two", &cloth, m, pose_turned(0.02, 0.01, 0.03, 0, 0.4));
  cloth_scene *scene = scene_new(def);
  masses(&cloth, m.density);
  memcpy(mass + N * N, mass, sizeof *mass * N * N);
  cloth_error err = {0};
  for (int c = 0; c < 2; c++) {
    for (int i = 0; i < N * N; i++)
      for (int k = 0; k < 3; k++)
        v[3 * (c * N * N + i) + k] = (k == 2) * (c ? -1.0 : 1.0) + 0.3 * sin(7.0 * i + 3 * k + c);
    CHECK_OK(cloth_state_set(scene, c, NULL, v + 3 * c * N * N, N * N, &err), err);
    scene_positions(scene, c, x + 3 * c * N * N);
  }
  momenta(2 * N * N, p0, l0, &size);
  int touched = 0;
  for (int n = 0; n < 20; n++) touched += scene_step(scene, 1).contacts_self;
  for (int c = 0; c < 2; c++) {
    scene_positions(scene, c, x + 3 * c * N * N);
    scene_velocities(scene, c, v + 3 * c * N * N);
  }
  double ignored;
  momenta(2 * N * N, p1, l1, &ignored);
  printf("  contacts seen: %d\n", touched);
  CHECK(touched > 100);
  bool single = precision[0] == 'f';
  for (int k = 0; k < 3; k++) {
    CHECK_NEAR(p1[k], p0[k], size * (single ? 1e-5 : 1e-12));
    // friction acts across the line between two particles: it is a couple, as is that of thick
    // cloth
    CHECK_NEAR(l1[k], l0[k], size * 0.2 * 0.2);
  }
  cloth_scene_free(scene);
  return 0;
}
BOTH(springs_and_collisions_keep_momentum, momentum)

// without friction every force acts along the line between two particles
static int spin(const char *precision)
{
  enum { N = 13 };
  double p0[3], l0[3], p1[3], l1[3], size;
  cloth_material m = limp();
  cloth_def *def = weightless(precision, "0", N, m);
  cloth_scene *scene = scene_new(def);
  masses(&cloth, m.density);
  cloth_error err = {0};
  for (int i = 0; i < N * N; i++) { // folds over a diagonal while it turns
    double a = cloth.x[3 * i] + cloth.x[3 * i + 1];
    v[3 * i] = -3 * cloth.x[3 * i + 1], v[3 * i + 1] = 3 * cloth.x[3 * i],
          v[3 * i + 2] = 60 * a * a;
  }
  CHECK_OK(cloth_state_set(scene, 0, NULL, v, N * N, &err), err);
  scene_positions(scene, 0, x);
  momenta(N * N, p0, l0, &size);
  scene_step(scene, 20);
  scene_positions(scene, 0, x), scene_velocities(scene, 0, v);
  double ignored;
  momenta(N * N, p1, l1, &ignored);
  for (int k = 0; k < 3; k++) {
    double exact = precision[0] == 'f' ? 1e-4 : 1e-11;
    CHECK_NEAR(p1[k], p0[k], size * exact);
    CHECK_NEAR(l1[k], l0[k], size * exact);
  }
  cloth_scene_free(scene);
  return 0;
}
BOTH(without_friction_angular_momentum_stays_too, spin)

// ---- springs ------------------------------------------------------------------------------------

// a chain of n particles of mass m hangs on the first: spring k carries what is below it
static int chain(const char *precision)
{
  enum { ROWS = 11 };
  const double width = 0.02, length = 0.2;
  sheet_make(&cloth, width, length, 2, ROWS);
  cloth_def *def = spring_def(precision);
  cloth_material m = soft();
  m.stretch_warp = m.shear = m.bend_warp = m.bend_weft = 0, m.damping_mass = 5;
  def_cloth(def, "chain", &cloth, m, pose_turned(0, 0, 0, 0, -acos(-1) / 2)); // row 0 on top
  cloth_scene *scene = scene_new(def);
  static const int top[2] = {0, 1};
  cloth_grasp_id id = scene_hold(scene, 0, top, 2, cloth_pose_identity());
  scene_step(scene, 300);
  scene_positions(scene, 0, x);
  masses(&cloth, m.density);
  double a = length / (ROWS - 1), k = m.stretch_weft * (width / 2) / a, below = 0;
  for (int r = ROWS - 1; r > 0; r--) {
    below += mass[2 * r];
    double l = x[3 * 2 * (r - 1) + 2] - x[3 * 2 * r + 2];
    CHECK_NEAR(l - a, below * G / k, 2e-4 * below * G / k + 100 * epsilon_of(precision));
  }
  // and the hold carries all of it but its own two
  double force[3], torque[3], all = 2 * (below + mass[0]) * G;
  cloth_error err = {0};
  CHECK_OK(cloth_grasp_wrench(scene, id, force, torque, &err), err);
  CHECK_NEAR(force[2] / all, 1, 1e-3);
  CHECK_NEAR(force[0] / all, 0, 1e-3);
  cloth_scene_free(scene);
  return 0;
}
BOTH(each_spring_of_a_chain_extends_by_the_weight_below_over_its_stiffness, chain)

// a strip of the whole net, shear and bend springs too, extends as the fabric does
static int strip(const char *precision)
{
  const double length = 0.3, width = 0.1;
  sheet_make(&cloth, width, length, 6, 16);
  cloth_def *def = spring_def(precision);
  cloth_material m = soft();
  m.density = 0.5, m.stretch_weft = m.stretch_warp = 40, m.shear = 8, m.damping_mass = 5;
  m.bend_warp = m.bend_weft = 1e-5;
  def_set(def, "spring_step", "0");
  def_cloth(def, "strip", &cloth, m, pose_turned(0, 0, 0, 0, -acos(-1) / 2));
  cloth_scene *scene = scene_new(def);
  int top[6] = {0, 1, 2, 3, 4, 5};
  scene_hold(scene, 0, top, 6, cloth_pose_identity());
  scene_step(scene, 300);
  scene_positions(scene, 0, x);
  double drop = 0, expected = m.density * G * length * length / (2 * m.stretch_weft);
  for (int c = 0; c < 6; c++) drop += (x[3 * c + 2] - x[3 * (15 * 6 + c) + 2]) / 6;
  // the held end cannot narrow, which stiffens a length of about the width by G / E, and springs
  // are linear in length where the strain is 2 expected / length
  CHECK_NEAR((drop - length) / expected, 1, 0.03);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_hanging_strip_extends_by_rho_g_L_squared_over_2_E, strip)

// two particles on two springs: period, and energy over a hundred of them
static int oscillator(const char *precision)
{
  const double a = 0.02, pi = acos(-1), amplitude = 1e-3;
  sheet_make(&cloth, a, a, 2, 2);
  cloth_def *def = spring_def(precision);
  cloth_material m = soft();
  m.stretch_warp = m.shear = m.bend_warp = m.bend_weft = 0;
  def_set(def, "gravity", "0 0 0");
  def_set(def, "effects.self_contact", "off");
  cloth_def_params(def)->time_step = 1e-3;
  def_cloth(def, "spring", &cloth, m, pose_at(0, 0, 0));
  cloth_scene *scene = scene_new(def);
  static const int low[2] = {0, 1};
  scene_hold(scene, 0, low, 2, cloth_pose_identity());
  scene_positions(scene, 0, x);
  x[7] += amplitude, x[10] += amplitude;
  cloth_error err = {0};
  CHECK_OK(cloth_state_set(scene, 0, x, NULL, 4, &err), err);
  double k = m.stretch_weft / 2, mk = m.density * a * a / 4, h = 1e-3, w = sqrt(k / mk);
  // symplectic Euler: sin(W h / 2) = w h / 2
  double period = pi * h / asin(w * h / 2), last = amplitude, first = -1, at = 0, most = 0,
         least = 1;
  int crossings = 0;
  for (int n = 1; n <= (int)(100.3 * period / h); n++) {
    scene_step(scene, 1);
    scene_positions(scene, 0, x), scene_velocities(scene, 0, v);
    double now = x[7] - x[1] - a, e = k / 2 * now * now + mk / 2 * v[7] * v[7];
    if (last > 0 && now <= 0) {
      at = h * (n - 1 + last / (last - now));
      if (crossings++ == 0) first = at;
    }
    last = now, most = fmax(most, e), least = fmin(least, e);
  }
  CHECK(crossings == 101);
  CHECK_NEAR((at - first) / 100 / period, 1, 1e-3);
  double e0 = k / 2 * amplitude * amplitude;
  // the conserved energy differs from the true one by w h / 2 of it either way, and no more
  CHECK(most < e0 * (1 + w * h) && least > e0 * (1 - w * h));
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_mass_on_a_spring_has_its_period_and_keeps_its_energy, oscillator)

// a stiff plate on two pins, as a pendulum of four particles, two of them held
static int pendulum(const char *precision)
{
  const double length = 0.1, angle = 0.05, pi = acos(-1);
  sheet_make(&cloth, length, length, 2, 2);
  cloth_def *def = spring_def(precision);
  cloth_material m = soft();
  m.stretch_warp = m.stretch_weft = 300, m.shear = 100, m.bend_warp = m.bend_weft = 0;
  cloth_def_params(def)->time_step = 1e-3;
  def_cloth(def, "plate", &cloth, m, pose_turned(0, 0, 0, 0, -pi / 2 + angle));
  cloth_scene *scene = scene_new(def);
  static const int top[2] = {0, 1};
  scene_hold(scene, 0, top, 2, cloth_pose_identity());
  double last = angle, first = 0, at = 0;
  int crossings = 0;
  for (int n = 1; n < 5000 && crossings < 9; n++) {
    scene_step(scene, 1);
    scene_positions(scene, 0, x);
    double now = atan2((x[7] + x[10]) / 2 - x[1], x[2] - (x[8] + x[11]) / 2);
    if ((last > 0) != (now > 0)) {
      at = 1e-3 * (n - 1 + last / (last - now));
      if (crossings++ == 0) first = at;
    }
    last = now;
  }
  CHECK(crossings == 9);
  // a point mass on a spring: longer by its weight; the swing adds angle^2 / 16
  double k = 300.0 / 2, stretch = m.density * length * length / 4 * G / k;
  double period = 2 * pi * sqrt((length + stretch) / G);
  CHECK_NEAR((at - first) / 4 / period, 1, angle * angle / 16 + 2e-3);
  cloth_scene_free(scene);
  return 0;
}
BOTH(pendulum_has_its_period, pendulum)

// ---- air ----------------------------------------------------------------------------------------

static int air(const char *precision)
{
  sheet_make(&cloth, 0.2, 0.2, 9, 9);
  cloth_def *def = spring_def(precision);
  cloth_material m = soft();
  def_set(def, "gravity", "0 0 0");
  def_set(def, "air_density", "1.2");
  def_set(def, "wind", "0 0 5");
  cloth_def_params(def)->time_step = 1e-3;
  def_cloth(def, "sheet", &cloth, m, pose_at(0, 0, 0));
  cloth_scene *scene = scene_new(def);
  scene_step(scene, 1);
  scene_velocities(scene, 0, v);
  masses(&cloth, m.density);
  double p = 0;
  for (int i = 0; i < 81; i++) p += mass[i] * v[3 * i + 2];
  double expected = 1.2 / 2 * m.drag * 25 * 0.04 * 1e-3; // rho/2 Cd u^2 A h
  CHECK_NEAR(p / expected, 1, precision[0] == 'f' ? 1e-5 : 1e-12);
  cloth_scene_free(scene);
  return 0;
}
BOTH(wind_presses_by_rho_over_2_u_squared_times_area, air)

// ---- bodies -------------------------------------------------------------------------------------

// distance of a point of the scene from a body's shape, at most: nearest point by clamping
static double gap_to(cloth_scene *scene, int body, cloth_shape shape, const double *size,
                     const double *p)
{
  cloth_pose pose = cloth_body_pose(scene, body);
  double d[3], q[3], sum = 0;
  const double *r = pose.rotation; // back into the frame of the body
  for (int k = 0; k < 3; k++) d[k] = p[k] - pose.position[k];
  for (int k = 0; k < 3; k++) {
    int a = (k + 1) % 3, b = (k + 2) % 3;
    double u[3];
    for (int c = 0; c < 3; c++) {
      int e = (c + 1) % 3, f = (c + 2) % 3;
      u[c] = -(r[e] * d[f] - r[f] * d[e]) + r[3] * d[c];
    }
    q[k] = d[k] + 2 * -(r[a] * u[b] - r[b] * u[a]);
  }
  if (shape == CLOTH_SHAPE_PLANE) return q[2];
  if (shape == CLOTH_SHAPE_SPHERE) return sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) - size[0];
  for (int k = 0; k < 3; k++) sum += pow(fmax(0, fabs(q[k]) - size[k] / 2), 2);
  return sqrt(sum);
}

// a sheet falls onto a ball that rolls away, a turning box and a floor
static int outside(const char *precision)
{
  static const cloth_shape shape[3] = {CLOTH_SHAPE_PLANE, CLOTH_SHAPE_SPHERE, CLOTH_SHAPE_BOX};
  static const double size[3][3] = {{0}, {0.08}, {0.1, 0.2, 0.08}};
  sheet_make(&cloth, 0.4, 0.4, 21, 21);
  cloth_def *def = spring_def(precision);
  cloth_material m = soft();
  m.damping_stretch = 2e-4;
  def_set(def, "particle_radius", "0.008");
  def_cloth(def, "sheet", &cloth, m, pose_at(0, 0, 0.25));
  add_shape(def, "floor", shape[0], 0, 0, 0, 0.3, cloth_pose_identity());
  add_shape(def, "ball", shape[1], size[1][0], 0, 0, 0.3, pose_at(0.05, 0, 0.09));
  add_shape(def, "box", shape[2], size[2][0], size[2][1], size[2][2], 0.3, pose_at(-0.1, 0, 0.06));
  cloth_scene *scene = scene_new(def);
  double least = 1;
  int touched = 0;
  cloth_error err = {0};
  for (int n = 0; n < 45; n++) {
    cloth_pose ball = pose_at(0.05 + 0.004 * n, 0, 0.09);
    cloth_pose box = pose_turned(-0.1, 0.001 * n, 0.06, 2, 0.05 * n);
    CHECK_OK(cloth_body_move(scene, 1, &ball, &err), err);
    CHECK_OK(cloth_body_move(scene, 2, &box, &err), err);
    touched += scene_step(scene, 1).contacts_body;
    scene_positions(scene, 0, x);
    for (int i = 0; i < 441; i++)
      for (int b = 0; b < 3; b++) {
        double gap = gap_to(scene, b, shape[b], size[b], x + 3 * i);
        // between ball, box and floor there may be less room than a particle needs
        least = fmin(least, gap);
        CHECK(gap > 0.8 * 0.008);
      }
  }
  printf("  nearest %.6f m of 0.008, %d contacts\n", least, touched);
  CHECK(touched > 1000);
  cloth_scene_free(scene);
  return 0;
}
BOTH(particles_stay_outside_of_floor_ball_and_box, outside)

// a floor alone leaves room: the radius is kept to rounding
static int on_floor(const char *precision)
{
  sheet_make(&cloth, 0.2, 0.2, 11, 11);
  cloth_def *def = spring_def(precision);
  def_cloth(def, "sheet", &cloth, soft(), pose_turned(0, 0, 0.3, 0, 0.7));
  def_set(def, "particle_radius", "0.006");
  add_shape(def, "floor", CLOTH_SHAPE_PLANE, 0, 0, 0, 0.3, cloth_pose_identity());
  cloth_scene *scene = scene_new(def);
  for (int n = 0; n < 60; n++) {
    scene_step(scene, 1);
    scene_positions(scene, 0, x);
    for (int i = 0; i < 121; i++) CHECK(x[3 * i + 2] >= 0.006 - 4 * epsilon_of(precision));
  }
  cloth_scene_free(scene);
  return 0;
}
BOTH(the_floor_is_never_nearer_than_the_radius, on_floor)

// a sheet on a slope of angle a slides when tan a > mu, with g (sin a - mu cos a)
static int slope(const char *precision)
{
  for (int slides = 0; slides < 2; slides++) {
    const double mu = 0.4, angle = slides ? 0.5 : 0.3;
    sheet_make(&cloth, 0.1, 0.1, 6, 6);
    cloth_def *def = spring_def(precision);
    def_cloth(def, "sheet", &cloth, soft(),
              pose_turned(0, -0.01 * sin(angle), 0.01 * cos(angle), 0, angle));
    def_set(def, "particle_radius", "0.01");
    add_shape(def, "slope", CLOTH_SHAPE_PLANE, 0, 0, 0, mu, pose_turned(0, 0, 0, 0, angle));
    cloth_scene *scene = scene_new(def);
    scene_step(scene, 15);
    scene_velocities(scene, 0, v);
    scene_positions(scene, 0, x);
    double t = 15 * H, a = G * (sin(angle) - mu * cos(angle)), along = 0;
    for (int i = 0; i < 36; i++)
      along -= (v[3 * i + 1] * cos(angle) + v[3 * i + 2] * sin(angle)) / 36;
    if (slides) {
      CHECK_NEAR(along / (a * t), 1, precision[0] == 'f' ? 1e-3 : 1e-6);
    } else {
      CHECK_NEAR(along, 0, precision[0] == 'f' ? 1e-6 : 1e-12);
      double moved = hypot(x[1] - (cloth.x[1] * cos(angle) - 0.01 * sin(angle)),
                           x[2] - (cloth.x[1] * sin(angle) + 0.01 * cos(angle)));
      CHECK(moved < 1e-5);
    }
    cloth_scene_free(scene);
  }
  return 0;
}
BOTH(a_sheet_on_a_slope_slides_exactly_when_tan_a_exceeds_mu, slope)

// ---- holds --------------------------------------------------------------------------------------

static int held(const char *precision)
{
  sheet_make(&cloth, 0.2, 0.2, 11, 11);
  cloth_def *def = spring_def(precision);
  def_cloth(def, "sheet", &cloth, soft(), pose_at(0, 0, 0));
  cloth_scene *scene = scene_new(def);
  static const int fixed[1] = {0}, moving[2] = {120, 119};
  scene_hold(scene, 0, fixed, 1, cloth_pose_identity());
  cloth_grasp_id id = scene_hold(scene, 0, moving, 2, pose_at(0.1, 0.1, 0));
  cloth_error err = {0};
  for (int n = 1; n <= 30; n++) {
    double s = 0.003 * n, turn = 0.02 * n;
    cloth_pose p = pose_turned(0.1, 0.1 - s, s, 2, turn);
    CHECK_OK(cloth_grasp_move(scene, id, &p, &err), err);
    scene_step(scene, 1);
    scene_positions(scene, 0, x);
    double tolerance = 4 * epsilon_of(precision);
    CHECK_NEAR(x[0], -0.1, tolerance);
    CHECK_NEAR(x[1], -0.1, tolerance);
    CHECK_NEAR(x[2], 0, tolerance);
    CHECK_NEAR(x[360], 0.1, tolerance);
    CHECK_NEAR(x[361], 0.1 - s, tolerance);
    CHECK_NEAR(x[362], s, tolerance);
    CHECK_NEAR(x[357], 0.1 - 0.02 * cos(turn), tolerance);
    CHECK_NEAR(x[358], 0.1 - s - 0.02 * sin(turn), tolerance);
  }
  CHECK_OK(cloth_grasp_release(scene, id, &err), err);
  scene_step(scene, 3);
  scene_positions(scene, 0, x);
  CHECK(x[362] < 0.09 - 0.005); // falls
  cloth_scene_free(scene);
  return 0;
}
BOTH(held_particles_are_exactly_where_they_are_held, held)

static int pulled(const char *precision)
{
  sheet_make(&cloth, 0.2, 0.2, 11, 11);
  cloth_def *def = spring_def(precision);
  cloth_material m = soft();
  m.damping_mass = 5, m.damping_stretch = 2e-4;
  def_cloth(def, "sheet", &cloth, m, pose_at(0, 0, 0));
  cloth_scene *scene = scene_new(def);
  static const int corner[1] = {0};
  cloth_error err = {0};
  cloth_grasp_id id;
  cloth_grasp_view g = {
      .count = 1, .vertex = corner, .body = -1, .frame = pose_at(-0.1, -0.1, 0), .stiffness = 20};
  CHECK_OK(cloth_grasp(scene, &g, &id, &err), err);
  scene_step(scene, 200);
  double force[3], torque[3], weight = 0.04 * G;
  CHECK_OK(cloth_grasp_wrench(scene, id, force, torque, &err), err);
  scene_positions(scene, 0, x);
  CHECK_NEAR(force[2] / weight, 1, 1e-2);
  CHECK_NEAR(-x[2] * 20 / weight, 1, 1e-2);
  // too stiff for the sub-step: refused, and nothing has changed
  CHECK_OK(cloth_grasp_release(scene, id, &err), err);
  g.stiffness = 1e4;
  CHECK_OK(cloth_grasp(scene, &g, &id, &err), err);
  uint64_t before = scene_hash(scene);
  CHECK(cloth_step(scene, 0, NULL, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strstr(err.text, "spring_step") && strstr(err.text, "stiffness 10000"));
  CHECK(scene_hash(scene) == before);
  cloth_scene_free(scene);
  return 0;
}
BOTH(a_hold_on_a_spring_carries_the_weight_and_is_refused_when_too_stiff, pulled)

// ---- what is refused ----------------------------------------------------------------------------

// damped so much that the stable sub-step is some nanoseconds
static int too_many_sub_steps(void)
{
  cloth_error err = {0};
  cloth_scene *scene = NULL;
  cloth_step_report report;
  cloth_material m = cloth_material_default();
  m.damping_stretch = 10;
  sheet_make(&cloth, 0.2, 0.2, 11, 11);
  cloth_def *def = spring_def("double");
  def_set(def, "spring_step", "0"), def_set(def, "time_step", "0.1");
  def_cloth(def, "towel", &cloth, m, pose_at(0, 0, 0));
  CHECK(cloth_scene_new(def, &scene, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strstr(err.text, "a step of 0.1 s needs") && strstr(err.text, "at most 1000000"));
  CHECK(strstr(err.text, "of cloth towel has"));
  def_set(def, "time_step", "0.0002"); // a shorter step has fewer
  err = (cloth_error){0};
  CHECK_OK(cloth_scene_new(def, &scene, &err), err);
  uint64_t before, after;
  CHECK_OK(cloth_state_hash(scene, &before, &err), err);
  CHECK(cloth_step(scene, 0.1, &report, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strstr(err.text, "a step of 0.1 s needs"));
  CHECK_OK(cloth_state_hash(scene, &after, &err), err);
  CHECK(after == before);
  cloth_scene_free(scene);
  cloth_def_free(def);
  return 0;
}

static int refusals(void)
{
  cloth_error err = {0};
  cloth_scene *scene = NULL;
  sheet_make(&cloth, 0.2, 0.2, 11, 11);
  cloth_def *def = spring_def("double");
  def_cloth(def, "towel", &cloth, cloth_material_default(), pose_at(0, 0, 0));
  CHECK(cloth_scene_new(def, &scene, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strstr(err.text, "spring_step = 0.001 [s] is above the stable limit") != NULL);
  CHECK(strstr(err.text, "towel") != NULL);
  def_set(def, "spring_step", "0"); // then it takes what is stable
  solid_box(&solids, 0.1, 0.1, 0.1);
  def_body(def, "crate", &solids, 0.3, pose_at(0, 0, -1));
  err = (cloth_error){0};
  CHECK(cloth_scene_new(def, &scene, &err) == CLOTH_UNSUPPORTED);
  CHECK(strstr(err.text, "crate is a mesh") != NULL);
  def_set(def, "effects.body_contact", "off");
  err = (cloth_error){0};
  CHECK_OK(cloth_scene_new(def, &scene, &err), err);
  cloth_body_pair pair;
  int count;
  CHECK(cloth_body_pairs(scene, 0.01, &pair, 1, &count, &err) == CLOTH_UNSUPPORTED);
  cloth_tangle_view tangle;
  CHECK(cloth_tangles(scene, &tangle, 1, &count, &err) == CLOTH_UNSUPPORTED);
  cloth_scene_free(scene);
  def_set(def, "effects.membrane", "on");
  err = (cloth_error){0};
  CHECK(cloth_scene_new(def, &scene, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "membrane is 'on'") && strstr(err.text, "mass_spring"));
  cloth_def_free(def);
  return 0;
}

// out of bounds: the state is that before the step
static int unstable(const char *precision)
{
  sheet_make(&cloth, 0.2, 0.2, 11, 11);
  cloth_def *def = spring_def(precision);
  def_set(def, "bounds", "1");
  def_cloth(def, "sheet", &cloth, soft(), pose_at(0, 0, 0));
  cloth_scene *scene = scene_new(def);
  cloth_error err = {0};
  int n = 0;
  uint64_t before = 0;
  cloth_status status = CLOTH_OK;
  for (; n < 60 && status == CLOTH_OK; n++) {
    before = scene_hash(scene);
    status = cloth_step(scene, 0, NULL, &err);
  }
  CHECK(status == CLOTH_UNSTABLE && n > 10 && n < 20);
  CHECK(scene_hash(scene) == before);
  cloth_scene_free(scene);
  return 0;
}
BOTH(leaving_the_bounds_is_undone, unstable)

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(free_fall_is_that_of_symplectic_euler);
  RUN(springs_and_collisions_keep_momentum);
  RUN(without_friction_angular_momentum_stays_too);
  RUN(each_spring_of_a_chain_extends_by_the_weight_below_over_its_stiffness);
  RUN(a_hanging_strip_extends_by_rho_g_L_squared_over_2_E);
  RUN(a_mass_on_a_spring_has_its_period_and_keeps_its_energy);
  RUN(pendulum_has_its_period);
  RUN(wind_presses_by_rho_over_2_u_squared_times_area);
  RUN(particles_stay_outside_of_floor_ball_and_box);
  RUN(the_floor_is_never_nearer_than_the_radius);
  RUN(a_sheet_on_a_slope_slides_exactly_when_tan_a_exceeds_mu);
  RUN(held_particles_are_exactly_where_they_are_held);
  RUN(a_hold_on_a_spring_carries_the_weight_and_is_refused_when_too_stiff);
  RUN(refusals);
  RUN(too_many_sub_steps);
  RUN(leaving_the_bounds_is_undone);
  return failures > 0;
}
