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

// ---- what leaves no room ------------------------------------------------------------------------

static cloth_status add_bodies(tool_blocking *b, cloth_scene *scene, cloth_error *err)
{
  int n = cloth_body_count(scene), count = 0;
  if (b->body == NULL) b->body = calloc((size_t)n + 1, 1);
  int *body = malloc(sizeof *body * (size_t)(n + 1));
  cloth_status status = CLOTH_OK;
  if (b->body == NULL || body == NULL)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "%d bodies", n);
  else
    status = cloth_blocking_bodies(scene, body, n, &count, err);
  for (int i = 0; status == CLOTH_OK && i < count; i++) b->body[body[i]] = 1;
  free(body);
  return status;
}

static bool is_same(const cloth_hold_view *a, const cloth_hold_view *b)
{
  return a->cloth == b->cloth && a->group == b->group && a->grasp.index1 == b->grasp.index1 &&
         a->grasp.generation == b->grasp.generation;
}

static cloth_status add_holds(tool_blocking *b, cloth_scene *scene, int n, cloth_error *err)
{
  int known = b->holds, count = 0;
  cloth_hold_view *hold = realloc(b->hold, sizeof *hold * (size_t)(known + n + 1));
  if (hold == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d holds", n);
  b->hold = hold;
  CLOTH_TRY(cloth_blocking_holds(scene, hold + known, n, &count, err));
  for (int i = known; i < known + count; i++) {
    bool told = false;
    for (int k = 0; k < b->holds && !told; k++) told = is_same(&hold[k], &hold[i]);
    if (!told) hold[b->holds++] = hold[i];
  }
  return CLOTH_OK;
}

cloth_status tool_blocking_add(tool_blocking *b, cloth_scene *scene, const cloth_step_report *r,
                               cloth_error *err)
{
  if (r->bodies_blocking > 0) CLOTH_TRY(add_bodies(b, scene, err));
  if (r->holds_blocking > 0) CLOTH_TRY(add_holds(b, scene, r->holds_blocking, err));
  b->steps += r->bodies_blocking > 0 || r->holds_blocking > 0;
  return CLOTH_OK;
}

void tool_blocking_print(const tool_blocking *b, const cloth_scene *scene)
{
  if (b->steps == 0) return;
  printf("no room           in %" PRId64 " steps, between", b->steps);
  for (int i = 0; b->body && i < cloth_body_count(scene); i++)
    if (b->body[i]) printf(" %s", cloth_body_name(scene, i));
  for (int i = 0; i < b->holds; i++)
    printf(" %s/%s", cloth_name(scene, b->hold[i].cloth),
           b->hold[i].group ? b->hold[i].group : "(a grasp)");
  printf("\n");
}

void tool_blocking_free(tool_blocking *b) { free(b->body), free(b->hold); }
