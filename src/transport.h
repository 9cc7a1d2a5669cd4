// How rows and numbers get from part to part: what the engine asks of whatever joins its devices.
// A table with one entry for devices that one process holds (peer copy) and one for a process per
// device, on one host or many (MPI for host bytes, and NCCL or MPI for device rows).
//
// Every process runs the same host program on the same scene, so every number that the host decides
// by must be the same in all of them: the host reads a part through share(), and an error of one
// process becomes everybody's through agree(). All processes call these in the same order.
#pragma once

#include "backend.h"

/// A part's own rows of a vector that every part holds whole.
typedef struct cloth_span {
  cloth_device *device;
  char *data;        // the whole vector on that device
  size_t begin, end; // its own rows
  cloth_event *ready, *sent;
} cloth_span;

typedef struct cloth_transport cloth_transport;

struct cloth_transport {
  const char *name; // "peer copy", "mpi", "nccl": how device rows travel
  char why[160];    // and why so, for people
  int rank, ranks;  // this process among all; 0, 1 with peer copy
  int rank_on_host; // among those of the same host

  // Every process has opened its device: choose how rows travel. Blocks. NULL: nothing to choose.
  cloth_status (*connect)(cloth_transport *transport, const cloth_backend *backend,
                          cloth_device *here, cloth_error *err);

  // Each part's own rows, of `row` bytes, go to all other parts. Comes after what was queued on
  // COMPUTE of every part and before what is queued there next.
  cloth_status (*exchange)(const cloth_transport *transport, const cloth_backend *backend,
                           int parts, const cloth_span *span, size_t row, cloth_error *err);

  // `bytes` of the host's memory of process `from` come to all. Blocks.
  cloth_status (*share)(const cloth_transport *transport, int from, void *host, size_t bytes,
                        cloth_error *err);

  // The first process that failed is how it went for all, with its message. Blocks.
  cloth_status (*agree)(const cloth_transport *transport, cloth_status mine, cloth_error *err);
};

/// Devices of one process: copies by their backend. There is one process, so nothing to share.
cloth_transport *cloth_transport_peer(void);
