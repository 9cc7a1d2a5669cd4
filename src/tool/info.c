// cloth info: what is in a scene, what it will compute and why, what it costs.
#include "scene/def.h"
#include "tool.h"

#include <math.h>
#include <string.h>

static const tool_option options[] = {{NULL, NULL, NULL}};

// ---- meshes ------------------------------------------------------------------------------------

typedef struct mesh_figures {
  double area;                             // m^2
  double edge_least, edge_mean, edge_most; // m
} mesh_figures;

static double corner_distance(const cloth_mesh *m, int triangle, int i, int j)
{
  const double *a, *b;
  double sum = 0;
  int size = m->material ? 2 : 3;
  if (m->material) { // cloth is as large as it is at rest
    a = m->material + 6 * triangle + 2 * i;
    b = m->material + 6 * triangle + 2 * j;
  } else {
    a = m->position + 3 * (ptrdiff_t)m->triangle[3 * triangle + i];
    b = m->position + 3 * (ptrdiff_t)m->triangle[3 * triangle + j];
  }
  for (int k = 0; k < size; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sqrt(sum);
}

// The mean is over corners of triangles: an edge between two triangles counts twice.
static mesh_figures measure(const cloth_mesh *m)
{
  mesh_figures f = {.edge_least = INFINITY};
  for (int t = 0; t < m->triangle_count; t++) {
    double e[3];
    for (int k = 0; k < 3; k++) {
      e[k] = corner_distance(m, t, k, (k + 1) % 3);
      f.edge_mean += e[k] / (3.0 * m->triangle_count);
      f.edge_least = fmin(f.edge_least, e[k]);
      f.edge_most = fmax(f.edge_most, e[k]);
    }
    double s = (e[0] + e[1] + e[2]) / 2; // Heron
    f.area += sqrt(fmax(0, s * (s - e[0]) * (s - e[1]) * (s - e[2])));
  }
  return f;
}

static void print_material(const cloth_material *m)
{
  for (const cloth_param_info *p = cloth_material_table(); p->name; p++) {
    double value = *(const double *)((const char *)m + p->offset);
    printf("    %-16s %.6g %s%s\n", p->name, value, strcmp(p->unit, "1") == 0 ? "" : p->unit,
           value == p->value[0] ? "" : "  (not the default)");
  }
}

static void print_repairs(const cloth_mesh_repairs *r)
{
  const struct {
    int count;
    const char *what;
  } repair[] = {{r->zero_area, "triangles without area dropped"},
                {r->duplicate, "repeated triangles dropped"},
                {r->non_manifold, "third triangles on an edge dropped"},
                {r->flipped, "triangles turned over"},
                {r->flattened, "triangles flattened anew in material space"},
                {r->unreferenced, "unused vertices dropped"}};
  for (size_t i = 0; i < sizeof repair / sizeof repair[0]; i++)
    if (repair[i].count) printf("  repaired: %d %s\n", repair[i].count, repair[i].what);
}

static void print_cloth(const cloth_cloth_def *c)
{
  mesh_figures f = measure(&c->mesh);
  printf("cloth %s\n", c->name);
  printf("  %d vertices, %d triangles, %.6g m^2, %.6g kg\n", c->mesh.vertex_count,
         c->mesh.triangle_count, f.area, f.area * c->material.density);
  printf("  edges at rest: shortest %.4g m, mean %.4g m, longest %.4g m\n", f.edge_least,
         f.edge_mean, f.edge_most);
  print_repairs(&c->repairs);
  for (int i = 0; i < c->group_count; i++)
    printf("  group %s: %d vertices\n", c->group[i].name, c->group[i].count);
  printf("  material %s\n", c->material_name ? c->material_name : "(unnamed)");
  print_material(&c->material);
}

static void print_body(const cloth_body_def *b)
{
  mesh_figures f = measure(&b->mesh);
  printf("body %s\n", b->name);
  if (b->plane) {
    printf("  plane, 50 m to each side\n");
  } else {
    printf("  %d vertices, %d triangles, %.6g m^2\n", b->mesh.vertex_count, b->mesh.triangle_count,
           f.area);
    printf("  edges: shortest %.4g m, mean %.4g m, longest %.4g m\n", f.edge_least, f.edge_mean,
           f.edge_most);
  }
  print_repairs(&b->repairs);
  printf("  friction %.6g, %s\n", b->friction,
         cloth_motion_moves(&b->motion) ? "moves by itself" : "moves as told");
}

// ---- parameters --------------------------------------------------------------------------------

static void print_value(const cloth_param_info *p, const void *value)
{
  const double *number = value;
  const int *whole = value;
  if (p->kind == CLOTH_IS_DOUBLE) {
    printf("%.6g", number[0]);
  } else if (p->kind == CLOTH_IS_VECTOR) {
    printf("%.6g %.6g %.6g", number[0], number[1], number[2]);
  } else if (p->kind == CLOTH_IS_INT) {
    printf("%d", *whole);
  } else {
    int length;
    const char *word = cloth_param_choice(p, *whole, &length);
    printf("%.*s", length, word);
  }
}

static void print_params(const cloth_params *params)
{
  cloth_params defaults = cloth_params_default();
  int count = 0;
  printf("parameters that are not the default\n");
  for (const cloth_param_info *p = cloth_param_table(); p->name; p++) {
    const void *value = (const char *)params + p->offset;
    size_t size = p->kind == CLOTH_IS_VECTOR   ? 3 * sizeof(double)
                  : p->kind == CLOTH_IS_DOUBLE ? sizeof(double)
                                               : sizeof(int);
    if (memcmp(value, (const char *)&defaults + p->offset, size) == 0) continue;
    count++;
    printf("  %-24s", p->name);
    print_value(p, value);
    printf(" %s\n", p->unit && strcmp(p->unit, "1") != 0 ? p->unit : "");
  }
  if (!count) printf("  none\n");
}

// ---- effects -----------------------------------------------------------------------------------

enum { TIMED_STEPS = 20, TIMED_MS = 1000 };

// steps the scene until enough is known of times; the first is not counted: buffers grow in it
static cloth_status time_effects(cloth_scene *scene, cloth_step_report *last, int *steps,
                                 double *ms, cloth_error *err)
{
  cloth_effect_info e;
  double spent = 0;
  for (*steps = -1; *steps < TIMED_STEPS && spent < TIMED_MS; ++*steps) {
    for (int i = 0; *steps == 0 && i < cloth_effect_count(); i++) {
      CLOTH_TRY(cloth_effect_describe(scene, i, &e, err));
      ms[i] = -e.ms;
    }
    CLOTH_TRY(cloth_step(scene, 0, last, err));
    spent += last->wall_ms;
  }
  for (int i = 0; i < cloth_effect_count(); i++) {
    CLOTH_TRY(cloth_effect_describe(scene, i, &e, err));
    ms[i] = (ms[i] + e.ms) / fmax(1, *steps);
  }
  return CLOTH_OK;
}

// Is it active, why, its memory and its time. What it adds to the shared stages (assembly, solve)
// is not its own; doc/effects.md has the price of each with all that.
static cloth_status print_effects(cloth_scene *scene, cloth_error *err)
{
  uint64_t bytes = 0;
  char text[32];
  double ms[64] = {0};
  int steps = 0;
  cloth_step_report last = {0};
  cloth_error failed = {0};
  cloth_status status = time_effects(scene, &last, &steps, ms, &failed);
  printf("effects: active or not, memory, time of their own kernels in a step (mean of %d), why\n",
         steps > 0 ? steps : 0);
  for (int i = 0; i < cloth_effect_count(); i++) {
    cloth_effect_info e;
    char time[32] = "";
    CLOTH_TRY(cloth_effect_describe(scene, i, &e, err));
    if (e.active && steps > 0) snprintf(time, sizeof time, "%.3f ms", ms[i]);
    printf("  %-16s %-4s %-10s %-10s %s\n", e.name, e.active ? "on" : "off",
           e.active ? tool_bytes(e.memory_bytes, text) : "", time, e.why);
    if (e.active && e.source && e.source[0]) printf("  %-16s %s\n", "", e.source);
    bytes += e.memory_bytes;
  }
  printf("memory of effects: %s\n", tool_bytes(bytes, text));
  // what the whole scene holds is known once it has stepped: buffers of contacts grow on demand
  if (status == CLOTH_OK)
    printf("memory of the scene after its first steps: %s\n", tool_bytes(last.memory_bytes, text));
  else
    printf("memory of the scene: unknown, its first steps fail: %s\n", failed.text);
  return CLOTH_OK;
}

static int info_main(const tool_arguments *args, cloth_error *err)
{
  cloth_def *def = NULL;
  cloth_scene *scene = NULL;
  cloth_status status = tool_scene_load(args, args->operand[0], &def, err);
  if (status == CLOTH_OK) {
    int profile = def->params.profile;
    def->params.profile = 2; // a GPU times effects only then
    status = cloth_scene_new(def, &scene, err);
    def->params.profile = profile;
  }
  if (status == CLOTH_OK) {
    printf("scene %s\n", def->name[0] ? def->name : args->operand[0]);
    printf("  backend %s (%s), precision %s, parts %d\n", cloth_backend_of(scene),
           cloth_backend_why(scene), def->precision, def->device_count);
    if (def->duration > 0) printf("  duration %.6g s\n", def->duration);
    for (int i = 0; i < def->cloth_count; i++) print_cloth(&def->cloth[i]);
    for (int i = 0; i < def->body_count; i++) print_body(&def->body[i]);
    printf("pins %d\n", def->pin_count);
    print_params(cloth_def_params(def));
    status = print_effects(scene, err);
  }
  cloth_scene_free(scene);
  cloth_def_free(def);
  return tool_exit_code(status);
}

const tool_command tool_info = {
    "info",   "SCENE.yaml", 1, 1, true, options, "meshes, materials, effects and why, memory, time",
    info_main};
