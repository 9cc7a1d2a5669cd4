// `bodies:` of a scene file.
#include "scene/scene_file.h"

#include <math.h>

enum { SEGMENTS = 32 };

static cloth_status need_length(cloth_value mapping, const char *key, double *out, cloth_error *err)
{
  cloth_value at;
  CLOTH_TRY(cloth_yaml_need(mapping, key, &at, err));
  return cloth_yaml_number(at, "m", 1e-6, 1e4, out, err);
}

static cloth_status read_segments(cloth_value mapping, int *out, cloth_error *err)
{
  cloth_value at;
  *out = SEGMENTS;
  if (!cloth_yaml_find(mapping, "segments", &at)) return CLOTH_OK;
  return cloth_yaml_int(at, "1", 3, 1000, out, err);
}

static cloth_status read_box(cloth_value at, cloth_mesh *out, cloth_error *err)
{
  static const char *const known[] = {"size", NULL};
  cloth_value size;
  double edge[3];
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(cloth_yaml_need(at, "size", &size, err));
  CLOTH_TRY(cloth_yaml_list(size, 3, 3, err));
  for (int i = 0; i < 3; i++)
    CLOTH_TRY(cloth_yaml_number(cloth_yaml_item(size, i), "m", 1e-6, 1e4, &edge[i], err));
  return cloth_mesh_box(edge, out, err);
}

static cloth_status read_sphere(cloth_value at, cloth_mesh *out, cloth_error *err)
{
  static const char *const known[] = {"radius", "segments", NULL};
  double radius;
  int segments;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(need_length(at, "radius", &radius, err));
  CLOTH_TRY(read_segments(at, &segments, err));
  return cloth_mesh_sphere(radius, segments, out, err);
}

static cloth_status read_cylinder(cloth_value at, cloth_mesh *out, cloth_error *err)
{
  static const char *const known[] = {"radius", "length", "segments", NULL};
  double radius, length;
  int segments;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(need_length(at, "radius", &radius, err));
  CLOTH_TRY(need_length(at, "length", &length, err));
  CLOTH_TRY(read_segments(at, &segments, err));
  return cloth_mesh_cylinder(radius, length, segments, out, err);
}

static cloth_status read_cone(cloth_value at, cloth_mesh *out, cloth_error *err)
{
  static const char *const known[] = {"radius", "length", "segments", NULL};
  cloth_value value;
  double radius[2] = {0, 0}, length;
  int segments;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(cloth_yaml_need(at, "radius", &value, err));
  if (cloth_yaml_is_list(value)) {
    CLOTH_TRY(cloth_yaml_list(value, 2, 2, err));
    for (int i = 0; i < 2; i++)
      CLOTH_TRY(cloth_yaml_number(cloth_yaml_item(value, i), "m", 0, 1e4, &radius[i], err));
  } else {
    CLOTH_TRY(cloth_yaml_number(value, "m", 1e-6, 1e4, &radius[0], err));
  }
  CLOTH_TRY(need_length(at, "length", &length, err));
  CLOTH_TRY(read_segments(at, &segments, err));
  cloth_error cause = {0};
  cloth_status status = cloth_mesh_cone(radius, length, segments, out, &cause);
  return cloth_yaml_blame(err, at, status, &cause);
}

// the shortest rotation that takes z to a unit vector
static void rotation_to(const double n[3], double q[4])
{
  if (n[2] < -1 + 1e-12) { // any axis at a right angle to z
    q[0] = 1, q[1] = q[2] = q[3] = 0;
    return;
  }
  double norm = sqrt(2 * (1 + n[2]));
  q[0] = -n[1] / norm, q[1] = n[0] / norm, q[2] = 0, q[3] = norm / 2;
}

static cloth_status read_plane(cloth_value at, cloth_mesh *mesh, cloth_pose *local,
                               cloth_error *err)
{
  static const char *const known[] = {"normal", "offset", "size", NULL};
  cloth_value value;
  double normal[3] = {0, 0, 1}, offset = 0, size = 4;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  if (cloth_yaml_find(at, "normal", &value)) {
    CLOTH_TRY(cloth_yaml_numbers(value, 3, "1", 1e6, normal, err));
    double norm = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if (!(norm > 1e-9)) CLOTH_YAML_FAIL(err, value, "a normal of length %g has no direction", norm);
    for (int i = 0; i < 3; i++) normal[i] /= norm;
  }
  if (cloth_yaml_find(at, "offset", &value))
    CLOTH_TRY(cloth_yaml_number(value, "m", -1e6, 1e6, &offset, err));
  if (cloth_yaml_find(at, "size", &value))
    CLOTH_TRY(cloth_yaml_number(value, "m", 1e-6, 1e4, &size, err));
  for (int i = 0; i < 3; i++) local->position[i] = offset * normal[i];
  rotation_to(normal, local->rotation);
  return cloth_mesh_square(size, mesh, err);
}

static cloth_status read_file(cloth_value at, cloth_mesh *mesh, cloth_error *err)
{
  cloth_mesh_file file;
  CLOTH_TRY(cloth_read_mesh_file(at, &file, err));
  *mesh = file.mesh;
  file.mesh = (cloth_mesh){0};
  cloth_mesh_file_free(&file);
  return CLOTH_OK;
}

// `local`: pose of the shape in the body's pose; only a plane has one
static cloth_status read_shape(cloth_value at, cloth_mesh *mesh, cloth_pose *local, bool *plane,
                               cloth_error *err)
{
  enum { BOX, SPHERE, CYLINDER, CONE, PLANE, MESH };
  static const char *const shapes[] = {"box", "sphere", "cylinder", "cone", "plane", "mesh", NULL};
  cloth_value shape = at, other, scale;
  int found = -1;
  for (int i = 0; shapes[i]; i++) {
    if (!cloth_yaml_find(at, shapes[i], &other)) continue;
    if (found >= 0)
      CLOTH_YAML_FAIL(err, other, "stands beside '%s'; a body has one shape", shapes[found]);
    found = i;
    shape = other;
  }
  *plane = found == PLANE;
  if (found != MESH && cloth_yaml_find(at, "scale", &scale))
    CLOTH_YAML_FAIL(err, scale, "belongs to 'mesh' only");
  switch (found) {
  case BOX:
    return read_box(shape, mesh, err);
  case SPHERE:
    return read_sphere(shape, mesh, err);
  case CYLINDER:
    return read_cylinder(shape, mesh, err);
  case CONE:
    return read_cone(shape, mesh, err);
  case PLANE:
    return read_plane(shape, mesh, local, err);
  case MESH:
    CLOTH_TRY(read_file(shape, mesh, err));
    return cloth_read_scale(at, mesh, err);
  }
  CLOTH_YAML_FAIL(err, at,
                  "the body has no shape; give one of box, sphere, cylinder, cone, plane, "
                  "mesh");
}

static cloth_status add_body(cloth_value at, const cloth_body_view *view, bool plane,
                             cloth_motion *motion, cloth_def *def, cloth_error *err)
{
  int index;
  cloth_error cause = {0};
  CLOTH_TRY(cloth_yaml_blame(err, at, cloth_def_add_body(def, view, &index, &cause), &cause));
  def->body[index].plane = plane;
  def->body[index].motion = *motion;
  *motion = (cloth_motion){0};
  return CLOTH_OK;
}

// what moves starts where its motion has it at time 0
static cloth_status read_body_motion(cloth_value at, const cloth_pose *local, cloth_pose *pose,
                                     cloth_motion *motion, cloth_error *err)
{
  static const char *const known[] = {"position", "rotation", "rpy", NULL};
  cloth_value value;
  if (cloth_yaml_find(at, "pose", &value)) {
    CLOTH_TRY(cloth_yaml_mapping(value, known, err));
    CLOTH_TRY(cloth_read_pose(value, pose, err));
  }
  if (cloth_yaml_find(at, "motion", &value)) CLOTH_TRY(cloth_read_motion(value, pose, motion, err));
  for (int i = 0; i < motion->key_count; i++)
    motion->pose[i] = cloth_pose_product(&motion->pose[i], local);
  *pose = cloth_pose_product(pose, local);
  if (motion->key_count > 0) *pose = cloth_motion_at(motion, *pose, 0);
  return CLOTH_OK;
}

cloth_status cloth_read_body(cloth_value at, cloth_def *def, cloth_error *err)
{
  static const char *const known[] = {"name", "box",   "sphere", "cylinder", "cone",   "plane",
                                      "mesh", "scale", "pose",   "friction", "motion", NULL};
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  cloth_value value;
  cloth_body_view view = {.pose = cloth_pose_identity(), .friction = 0.3};
  CLOTH_TRY(cloth_yaml_need(at, "name", &value, err));
  CLOTH_TRY(cloth_yaml_text(value, &view.name, err));
  if (cloth_yaml_find(at, "friction", &value))
    CLOTH_TRY(cloth_yaml_number(value, "1", 0, 10, &view.friction, err));

  cloth_mesh mesh = {0};
  cloth_motion motion = {0};
  cloth_pose local = cloth_pose_identity();
  bool plane = false;
  cloth_status status = read_shape(at, &mesh, &local, &plane, err);
  if (status == CLOTH_OK) status = cloth_read_size(at, &view, err);
  if (status == CLOTH_OK) status = read_body_motion(at, &local, &view.pose, &motion, err);
  if (status == CLOTH_OK) {
    view.mesh = (cloth_mesh_view){mesh.vertex_count, mesh.triangle_count, mesh.position,
                                  mesh.triangle, NULL};
    status = add_body(at, &view, plane, &motion, def, err);
  }
  cloth_mesh_free(&mesh);
  cloth_motion_free(&motion);
  return status;
}
