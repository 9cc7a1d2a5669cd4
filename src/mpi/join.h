// What the files of libcloth_mpi share.
#pragma once

#include "transport/spread.h"

/// Rows by NCCL from now on, where every process has a GPU of its own; otherwise transport->why
/// says why not. Blocks.
cloth_status cloth_nccl_connect(cloth_transport *transport, const cloth_backend *backend,
                                cloth_device *here, cloth_error *err);

/// This process cannot go on with the others: what is shared or agreed on from now on fails at
/// once.
void cloth_mpi_alone(void);

/// The end of it, after all processes are through.
void cloth_nccl_leave(void);
