// Poses, motions and meshes of scene files.
#include "scene/scene_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double FAR = 1e6; // m, s, m/s: nothing in a scene is beyond

// fixed axes x, y, z in this order, as in URDF
static void rotation_from_rpy(const double rpy[3], double q[4])
{
  double c[3], s[3];
  for (int i = 0; i < 3; i++) c[i] = cos(rpy[i] / 2), s[i] = sin(rpy[i] / 2);
  q[0] = s[0] * c[1] * c[2] - c[0] * s[1] * s[2];
  q[1] = c[0] * s[1] * c[2] + s[0] * c[1] * s[2];
  q[2] = c[0] * c[1] * s[2] - s[0] * s[1] * c[2];
  q[3] = c[0] * c[1] * c[2] + s[0] * s[1] * s[2];
}

cloth_status cloth_read_pose(cloth_value mapping, cloth_pose *pose, cloth_error *err)
{
  cloth_value position, rotation, rpy;
  double angles[3];
  if (cloth_yaml_find(mapping, "position", &position))
    CLOTH_TRY(cloth_yaml_numbers(position, 3, "m", FAR, pose->position, err));
  bool has_rotation = cloth_yaml_find(mapping, "rotation", &rotation);
  if (cloth_yaml_find(mapping, "rpy", &rpy)) {
    if (has_rotation) CLOTH_YAML_FAIL(err, rpy, "stands beside 'rotation'; give one of them");
    CLOTH_TRY(cloth_yaml_numbers(rpy, 3, "rad", FAR, angles, err));
    rotation_from_rpy(angles, pose->rotation);
  }
  if (!has_rotation) return CLOTH_OK;
  CLOTH_TRY(cloth_yaml_numbers(rotation, 4, "1", 2, pose->rotation, err));
  cloth_error cause = {0};
  return cloth_yaml_blame(err, rotation, cloth_pose_normalise(pose, &cause), &cause);
}

static void turn(const double q[4], const double v[3], double out[3])
{
  // v + 2 q x (q x v + w v)
  double a[3], b[3];
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    a[i] = q[j] * v[k] - q[k] * v[j] + q[3] * v[i];
  }
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    b[i] = q[j] * a[k] - q[k] * a[j];
  }
  for (int i = 0; i < 3; i++) out[i] = v[i] + 2 * b[i];
}

cloth_pose cloth_pose_product(const cloth_pose *a, const cloth_pose *b)
{
  cloth_pose out;
  const double *p = a->rotation, *q = b->rotation;
  turn(p, b->position, out.position);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    out.position[i] += a->position[i];
    out.rotation[i] = p[3] * q[i] + p[i] * q[3] + p[j] * q[k] - p[k] * q[j];
  }
  out.rotation[3] = p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2];
  return out;
}

static cloth_status read_keys(cloth_value at, const cloth_pose *start, cloth_motion *out,
                              cloth_error *err)
{
  static const char *const known[] = {"time", "position", "rotation", "rpy", NULL};
  CLOTH_TRY(cloth_yaml_list(at, 1, -1, err));
  size_t n = (size_t)cloth_yaml_count(at);
  out->time = calloc(n, sizeof *out->time);
  out->pose = calloc(n, sizeof *out->pose);
  if (out->time == NULL || out->pose == NULL)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for a motion");
  for (size_t i = 0; i < n; i++) {
    cloth_value item = cloth_yaml_item(at, (int)i), time;
    CLOTH_TRY(cloth_yaml_mapping(item, known, err));
    CLOTH_TRY(cloth_yaml_need(item, "time", &time, err));
    CLOTH_TRY(cloth_yaml_number(time, "s", 0, FAR, &out->time[i], err));
    if (i > 0 && !(out->time[i] > out->time[i - 1]))
      CLOTH_YAML_FAIL(err, time, "%g [s] is not after the key before, %g", out->time[i],
                      out->time[i - 1]);
    out->pose[i] = i > 0 ? out->pose[i - 1] : *start;
    CLOTH_TRY(cloth_read_pose(item, &out->pose[i], err));
  }
  out->key_count = (int)n;
  return CLOTH_OK;
}

static cloth_status read_oscillation(cloth_value at, cloth_motion *out, cloth_error *err)
{
  static const char *const known[] = {"amplitude", "swing", "period", NULL};
  cloth_value value;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  CLOTH_TRY(cloth_yaml_need(at, "period", &value, err));
  CLOTH_TRY(cloth_yaml_number(value, "s", 1e-3, FAR, &out->period, err));
  if (cloth_yaml_find(at, "amplitude", &value))
    CLOTH_TRY(cloth_yaml_numbers(value, 3, "m", 1e3, out->amplitude, err));
  if (cloth_yaml_find(at, "swing", &value))
    CLOTH_TRY(cloth_yaml_numbers(value, 3, "rad", 1e3, out->swing, err));
  return CLOTH_OK;
}

cloth_status cloth_read_motion(cloth_value at, const cloth_pose *start, cloth_motion *out,
                               cloth_error *err)
{
  static const char *const known[] = {"keys",  "velocity", "spin", "oscillation",
                                      "start", "end",      NULL};
  *out = (cloth_motion){.end = INFINITY};
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  cloth_value keys, value;
  if (cloth_yaml_find(at, "keys", &keys)) {
    for (int i = 1; known[i]; i++)
      if (cloth_yaml_find(at, known[i], &value))
        CLOTH_YAML_FAIL(err, value, "stands beside 'keys'; a motion is either keys or a velocity");
    return read_keys(keys, start, out, err);
  }
  if (cloth_yaml_find(at, "velocity", &value))
    CLOTH_TRY(cloth_yaml_numbers(value, 3, "m/s", 1e3, out->velocity, err));
  if (cloth_yaml_find(at, "spin", &value))
    CLOTH_TRY(cloth_yaml_numbers(value, 3, "rad/s", 1e3, out->spin, err));
  if (cloth_yaml_find(at, "oscillation", &value)) CLOTH_TRY(read_oscillation(value, out, err));
  if (cloth_yaml_find(at, "start", &value))
    CLOTH_TRY(cloth_yaml_number(value, "s", 0, FAR, &out->start, err));
  if (cloth_yaml_find(at, "end", &value))
    CLOTH_TRY(cloth_yaml_number(value, "s", out->start, INFINITY, &out->end, err));
  return CLOTH_OK;
}

cloth_status cloth_read_mesh_file(cloth_value at, cloth_mesh_file *out, cloth_error *err)
{
  const char *name;
  char *path = NULL;
  *out = (cloth_mesh_file){0};
  CLOTH_TRY(cloth_yaml_text(at, &name, err));
  CLOTH_TRY(cloth_path_beside(at.file->path, name, &path, err));
  cloth_error cause = {0};
  cloth_status status = cloth_mesh_file_read(path, out, &cause);
  free(path);
  return cloth_yaml_blame(err, at, status, &cause);
}

cloth_status cloth_read_scale(cloth_value mapping, cloth_mesh *mesh, cloth_error *err)
{
  cloth_value at;
  double scale[3];
  if (!cloth_yaml_find(mapping, "scale", &at)) return CLOTH_OK;
  if (cloth_yaml_is_list(at)) {
    CLOTH_TRY(cloth_yaml_numbers(at, 3, "1", 1e6, scale, err));
  } else {
    CLOTH_TRY(cloth_yaml_number(at, "1", -1e6, 1e6, &scale[0], err));
    scale[1] = scale[2] = scale[0];
  }
  for (int i = 0; i < 3; i++)
    if (!(fabs(scale[i]) >= 1e-6))
      CLOTH_YAML_FAIL(err, at, "%g [1]: the absolute value is not in [1e-06, 1e+06]", scale[i]);
  for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++) mesh->position[i] *= scale[i % 3];
  if (scale[0] * scale[1] * scale[2] > 0) return CLOTH_OK;
  for (size_t t = 0; t < (size_t)mesh->triangle_count; t++) {
    int *v = mesh->triangle + 3 * t, second = v[1];
    v[1] = v[2], v[2] = second;
    if (mesh->material == NULL) continue;
    double *u = mesh->material + 6 * t, corner[2] = {u[2], u[3]};
    memcpy(u + 2, u + 4, sizeof corner);
    memcpy(u + 4, corner, sizeof corner);
  }
  return CLOTH_OK;
}
