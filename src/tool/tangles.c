#include "tangles.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

enum { SHOWN = 10 };

cloth_status tool_tangles_print(cloth_scene *scene, int *count, cloth_error *err)
{
  cloth_tangle_view pair[SHOWN];
  cloth_error cause = {0};
  cloth_status status = cloth_tangles(scene, pair, SHOWN, count, &cause);
  if (status == CLOTH_UNSUPPORTED) return CLOTH_OK; // an integrator that knows no triangles
  if (status != CLOTH_OK) *err = cause;
  CLOTH_TRY(status);
  if (*count == 0) return CLOTH_OK;
  printf("the start intersects: %d pairs of triangles\n", *count);
  for (int i = 0; i < *count && i < SHOWN; i++) {
    const cloth_tangle_view *p = &pair[i];
    const char *other = p->other_body >= 0 ? cloth_body_name(scene, p->other_body)
                                           : cloth_name(scene, p->other_cloth);
    printf("  cloth %s triangle %d, %s %s triangle %d\n", cloth_name(scene, p->cloth), p->triangle,
           p->other_body >= 0 ? "body" : "cloth", other, p->other_triangle);
  }
  if (*count > SHOWN) printf("  and %d more\n", *count - SHOWN);
  return CLOTH_OK;
}

cloth_status tool_blocking_add(cloth_scene *scene, unsigned char *blocking, cloth_error *err)
{
  int n = cloth_body_count(scene), count = 0;
  int *body = malloc(sizeof *body * (size_t)(n + 1));
  if (body == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d bodies", n);
  cloth_status status = cloth_blocking_bodies(scene, body, n, &count, err);
  for (int i = 0; status == CLOTH_OK && i < count; i++) blocking[body[i]] = 1;
  free(body);
  return status;
}

void tool_blocking_print(const cloth_scene *scene, const unsigned char *blocking, int64_t steps)
{
  printf("no room           in %" PRId64 " steps, between", steps);
  for (int b = 0; b < cloth_body_count(scene); b++)
    if (blocking[b]) printf(" %s", cloth_body_name(scene, b));
  printf("\n");
}
