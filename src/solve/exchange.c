// Vertex vectors travel between parts: each part sends what it owns to all others (P-Cloth
// section 3.1, whole sub-vectors), by the transport that joins them (transport.h).
#include "pcg.h"
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
  return (size_t)cloth_aggregate_from(chunk, sim->chunks, sim->aggregates);
}

cloth_status cloth_exchange(cloth_sim *sim, size_t field, cloth_rows_of rows, size_t row,
                            cloth_error *err)
{
  cloth_span span[CLOTH_DEVICES_MAX];
  if (sim->part_count == 1) return CLOTH_OK;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    span[i] = (cloth_span){p->device,
                           field_of(p, field),
                           begin_of(sim, p->v0, rows),
                           begin_of(sim, p->v1, rows),
                           p->ready,
                           p->sent};
    if (rows == CLOTH_PER_NODE)
      span[i].begin = (size_t)p->hat_share.begin, span[i].end = (size_t)p->hat_share.end;
  }
  return sim->transport->exchange(sim->transport, sim->backend, sim->part_count, span, row, err);
}

cloth_status cloth_copy_local(cloth_sim *sim, cloth_part *part, void *dst, const void *src,
                              size_t bytes, cloth_error *err)
{
  return sim->backend->move(part->device, dst, src, bytes, err);
}
