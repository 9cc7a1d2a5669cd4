// Tests of src/scene/def.c and def_set.c.
#include "check.h"
#include "scene/def.h"
#include "scene/mesh.h"

static const double triangle_x[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
static const int triangle_v[3] = {0, 1, 2};
static const cloth_mesh_view triangle = {3, 1, triangle_x, triangle_v, NULL};

static cloth_cloth_view cloth_view(const char *name)
{
  cloth_cloth_view v = {.name = name,
                        .mesh = triangle,
                        .material = cloth_material_default(),
                        .pose = cloth_pose_identity()};
  return v;
}

static cloth_body_view body_view(const char *name)
{
  cloth_body_view v = {
      .name = name, .mesh = triangle, .pose = cloth_pose_identity(), .friction = 0.5};
  return v;
}

static int a_new_description_has_the_defaults(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(cloth_def_new(&def, &err), err);
  cloth_params expected = cloth_params_default();
  // field by field: a struct may have bytes between its fields
  for (const cloth_param_info *i = cloth_param_table(); i->name; i++) {
    size_t size = i->kind == CLOTH_IS_VECTOR   ? 3 * sizeof(double)
                  : i->kind == CLOTH_IS_DOUBLE ? sizeof(double)
                                               : sizeof(int);
    CHECK(memcmp((const char *)cloth_def_params(def) + i->offset,
                 (const char *)&expected + i->offset, size) == 0);
  }
  CHECK(strcmp(def->backend, "auto") == 0 && strcmp(def->precision, "double") == 0);
  CHECK(def->device_count == 1 && def->device[0] == 0 && def->effect_count == 0);
  cloth_def_free(def);
  cloth_def_free(NULL);
  return 0;
}

static int settings_are_taken_by_name(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(cloth_def_new(&def, &err), err);
  CHECK_OK(cloth_def_set(def, "thickness", "0.004", &err), err);
  CHECK_OK(cloth_def_set(def, "gravity", "0 0 -1.62", &err), err);
  CHECK_OK(cloth_def_set(def, "backend", "shuffle", &err), err);
  CHECK_OK(cloth_def_set(def, "precision", "float", &err), err);
  CHECK_OK(cloth_def_set(def, "duration", "2.5", &err), err);
  CHECK_OK(cloth_def_set(def, "effects.bending", "off", &err), err);
  CHECK_OK(cloth_def_set(def, "effects.air", "on", &err), err);
  CHECK_OK(cloth_def_set(def, "effects.bending", "auto", &err), err); // again: replaced
  CHECK(def->params.thickness == 0.004 && def->params.gravity[2] == -1.62);
  CHECK(strcmp(def->backend, "shuffle") == 0 && strcmp(def->precision, "float") == 0);
  CHECK(def->duration == 2.5 && def->effect_count == 2);
  CHECK(strcmp(def->effect[0].name, "bending") == 0 && def->effect[0].wish == CLOTH_EFFECT_AUTO);
  CHECK(strcmp(def->effect[1].name, "air") == 0 && def->effect[1].wish == CLOTH_EFFECT_ON);
  cloth_def_free(def);
  return 0;
}

static int devices_count_up_or_are_named(void)
{
  static const struct {
    const char *text;
    int count, device[4];
  } rows[] = {{"cpu", 1, {0}},
              {"cpu,cpu,cpu", 3, {0, 1, 2}},
              {"0,0,1", 3, {0, 0, 1}},
              {" cpu , cpu ", 2, {0, 1}},
              {"3", 1, {3}}};
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(cloth_def_new(&def, &err), err);
  for (int i = 0; i < 5; i++) {
    CHECK_OK(cloth_def_set(def, "devices", rows[i].text, &err), err);
    CHECK(def->device_count == rows[i].count);
    for (int k = 0; k < rows[i].count; k++) CHECK(def->device[k] == rows[i].device[k]);
  }
  cloth_def_free(def);
  return 0;
}

static int bad_settings_change_nothing(void)
{
  static const char *const rows[][3] = {
      {"thicknes", "1", "unknown name 'thicknes'; the nearest is 'thickness'"},
      {"backends", "cpu", "unknown name 'backends'; the nearest is 'backend'"},
      {"device", "cpu", "the nearest is 'devices'"},
      {"", "1", "unknown name ''"},
      {"thickness", "1", "thickness = 1 [m] is not in [1e-05, 0.05]"},
      {"backend", "gpu", "backend = 'gpu' is not one of auto, cpu, cuda, shuffle; the nearest is 'cpu'"},
      {"precision", "duoble", "the nearest is 'double'"},
      {"devices", "", "'' is neither 'cpu' nor a device index"},
      {"devices", "cpu,", "is neither"},
      {"devices", "cpu,,cpu", "is neither"},
      {"devices", "-1", "'-1' is neither 'cpu' nor a device index in [0, 1023]"},
      {"devices", "gpu", "'gpu' is neither"},
      {"duration", "-1", "duration = -1 [s] is not in [0, 1e+06]"},
      {"duration", "nan", "duration = nan [s]"},
      {"duration", "long", "duration = 'long' is not a number"},
      {"effects.bending", "maybe", "effects.bending = 'maybe' is not one of auto, on, off"},
      {"effects.bendign", "on", "unknown effect; the nearest is 'bending'"},
      {"effects.", "on", "unknown effect"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    cloth_def *def;
    cloth_error err = {0};
    CHECK_OK(cloth_def_new(&def, &err), err);
    cloth_def before = *def;
    CHECK(cloth_def_set(def, rows[i][0], rows[i][1], &err) == CLOTH_BAD_ARGUMENT);
    if (strstr(err.text, rows[i][2]) == NULL) {
      printf("%s = %s: %s\n", rows[i][0], rows[i][1], err.text);
      return 1;
    }
    CHECK(memcmp(def, &before, sizeof before) == 0);
    cloth_def_free(def);
  }
  char many[1000] = "cpu";
  for (int i = 0; i < CLOTH_DEVICES_MAX; i++) strcat(many, ",cpu");
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(cloth_def_new(&def, &err), err);
  CHECK(cloth_def_set(def, "devices", many, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strstr(err.text, "has more than 64 parts") != NULL);
  CHECK(def->device_count == 1);
  cloth_def_free(def);
  return 0;
}

// the caller may change or free what it gave
static int adding_copies_everything(void)
{
  cloth_def *def;
  cloth_error err = {0};
  char name[] = "sheet";
  double x[9], u[6] = {0, 0, 1, 0, 0, 1};
  int v[3], members[] = {2, 0, 2}, index = -1;
  memcpy(x, triangle_x, sizeof x);
  memcpy(v, triangle_v, sizeof v);
  cloth_group_view group = {"edge", 3, members};
  cloth_cloth_view cloth = cloth_view(name);
  cloth.mesh = (cloth_mesh_view){3, 1, x, v, u};
  cloth.group = &group, cloth.group_count = 1;
  cloth.velocity[1] = 3;
  CHECK_OK(cloth_def_new(&def, &err), err);
  CHECK_OK(cloth_def_add_cloth(def, &cloth, &index, &err), err);
  CHECK(index == 0);
  memset(name, 0, sizeof name), memset(x, 0, sizeof x), memset(u, 0, sizeof u);
  memset(v, 0, sizeof v), memset(members, 0, sizeof members);
  const cloth_cloth_def *c = &def->cloth[0];
  CHECK(strcmp(c->name, "sheet") == 0 && strcmp(c->material_name, "default") == 0);
  CHECK(memcmp(c->mesh.position, triangle_x, sizeof triangle_x) == 0);
  CHECK(memcmp(c->mesh.triangle, triangle_v, sizeof triangle_v) == 0);
  CHECK(c->mesh.material[2] == 1 && c->velocity[1] == 3);
  CHECK(c->group_count == 1 && strcmp(c->group[0].name, "edge") == 0);
  CHECK(c->group[0].count == 2 && c->group[0].vertex[0] == 0 && c->group[0].vertex[1] == 2);

  cloth_body_view body = body_view("link");
  CHECK_OK(cloth_def_add_body(def, &body, &index, &err), err);
  body.name = "link2";
  CHECK_OK(cloth_def_add_body(def, &body, &index, &err), err);
  CHECK(index == 1 && cloth_def_find_body(def, "link2") == 1 &&
        cloth_def_find_body(def, "x") == -1);
  CHECK(!cloth_motion_moves(&def->body[1].motion));
  cloth_def_free(def);
  return 0;
}

static int quaternions_are_given_length_1(void)
{
  cloth_def *def;
  cloth_error err = {0};
  cloth_body_view body = body_view("link");
  const double rounded[4] = {0.7071, 0, 0, 0.7071};
  memcpy(body.pose.rotation, rounded, sizeof rounded);
  CHECK_OK(cloth_def_new(&def, &err), err);
  CHECK_OK(cloth_def_add_body(def, &body, NULL, &err), err);
  CHECK_NEAR(def->body[0].pose.rotation[0], sqrt(0.5), 1e-15);
  cloth_def_free(def);
  return 0;
}

static int bad_views_are_refused_and_leave_nothing(void)
{
  static const int out_of_range[] = {3};
  static const cloth_group_view groups[] = {{"a", 1, out_of_range},
                                            {"", 1, triangle_v},
                                            {"b", 0, triangle_v},
                                            {"c", 1, triangle_v},
                                            {"c", 1, triangle_v}};
  static const char *const expected[] = {
      "the cloth's name '' is not a letter followed by",
      "the cloth's name 'a b' is not",
      "the cloth's name '../x' is not",
      "the cloth's name '1st' is not",
      "there is a cloth 'twin' already",
      "'sheet': material: density = nan [kg/m^2] is not in",
      "'sheet': velocity (0, nan, 0) [m/s]: y is not in",
      "'sheet': pose: position (inf, 0, 0) [m] is not finite",
      "'sheet': pose: rotation (0, 0, 0, 0) [1] has length 0",
      "'sheet': pose: rotation (0, 0, 0, nan)",
      "'sheet': group 'a' names vertex 3; the mesh has vertices 0 to 2",
      "'sheet': group 0 has no name",
      "'sheet': group 'b' has no vertices",
      "'sheet': group 'c' is there twice"};
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(cloth_def_new(&def, &err), err);
  cloth_cloth_view twin = cloth_view("twin");
  CHECK_OK(cloth_def_add_cloth(def, &twin, NULL, &err), err);
  for (int i = 0; i < 14; i++) {
    static const char *const names[] = {NULL, "a b", "../x", "1st", "twin"};
    cloth_cloth_view v = cloth_view(i < 5 ? names[i] : "sheet");
    if (i == 5) v.material.density = NAN;
    if (i == 6) v.velocity[1] = NAN;
    if (i == 7) v.pose.position[0] = INFINITY;
    if (i == 8) v.pose.rotation[3] = 0;
    if (i == 9) v.pose.rotation[3] = NAN;
    if (i >= 10) v.group = &groups[i - 10], v.group_count = i == 13 ? 2 : 1;
    int index = 42;
    err = (cloth_error){0};
    CHECK(cloth_def_add_cloth(def, &v, &index, &err) == CLOTH_BAD_SCENE);
    if (strstr(err.text, expected[i]) == NULL) {
      printf("row %d: %s\n", i, err.text);
      return 1;
    }
    CHECK(index == 42 && def->cloth_count == 1);
  }
  cloth_body_view body = body_view("");
  CHECK(cloth_def_add_body(def, &body, NULL, NULL) == CLOTH_BAD_SCENE);
  body = body_view("b");
  body.friction = -0.1;
  err = (cloth_error){0};
  CHECK(cloth_def_add_body(def, &body, NULL, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "'b': friction = -0.1 [1] is not in [0, 10]") != NULL);
  CHECK(def->body_count == 0);
  cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_new_description_has_the_defaults);
  RUN(settings_are_taken_by_name);
  RUN(devices_count_up_or_are_named);
  RUN(bad_settings_change_nothing);
  RUN(adding_copies_everything);
  RUN(quaternions_are_given_length_1);
  RUN(bad_views_are_refused_and_leave_nothing);
  return failures != 0;
}
