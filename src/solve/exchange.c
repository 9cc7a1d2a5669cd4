// Vertex vectors travel between parts: each part sends what it owns to all others (P-Cloth
// section 3.1, whole sub-vectors). Copies run on COPY queues; events order them against COMPUTE, so
// that nothing is overwritten while somebody still reads it.
#include "chunk.h"
#include "state/sim.h"

#include <string.h>

static char *field_of(cloth_part *part, size_t field)
{
  char *data;
  memcpy(&data, (char *)part + field, sizeof data);
  return data;
}

// a part's own rows: [begin, end)
static size_t begin_of(const cloth_sim *sim, int vertex, cloth_rows_of rows)
{
  int chunk = (vertex + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
  if (rows == CLOTH_PER_VERTEX) return (size_t)vertex;
  if (rows == CLOTH_PER_CHUNK) return (size_t)chunk;
  return (size_t)((int64_t)chunk * sim->aggregates / sim->chunks);
}

cloth_status cloth_exchange(cloth_sim *sim, size_t field, cloth_rows_of rows, size_t row,
                            cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  if (sim->part_count == 1) return CLOTH_OK;

  // ready: all that was queued before is done, both computing one's own rows and reading the
  // others'
  for (int i = 0; i < sim->part_count; i++)
    CLOTH_TRY(be->record(sim->part[i].device, CLOTH_COMPUTE, sim->part[i].ready, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *from = &sim->part[i];
    size_t begin = begin_of(sim, from->v0, rows) * row, end = begin_of(sim, from->v1, rows) * row;
    if (rows == CLOTH_PER_NODE)
      begin = (size_t)from->hat_share.begin * row, end = (size_t)from->hat_share.end * row;
    CLOTH_TRY(be->wait(from->device, CLOTH_COPY, from->ready, err));
    for (int j = 0; j < sim->part_count && end > begin; j++) {
      cloth_part *to = &sim->part[j];
      if (j == i) continue;
      CLOTH_TRY(be->wait(from->device, CLOTH_COPY, to->ready, err));
      CLOTH_TRY(be->copy(from->device, to->device, field_of(to, field) + begin,
                         field_of(from, field) + begin, end - begin, err));
    }
    CLOTH_TRY(be->record(from->device, CLOTH_COPY, from->sent, err));
  }
  // go on when the others' rows have come and one's own have left
  for (int i = 0; i < sim->part_count; i++)
    for (int j = 0; j < sim->part_count; j++)
      CLOTH_TRY(be->wait(sim->part[i].device, CLOTH_COMPUTE, sim->part[j].sent, err));
  return CLOTH_OK;
}

cloth_status cloth_copy_local(cloth_sim *sim, cloth_part *part, void *dst, const void *src,
                              size_t bytes, cloth_error *err)
{
  return sim->backend->move(part->device, dst, src, bytes, err);
}
