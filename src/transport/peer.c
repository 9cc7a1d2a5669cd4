// Devices that one process holds: copies run on COPY queues; events order them against COMPUTE, so
// that nothing is overwritten while somebody still reads it.
#include "transport.h"

static cloth_status send(const cloth_backend *be, int parts, const cloth_span *span, int i,
                         size_t row, cloth_error *err)
{
  const cloth_span *from = &span[i];
  size_t begin = from->begin * row, end = from->end * row;
  CLOTH_TRY(be->wait(from->device, CLOTH_COPY, from->ready, err));
  for (int j = 0; j < parts && end > begin; j++) {
    const cloth_span *to = &span[j];
    if (j == i) continue;
    CLOTH_TRY(be->wait(from->device, CLOTH_COPY, to->ready, err));
    CLOTH_TRY(
        be->copy(from->device, to->device, to->data + begin, from->data + begin, end - begin, err));
  }
  return be->record(from->device, CLOTH_COPY, from->sent, err);
}

static cloth_status exchange(const cloth_transport *transport, const cloth_backend *be, int parts,
                             const cloth_span *span, size_t row, cloth_error *err)
{
  (void)transport;
  // ready: all that was queued before is done, both computing one's own rows and reading the
  // others'
  for (int i = 0; i < parts; i++)
    CLOTH_TRY(be->record(span[i].device, CLOTH_COMPUTE, span[i].ready, err));
  for (int i = 0; i < parts; i++) CLOTH_TRY(send(be, parts, span, i, row, err));
  // go on when the others' rows have come and one's own have left
  for (int i = 0; i < parts; i++)
    for (int j = 0; j < parts; j++)
      CLOTH_TRY(be->wait(span[i].device, CLOTH_COMPUTE, span[j].sent, err));
  return CLOTH_OK;
}

static cloth_status share(const cloth_transport *transport, int from, void *host, size_t bytes,
                          cloth_error *err)
{
  (void)transport, (void)from, (void)host, (void)bytes, (void)err;
  return CLOTH_OK;
}

static cloth_status agree(const cloth_transport *transport, cloth_status mine, cloth_error *err)
{
  (void)transport, (void)err;
  return mine;
}

cloth_transport *cloth_transport_peer(void)
{
  static cloth_transport transport = {
      .name = "peer copy", .ranks = 1, .exchange = exchange, .share = share, .agree = agree};
  return &transport;
}
