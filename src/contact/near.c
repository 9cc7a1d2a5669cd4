#include "contact/near.h"

#include <stdlib.h>
#include <string.h>

int cloth_near_next(const cloth_sim *sim, int b)
{
  while (b < sim->def->body_count && !sim->body[b].near) b++;
  return b;
}

int cloth_near_run(const cloth_sim *sim, int b, bool triangles, int *first, int *count)
{
  int bodies = sim->def->body_count;
  *first = 0, *count = triangles ? sim->triangle_count : sim->vertex_count;
  if (b >= 0) *first = triangles ? sim->body[b].triangle_first : sim->body[b].vertex_first;
  if (b >= 0) *count = triangles ? sim->body[b].triangle_count : sim->body[b].vertex_count;
  for (b++; b < bodies; b++) {
    const cloth_body *next = &sim->body[b];
    if (!next->near) continue;
    if ((triangles ? next->triangle_first : next->vertex_first) != *first + *count) break;
    *count += triangles ? next->triangle_count : next->vertex_count;
  }
  return b;
}

static int count_near_triangles(const cloth_sim *sim)
{
  int n = 0;
  for (int b = 0; b < sim->def->body_count; b++)
    n += sim->body[b].near ? sim->body[b].triangle_count : 0;
  return n;
}

// written only where other bodies are near than the last time
cloth_status cloth_near_list(cloth_sim *sim, cloth_part *p, int *count, cloth_error *err)
{
  int n = *count = count_near_triangles(sim);
  if (n == 0) return CLOTH_OK;
  CLOTH_TRY(cloth_staging(sim, (size_t)n, err)); // an int is no larger than a cloth_real
  int *list = (int *)(void *)sim->host, k = 0;
  for (int b = 0; b < sim->def->body_count; b++)
    for (int t = 0; sim->body[b].near && t < sim->body[b].triangle_count; t++)
      list[k++] = sim->body[b].triangle_first + t;
  size_t bytes = sizeof *list * (size_t)n;
  if (n == p->body_listed_count && memcmp(list, p->body_listed, bytes) == 0) return CLOTH_OK;
  int *listed = realloc(p->body_listed, bytes);
  if (listed == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d triangles of bodies", n);
  memcpy(listed, list, bytes);
  p->body_listed = listed, p->body_listed_count = n;
  return sim->backend->write(p->device, p->body_triangle, list, bytes, err);
}
