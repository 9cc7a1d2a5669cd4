// A build without NCCL: rows of GPUs travel through the host's memory.
#include "mpi/join.h"

#include <stdio.h>

cloth_status cloth_nccl_connect(cloth_transport *t, const cloth_backend *be, cloth_device *here,
                                cloth_error *err)
{
  (void)be, (void)here, (void)err;
  snprintf(t->why, sizeof t->why, "through the host's memory, as this build has no NCCL");
  return CLOTH_OK;
}

void cloth_nccl_leave(void) {}
