// `groups:` of a cloth in a scene file: which vertices a name means. Positions are those of the
// mesh frame, after `scale`.
#include "scene/scene_file.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct selection {
  const cloth_mesh *mesh;
  const char *sides; // axis of left, right, bottom, top; -: none
  bool *chosen;      // [vertex_count]
} selection;

static const double *vertex(const selection *s, int v) { return s->mesh->position + 3 * (size_t)v; }

static cloth_status select_vertices(cloth_value at, selection *s, cloth_error *err)
{
  CLOTH_TRY(cloth_yaml_list(at, 1, -1, err));
  if (s->sides[2] != '-' && at.file->resolution > 0 && at.file->resolution != 1)
    CLOTH_YAML_FAIL(err, at,
                    "numbers mean other vertices at %g times the resolution; use a place "
                    "(nearest, box, radius, side)",
                    at.file->resolution);
  for (int i = 0; i < cloth_yaml_count(at); i++) {
    int v;
    CLOTH_TRY(
        cloth_yaml_int(cloth_yaml_item(at, i), "vertex", 0, s->mesh->vertex_count - 1, &v, err));
    s->chosen[v] = true;
  }
  return CLOTH_OK;
}

static cloth_status select_box(cloth_value at, selection *s, cloth_error *err)
{
  double low[3], high[3];
  CLOTH_TRY(cloth_yaml_list(at, 2, 2, err));
  CLOTH_TRY(cloth_yaml_numbers(cloth_yaml_item(at, 0), 3, "m", 1e6, low, err));
  CLOTH_TRY(cloth_yaml_numbers(cloth_yaml_item(at, 1), 3, "m", 1e6, high, err));
  for (int i = 0; i < 3; i++)
    if (!(low[i] <= high[i]))
      CLOTH_YAML_FAIL(err, at, "the first corner's %c = %g [m] is above the second's %g", "xyz"[i],
                      low[i], high[i]);
  for (int v = 0; v < s->mesh->vertex_count; v++) {
    const double *x = vertex(s, v);
    bool inside = true;
    for (int i = 0; i < 3; i++) inside = inside && x[i] >= low[i] && x[i] <= high[i];
    s->chosen[v] |= inside;
  }
  return CLOTH_OK;
}

static double distance_sq(const double *a, const double *b)
{
  double sum = 0;
  for (int i = 0; i < 3; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

// the vertex nearest to a point, the first of several
static cloth_status select_nearest_to(cloth_value at, selection *s, cloth_error *err)
{
  double point[3], least = DBL_MAX;
  int best = 0;
  CLOTH_TRY(cloth_yaml_numbers(at, 3, "m", 1e6, point, err));
  for (int v = 0; v < s->mesh->vertex_count; v++) {
    double d = distance_sq(vertex(s, v), point);
    if (d < least) least = d, best = v;
  }
  s->chosen[best] = true;
  return CLOTH_OK;
}

// one point, or a list of points
static cloth_status select_nearest(cloth_value at, selection *s, cloth_error *err)
{
  bool several = cloth_yaml_count(at) > 0 && cloth_yaml_is_list(at) &&
                 cloth_yaml_is_list(cloth_yaml_item(at, 0));
  if (!several) return select_nearest_to(at, s, err);
  for (int i = 0; i < cloth_yaml_count(at); i++)
    CLOTH_TRY(select_nearest_to(cloth_yaml_item(at, i), s, err));
  return CLOTH_OK;
}

static cloth_status select_radius(cloth_value at, selection *s, cloth_error *err)
{
  static const char *const known[] = {"center", "r", NULL};
  cloth_value value;
  double center[3], r;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(cloth_yaml_need(at, "center", &value, err));
  CLOTH_TRY(cloth_yaml_numbers(value, 3, "m", 1e6, center, err));
  CLOTH_TRY(cloth_yaml_need(at, "r", &value, err));
  CLOTH_TRY(cloth_yaml_number(value, "m", 0, 1e6, &r, err));
  for (int v = 0; v < s->mesh->vertex_count; v++)
    s->chosen[v] |= distance_sq(vertex(s, v), center) <= r * r;
  return CLOTH_OK;
}

static cloth_status select_side(cloth_value at, selection *s, cloth_error *err)
{
  static const char *const sides[] = {"left", "right", "bottom", "top", NULL};
  int side;
  CLOTH_TRY(cloth_yaml_choice(at, sides, &side, err));
  if (s->sides[side] == '-')
    CLOTH_YAML_FAIL(err, at, "only a 'grid' has %s; select this mesh's by 'box'",
                    side < 2 ? "left and right" : "sides, a 'tube' top and bottom");
  int axis = s->sides[side] - 'x';
  double sign = side % 2 ? 1 : -1, most = -DBL_MAX;
  for (int v = 0; v < s->mesh->vertex_count; v++) most = fmax(most, sign * vertex(s, v)[axis]);
  // borders of grids and tubes are exact, and a scale keeps them so
  for (int v = 0; v < s->mesh->vertex_count; v++) s->chosen[v] |= sign * vertex(s, v)[axis] == most;
  return CLOTH_OK;
}

// one selector, or a list of them: what any of them selects
static cloth_status select_any(cloth_value at, bool in_list, selection *s, cloth_error *err)
{
  static const char *const known[] = {"vertices", "box", "nearest", "radius", "side", NULL};
  if (cloth_yaml_is_list(at) && !in_list) {
    CLOTH_TRY(cloth_yaml_list(at, 1, -1, err));
    for (int i = 0; i < cloth_yaml_count(at); i++)
      CLOTH_TRY(select_any(cloth_yaml_item(at, i), true, s, err));
    return CLOTH_OK;
  }
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  if (cloth_yaml_count(at) != 1)
    CLOTH_YAML_FAIL(err, at, "expected one of vertices, box, nearest, radius, side, found %d keys",
                    cloth_yaml_count(at));
  cloth_value how = cloth_yaml_pair(at, 0);
  switch (how.key[0]) {
  case 'v':
    return select_vertices(how, s, err);
  case 'b':
    return select_box(how, s, err);
  case 'n':
    return select_nearest(how, s, err);
  case 'r':
    return select_radius(how, s, err);
  default:
    return select_side(how, s, err);
  }
}

static cloth_status keep(cloth_value at, const selection *s, cloth_group_def *out, cloth_error *err)
{
  size_t n = 0;
  for (int v = 0; v < s->mesh->vertex_count; v++) n += s->chosen[v];
  if (n == 0) CLOTH_YAML_FAIL(err, at, "no vertex of the mesh is in this group");
  out->name = cloth_string_copy(at.key);
  out->vertex = malloc(sizeof *out->vertex * n);
  if (out->name == NULL || out->vertex == NULL)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for groups");
  for (int v = 0; v < s->mesh->vertex_count; v++)
    if (s->chosen[v]) out->vertex[out->count++] = v;
  return CLOTH_OK;
}

cloth_status cloth_read_groups(cloth_value at, const char *sides, cloth_mesh_file *file,
                               cloth_error *err)
{
  CLOTH_TRY(cloth_yaml_mapping(at, NULL, err));
  int n = cloth_yaml_count(at);
  size_t room = (size_t)file->group_count + (size_t)n + 1;
  cloth_group_def *grown = realloc(file->group, room * sizeof *grown);
  if (grown == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for groups");
  file->group = grown;
  for (int i = 0; i < n; i++) {
    cloth_value entry = cloth_yaml_pair(at, i);
    for (int g = 0; g < file->group_count; g++)
      if (strcmp(file->group[g].name, entry.key) == 0)
        CLOTH_YAML_FAIL(err, entry, "the mesh file has a group of this name");
    selection s = {&file->mesh, sides, calloc((size_t)file->mesh.vertex_count, sizeof(bool))};
    if (s.chosen == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for groups");
    file->group[file->group_count] = (cloth_group_def){0};
    file->group_count++;
    cloth_status status = select_any(entry, false, &s, err);
    if (status == CLOTH_OK) status = keep(entry, &s, &file->group[file->group_count - 1], err);
    free(s.chosen);
    CLOTH_TRY(status);
  }
  return CLOTH_OK;
}
