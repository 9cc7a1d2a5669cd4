#include "scene/mesh.h"

#include <stdlib.h>
#include <string.h>

// three indices, nine coordinates and six material numbers of the largest mesh still count in an
// int
enum { MESH_MAX = 100 * 1000 * 1000 };

cloth_status cloth_mesh_new(int vertex_count, int triangle_count, bool with_material,
                            cloth_mesh *out, cloth_error *err)
{
  *out = (cloth_mesh){.vertex_count = vertex_count, .triangle_count = triangle_count};
  size_t vertices = (size_t)vertex_count, triangles = (size_t)triangle_count;
  out->position = calloc(3 * vertices + 1, sizeof *out->position);
  out->triangle = calloc(3 * triangles + 1, sizeof *out->triangle);
  out->material = with_material ? calloc(6 * triangles + 1, sizeof *out->material) : NULL;
  if (out->position && out->triangle && (out->material || !with_material)) return CLOTH_OK;
  cloth_mesh_free(out);
  CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for a mesh of %d vertices and %d triangles",
             vertex_count, triangle_count);
}

void cloth_mesh_free(cloth_mesh *mesh)
{
  free(mesh->position);
  free(mesh->triangle);
  free(mesh->material);
  *mesh = (cloth_mesh){0};
}

cloth_status cloth_mesh_copy(const cloth_mesh_view *view, cloth_mesh *out, cloth_error *err)
{
  *out = (cloth_mesh){0};
  int n = view->vertex_count, m = view->triangle_count;
  if (n < 1 || m < 1)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "the mesh has %d vertices and %d triangles; it needs some", n,
               m);
  if (n > MESH_MAX || m > MESH_MAX)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "the mesh has %d vertices and %d triangles; %d is the limit",
               n, m, (int)MESH_MAX);
  if (view->position == NULL || view->triangle == NULL)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "the mesh has no array of %s (NULL)",
               view->position ? "triangles" : "positions");
  CLOTH_TRY(cloth_mesh_new(n, m, view->material != NULL, out, err));
  memcpy(out->position, view->position, sizeof *out->position * 3 * (size_t)n);
  memcpy(out->triangle, view->triangle, sizeof *out->triangle * 3 * (size_t)m);
  if (out->material) memcpy(out->material, view->material, sizeof *out->material * 6 * (size_t)m);
  return CLOTH_OK;
}
