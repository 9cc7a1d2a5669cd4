#include "contact/ghosts.h"

#include "box_merge.h"
#include "chunk.h"
#include "chunk_near.h"
#include "effect/effect.h"

#include <stdlib.h>

enum { MARK_BITS_MIN = 10, MARK_BITS_MAX = 27, MARKS_EACH = 8 }; // cell_mark.h; for a triangle

static int chunks_of(int n) { return (n + CLOTH_CHUNK - 1) / CLOTH_CHUNK; }

// the chunks of vertices that a chunk of triangles has, each once; returns how many
static int list_chunk(const cloth_sim *sim, int chunk, int *seen, int *list)
{
  int n = 0, end = cloth_chunk_end(0, sim->triangle_count, chunk);
  for (int i = 3 * chunk * CLOTH_CHUNK; i < 3 * end; i++) {
    int of = sim->triangle[i] / CLOTH_CHUNK;
    if (seen[of] == chunk + 1) continue;
    seen[of] = chunk + 1;
    list[n++] = of;
  }
  return n;
}

static cloth_status take(cloth_sim *sim, cloth_part *p, const int *first, const int *list,
                         cloth_error *err)
{
  int chunks = chunks_of(sim->triangle_count);
  size_t n = sizeof(int);
  CLOTH_TRY(
      cloth_upload(sim, p, "ghost_first", first, n * ((size_t)chunks + 1), &p->ghost_first, err));
  CLOTH_TRY(
      cloth_upload(sim, p, "ghost_list", list, n * (size_t)first[chunks], &p->ghost_list, err));
  CLOTH_TRY(cloth_take(sim, p, "ghost_near", (size_t)chunks, &p->ghost_near, err));
  CLOTH_TRY(cloth_take(sim, p, "ghost_box", sizeof(cloth_real) * 6 * (size_t)sim->chunks,
                       &p->ghost_box, err));
  p->cell_mark_bits = MARK_BITS_MIN;
  while (p->cell_mark_bits < MARK_BITS_MAX &&
         (int64_t)1 << p->cell_mark_bits < MARKS_EACH * (int64_t)sim->triangle_count)
    p->cell_mark_bits++;
  return cloth_take(sim, p, "cell_mark", (size_t)1 << (p->cell_mark_bits - 3), &p->cell_mark, err);
}

cloth_status cloth_ghosts_build(cloth_sim *sim, cloth_error *err)
{
  bool self = sim->active[CLOTH_EFFECT_self_contact], body = sim->active[CLOTH_EFFECT_body_contact];
  if (sim->part_count == 1 || cloth_is_mass_spring(sim) || !(self || body)) return CLOTH_OK;
  int chunks = chunks_of(sim->triangle_count);
  int *first = malloc(sizeof *first * ((size_t)chunks + 1));
  int *list = malloc(sizeof *list * 3 * ((size_t)sim->triangle_count + 1)); // far more than enough
  int *seen = calloc((size_t)sim->chunks + 1, sizeof *seen);
  cloth_status status = CLOTH_OK;
  if (!first || !list || !seen) {
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "%d chunks", chunks);
    goto done;
  }
  first[0] = 0;
  for (int i = 0; i < chunks; i++)
    first[i + 1] = first[i] + list_chunk(sim, i, seen, list + first[i]);
  sim->owner = cloth_contact_owner(sim);
  for (int p = 0; p < sim->part_count && status == CLOTH_OK; p++)
    status = take(sim, &sim->part[p], first, list, err);
  sim->owner = CLOTH_CORE;
done:
  free(first), free(list), free(seen);
  return status;
}

cloth_cell_marks cloth_ghosts_marks(const cloth_part *p)
{
  return (cloth_cell_marks){p->cell_mark, p->cell_mark_bits};
}

cloth_status cloth_ghosts_find(cloth_sim *sim, cloth_part *p, const cloth_grid *grid, double gap,
                               cloth_error *err)
{
  if (p->cell_mark == NULL) return CLOTH_OK;
  cloth_cell_marks marks = cloth_ghosts_marks(p);
  CLOTH_TRY(sim->backend->fill(p->device, p->cell_mark, 0, (size_t)1 << (marks.bits - 3), err));
  cloth_cell_mark_args m = {*grid,       (cloth_real)gap, p->v0, p->v1,
                            p->triangle, p->vertex_box,   marks};
  CLOTH_LAUNCH(sim, p, cell_mark, sim->triangle_count, &m, err);
  cloth_box_merge_args b = {sim->vertex_count, p->vertex_box, p->ghost_box};
  CLOTH_LAUNCH(sim, p, box_merge, sim->chunks, &b, err);
  cloth_chunk_near_args n = {*grid,        (cloth_real)gap, p->ghost_first, p->ghost_list,
                             p->ghost_box, marks,           p->ghost_near};
  return cloth_launch(sim, p, CLOTH_KERNEL_chunk_near, chunks_of(sim->triangle_count), &n, err);
}
