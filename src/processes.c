#define _GNU_SOURCE // dlfcn.h beside strict C11
#include "processes.h"

#include <dlfcn.h>
#include <stddef.h>

static const cloth_processes *library;

static cloth_status load(cloth_error *err)
{
  // global: MPI loads parts of itself that look for it there
  void *handle = dlopen("libcloth_mpi.so", RTLD_NOW | RTLD_GLOBAL);
  if (handle == NULL)
    CLOTH_FAIL(err, CLOTH_UNSUPPORTED,
               "devices = 'mpi': this build has no MPI (cmake -DCLOTH_MPI=ON): %s", dlerror());
  library = dlsym(handle, "cloth_mpi");
  if (library == NULL) CLOTH_FAIL(err, CLOTH_UNSUPPORTED, "devices = 'mpi': %s", dlerror());
  return CLOTH_OK;
}

cloth_status cloth_processes_join(cloth_transport **out, cloth_error *err)
{
  if (library == NULL) CLOTH_TRY(load(err));
  return library->join(out, err);
}

int cloth_processes_leave(int code, int fd, const char *message)
{
  return library == NULL ? code : library->leave(code, fd, message);
}
