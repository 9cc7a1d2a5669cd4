// Rows between GPUs by NCCL, on the stream that computes: so they wait for what computed them, and
// what reads them waits for them, without the host. In place, each part's rows from its process to
// all (the form of an all-gather of unequal shares that NCCL's manual gives).
#define _GNU_SOURCE // gethostname
#include "mpi/join.h"

#include <cuda_runtime_api.h>
#include <nccl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { GPU_NAME = 96 };

static ncclComm_t communicator;

static cloth_status fail(const char *what, const char *why, cloth_error *err)
{
  if (communicator != NULL) ncclCommAbort(communicator); // what waits on the GPU for others ends
  communicator = NULL;
  CLOTH_FAIL(err, CLOTH_DEVICE_LOST, "NCCL, %s: %s", what, why);
}

static cloth_status exchange(const cloth_transport *t, const cloth_backend *be, int parts,
                             const cloth_span *span, size_t row, cloth_error *err)
{
  (void)be;
  const cloth_spread_device *d = (const cloth_spread_device *)(const void *)span[t->rank].device;
  int ordinal;
  cudaStream_t stream = d->inner->stream(d->here, &ordinal);
  char *data = span[t->rank].data;
  // the others wait for it on their GPUs: it cannot go on as if
  if (d->failed != CLOTH_OK) {
    cloth_mpi_alone();
    return fail("this process's device", d->why.text, err);
  }
  ncclResult_t result = ncclGroupStart();
  for (int i = 0; i < parts && result == ncclSuccess; i++) {
    size_t at = span[i].begin * row, bytes = (span[i].end - span[i].begin) * row;
    if (bytes > 0)
      result = ncclBroadcast(data + at, data + at, bytes, ncclChar, i, communicator, stream);
  }
  ncclResult_t end = ncclGroupEnd();
  if (result == ncclSuccess) result = end;
  if (result == ncclSuccess) return CLOTH_OK;
  cloth_mpi_alone();
  return fail("exchange", ncclGetErrorString(result), err);
}

// this process's GPU as no other is called
static cudaError_t name_gpu(int ordinal, char name[GPU_NAME])
{
  char host[64] = "";
  gethostname(host, sizeof host - 1);
  int n = snprintf(name, GPU_NAME, "%s ", host);
  return cudaDeviceGetPCIBusId(name + n, GPU_NAME - n, ordinal);
}

// does every process have a GPU of its own? NCCL refuses two on one.
static cloth_status each_its_own(const cloth_transport *t, int ordinal, bool *out, cloth_error *err)
{
  char name[CLOTH_SPREAD_MAX][GPU_NAME] = {{0}};
  cudaError_t e = name_gpu(ordinal, name[t->rank]);
  cloth_status mine = e == cudaSuccess
                          ? CLOTH_OK
                          : cloth_fail(err, CLOTH_DEVICE_LOST, __FILE__, __LINE__,
                                       "GPU of process %d: %s", t->rank, cudaGetErrorString(e));
  CLOTH_TRY(t->agree(t, mine, err));
  *out = true;
  for (int i = 0; i < t->ranks; i++) {
    CLOTH_TRY(t->share(t, i, name[i], GPU_NAME, err));
    for (int j = 0; j < i; j++) *out = *out && strcmp(name[i], name[j]) != 0;
  }
  return CLOTH_OK;
}

static cloth_status start(const cloth_transport *t, int ordinal, cloth_error *err)
{
  ncclUniqueId id = {{0}};
  ncclResult_t result = t->rank == 0 ? ncclGetUniqueId(&id) : ncclSuccess;
  CLOTH_TRY(t->share(t, 0, &id, sizeof id, err));
  if (result == ncclSuccess && cudaSetDevice(ordinal) == cudaSuccess)
    result = ncclCommInitRank(&communicator, t->ranks, id, t->rank);
  return result == ncclSuccess && communicator != NULL
             ? CLOTH_OK
             : fail("start", ncclGetErrorString(result), err);
}

cloth_status cloth_nccl_connect(cloth_transport *t, const cloth_backend *be, cloth_device *here,
                                cloth_error *err)
{
  int ordinal;
  bool own;
  be->stream(here, &ordinal);
  CLOTH_TRY(each_its_own(t, ordinal, &own, err));
  if (!own) {
    snprintf(t->why, sizeof t->why, "through the host's memory, as processes share a GPU");
    return CLOTH_OK;
  }
  if (communicator == NULL) {
    cloth_status mine = start(t, ordinal, err);
    CLOTH_TRY(t->agree(t, mine, err));
  }
  t->name = "nccl", t->exchange = exchange;
  return CLOTH_OK;
}

void cloth_nccl_leave(void)
{
  if (communicator != NULL) ncclCommDestroy(communicator);
  communicator = NULL;
}
