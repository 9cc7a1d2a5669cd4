// What a body's mesh stands for, for integrators that collide with shapes instead of triangles.
#include "scene/scene_file.h"

static cloth_status read_lengths(cloth_value at, const char *const *keys, int n, double *size,
                                 cloth_error *err)
{
  for (int i = 0; i < n; i++) {
    cloth_value value;
    CLOTH_TRY(cloth_yaml_need(at, keys[i], &value, err));
    CLOTH_TRY(cloth_yaml_number(value, "m", 1e-6, 1e4, &size[i], err));
  }
  return CLOTH_OK;
}

cloth_status cloth_read_size(cloth_value body, cloth_body_view *view, cloth_error *err)
{
  static const char *const keys[] = {"radius", "length"};
  cloth_value at, value;
  if (cloth_yaml_find(body, "plane", &at)) view->shape = CLOTH_SHAPE_PLANE;
  if (cloth_yaml_find(body, "sphere", &at)) {
    view->shape = CLOTH_SHAPE_SPHERE;
    return read_lengths(at, keys, 1, view->size, err);
  }
  if (cloth_yaml_find(body, "cylinder", &at)) {
    view->shape = CLOTH_SHAPE_CYLINDER;
    return read_lengths(at, keys, 2, view->size, err);
  }
  if (!cloth_yaml_find(body, "box", &at)) return CLOTH_OK;
  view->shape = CLOTH_SHAPE_BOX;
  CLOTH_TRY(cloth_yaml_need(at, "size", &value, err));
  for (int i = 0; i < 3; i++)
    CLOTH_TRY(cloth_yaml_number(cloth_yaml_item(value, i), "m", 1e-6, 1e4, &view->size[i], err));
  return CLOTH_OK;
}
