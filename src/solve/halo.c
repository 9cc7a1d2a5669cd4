// What parts read of each other in a solve: the mesh's share is known once and for all, that of the
// contacts changes with every system. A part knows itself who reads its rows, because it has every
// element and every contact that touches them.
#include "halo_chunk.h"
#include "halo_contact.h"
#include "halo_group.h"
#include "halo_order.h"
#include "pcg_part.h"
#include "state/sim.h"

#include <stdlib.h>

void cloth_cuts(const cloth_sim *sim, int *cut)
{
  for (int j = 0; j < sim->part_count; j++) cut[j] = sim->part[j].v0;
  cut[sim->part_count] = sim->vertex_count;
}

cloth_status cloth_halo_build(cloth_sim *sim, cloth_part *p, const int *first, const int *col,
                              cloth_error *err)
{
  if (!sim->joined) return CLOTH_OK;
  int rows = p->v1 - p->v0, chunks = cloth_part_chunks(p), cut[CLOTH_HALO_PARTS + 1];
  size_t bytes = sizeof(uint32_t) * (size_t)rows;
  uint32_t *reader = calloc((size_t)rows + 1, sizeof *reader);
  if (reader == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "halo: %d rows", rows);
  cloth_cuts(sim, cut);
  for (int row = 0; row < rows; row++)
    for (int s = first[row]; s < first[row + 1]; s++) {
      int j = cloth_part_of(cut, sim->part_count, col[s]);
      if (j != p->index) reader[row] |= 1u << j;
    }
  cloth_status status = cloth_upload(sim, p, "halo_mesh", reader, bytes, &p->reader_mesh, err);
  free(reader);
  CLOTH_TRY(status);
  size_t list = sizeof(uint32_t) * ((size_t)chunks + 1);
  CLOTH_TRY(cloth_take(sim, p, "halo_reader", bytes, &p->reader, err));
  CLOTH_TRY(cloth_take(sim, p, "halo_chunk", list, &p->chunk_reader, err));
  CLOTH_TRY(cloth_take(sim, p, "halo_place", list, &p->halo_place, err));
  CLOTH_TRY(cloth_take(sim, p, "halo_order", list, &p->halo_order, err));
  CLOTH_TRY(cloth_take(sim, p, "halo_outer", 2 * sizeof(uint32_t), &p->halo_outer, err));
  return cloth_take(sim, p, "flag", sizeof(int) * CLOTH_FLAG_WORDS, &p->flag, err);
}

static cloth_status update_part(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  int rows = p->v1 - p->v0, chunks = cloth_part_chunks(p);
  CLOTH_TRY(be->fill(p->device, p->halo_outer, 0, 2 * sizeof(uint32_t), err));
  CLOTH_TRY(
      cloth_copy_local(sim, p, p->reader, p->reader_mesh, sizeof(uint32_t) * (size_t)rows, err));
  cloth_halo_contact_args c = {.parts = sim->part_count,
                               .me = p->index,
                               .vertex = p->contact_vertex,
                               .reader = p->reader,
                               .outer = p->halo_outer + 1};
  cloth_cuts(sim, c.cut);
  CLOTH_LAUNCH(sim, p, halo_contact, p->contact_count, &c, err);
  cloth_halo_chunk_args k = {rows, p->reader, p->chunk_reader};
  CLOTH_LAUNCH(sim, p, halo_chunk, chunks, &k, err);
  cloth_halo_group_args g = {chunks, cloth_chunk_group(sim->chunks), p->chunk_reader,
                             p->halo_place};
  CLOTH_LAUNCH(sim, p, halo_group, chunks, &g, err);
  if (chunks == 0) return CLOTH_OK;
  CLOTH_TRY(be->scan(p->device, chunks, p->halo_place, err));
  cloth_halo_order_args o = {chunks, p->halo_place, p->halo_order, p->halo_outer};
  return cloth_launch(sim, p, CLOTH_KERNEL_halo_order, chunks, &o, err);
}

cloth_status cloth_halo_update(cloth_sim *sim, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(update_part(sim, &sim->part[i], err));
  return CLOTH_OK;
}

cloth_status cloth_meet(cloth_sim *sim, cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  for (int i = 0; i < sim->part_count; i++)
    CLOTH_TRY(be->record(sim->part[i].device, CLOTH_COMPUTE, sim->part[i].ready, err));
  for (int i = 0; i < sim->part_count; i++)
    for (int j = 0; j < sim->part_count; j++)
      if (i != j) CLOTH_TRY(be->wait(sim->part[i].device, CLOTH_COMPUTE, sim->part[j].ready, err));
  return CLOTH_OK;
}
