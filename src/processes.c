#define _GNU_SOURCE // dlfcn.h beside strict C11
#include "processes.h"

#include <dlfcn.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const cloth_processes *library;

// beside this library, else where the system looks
static void *open_library(void)
{
  char path[4096];
  Dl_info here;
  if (dladdr(&library, &here) != 0 && here.dli_fname != NULL) {
    const char *end = strrchr(here.dli_fname, '/');
    int n = snprintf(path, sizeof path, "%.*slibcloth_mpi.so",
                     end ? (int)(end - here.dli_fname + 1) : 0, here.dli_fname);
    if (end != NULL && n < (int)sizeof path && access(path, F_OK) == 0)
      return dlopen(path, RTLD_NOW | RTLD_GLOBAL);
  }
  return dlopen("libcloth_mpi.so", RTLD_NOW | RTLD_GLOBAL);
}

static cloth_status load(cloth_error *err)
{
  void *handle = open_library(); // global: MPI loads parts of itself that look for it there
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
