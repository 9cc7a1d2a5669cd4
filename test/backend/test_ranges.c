// Ranges reach whoever listens to NVTX, in the project's domain, nested as they were opened. Needs
// no GPU, but a build with CUDA.
#include "backend.h"
#include "check.h"

#include <dlfcn.h>

#ifndef NVTX_LISTENER
#define NVTX_LISTENER ""
#endif

static int ranges_reach_a_profiler(void)
{
  const cloth_backend *cuda = cloth_backend_cuda();
  CHECK(setenv("NVTX_INJECTION64_PATH", NVTX_LISTENER, 1) == 0);
  cuda->range_begin("step"), cuda->range_begin("solve");
  cuda->range_end(), cuda->range_end();
  void *listener = dlopen(NVTX_LISTENER, RTLD_NOW), *symbol;
  CHECK(listener != NULL);
  symbol = dlsym(listener, "nvtx_heard");
  CHECK(symbol != NULL);
  const char *(*nvtx_heard)(void);
  memcpy(&nvtx_heard, &symbol, sizeof symbol);
  printf("  %s\n", nvtx_heard());
  CHECK(strcmp(nvtx_heard(), "domain robot_cloth >step >solve < <") == 0);
  dlclose(listener);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  if (cloth_backend_cuda() == NULL)
    printf("skip ranges_reach_a_profiler: built without CUDA\n");
  else
    RUN(ranges_reach_a_profiler);
  return failures > 0;
}
