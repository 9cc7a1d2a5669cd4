// cloth check: which triangles of meshes intersect, by exact predicates. None of the engine's
// contact code takes part.
#include "geometry/intersections.h"
#include "scene/mesh.h"
#include "tool.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

static const tool_option options[] = {
    {"max-pairs", "N", "list at most N intersecting pairs (default 20)"},
    {"list", "FILE.csv", "write all pairs there: mesh0,triangle0,mesh1,triangle1, files in quotes"},
    {NULL, NULL, NULL},
};

typedef struct check {
  int count;
  const char **path;     // [count]
  cloth_mesh_file *file; // [count]
  cloth_mesh_view *view; // [count]
  cloth_triangle_pair *pair;
  int64_t pair_count;
} check;

static cloth_status read_meshes(check *c, cloth_error *err)
{
  c->file = calloc((size_t)c->count, sizeof *c->file);
  c->view = calloc((size_t)c->count, sizeof *c->view);
  if (!c->file || !c->view) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d meshes", c->count);
  for (int i = 0; i < c->count; i++) {
    CLOTH_TRY(cloth_mesh_file_read(c->path[i], &c->file[i], err));
    const cloth_mesh *m = &c->file[i].mesh;
    c->view[i] =
        (cloth_mesh_view){m->vertex_count, m->triangle_count, m->position, m->triangle, NULL};
  }
  return CLOTH_OK;
}

// ---- output ------------------------------------------------------------------------------------

static void write_quoted(FILE *out, const char *text)
{
  fputc('"', out);
  for (; *text; text++) {
    if (*text == '"') fputc('"', out);
    fputc(*text, out);
  }
  fputc('"', out);
}

static cloth_status write_list(const check *c, const char *path, cloth_error *err)
{
  char part[PATH_MAX];
  if ((size_t)snprintf(part, sizeof part, "%s.part", path) >= sizeof part)
    CLOTH_FAIL(err, CLOTH_IO, "--list: the name is too long");
  FILE *out = fopen(part, "w");
  if (!out) CLOTH_FAIL(err, CLOTH_IO, "--list: cannot write %s: %s", part, strerror(errno));
  fprintf(out, "mesh0,triangle0,mesh1,triangle1\n");
  for (int64_t i = 0; i < c->pair_count; i++)
    for (int k = 0; k < 2; k++) {
      write_quoted(out, c->path[c->pair[i].mesh[k]]);
      fprintf(out, ",%d%c", c->pair[i].triangle[k], k ? '\n' : ',');
    }
  bool written = !ferror(out);
  written = fclose(out) == 0 && written;
  if (written && rename(part, path) == 0) return CLOTH_OK;
  remove(part);
  CLOTH_FAIL(err, CLOTH_IO, "--list: cannot write %s: %s", path, strerror(errno));
}

static void print_pairs(const check *c, int64_t most)
{
  for (int64_t i = 0; i < c->pair_count && i < most; i++) {
    const cloth_triangle_pair *p = &c->pair[i];
    printf("%s triangle %d, %s triangle %d\n", c->path[p->mesh[0]], p->triangle[0],
           c->path[p->mesh[1]], p->triangle[1]);
  }
  if (c->pair_count > most)
    printf("%" PRId64 " more are not shown (--max-pairs, --list)\n", c->pair_count - most);
}

// Pairs are sorted by triangle of the first mesh, so those of two meshes are not together.
static cloth_status print_totals(const check *c, cloth_error *err)
{
  size_t n = (size_t)c->count;
  int64_t *total = calloc(n * n, sizeof *total);
  if (!total) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for the totals of %d meshes", c->count);
  for (int64_t i = 0; i < c->pair_count; i++)
    total[(size_t)c->pair[i].mesh[0] * n + (size_t)c->pair[i].mesh[1]]++;
  for (size_t i = 0; i < n; i++)
    printf("%s: %d triangles, %" PRId64 " pairs with itself\n", c->path[i],
           c->view[i].triangle_count, total[i * n + i]);
  for (size_t i = 0; i < n; i++)
    for (size_t j = i + 1; j < n; j++)
      printf("%s and %s: %" PRId64 " pairs\n", c->path[i], c->path[j], total[i * n + j]);
  free(total);
  return CLOTH_OK;
}

// ---- the command -------------------------------------------------------------------------------

static int check_main(const tool_arguments *args, cloth_error *err)
{
  check c = {.count = args->operand_count, .path = args->operand};
  const char *list = tool_text(args, "list");
  int64_t most = 20;
  int code;
  cloth_status status;
  CLOTH_TRY_GOTO(tool_integer(args, "max-pairs", 0, INT64_MAX, &most, err), status, done);
  CLOTH_TRY_GOTO(read_meshes(&c, err), status, done);
  CLOTH_TRY_GOTO(cloth_intersections_find(c.count, c.view, &c.pair, &c.pair_count, err), status,
                 done);
  print_pairs(&c, most);
  CLOTH_TRY_GOTO(print_totals(&c, err), status, done);
  if (list) CLOTH_TRY_GOTO(write_list(&c, list, err), status, done);
  printf("intersecting pairs %" PRId64 "\n", c.pair_count);
done:
  code = status != CLOTH_OK ? tool_exit_code(status) : c.pair_count > 0 ? TOOL_FAILED : TOOL_DONE;
  for (int i = 0; i < c.count && c.file; i++) cloth_mesh_file_free(&c.file[i]);
  free(c.file);
  free(c.view);
  free(c.pair);
  return code;
}

const tool_command tool_check = {"check",
                                 "MESH...",
                                 1,
                                 INT_MAX,
                                 false,
                                 options,
                                 "do triangles of meshes (OBJ, PLY) intersect, by exact predicates",
                                 check_main};
