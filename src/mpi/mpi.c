// libcloth_mpi: processes joined by MPI. Host bytes travel by MPI, device rows by NCCL where each
// process has a GPU of its own (nccl.c), otherwise by MPI too: from memory on CPUs, through the
// host's memory on GPUs.
#define _GNU_SOURCE // dprintf, nanosleep
#include "mpi/join.h"
#include "processes.h"

#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PIECE = 1 << 30, PATIENCE_MS = 5000 };

static MPI_Comm world, last;  // for work; to meet at the end, whatever was going on
static bool started;          // MPI by us
static unsigned char *staged; // a whole vector of a GPU
static size_t staged_bytes;

static bool alone; // this process has given up while the others go on

void cloth_mpi_alone(void) { alone = true; }

static cloth_status fail_alone(cloth_error *err)
{
  CLOTH_FAIL(err, CLOTH_DEVICE_LOST, "this process cannot go on with the others");
}

// ---- host bytes ---------------------------------------------------------------------------------

static cloth_status share(const cloth_transport *t, int from, void *host, size_t bytes,
                          cloth_error *err)
{
  (void)t;
  if (alone) return fail_alone(err);
  // MPI ends all processes by itself when it cannot go on
  for (size_t at = 0; at < bytes; at += PIECE) {
    size_t n = bytes - at < PIECE ? bytes - at : PIECE;
    MPI_Bcast((char *)host + at, (int)n, MPI_BYTE, from, world);
  }
  return CLOTH_OK;
}

static cloth_status agree(const cloth_transport *t, cloth_status mine, cloth_error *err)
{
  static char file[128]; // an error points to it
  if (alone) return mine == CLOTH_OK ? fail_alone(err) : mine;
  cloth_error theirs = {.status = mine};
  int first = mine == CLOTH_OK ? t->ranks : t->rank;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, world);
  if (first == t->ranks) return CLOTH_OK;
  if (first == t->rank && err != NULL) theirs = *err;
  char name[sizeof file] = "";
  if (theirs.file != NULL) snprintf(name, sizeof name, "%s", theirs.file);
  MPI_Bcast(&theirs, (int)sizeof theirs, MPI_BYTE, first, world);
  MPI_Bcast(name, (int)sizeof name, MPI_BYTE, first, world);
  memcpy(file, name, sizeof file);
  if (first == t->rank) return mine;
  if (err != NULL) *err = (cloth_error){0}; // theirs came first
  return cloth_fail(err, theirs.status, file, theirs.line, "%s", theirs.text);
}

// ---- rows ---------------------------------------------------------------------------------------

// rows of all parts in one array of the host
static void gather(int parts, const cloth_span *span, size_t row, void *data)
{
  int count[CLOTH_SPREAD_MAX], begin[CLOTH_SPREAD_MAX];
  MPI_Datatype type;
  for (int i = 0; i < parts; i++)
    count[i] = (int)(span[i].end - span[i].begin), begin[i] = (int)span[i].begin;
  MPI_Type_contiguous((int)row, MPI_BYTE, &type); // counts are int: rows fit where bytes may not
  MPI_Type_commit(&type);
  MPI_Allgatherv(MPI_IN_PLACE, 0, type, data, count, begin, type, world);
  MPI_Type_free(&type);
}

static cloth_status stage(size_t bytes, cloth_error *err)
{
  if (staged_bytes >= bytes) return CLOTH_OK;
  unsigned char *more = realloc(staged, bytes);
  if (more == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "exchange: %zu bytes of the host", bytes);
  staged = more, staged_bytes = bytes;
  return CLOTH_OK;
}

// from a GPU through the host's memory
static cloth_status exchange_staged(const cloth_spread_device *d, int parts, const cloth_span *span,
                                    size_t row, cloth_error *err)
{
  const cloth_span *own = &span[d->rank];
  size_t most = 0;
  for (int i = 0; i < parts; i++) most = span[i].end * row > most ? span[i].end * row : most;
  CLOTH_TRY(stage(most, err));
  size_t begin = own->begin * row, bytes = (own->end - own->begin) * row;
  cloth_status status = d->failed; // the others gather all the same
  if (status == CLOTH_OK && bytes > 0)
    status = d->inner->read(d->here, staged + begin, own->data + begin, bytes, err);
  gather(parts, span, row, staged);
  for (int i = 0; i < parts && status == CLOTH_OK; i++) {
    size_t at = span[i].begin * row, n = (span[i].end - span[i].begin) * row;
    if (i != d->rank && n > 0)
      status = d->inner->write(d->here, own->data + at, staged + at, n, err);
  }
  return d->failed == CLOTH_OK ? status : CLOTH_OK; // an older error shows at the next read
}

static cloth_status exchange(const cloth_transport *t, const cloth_backend *be, int parts,
                             const cloth_span *span, size_t row, cloth_error *err)
{
  (void)be;
  const cloth_spread_device *d = (const cloth_spread_device *)(const void *)span[t->rank].device;
  if (d->inner->stream != NULL) return exchange_staged(d, parts, span, row, err);
  gather(parts, span, row, span[t->rank].data);
  return CLOTH_OK;
}

// ---- beginning and end --------------------------------------------------------------------------

static cloth_status connect(cloth_transport *t, const cloth_backend *be, cloth_device *here,
                            cloth_error *err)
{
  t->name = "mpi", t->why[0] = '\0', t->exchange = exchange;
  return be->stream != NULL ? cloth_nccl_connect(t, be, here, err) : CLOTH_OK;
}

static cloth_transport transport = {
    .name = "mpi", .connect = connect, .exchange = exchange, .share = share, .agree = agree};

static cloth_status join(cloth_transport **out, cloth_error *err)
{
  int running = 0, level;
  *out = &transport;
  if (transport.ranks > 0) return CLOTH_OK;
  MPI_Initialized(&running);
  if (!running && MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS)
    CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "devices = 'mpi': MPI does not start");
  started = !running;
  MPI_Comm host;
  MPI_Comm_dup(MPI_COMM_WORLD, &world);
  MPI_Comm_dup(MPI_COMM_WORLD, &last);
  MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &host);
  MPI_Comm_rank(host, &transport.rank_on_host);
  MPI_Comm_free(&host);
  MPI_Comm_rank(world, &transport.rank);
  MPI_Comm_size(world, &transport.ranks);
  return CLOTH_OK;
}

// everybody at the end? A process that failed does not wait for ever.
static bool meet(bool patient)
{
  MPI_Request request;
  MPI_Ibarrier(last, &request);
  for (int ms = 0;; ms++) {
    int done;
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done) return true;
    if (!patient && ms >= PATIENCE_MS) return false;
    nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
  }
}

static void say(int fd, const char *message)
{
  if (message != NULL && message[0] != '\0') dprintf(fd, "%s\n", message);
}

static int leave(int code, int fd, const char *message)
{
  if (transport.ranks == 0) return code;
  if (!meet(code == 0)) {
    say(fd, message);
    MPI_Abort(MPI_COMM_WORLD, code);
  }
  int first = code != 0 ? transport.rank : transport.ranks;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, last);
  MPI_Allreduce(MPI_IN_PLACE, &code, 1, MPI_INT, MPI_MAX, last);
  if (first > 0 && first == transport.rank) say(fd, message); // process 0 has said its own
  cloth_nccl_leave();
  free(staged), staged = NULL, staged_bytes = 0;
  MPI_Comm_free(&world);
  MPI_Comm_free(&last);
  transport.ranks = 0;
  if (started) MPI_Finalize();
  return code;
}

__attribute__((visibility("default")))
const cloth_processes cloth_mpi = {.join = join, .leave = leave};
