// Ranges of NVTX, in a domain of their own. Its header loads whatever profiler the environment
// names, once; without one a call is a branch.
#include "device.h"

#include <nvtx3/nvToolsExt.h>

namespace {

nvtxDomainHandle_t domain(void)
{
  static nvtxDomainHandle_t handle = nvtxDomainCreateA("robot_cloth");
  return handle;
}

} // namespace

void cloth_cuda_range_begin(const char *name)
{
  nvtxEventAttributes_t a = {};
  a.version = NVTX_VERSION, a.size = NVTX_EVENT_ATTRIB_STRUCT_SIZE;
  a.messageType = NVTX_MESSAGE_TYPE_ASCII, a.message.ascii = name;
  nvtxDomainRangePushEx(domain(), &a);
}

void cloth_cuda_range_end(void) { nvtxDomainRangePop(domain()); }
