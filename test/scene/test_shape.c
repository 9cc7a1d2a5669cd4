// What a body's mesh stands for: from scene files and from calls.
#include "check.h"
#include "scene/def.h"
#include "scene/folder.h"

static int files_say_what_a_body_is(void)
{
  static const struct {
    const char *name;
    cloth_shape shape;
    double size[3];
  } expected[] = {{"crate", CLOTH_SHAPE_BOX, {0.1, 0.2, 0.3}},
                  {"ball", CLOTH_SHAPE_SPHERE, {0.4}},
                  {"rod", CLOTH_SHAPE_CYLINDER, {0.05, 0.6}},
                  {"floor", CLOTH_SHAPE_PLANE, {0}}};
  cloth_error err = {0};
  cloth_def *def = NULL;
  folder f = folder_make();
  const char *path = folder_path(&f, "scene.yaml");
  FILE *file = fopen(path, "w");
  CHECK(file != NULL);
  fputs("cloths:\n  - {name: c, grid: {size: [1, 1], resolution: [2, 2]}}\nbodies:\n"
        "  - {name: crate, box: {size: [0.1, 0.2, 0.3]}}\n"
        "  - {name: ball, sphere: {radius: 0.4}}\n"
        "  - {name: rod, cylinder: {radius: 0.05, length: 0.6, segments: 8}}\n"
        "  - {name: floor, plane: {normal: [0, 1, 0]}}\n",
        file);
  fclose(file);
  cloth_status status = cloth_def_load(path, &def, &err);
  folder_remove(&f);
  CHECK_OK(status, err);
  for (int i = 0; i < 4; i++) {
    const cloth_body_def *b = &def->body[cloth_def_find_body(def, expected[i].name)];
    CHECK(b->shape == expected[i].shape && b->plane == (b->shape == CLOTH_SHAPE_PLANE));
    for (int k = 0; k < 3; k++) CHECK(b->size[k] == expected[i].size[k]);
  }
  cloth_def_free(def);
  return 0;
}

static int calls_are_held_to_sizes(void)
{
  static const double x[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  static const int triangle[3] = {0, 1, 2};
  cloth_error err = {0};
  cloth_def *def = NULL;
  CHECK_OK(cloth_def_new(&def, &err), err);
  cloth_body_view view = {.name = "b",
                          .mesh = {3, 1, x, triangle, NULL},
                          .pose = cloth_pose_identity(),
                          .shape = CLOTH_SHAPE_CYLINDER,
                          .size = {0.1, 0, 0}};
  CHECK(cloth_def_add_body(def, &view, NULL, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "size[1] = 0 [m] is not in [1e-06, 10000]") != NULL);
  err = (cloth_error){0};
  view.shape = (cloth_shape)9;
  CHECK(cloth_def_add_body(def, &view, NULL, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "shape = 9") != NULL);
  err = (cloth_error){0};
  view.shape = CLOTH_SHAPE_SPHERE;
  CHECK_OK(cloth_def_add_body(def, &view, NULL, &err), err);
  view.shape = CLOTH_SHAPE_MESH, view.name = "m";
  CHECK_OK(cloth_def_add_body(def, &view, NULL, &err), err);
  cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(files_say_what_a_body_is);
  RUN(calls_are_held_to_sizes);
  return failures > 0;
}
