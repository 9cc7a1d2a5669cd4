// Scenes for the tests of the engine, made through the public interface alone. Meshes live in
// static storage of the test, so nothing has to be freed on a failed CHECK but the scene.
#pragma once

#include "check.h"
#include "cloth.h"

#ifndef SHEET_SIDE_MAX
#define SHEET_SIDE_MAX 41
#endif
enum { SHEET_MAX = SHEET_SIDE_MAX * SHEET_SIDE_MAX, SOLID_MAX = 2000 };

#define G 9.81 // m/s^2, the default gravity

// A failed CHECK leaves its scene behind, and the leak check ends the program before buffers are
// written: lines go out as they come.
__attribute__((constructor)) static void write_lines_at_once(void)
{
  setvbuf(stdout, NULL, _IOLBF, 0);
}

// ---- meshes -------------------------------------------------------------------------------------

/// A flat sheet in z = 0 around the origin; vertex row * columns + column, rows along y.
typedef struct sheet {
  int columns, rows, triangles;
  double x[3 * SHEET_MAX];
  int triangle[6 * SHEET_MAX];
} sheet;

static inline void sheet_make(sheet *s, double width, double height, int columns, int rows)
{
  s->columns = columns, s->rows = rows, s->triangles = 0;
  if (columns * rows > SHEET_MAX) abort();
  for (int r = 0; r < rows; r++)
    for (int c = 0; c < columns; c++) {
      double *x = s->x + 3 * (r * columns + c);
      x[0] = width * ((double)c / (columns - 1) - 0.5);
      x[1] = height * ((double)r / (rows - 1) - 0.5);
      x[2] = 0;
    }
  for (int r = 0; r + 1 < rows; r++)
    for (int c = 0; c + 1 < columns; c++) {
      int a = r * columns + c, b = a + 1, d = a + columns, e = d + 1;
      int even[6] = {a, b, e, a, e, d}, odd[6] = {a, b, d, b, e, d};
      memcpy(s->triangle + 3 * s->triangles, (r + c) % 2 ? odd : even, sizeof even);
      s->triangles += 2;
    }
}

static inline cloth_mesh_view sheet_view(const sheet *s)
{
  cloth_mesh_view v = {s->columns * s->rows, s->triangles, s->x, s->triangle, NULL};
  return v;
}

/// A closed mesh of a body.
typedef struct solid {
  int vertices, triangles;
  double x[3 * SOLID_MAX];
  int triangle[6 * SOLID_MAX];
} solid;

static inline void solid_box(solid *s, double sx, double sy, double sz)
{
  static const int faces[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  s->vertices = 8, s->triangles = 12;
  for (int v = 0; v < 8; v++) {
    s->x[3 * v] = (v & 1 ? 0.5 : -0.5) * sx;
    s->x[3 * v + 1] = (v & 2 ? 0.5 : -0.5) * sy;
    s->x[3 * v + 2] = (v & 4 ? 0.5 : -0.5) * sz;
  }
  memcpy(s->triangle, faces, sizeof faces);
}

/// Meridians and parallels; its vertices at `radius`.
static inline void solid_sphere(solid *s, double radius, int around, int rings)
{
  const double pi = acos(-1);
  s->vertices = 2 + around * rings, s->triangles = 0;
  if (s->vertices > SOLID_MAX) abort();
  memset(s->x, 0, sizeof(double) * 6);
  s->x[2] = -radius, s->x[5] = radius;
  for (int r = 0; r < rings; r++)
    for (int a = 0; a < around; a++) {
      double up = pi * (r + 1) / (rings + 1) - pi / 2, turn = 2 * pi * a / around;
      double *x = s->x + 3 * (2 + r * around + a);
      x[0] = radius * cos(up) * cos(turn), x[1] = radius * cos(up) * sin(turn);
      x[2] = radius * sin(up);
    }
  for (int a = 0; a < around; a++) {
    int b = (a + 1) % around, top = 2 + (rings - 1) * around;
    int caps[6] = {0, 2 + b, 2 + a, 1, top + a, top + b};
    memcpy(s->triangle + 3 * s->triangles, caps, sizeof caps);
    s->triangles += 2;
    for (int r = 0; r + 1 < rings; r++) {
      int o = 2 + r * around, p = o + around;
      int quad[6] = {o + a, o + b, p + b, o + a, p + b, p + a};
      memcpy(s->triangle + 3 * s->triangles, quad, sizeof quad);
      s->triangles += 2;
    }
  }
}

static inline cloth_mesh_view solid_view(const solid *s)
{
  cloth_mesh_view v = {s->vertices, s->triangles, s->x, s->triangle, NULL};
  return v;
}

// ---- descriptions -------------------------------------------------------------------------------

/// Anything that goes wrong while a scene is made is a fault of the test: say so and stop.
static inline void must(cloth_status status, const cloth_error *err)
{
  if (status == CLOTH_OK) return;
  printf("FAIL scene: %s:%d: %s\n", err->file, err->line, err->text);
  exit(1);
}

static inline cloth_def *def_new(const char *precision)
{
  cloth_error err = {0};
  cloth_def *def = NULL;
  must(cloth_def_new(&def, &err), &err);
  must(cloth_def_set(def, "precision", precision, &err), &err);
  return def;
}

static inline void def_set(cloth_def *def, const char *name, const char *value)
{
  cloth_error err = {0};
  must(cloth_def_set(def, name, value, &err), &err);
}

static inline cloth_pose pose_at(double x, double y, double z)
{
  cloth_pose p = {{x, y, z}, {0, 0, 0, 1}};
  return p;
}

/// Turned by `angle` [rad] about axis 0, 1 or 2 of the scene.
static inline cloth_pose pose_turned(double x, double y, double z, int axis, double angle)
{
  cloth_pose p = {{x, y, z}, {0, 0, 0, cos(angle / 2)}};
  p.rotation[axis] = sin(angle / 2);
  return p;
}

static inline void def_cloth(cloth_def *def, const char *name, const sheet *s,
                             cloth_material material, cloth_pose pose)
{
  cloth_error err = {0};
  cloth_cloth_view v = {.name = name, .mesh = sheet_view(s), .material = material, .pose = pose};
  must(cloth_def_add_cloth(def, &v, NULL, &err), &err);
}

static inline void def_body(cloth_def *def, const char *name, const solid *s, double friction,
                            cloth_pose pose)
{
  cloth_error err = {0};
  cloth_body_view v = {.name = name, .mesh = solid_view(s), .pose = pose, .friction = friction};
  must(cloth_def_add_body(def, &v, NULL, &err), &err);
}

/// Build the scene and free the description.
static inline cloth_scene *scene_new(cloth_def *def)
{
  cloth_error err = {0};
  cloth_scene *scene = NULL;
  must(cloth_scene_new(def, &scene, &err), &err);
  cloth_def_free(def);
  return scene;
}

// ---- scenes -------------------------------------------------------------------------------------

static inline cloth_step_report scene_step(cloth_scene *scene, int steps)
{
  cloth_step_report report = {0};
  cloth_error err = {0};
  for (int i = 0; i < steps; i++) must(cloth_step(scene, 0, &report, &err), &err);
  return report;
}

static inline void scene_positions(cloth_scene *scene, int cloth, double *x)
{
  cloth_error err = {0};
  must(cloth_positions(scene, cloth, x, cloth_vertex_count(scene, cloth), &err), &err);
}

static inline void scene_velocities(cloth_scene *scene, int cloth, double *v)
{
  cloth_error err = {0};
  must(cloth_velocities(scene, cloth, v, cloth_vertex_count(scene, cloth), &err), &err);
}

static inline uint64_t scene_hash(cloth_scene *scene)
{
  cloth_error err = {0};
  uint64_t hash = 0;
  must(cloth_state_hash(scene, &hash, &err), &err);
  return hash;
}

/// Hold vertices where they are, rigidly; the frame is at (x, y, z).
static inline cloth_grasp_id scene_hold(cloth_scene *scene, int cloth, const int *vertex, int count,
                                        cloth_pose frame)
{
  cloth_error err = {0};
  cloth_grasp_id id = {0, 0};
  cloth_grasp_view g = {
      .cloth = cloth, .count = count, .vertex = vertex, .body = -1, .frame = frame};
  must(cloth_grasp(scene, &g, &id, &err), &err);
  return id;
}

/// Lumped masses [kg]: a third of each triangle's rest area, times the density.
static inline void sheet_masses(const sheet *s, double density, double *mass)
{
  memset(mass, 0, sizeof *mass * (size_t)(s->columns * s->rows));
  for (int t = 0; t < s->triangles; t++) {
    const int *v = s->triangle + 3 * t;
    const double *a = s->x + 3 * v[0], *b = s->x + 3 * v[1], *c = s->x + 3 * v[2];
    double area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    for (int k = 0; k < 3; k++) mass[v[k]] += density * fabs(area) / 3;
  }
}

/// Is there a GPU to run on? A scene of one triangle is asked.
static inline bool cuda_is_there(void)
{
  static sheet s;
  cloth_error err = {0};
  cloth_scene *scene = NULL;
  sheet_make(&s, 1, 1, 2, 2);
  cloth_def *def = def_new("float");
  def_set(def, "backend", "cuda");
  def_cloth(def, "probe", &s, cloth_material_default(), pose_at(0, 0, 0));
  bool there = cloth_scene_new(def, &scene, &err) == CLOTH_OK;
  if (!there) printf("  no GPU: %s\n", err.text);
  cloth_scene_free(scene), cloth_def_free(def);
  return there;
}

/// 0 if two runs have the same state hash after each of `steps` steps; else says where they part.
static inline int same_hashes(int steps, const char *what, const uint64_t *a, const uint64_t *b)
{
  for (int n = 0; n < steps; n++)
    if (a[n] != b[n]) {
      printf("  %s: first differs at step %d\n", what, n + 1);
      return 1;
    }
  return 0;
}

// ---- both precisions ----------------------------------------------------------------------------

typedef int precision_test(const char *precision);

static inline int both(precision_test *test)
{
  static const char *const precisions[] = {"double", "float"};
  for (int p = 0; p < 2; p++)
    if (test(precisions[p])) {
      printf("  with precision %s\n", precisions[p]);
      return 1;
    }
  return 0;
}

/// Distance from 1 to the next number of a precision.
static inline double epsilon_of(const char *precision)
{
  return precision[0] == 'f' ? 1.1920929e-7 : 2.220446049250313e-16;
}

#define BOTH(name, test)                                                                           \
  static int name(void) { return both(test); }
