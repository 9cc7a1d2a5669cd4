// `devices: mpi`: one part for each process that mpirun started. What joins them is in a library of
// its own, libcloth_mpi, which is loaded when a scene asks for it: who has no MPI loses nothing,
// and who has it pays for MPI and NCCL only then.
#pragma once

#include "transport.h"

/// What libcloth_mpi exports, as `cloth_mpi`.
typedef struct cloth_processes {
  // Joins the other processes; starts MPI unless it runs. The same transport every time.
  cloth_status (*join)(cloth_transport **out, cloth_error *err);

  // All processes are through. Returns the largest exit code of all. Where the first one that
  // failed is not process 0, it writes its message to file descriptor `fd`. One that failed, and
  // that the others do not follow within seconds, writes its message and ends them all: MPI_Abort.
  int (*leave)(int code, int fd, const char *message);
} cloth_processes;

/// The processes' transport. Blocks until all have joined. CLOTH_UNSUPPORTED: there is no
/// libcloth_mpi.
cloth_status cloth_processes_join(cloth_transport **out, cloth_error *err);

/// See leave(); `code` where no transport was ever asked for. The last call of a program.
int cloth_processes_leave(int code, int fd, const char *message);
