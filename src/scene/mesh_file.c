#include "scene/mesh_file.h"

#include <string.h>
#include <strings.h>

void cloth_mesh_file_free(cloth_mesh_file *file)
{
  cloth_mesh_free(&file->mesh);
  cloth_groups_free(file->group, file->group_count);
  *file = (cloth_mesh_file){0};
}

static bool ends_with(const char *path, const char *end)
{
  size_t n = strlen(path), m = strlen(end);
  return n > m && strcasecmp(path + n - m, end) == 0;
}

cloth_status cloth_mesh_file_read(const char *path, cloth_mesh_file *out, cloth_error *err)
{
  *out = (cloth_mesh_file){0};
  bool obj = ends_with(path, ".obj");
  if (!obj && !ends_with(path, ".ply"))
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: the name ends neither with .obj nor with .ply", path);
  cloth_text text;
  CLOTH_TRY(cloth_text_read(path, &text, err));
  cloth_status status = (obj ? cloth_obj_parse : cloth_ply_parse)(path, &text, out, err);
  free(text.data);
  if (status == CLOTH_OK && (out->mesh.vertex_count < 1 || out->mesh.triangle_count < 1))
    status = cloth_fail(err, CLOTH_BAD_SCENE, __FILE__, __LINE__,
                        "%s: the mesh has %d vertices and %d triangles; it needs some", path,
                        out->mesh.vertex_count, out->mesh.triangle_count);
  if (status != CLOTH_OK) cloth_mesh_file_free(out);
  return status;
}
