#ifndef _GNU_SOURCE
#define _GNU_SOURCE // newlocale
#endif
#include "scene/mesh.h"

#include <errno.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// 17 digits carry every bit of a double
static void write_mesh(FILE *f, int vertex_count, const double *position, int triangle_count,
                       const int *triangle)
{
  fprintf(f, "# %d vertices [m], %d triangles\n", vertex_count, triangle_count);
  for (size_t v = 0; v < (size_t)vertex_count; v++)
    fprintf(f, "v %.17g %.17g %.17g\n", position[3 * v], position[3 * v + 1], position[3 * v + 2]);
  for (size_t t = 0; t < (size_t)triangle_count; t++)
    fprintf(f, "f %d %d %d\n", triangle[3 * t] + 1, triangle[3 * t + 1] + 1,
            triangle[3 * t + 2] + 1);
}

cloth_status cloth_obj_write(const char *path, int vertex_count, const double *position,
                             int triangle_count, const int *triangle, cloth_error *err)
{
  // written beside and renamed, so that nobody reads half a mesh
  size_t room = strlen(path) + sizeof ".part";
  char *part = malloc(room);
  locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  if (part == NULL || c == (locale_t)0) {
    free(part);
    if (c != (locale_t)0) freelocale(c);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: no memory", path);
  }
  snprintf(part, room, "%s.part", path);

  bool written = false;
  errno = 0;
  FILE *f = fopen(part, "wb");
  if (f) {
    locale_t before = uselocale(c);
    write_mesh(f, vertex_count, position, triangle_count, triangle);
    uselocale(before);
    written = !ferror(f);
    written = fclose(f) == 0 && written;
    if (written) written = rename(part, path) == 0;
    int why = errno;
    if (!written) remove(part);
    errno = why;
  }
  int why = errno;
  free(part);
  freelocale(c);
  if (!written) CLOTH_FAIL(err, CLOTH_IO, "%s: cannot be written: %s", path, strerror(why));
  return CLOTH_OK;
}
