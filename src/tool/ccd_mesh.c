// cloth ccd-mesh: what touches in one step of a mesh, from the mesh at its start and at its end.
#include "geometry/mesh_impacts.h"
#include "precision.h"
#include "scene/mesh.h"

#include <float.h>
#include <inttypes.h>
#include <string.h>

static const tool_option options[] = {
    {"inflate", "R", "make every box larger by R on all sides [m] (default 0); boxes only"},
    {"precision", "NAME", "float or double (default double)"},
    {"float-only", NULL, "with --precision float: no second look in double at close calls"},
    {NULL, NULL, NULL},
};

static cloth_status check_same(const char *const path[2], const cloth_mesh *a, const cloth_mesh *b,
                               cloth_error *err)
{
  if (a->vertex_count != b->vertex_count || a->triangle_count != b->triangle_count)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE,
               "%s has %d vertices and %d triangles, %s %d and %d; both must be the same mesh",
               path[0], a->vertex_count, a->triangle_count, path[1], b->vertex_count,
               b->triangle_count);
  for (size_t t = 0; t < (size_t)a->triangle_count; t++) {
    const int *v = a->triangle + 3 * t, *w = b->triangle + 3 * t;
    if (memcmp(v, w, 3 * sizeof *v) != 0)
      CLOTH_FAIL(
          err, CLOTH_BAD_SCENE,
          "triangle %zu is (%d, %d, %d) in %s, but (%d, %d, %d) in %s; both must be the same "
          "mesh",
          t, v[0], v[1], v[2], path[0], w[0], w[1], w[2], path[1]);
  }
  return CLOTH_OK;
}

static void print_impacts(const cloth_mesh *m, const cloth_mesh_impacts *r)
{
  printf("mesh: vertices %d, triangles %d, edges %d", m->vertex_count, m->triangle_count, r->edges);
  if (r->unreferenced) printf(" (%d vertices belong to no triangle; they count)", r->unreferenced);
  printf("\ncandidate pairs: edge-edge %" PRId64 ", vertex-face %" PRId64 "\n", r->candidates[0],
         r->candidates[1]);
  printf("colliding pairs: edge-edge %" PRId64 ", vertex-face %" PRId64 "\n", r->colliding[0],
         r->colliding[1]);
  int kind = r->first[1] < r->first[0] ? 1 : 0;
  const int *v = r->first_vertex[kind];
  if (r->colliding[kind] == 0)
    printf("earliest time of impact: none\n");
  else if (kind == 0)
    printf("earliest time of impact: %.17g (edges %d-%d and %d-%d)\n", r->first[0], v[0], v[1],
           v[2], v[3]);
  else
    printf("earliest time of impact: %.17g (vertex %d and face %d-%d-%d)\n", r->first[1], v[0],
           v[1], v[2], v[3]);
  for (int k = 0; k < 2 && (r->colliding[0] || r->colliding[1]); k++) {
    printf("%s %s", k ? ", vertex-face" : "  edge-edge", r->colliding[k] ? "" : "none");
    if (r->colliding[k]) printf("%.17g", r->first[k]);
    if (k == 1) printf("\n");
  }
  double pairs = (double)(r->candidates[0] + r->candidates[1]);
  printf("time: broad phase %.3f s, narrow phase %.3f s, %.0f ns per candidate\n", r->seconds[0],
         r->seconds[1], pairs > 0 ? 1e9 * r->seconds[1] / pairs : 0);
}

static int ccd_mesh_main(const tool_arguments *args, cloth_error *err)
{
  cloth_mesh_file file[2] = {0};
  cloth_mesh_impacts result;
  cloth_impact_precision precision;
  double inflate = 0;
  cloth_status status;
  const char *const path[2] = {args->operand[0], args->operand[1]};
  CLOTH_TRY_GOTO(tool_number(args, "inflate", "m", 0, DBL_MAX / 4, &inflate, err), status, done);
  CLOTH_TRY_GOTO(tool_precision(args, &precision, err), status, done);
  for (int i = 0; i < 2; i++)
    CLOTH_TRY_GOTO(cloth_mesh_file_read(path[i], &file[i], err), status, done);
  const cloth_mesh *m = &file[0].mesh;
  CLOTH_TRY_GOTO(check_same(path, m, &file[1].mesh, err), status, done);
  cloth_mesh_view view = {m->vertex_count, m->triangle_count, m->position, m->triangle, NULL};
  CLOTH_TRY_GOTO(
      cloth_mesh_impacts_find(&view, file[1].mesh.position, inflate, precision, &result, err),
      status, done);
  print_impacts(m, &result);
done:
  for (int i = 0; i < 2; i++) cloth_mesh_file_free(&file[i]);
  return tool_exit_code(status);
}

const tool_command tool_ccd_mesh = {"ccd-mesh",
                                    "T0.ply T1.ply",
                                    2,
                                    2,
                                    false,
                                    options,
                                    "what touches in one step of a mesh (PLY or OBJ)",
                                    ccd_mesh_main};
