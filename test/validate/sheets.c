// Hanging sheets: frequencies, catenary; and the Cusick drape of discs.
#include "validate/cases.h"
#include "validate/strip.h"

#include <unistd.h>

static strip s;
static double x[3 * STRIP_MAX];
static const cloth_grasp_view rigid = {.frame = {{0, 0, 0}, {0, 0, 0, 1}}};

static cloth_material limp(void)
{
  cloth_material m = cloth_material_default();
  m.density = 0.2, m.stretch_warp = m.stretch_weft = 2e4, m.shear = 8e3;
  m.bend_warp = m.bend_weft = 1e-9;
  m.damping_stretch = m.damping_bend = m.damping_mass = 0;
  return m;
}

// A sheet that hangs along x is let go in the shape of mode n and timed. Backward Euler turns
// frequency w into atan(w h) / h.
void case_hanging_sheet(int mesh, int mode)
{
  static const double zero[4] = {0, 2.404825557695773, 5.520078110286311, 8.653727912911013};
  const double length = 0.5, omega = zero[mode] / 2 * sqrt(G / length), h = 0.02 / omega;
  strip_make(&s, (strip_mesh)mesh, length, 50, 4, 0);
  cloth_scene *scene = strip_scene(&s, limp(), "9.81 0 0", "shape"); // gravity along the strip
  strip_hold(&s, scene, 0, 1, &rigid);
  strip_settle(scene, 1e-14, 60); // its own stretch
  scene_positions(scene, 0, x);
  for (int v = 0; v < s.vertices; v++) {
    double above = fmax(0, (length - x[3 * v]) / length); // from the free end
    x[3 * v + 2] = 1e-3 * length * j0(zero[mode] * sqrt(fmin(1, above)));
  }
  cloth_error err = {0};
  must(cloth_state_set(scene, 0, x, NULL, s.vertices, &err), &err);
  double last = strip_mean(&s, x, s.columns - 1, 2), first = 0, period = 0;
  for (int n = 1, crossings = 0; n < 2000 && crossings < 3; n++) {
    must(cloth_step(scene, h, NULL, &err), &err);
    scene_positions(scene, 0, x);
    double now = strip_mean(&s, x, s.columns - 1, 2), at = (n - 1 + last / (last - now)) * h;
    if ((now > 0) != (last > 0) && crossings++ == 0) first = at;
    period = at - first;
    last = now;
  }
  double expected = atan(omega * h) / h;
  result("hanging sheet", strip_mesh_name[mesh], "frequency [rad/s]", mode, 2 * acos(-1) / period,
         expected, 0.02);
  cloth_scene_free(scene);
}

// sag over length of a chain whose ends are `apart` of its length apart, level
static double catenary_sag(double apart)
{
  double low = 1e-6, high = 50; // u = apart L / 2a: sinh(u) / u = 1 / apart
  for (int i = 0; i < 200; i++) {
    double u = (low + high) / 2;
    if (sinh(u) / u < 1 / apart)
      low = u;
    else
      high = u;
  }
  return apart / (2 * low) * (cosh(low) - 1);
}

void case_catenary(int mesh, double apart)
{
  const double length = 0.5;
  strip_make(&s, (strip_mesh)mesh, length, 50, 4, 0);
  cloth_scene *scene = strip_scene(&s, limp(), "0 0 -9.81", "shape");
  double rise = length / 2 * sqrt(1 - apart * apart); // start: a V
  for (int v = 0; v < s.vertices; v++) {
    double at = fmax(0, s.x[3 * v]) / length;
    x[3 * v] = s.x[3 * v] < 0 ? s.x[3 * v] * apart : apart * length * at;
    x[3 * v + 1] = s.x[3 * v + 1];
    x[3 * v + 2] = -rise * (1 - fabs(2 * at - 1));
  }
  cloth_error err = {0};
  must(cloth_state_set(scene, 0, x, NULL, s.vertices, &err), &err);
  strip_hold(&s, scene, 1, 1, &rigid);
  strip_hold(&s, scene, s.columns - 1, s.columns - 1, &rigid);
  strip_settle(scene, 1e-12, 300);
  scene_positions(scene, 0, x);
  double low = 0;
  for (int c = 0; c < s.columns; c++)
    if (c > 0) low = fmin(low, strip_mean(&s, x, c, 2));
  result("catenary", strip_mesh_name[mesh], "sag/L", apart, -low / length, catenary_sag(apart),
         0.02);
  cloth_scene_free(scene);
}

// ---- drape --------------------------------------------------------------------------------------

// rings of 6 k vertices: triangles of one size
static void disc(double radius, int rings)
{
  const double pi = acos(-1);
  s.vertices = s.triangles = 0;
  for (int k = 0; k <= rings; k++)
    for (int i = 0; i < (k ? 6 * k : 1); i++) {
      double turn = k ? 2 * pi * i / (6 * k) : 0;
      double *p = s.x + 3 * s.vertices++;
      p[0] = radius * k / rings * cos(turn), p[1] = radius * k / rings * sin(turn), p[2] = 0;
    }
  for (int k = 1; k <= rings; k++) {
    int outer = 1 + 3 * k * (k - 1), inner = k > 1 ? 1 + 3 * (k - 1) * (k - 2) : 0;
    int few = k > 1 ? 6 * (k - 1) : 1;
    for (int side = 0; side < 6; side++)
      for (int i = 0; i < k; i++) {
        int a = outer + side * k + i, b = outer + (side * k + i + 1) % (6 * k);
        int c = inner + (side * (k - 1) + i) % few,
            d = inner + (side * (k - 1) + i + few - 1) % few;
        int *t = s.triangle + 3 * s.triangles;
        t[0] = a, t[1] = b, t[2] = c, s.triangles++;
        if (i > 0) t[3] = a, t[4] = c, t[5] = d, s.triangles++;
      }
  }
}

// area of the shadow from above [m^2], counted in squares of 1 mm
static double shadow(void)
{
  enum { N = 320 };
  static unsigned char dark[N][N];
  memset(dark, 0, sizeof dark);
  for (int t = 0; t < s.triangles; t++) {
    double p[3][2], low[2] = {N, N}, high[2] = {0, 0};
    for (int k = 0; k < 3; k++)
      for (int c = 0; c < 2; c++) {
        p[k][c] = x[3 * s.triangle[3 * t + k] + c] * 1000 + N / 2;
        low[c] = fmax(0, fmin(low[c], p[k][c])), high[c] = fmin(N - 1, fmax(high[c], p[k][c]));
      }
    for (int i = (int)low[0]; i <= (int)high[0]; i++)
      for (int j = (int)low[1]; j <= (int)high[1]; j++) {
        int plus = 0, minus = 0;
        for (int k = 0; k < 3; k++) {
          const double *a = p[k], *b = p[(k + 1) % 3];
          double side = (b[0] - a[0]) * (j + 0.5 - a[1]) - (b[1] - a[1]) * (i + 0.5 - a[0]);
          plus += side > 0, minus += side < 0;
        }
        if (plus == 0 || minus == 0) dark[i][j] = 1;
      }
  }
  int count = 0;
  for (int i = 0; i < N * N; i++) count += dark[i / N][i % N];
  return count * 1e-6;
}

// the mesh as a cloth of a fabric of config/materials, through files as a user would
static cloth_scene *scene_of_fabric(const char *fabric)
{
  cloth_error err = {0};
  cloth_def *def = NULL;
  char folder[] = "/tmp/cloth_validate_XXXXXX", scene[64], mesh[64];
  if (mkdtemp(folder) == NULL) return NULL;
  snprintf(scene, sizeof scene, "%s/scene.yaml", folder);
  snprintf(mesh, sizeof mesh, "%s/disc.obj", folder);
  FILE *f = fopen(mesh, "w");
  for (int v = 0; f && v < s.vertices; v++)
    fprintf(f, "v %.17g %.17g 0\n", s.x[3 * v], s.x[3 * v + 1]);
  for (int t = 0; f && t < s.triangles; t++)
    fprintf(f, "f %d %d %d\n", s.triangle[3 * t] + 1, s.triangle[3 * t + 1] + 1,
            s.triangle[3 * t + 2] + 1);
  if (f) fclose(f);
  f = fopen(scene, "w");
  if (f) {
    fprintf(f,
            "params: {time_step: 0.02, newton_iterations_max: 6, newton_tolerance: 1e-3, "
            "pcg_tolerance: 1e-3}\n"
            "effects: {self_contact: off}\n"
            "materials: {m: {file: '%s/%s.yaml'}}\n"
            "cloths: [{name: disc, mesh: disc.obj, material: m}]\n",
            CLOTH_MATERIALS, fabric);
    fclose(f);
  }
  must(cloth_def_load(scene, &def, &err), &err);
  remove(scene), remove(mesh), rmdir(folder);
  return scene_new(def);
}

// the share of the ring that still shows, from a start that is disturbed in one way or another
static double drape_of(const char *fabric, int rings, int start)
{
  const double pi = acos(-1), radius = 0.15, support = 0.09;
  disc(radius, rings);
  cloth_scene *scene = scene_of_fabric(fabric);
  if (scene == NULL) return 0;
  cloth_error err = {0};
  static int held[STRIP_MAX];
  int count = 0;
  for (int i = 0; i < s.vertices; i++) {
    memcpy(x + 3 * i, s.x + 3 * i, 3 * sizeof *x);
    double r = sqrt(x[3 * i] * x[3 * i] + x[3 * i + 1] * x[3 * i + 1]);
    if (r < support + 1e-6)
      held[count++] = i;
    else
      x[3 * i + 2] = 2e-4 * sin(37.0 * i + 2 * start); // no symmetry to stay in
  }
  must(cloth_state_set(scene, 0, x, NULL, s.vertices, &err), &err);
  scene_hold(scene, 0, held, count, cloth_pose_identity());
  strip_settle(scene, 1e-10, 400);
  scene_positions(scene, 0, x);
  cloth_scene_free(scene);
  return (shadow() - pi * support * support) / (pi * (radius * radius - support * support));
}

// A disc of 30 cm is held flat between two plates of 18 cm; how much of its ring still shows. Limp
// cloth falls into more folds or fewer, so as in the laboratory the mean of several trials counts.
double case_drape(const char *fabric, int rings, double least, double most)
{
  enum { TRIALS = 3 };
  double share = 0;
  for (int n = 0; n < TRIALS; n++) share += drape_of(fabric, rings, n) / TRIALS;
  result("drape", "disc", fabric, rings, share, (least + most) / 2,
         (most - least) / (most + least));
  return share;
}
