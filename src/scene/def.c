// Making and filling a description. Readers of scene files end up here too, so that a file and
// calls are held to the same rules.
#include "scene/def.h"

#include "scene/file.h"
#include "scene/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

cloth_status cloth_def_new(cloth_def **out, cloth_error *err)
{
  *out = NULL;
  cloth_def *def = calloc(1, sizeof *def);
  if (def == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for a scene description");
  def->params = cloth_params_default();
  strcpy(def->name, "scene");
  strcpy(def->backend, "auto");
  strcpy(def->precision, "double");
  def->device_count = 1;
  *out = def;
  return CLOTH_OK;
}

void cloth_motion_free(cloth_motion *motion)
{
  free(motion->time);
  free(motion->pose);
  *motion = (cloth_motion){0};
}

void cloth_groups_free(cloth_group_def *group, int count)
{
  for (int i = 0; group != NULL && i < count; i++) {
    free(group[i].name);
    free(group[i].vertex);
  }
  free(group);
}

static void free_cloth(cloth_cloth_def *cloth)
{
  free(cloth->name);
  free(cloth->material_name);
  cloth_mesh_free(&cloth->mesh);
  cloth_groups_free(cloth->group, cloth->group_count);
}

static void free_body(cloth_body_def *body)
{
  free(body->name);
  cloth_mesh_free(&body->mesh);
  cloth_motion_free(&body->motion);
}

void cloth_def_free(cloth_def *def)
{
  if (def == NULL) return;
  for (int i = 0; i < def->cloth_count; i++) free_cloth(&def->cloth[i]);
  for (int i = 0; i < def->body_count; i++) free_body(&def->body[i]);
  for (int i = 0; i < def->pin_count; i++) cloth_motion_free(&def->pin[i].motion);
  free(def->cloth);
  free(def->body);
  free(def->pin);
  free(def->path);
  free(def);
}

cloth_params *cloth_def_params(cloth_def *def) { return &def->params; }
const char *cloth_def_precision(const cloth_def *def) { return def->precision; }
double cloth_def_duration(const cloth_def *def) { return def->duration; }

int cloth_def_find_cloth(const cloth_def *def, const char *name)
{
  for (int i = 0; i < def->cloth_count; i++)
    if (strcmp(def->cloth[i].name, name) == 0) return i;
  return -1;
}

int cloth_def_find_body(const cloth_def *def, const char *name)
{
  for (int i = 0; i < def->body_count; i++)
    if (strcmp(def->body[i].name, name) == 0) return i;
  return -1;
}

// ---- checks of what comes in --------------------------------------------------------------------

cloth_status cloth_pose_normalise(cloth_pose *pose, cloth_error *err)
{
  double norm_sq = 0;
  for (int i = 0; i < 3; i++)
    if (!isfinite(pose->position[i]))
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "position (%g, %g, %g) [m] is not finite", pose->position[0],
                 pose->position[1], pose->position[2]);
  const double *q = pose->rotation;
  for (int i = 0; i < 4; i++) norm_sq += q[i] * q[i];
  // far from 1 it is no rotation that was written with few digits, but something else
  if (!(norm_sq > 0.81 && norm_sq < 1.21))
    CLOTH_FAIL(err, CLOTH_BAD_SCENE,
               "rotation (%g, %g, %g, %g) [1] has length %g; a quaternion x, y, z, w has length 1",
               q[0], q[1], q[2], q[3], sqrt(norm_sq));
  for (int i = 0; i < 4; i++) pose->rotation[i] /= sqrt(norm_sq);
  return CLOTH_OK;
}

static bool is_word(const char *name)
{
  if (!((*name >= 'a' && *name <= 'z') || (*name >= 'A' && *name <= 'Z'))) return false;
  for (; *name; name++)
    if (!((*name >= 'a' && *name <= 'z') || (*name >= 'A' && *name <= 'Z') ||
          (*name >= '0' && *name <= '9') || *name == '_'))
      return false;
  return true;
}

static cloth_status check_cloth_view(const cloth_def *def, const cloth_cloth_view *view,
                                     cloth_error *err)
{
  // it becomes a part of file and topic names
  if (view->name == NULL || !is_word(view->name))
    CLOTH_FAIL(err, CLOTH_BAD_SCENE,
               "the cloth's name '%s' is not a letter followed by letters, digits and _",
               view->name ? view->name : "");
  if (cloth_def_find_cloth(def, view->name) >= 0)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "there is a cloth '%s' already", view->name);
  cloth_error inner = {0};
  if (cloth_material_check(&view->material, &inner) != CLOTH_OK)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': material: %s", view->name, inner.text);
  for (int i = 0; i < 3; i++)
    if (!(fabs(view->velocity[i]) <= 1e3))
      CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                 "'%s': velocity (%g, %g, %g) [m/s]: %c is not in [-1000, 1000]", view->name,
                 view->velocity[0], view->velocity[1], view->velocity[2], "xyz"[i]);
  return CLOTH_OK;
}

static cloth_status check_group(const cloth_cloth_view *cloth, int index, cloth_error *err)
{
  const cloth_group_view *g = &cloth->group[index];
  if (g->name == NULL || g->name[0] == '\0')
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': group %d has no name", cloth->name, index);
  for (int i = 0; i < index; i++)
    if (strcmp(cloth->group[i].name, g->name) == 0)
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': group '%s' is there twice", cloth->name, g->name);
  if (g->count < 1 || g->vertex == NULL)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': group '%s' has no vertices", cloth->name, g->name);
  for (int i = 0; i < g->count; i++)
    if (g->vertex[i] < 0 || g->vertex[i] >= cloth->mesh.vertex_count)
      CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                 "'%s': group '%s' names vertex %d; the mesh has vertices 0 to %d", cloth->name,
                 g->name, g->vertex[i], cloth->mesh.vertex_count - 1);
  return CLOTH_OK;
}

static int compare_ints(const void *a, const void *b)
{
  int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

// `kept` leads from the vertices of the view to those of the repaired mesh
static cloth_status copy_group(const char *cloth, const cloth_group_view *view, const int *kept,
                               cloth_group_def *out, cloth_error *err)
{
  out->name = cloth_string_copy(view->name);
  out->vertex = malloc(sizeof *out->vertex * (size_t)view->count);
  if (out->name == NULL || out->vertex == NULL)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "'%s': no memory for group '%s'", cloth, view->name);
  int n = 0;
  for (int i = 0; i < view->count; i++)
    if (kept[view->vertex[i]] >= 0) out->vertex[n++] = kept[view->vertex[i]];
  if (n == 0)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE,
               "'%s': no vertex of group '%s' is left after the mesh's repair", cloth, view->name);
  qsort(out->vertex, (size_t)n, sizeof *out->vertex, compare_ints);
  for (int i = 0; i < n; i++)
    if (i == 0 || out->vertex[i] != out->vertex[out->count - 1])
      out->vertex[out->count++] = out->vertex[i];
  return CLOTH_OK;
}

static cloth_status copy_groups(const cloth_cloth_view *view, const int *kept, cloth_cloth_def *out,
                                cloth_error *err)
{
  if (view->group_count <= 0) return CLOTH_OK;
  for (int i = 0; i < view->group_count; i++) CLOTH_TRY(check_group(view, i, err));
  out->group = calloc((size_t)view->group_count, sizeof *out->group);
  if (out->group == NULL)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "'%s': no memory for groups", view->name);
  for (int i = 0; i < view->group_count; i++) {
    out->group_count++;
    CLOTH_TRY(copy_group(view->name, &view->group[i], kept, &out->group[i], err));
  }
  return CLOTH_OK;
}

// A checked copy of the mesh; *kept [view->vertex_count] is the caller's to free, also after a
// failure.
static cloth_status take_mesh(const cloth_def *def, const char *name, bool is_cloth,
                              const cloth_mesh_view *view, cloth_mesh *out, int **kept,
                              cloth_mesh_repairs *repairs, cloth_error *err)
{
  *kept = NULL;
  cloth_error inner = {0};
  cloth_status status = cloth_mesh_copy(view, out, &inner);
  if (status != CLOTH_OK) CLOTH_FAIL(err, status, "'%s': %s", name, inner.text);
  *kept = malloc(sizeof **kept * (size_t)view->vertex_count);
  if (*kept == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "'%s': no memory to check the mesh", name);
  return cloth_mesh_check(name, is_cloth, def->params.mesh_defects != 0, out, *kept, repairs, err);
}

// ---- adding -------------------------------------------------------------------------------------

static cloth_status fill_cloth(const cloth_def *def, const cloth_cloth_view *view,
                               cloth_cloth_def *out, cloth_error *err)
{
  *out = (cloth_cloth_def){.material = view->material, .pose = view->pose};
  memcpy(out->velocity, view->velocity, sizeof out->velocity);
  cloth_error inner = {0};
  if (cloth_pose_normalise(&out->pose, &inner) != CLOTH_OK)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': pose: %s", view->name, inner.text);
  out->name = cloth_string_copy(view->name);
  out->material_name = cloth_string_copy("default");
  if (out->name == NULL || out->material_name == NULL)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for cloth '%s'", view->name);
  int *kept;
  cloth_status status =
      take_mesh(def, view->name, true, &view->mesh, &out->mesh, &kept, &out->repairs, err);
  if (status == CLOTH_OK) status = copy_groups(view, kept, out, err);
  free(kept);
  return status;
}

cloth_status cloth_def_add_cloth(cloth_def *def, const cloth_cloth_view *cloth, int *index,
                                 cloth_error *err)
{
  CLOTH_TRY(check_cloth_view(def, cloth, err));
  cloth_cloth_def *grown = realloc(def->cloth, sizeof *grown * ((size_t)def->cloth_count + 1));
  if (grown == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for cloth '%s'", cloth->name);
  def->cloth = grown;
  cloth_status status = fill_cloth(def, cloth, &grown[def->cloth_count], err);
  if (status != CLOTH_OK) {
    free_cloth(&grown[def->cloth_count]);
    return status;
  }
  if (index) *index = def->cloth_count;
  def->cloth_count++;
  return CLOTH_OK;
}

static cloth_status fill_body(const cloth_def *def, const cloth_body_view *view,
                              cloth_body_def *out, cloth_error *err)
{
  *out = (cloth_body_def){.pose = view->pose,
                          .friction = view->friction,
                          .plane = view->shape == CLOTH_SHAPE_PLANE,
                          .shape = view->shape};
  memcpy(out->size, view->size, sizeof out->size);
  cloth_error inner = {0};
  if (cloth_pose_normalise(&out->pose, &inner) != CLOTH_OK)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': pose: %s", view->name, inner.text);
  out->name = cloth_string_copy(view->name);
  if (out->name == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for body '%s'", view->name);
  cloth_mesh_view mesh = view->mesh;
  mesh.material = NULL;
  int *kept;
  cloth_status status =
      take_mesh(def, view->name, false, &mesh, &out->mesh, &kept, &out->repairs, err);
  free(kept);
  return status;
}

static cloth_status check_shape(const cloth_body_view *body, cloth_error *err)
{
  static const int lengths[] = {0, 3, 1, 2, 0}; // of each cloth_shape
  int shape = (int)body->shape;
  if (shape < 0 || shape > CLOTH_SHAPE_PLANE)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': shape = %d is not in [0, %d]", body->name, shape,
               CLOTH_SHAPE_PLANE);
  for (int i = 0; i < lengths[shape]; i++)
    if (!(body->size[i] >= 1e-6 && body->size[i] <= 1e4))
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': size[%d] = %g [m] is not in [1e-06, 10000]",
                 body->name, i, body->size[i]);
  return CLOTH_OK;
}

cloth_status cloth_def_add_body(cloth_def *def, const cloth_body_view *body, int *index,
                                cloth_error *err)
{
  if (body->name == NULL || body->name[0] == '\0')
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "the body has no name");
  if (cloth_def_find_body(def, body->name) >= 0)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "there is a body '%s' already", body->name);
  if (!(body->friction >= 0 && body->friction <= 10))
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "'%s': friction = %g [1] is not in [0, 10]", body->name,
               body->friction);
  CLOTH_TRY(check_shape(body, err));
  cloth_body_def *grown = realloc(def->body, sizeof *grown * ((size_t)def->body_count + 1));
  if (grown == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for body '%s'", body->name);
  def->body = grown;
  cloth_status status = fill_body(def, body, &grown[def->body_count], err);
  if (status != CLOTH_OK) {
    free_body(&grown[def->body_count]);
    return status;
  }
  if (index) *index = def->body_count;
  def->body_count++;
  return CLOTH_OK;
}
