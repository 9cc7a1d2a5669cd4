// What a part holds of the mass-spring cloth: rows of springs and triangles for its own particles,
// bodies, and room for candidates. What the scene does not call for takes no memory.
#include "effect/effect.h"
#include "membrane_stretch.h"
#include "shape.h"
#include "spring_chunk.h"

#include <stdlib.h>
#include <string.h>

static bool is_mine(const cloth_part *p, int v) { return v >= p->v0 && v < p->v1; }

// counts [rows + 1] become the place where each row begins
static void begin_rows(uint32_t *first, int rows)
{
  uint32_t sum = 0;
  for (int r = 0; r <= rows; r++) {
    uint32_t here = first[r];
    first[r] = sum, sum += here;
  }
}

// ---- springs ------------------------------------------------------------------------------------

// fills rows: first [rows + 1], to [entries], law [entries x 3]; next [rows] is scratch
static void fill_springs(const cloth_springs *s, const cloth_part *p, const uint32_t *first,
                         uint32_t *next, int *to, double *law)
{
  memcpy(next, first, sizeof *next * (size_t)(p->v1 - p->v0));
  for (int i = 0; i < s->count; i++) {
    const cloth_spring *spring = &s->list[i];
    for (int end = 0; end < 2; end++) {
      int v = end ? spring->b : spring->a;
      if (!is_mine(p, v)) continue;
      uint32_t e = next[v - p->v0]++;
      to[e] = end ? spring->a : spring->b;
      law[3 * e] = spring->rest, law[3 * e + 1] = spring->stiffness;
      law[3 * e + 2] = spring->damping;
    }
  }
}

static cloth_status upload_springs(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  const cloth_springs *s = &sim->springs;
  int rows = p->v1 - p->v0;
  uint32_t *first = calloc(2 * ((size_t)rows + 1), sizeof *first);
  int *to = malloc(sizeof *to * (2 * (size_t)s->count + 1));
  double *law = malloc(sizeof *law * (6 * (size_t)s->count + 1));
  cloth_status status = CLOTH_NO_MEMORY;
  if (!first || !to || !law) {
    cloth_fail(err, status, __FILE__, __LINE__, "%d springs", s->count);
    goto done;
  }
  for (int i = 0; i < s->count; i++) {
    if (is_mine(p, s->list[i].a)) first[s->list[i].a - p->v0]++;
    if (is_mine(p, s->list[i].b)) first[s->list[i].b - p->v0]++;
  }
  begin_rows(first, rows);
  fill_springs(s, p, first, first + rows + 1, to, law);
  size_t entries = first[rows];
  CLOTH_TRY_GOTO(cloth_upload(sim, p, "spring_first", first, sizeof *first * ((size_t)rows + 1),
                              &p->spring.first, err),
                 status, done);
  CLOTH_TRY_GOTO(cloth_upload(sim, p, "spring_to", to, sizeof *to * entries, &p->spring.to, err),
                 status, done);
  CLOTH_TRY_GOTO(
      cloth_upload_real(sim, p, "spring_law", law, 3 * (int)entries, &p->spring.law, err), status,
      done);
done:
  free(first), free(to), free(law);
  return status;
}

// the worst stretch of a triangle, as the membrane reports it
static cloth_status upload_triangles(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  CLOTH_TRY(
      cloth_elements_select(p, sim->triangle_count, 3, sim->triangle, false, &p->membrane, err));
  size_t n = (size_t)p->membrane.count;
  double *rest = malloc(sizeof *rest * (5 * n + 1));
  if (rest == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%zu triangles", n);
  for (size_t i = 0; i < n; i++) cloth_rest_triangle(sim, p->membrane.which[i], rest + 5 * i);
  cloth_status status = cloth_upload_real(sim, p, "rest", rest, 5 * (int)n, &p->membrane_rest, err);
  free(rest);
  CLOTH_TRY(status);
  CLOTH_TRY(cloth_upload(sim, p, "triangle", p->membrane.host_vertex, sizeof(int) * 3 * n,
                         &p->membrane.vertex, err));
  free(p->membrane.host_vertex), free(p->membrane.which);
  p->membrane.host_vertex = p->membrane.which = NULL;
  CLOTH_TRY(cloth_take(sim, p, "stretch", sizeof(cloth_real) * n, &p->stretch, err));
  return cloth_take(sim, p, "stretch_largest",
                    sizeof(cloth_real) * (size_t)cloth_chunk_levels((int)n), &p->stretch_largest,
                    err);
}

// ---- air ----------------------------------------------------------------------------------------

static cloth_status upload_air(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  int rows = p->v1 - p->v0, corners = 3 * sim->triangle_count;
  uint32_t *first = calloc(2 * ((size_t)rows + 1), sizeof *first), *next;
  int *triangle = malloc(sizeof *triangle * (3 * (size_t)corners + 1));
  double *drag = malloc(sizeof *drag * (2 * (size_t)rows + 1));
  cloth_status status = CLOTH_NO_MEMORY;
  if (!first || !triangle || !drag) {
    cloth_fail(err, status, __FILE__, __LINE__, "air on %d triangles", sim->triangle_count);
    goto done;
  }
  for (int i = 0; i < corners; i++)
    if (is_mine(p, sim->triangle[i])) first[sim->triangle[i] - p->v0]++;
  begin_rows(first, rows);
  next = first + rows + 1;
  memcpy(next, first, sizeof *next * (size_t)rows);
  for (int i = 0; i < corners; i++)
    if (is_mine(p, sim->triangle[i]))
      memcpy(triangle + 3 * next[sim->triangle[i] - p->v0]++, sim->triangle + 3 * (i / 3),
             3 * sizeof *triangle);
  for (int r = 0; r < rows; r++) {
    const cloth_material *m = &sim->def->cloth[cloth_of_vertex(sim, p->v0 + r)].material;
    drag[2 * r] = m->drag, drag[2 * r + 1] = m->skin_drag;
  }
  CLOTH_TRY_GOTO(cloth_upload(sim, p, "air_first", first, sizeof *first * ((size_t)rows + 1),
                              &p->spring.air_first, err),
                 status, done);
  CLOTH_TRY_GOTO(cloth_upload(sim, p, "air_triangle", triangle, sizeof(int) * 3 * first[rows],
                              &p->spring.air_triangle, err),
                 status, done);
  CLOTH_TRY_GOTO(cloth_upload_real(sim, p, "air_drag", drag, 2 * rows, &p->spring.air_drag, err),
                 status, done);
done:
  free(first), free(triangle), free(drag);
  return status;
}

// ---- bodies -------------------------------------------------------------------------------------

static int kind_of(const cloth_body_def *b, double size[3])
{
  for (int k = 0; k < 3; k++) size[k] = b->size[k];
  if (b->shape == CLOTH_SHAPE_SPHERE) return CLOTH_SHAPE_KIND_SPHERE;
  if (b->shape == CLOTH_SHAPE_BOX) {
    for (int k = 0; k < 3; k++) size[k] /= 2;
    return CLOTH_SHAPE_KIND_BOX;
  }
  if (b->shape == CLOTH_SHAPE_PLANE) return CLOTH_SHAPE_KIND_HALF_SPACE;
  size[1] /= 2;
  return CLOTH_SHAPE_KIND_CYLINDER;
}

static cloth_status upload_bodies(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  int n = sim->def->body_count;
  int *kind = malloc(sizeof *kind * (size_t)n);
  double *size = malloc(sizeof *size * 4 * (size_t)n), *friction = size + 3 * n;
  cloth_status status = CLOTH_NO_MEMORY;
  if (!kind || !size) {
    cloth_fail(err, status, __FILE__, __LINE__, "%d bodies", n);
    goto done;
  }
  for (int b = 0; b < n; b++) {
    kind[b] = kind_of(&sim->def->body[b], size + 3 * b);
    friction[b] = sim->active[CLOTH_EFFECT_friction] ? sim->def->body[b].friction : 0;
  }
  CLOTH_TRY_GOTO(cloth_upload(sim, p, "shape_kind", kind, sizeof *kind * (size_t)n,
                              &p->spring.shape_kind, err),
                 status, done);
  CLOTH_TRY_GOTO(cloth_upload_real(sim, p, "shape_size", size, 3 * n, &p->spring.shape_size, err),
                 status, done);
  CLOTH_TRY_GOTO(
      cloth_upload_real(sim, p, "shape_friction", friction, n, &p->spring.shape_friction, err),
      status, done);
done:
  free(kind), free(size);
  return status;
}

// ---- all of it ----------------------------------------------------------------------------------

// one after the other for the effect that asked for it, so that it can be charged
cloth_status cloth_springs_upload(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  bool self = sim->active[CLOTH_EFFECT_self_contact], body = sim->active[CLOTH_EFFECT_body_contact];
  size_t n = (size_t)sim->vertex_count;
  CLOTH_TRY(cloth_take(sim, p, "sums",
                       sizeof(uint32_t) * CLOTH_SPRING_HEAD +
                           sizeof(cloth_real) * CLOTH_SPRING_FIELDS * (size_t)sim->chunks,
                       &p->spring.sums, err));
  p->spring.chunk = (cloth_real *)(void *)(p->spring.sums + CLOTH_SPRING_HEAD);
  sim->owner = CLOTH_EFFECT_springs;
  if (sim->active[CLOTH_EFFECT_springs]) {
    CLOTH_TRY(upload_springs(sim, p, err));
    CLOTH_TRY(upload_triangles(sim, p, err));
  }
  sim->owner = CLOTH_EFFECT_damping;
  if (sim->active[CLOTH_EFFECT_damping])
    CLOTH_TRY(cloth_effects[CLOTH_EFFECT_damping]->upload(sim, p, err));
  sim->owner = CLOTH_EFFECT_air;
  if (sim->active[CLOTH_EFFECT_air]) CLOTH_TRY(upload_air(sim, p, err));
  sim->owner = CLOTH_EFFECT_body_contact;
  if (body) CLOTH_TRY(upload_bodies(sim, p, err));
  sim->owner = cloth_contact_owner(sim);
  if (self || body)
    CLOTH_TRY(cloth_take(sim, p, "touch", sizeof(uint32_t) * 2 * n, &p->spring.touch, err));
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}
