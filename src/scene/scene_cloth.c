// `cloths:` of a scene file, with their pins.
#include "nearest.h"
#include "scene/scene_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// a side of n vertices that end in `ends` more than there are cells, at the wanted resolution
static void refine(cloth_value at, int *n, int ends)
{
  double factor = at.file->resolution;
  if (!(factor > 0) || factor == 1) return;
  double cells = fmin(1e6, round((*n - ends) * factor));
  *n = ends + (int)fmax(ends ? 1 : 3, cells);
}

static cloth_status read_grid(cloth_value at, cloth_mesh *out, cloth_error *err)
{
  static const char *const known[] = {"size", "resolution", "pattern", NULL};
  static const char *const patterns[] = {"alternating", "left", "right", "unstructured", NULL};
  cloth_value value;
  double size[2];
  int resolution[2], pattern = CLOTH_GRID_ALTERNATING;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(cloth_yaml_need(at, "size", &value, err));
  CLOTH_TRY(cloth_yaml_list(value, 2, 2, err));
  for (int i = 0; i < 2; i++)
    CLOTH_TRY(cloth_yaml_number(cloth_yaml_item(value, i), "m", 1e-6, 1e4, &size[i], err));
  CLOTH_TRY(cloth_yaml_need(at, "resolution", &value, err));
  CLOTH_TRY(cloth_yaml_list(value, 2, 2, err));
  for (int i = 0; i < 2; i++)
    CLOTH_TRY(cloth_yaml_int(cloth_yaml_item(value, i), "vertices", 2, 10000, &resolution[i], err));
  refine(at, &resolution[0], 1);
  refine(at, &resolution[1], 1);
  if (cloth_yaml_find(at, "pattern", &value))
    CLOTH_TRY(cloth_yaml_choice(value, patterns, &pattern, err));
  cloth_error cause = {0};
  cloth_status status = cloth_mesh_grid(size, resolution, (cloth_grid_pattern)pattern, out, &cause);
  return cloth_yaml_blame(err, at, status, &cause);
}

static cloth_status read_tube(cloth_value at, cloth_mesh *out, cloth_error *err)
{
  static const char *const known[] = {"radius", "length", "resolution", NULL};
  cloth_value value;
  double radius, length;
  int resolution[2];
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(cloth_yaml_need(at, "radius", &value, err));
  CLOTH_TRY(cloth_yaml_number(value, "m", 1e-6, 1e4, &radius, err));
  CLOTH_TRY(cloth_yaml_need(at, "length", &value, err));
  CLOTH_TRY(cloth_yaml_number(value, "m", 1e-6, 1e4, &length, err));
  CLOTH_TRY(cloth_yaml_need(at, "resolution", &value, err));
  CLOTH_TRY(cloth_yaml_list(value, 2, 2, err));
  for (int i = 0; i < 2; i++)
    CLOTH_TRY(
        cloth_yaml_int(cloth_yaml_item(value, i), "vertices", 3 - i, 10000, &resolution[i], err));
  refine(at, &resolution[0], 0);
  refine(at, &resolution[1], 1);
  cloth_error cause = {0};
  cloth_status status = cloth_mesh_tube(radius, length, resolution, out, &cause);
  return cloth_yaml_blame(err, at, status, &cause);
}

// texture coordinates of a file are metres of material, unless they are to be scaled or left out
static cloth_status read_material_coordinates(cloth_value at, cloth_value mesh,
                                              cloth_mesh_file *file, cloth_error *err)
{
  static const char *const words[] = {"file", "flatten", NULL};
  cloth_value value;
  int from = file->material_missing || file->mesh.material ? 0 : 1;
  double scale = 1;
  if (cloth_yaml_find(at, "material_coordinates", &value)) {
    int wanted;
    CLOTH_TRY(cloth_yaml_choice(value, words, &wanted, err));
    if (wanted == 0 && from == 1)
      CLOTH_YAML_FAIL(err, value, "the mesh file has no texture coordinates");
    from = wanted;
  }
  if (from == 0 && file->material_missing)
    CLOTH_YAML_FAIL(err, mesh,
                    "line %d of the file: a face without vt, though others have them; give all or "
                    "'material_coordinates: flatten'",
                    file->material_missing);
  if (from == 1) {
    free(file->mesh.material);
    file->mesh.material = NULL;
  }
  if (!cloth_yaml_find(at, "material_scale", &value)) return CLOTH_OK;
  CLOTH_TRY(cloth_yaml_number(value, "1", 1e-6, 1e6, &scale, err));
  if (file->mesh.material == NULL)
    CLOTH_YAML_FAIL(err, value, "there are no material coordinates to be scaled");
  for (size_t i = 0; i < 6 * (size_t)file->mesh.triangle_count; i++)
    file->mesh.material[i] *= scale;
  return CLOTH_OK;
}

// the shape's mesh, before its groups
static cloth_status read_mesh(cloth_value at, cloth_value mesh, cloth_mesh_file *out,
                              cloth_error *err)
{
  CLOTH_TRY(cloth_read_mesh_file(mesh, out, err));
  CLOTH_TRY(cloth_read_scale(at, &out->mesh, err));
  return read_material_coordinates(at, mesh, out, err);
}

static cloth_status read_shape(cloth_value at, cloth_mesh_file *out, cloth_error *err)
{
  static const char *const shapes[] = {"grid", "tube", "mesh", NULL};
  static const char *const for_mesh[] = {"scale", "material_coordinates", "material_scale", NULL};
  cloth_value shape = at, value;
  const char *found = NULL;
  for (int i = 0; shapes[i]; i++) {
    if (!cloth_yaml_find(at, shapes[i], &value)) continue;
    if (found) CLOTH_YAML_FAIL(err, value, "stands beside '%s'; a cloth has one shape", found);
    found = shapes[i];
    shape = value;
  }
  if (!found)
    CLOTH_YAML_FAIL(err, at, "the cloth has no shape; give one of 'grid', 'tube' or 'mesh'");
  for (int i = 0; for_mesh[i] && found[0] != 'm'; i++)
    if (cloth_yaml_find(at, for_mesh[i], &value))
      CLOTH_YAML_FAIL(err, value, "belongs to 'mesh' only");
  if (found[0] == 'g')
    CLOTH_TRY(read_grid(shape, &out->mesh, err));
  else if (found[0] == 't')
    CLOTH_TRY(read_tube(shape, &out->mesh, err));
  else
    CLOTH_TRY(read_mesh(at, shape, out, err));
  const char *sides = found[0] == 'g' ? "xxyy" : found[0] == 't' ? "--zz" : "----";
  if (cloth_yaml_find(at, "groups", &value)) return cloth_read_groups(value, sides, out, err);
  return CLOTH_OK;
}

static cloth_status find_material(cloth_value at, const cloth_materials *materials,
                                  const cloth_named_material **out, cloth_error *err)
{
  const char *name, *best = NULL;
  CLOTH_TRY(cloth_yaml_text(at, &name, err));
  for (int i = 0; i < materials->count; i++) {
    if (strcmp(materials->item[i].name, name) == 0) {
      *out = &materials->item[i];
      return CLOTH_OK;
    }
    cloth_nearest(name, materials->item[i].name, &best);
  }
  if (best == NULL) CLOTH_YAML_FAIL(err, at, "no material '%s': the file has no 'materials'", name);
  CLOTH_YAML_FAIL(err, at, "no material '%s'; the nearest is '%s'", name, best);
}

// ---- pins ---------------------------------------------------------------------------------------

static cloth_status find_group(cloth_value at, const cloth_cloth_def *cloth, int *out,
                               cloth_error *err)
{
  const char *name, *best = NULL;
  CLOTH_TRY(cloth_yaml_text(at, &name, err));
  for (int i = 0; i < cloth->group_count; i++) {
    if (strcmp(cloth->group[i].name, name) == 0) {
      *out = i;
      return CLOTH_OK;
    }
    cloth_nearest(name, cloth->group[i].name, &best);
  }
  if (best == NULL) CLOTH_YAML_FAIL(err, at, "no group '%s': the cloth has no groups", name);
  CLOTH_YAML_FAIL(err, at, "no group '%s'; the nearest is '%s'", name, best);
}

static cloth_status find_body(cloth_value at, const cloth_def *def, int *out, cloth_error *err)
{
  const char *name, *best = NULL;
  CLOTH_TRY(cloth_yaml_text(at, &name, err));
  *out = cloth_def_find_body(def, name);
  if (*out >= 0) return CLOTH_OK;
  for (int i = 0; i < def->body_count; i++) cloth_nearest(name, def->body[i].name, &best);
  if (best == NULL) CLOTH_YAML_FAIL(err, at, "no body '%s': the file has no bodies", name);
  CLOTH_YAML_FAIL(err, at, "no body '%s'; the nearest is '%s'", name, best);
}

// a vertex that two groups share, or -1; groups are ascending
static int shared_vertex(const cloth_group_def *a, const cloth_group_def *b)
{
  for (int i = 0, j = 0; i < a->count && j < b->count;) {
    if (a->vertex[i] == b->vertex[j]) return a->vertex[i];
    if (a->vertex[i] < b->vertex[j])
      i++;
    else
      j++;
  }
  return -1;
}

static cloth_status check_overlap(cloth_value at, const cloth_def *def, const cloth_pin_def *pin,
                                  cloth_error *err)
{
  const cloth_group_def *group = def->cloth[pin->cloth].group;
  for (int i = 0; i < def->pin_count; i++) {
    const cloth_pin_def *other = &def->pin[i];
    if (other->cloth != pin->cloth || !(pin->start < other->end && other->start < pin->end))
      continue;
    int v = shared_vertex(&group[pin->group], &group[other->group]);
    if (v >= 0)
      CLOTH_YAML_FAIL(err, at, "vertex %d is held by groups '%s' and '%s' at the same time", v,
                      group[other->group].name, group[pin->group].name);
  }
  return CLOTH_OK;
}

static cloth_status read_pin(cloth_value at, const cloth_def *def, cloth_pin_def *pin,
                             cloth_error *err)
{
  static const char *const known[] = {"group", "body",      "motion",      "start",
                                      "end",   "stiffness", "break_force", NULL};
  cloth_value value, body;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(cloth_yaml_need(at, "group", &value, err));
  CLOTH_TRY(find_group(value, &def->cloth[pin->cloth], &pin->group, err));
  bool has_body = cloth_yaml_find(at, "body", &body);
  if (has_body) CLOTH_TRY(find_body(body, def, &pin->body, err));
  if (cloth_yaml_find(at, "motion", &value)) {
    if (has_body) CLOTH_YAML_FAIL(err, value, "stands beside 'body'; a pin follows one of them");
    cloth_pose still = cloth_pose_identity();
    CLOTH_TRY(cloth_read_motion(value, &still, &pin->motion, err));
  }
  if (cloth_yaml_find(at, "start", &value))
    CLOTH_TRY(cloth_yaml_number(value, "s", 0, 1e6, &pin->start, err));
  if (cloth_yaml_find(at, "end", &value))
    CLOTH_TRY(cloth_yaml_number(value, "s", pin->start, INFINITY, &pin->end, err));
  if (cloth_yaml_find(at, "stiffness", &value))
    CLOTH_TRY(cloth_yaml_number(value, "N/m", 0, 1e9, &pin->stiffness, err));
  if (cloth_yaml_find(at, "break_force", &value))
    CLOTH_TRY(cloth_yaml_number(value, "N", 0, 1e9, &pin->break_force, err));
  return check_overlap(at, def, pin, err);
}

static cloth_status read_pins(cloth_value at, int cloth, cloth_def *def, cloth_error *err)
{
  CLOTH_TRY(cloth_yaml_list(at, 0, -1, err));
  for (int i = 0; i < cloth_yaml_count(at); i++) {
    cloth_pin_def *grown = realloc(def->pin, sizeof *grown * ((size_t)def->pin_count + 1));
    if (grown == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for pins");
    def->pin = grown;
    cloth_pin_def *pin = &def->pin[def->pin_count];
    *pin = (cloth_pin_def){.cloth = cloth, .body = -1, .end = INFINITY};
    cloth_status status = read_pin(cloth_yaml_item(at, i), def, pin, err);
    def->pin_count++; // from here on the description frees it
    CLOTH_TRY(status);
  }
  return CLOTH_OK;
}

// ---- cloth --------------------------------------------------------------------------------------

static cloth_status read_state(cloth_value at, cloth_cloth_view *view, cloth_error *err)
{
  static const char *const known[] = {"position", "rotation", "rpy", NULL};
  cloth_value value;
  if (cloth_yaml_find(at, "pose", &value)) {
    CLOTH_TRY(cloth_yaml_mapping(value, known, err));
    CLOTH_TRY(cloth_read_pose(value, &view->pose, err));
  }
  if (cloth_yaml_find(at, "velocity", &value))
    return cloth_yaml_numbers(value, 3, "m/s", 1e3, view->velocity, err);
  return CLOTH_OK;
}

static cloth_status add_cloth(cloth_value at, cloth_cloth_view *view, const cloth_mesh_file *file,
                              cloth_def *def, int *index, cloth_error *err)
{
  const cloth_mesh *m = &file->mesh;
  view->mesh =
      (cloth_mesh_view){m->vertex_count, m->triangle_count, m->position, m->triangle, m->material};
  cloth_group_view *groups = calloc((size_t)file->group_count + 1, sizeof *groups);
  if (groups == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for groups");
  for (int i = 0; i < file->group_count; i++)
    groups[i] =
        (cloth_group_view){file->group[i].name, file->group[i].count, file->group[i].vertex};
  view->group = groups;
  view->group_count = file->group_count;
  cloth_error cause = {0};
  cloth_status status = cloth_def_add_cloth(def, view, index, &cause);
  free(groups);
  return cloth_yaml_blame(err, at, status, &cause);
}

cloth_status cloth_read_cloth(cloth_value at, const cloth_materials *materials, cloth_def *def,
                              cloth_error *err)
{
  static const char *const known[] = {"name",
                                      "grid",
                                      "tube",
                                      "mesh",
                                      "scale",
                                      "material_coordinates",
                                      "material_scale",
                                      "material",
                                      "pose",
                                      "velocity",
                                      "groups",
                                      "pins",
                                      NULL};
  const cloth_named_material standard = {"default", cloth_material_default()},
                             *material = &standard;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  cloth_value value;
  cloth_cloth_view view = {.pose = cloth_pose_identity()};
  CLOTH_TRY(cloth_yaml_need(at, "name", &value, err));
  CLOTH_TRY(cloth_yaml_text(value, &view.name, err));
  if (cloth_yaml_find(at, "material", &value))
    CLOTH_TRY(find_material(value, materials, &material, err));
  view.material = material->material;
  CLOTH_TRY(read_state(at, &view, err));

  cloth_mesh_file file = {0};
  int index = 0;
  cloth_status status = read_shape(at, &file, err);
  if (status == CLOTH_OK) status = add_cloth(at, &view, &file, def, &index, err);
  cloth_mesh_file_free(&file);
  CLOTH_TRY(status);

  char *name = cloth_string_copy(material->name);
  if (name == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for cloth '%s'", view.name);
  free(def->cloth[index].material_name);
  def->cloth[index].material_name = name;
  if (cloth_yaml_find(at, "pins", &value)) return read_pins(value, index, def, err);
  return CLOTH_OK;
}
