// What a profiler is to NVTX: a library that the environment names. It writes down which ranges of
// which domain were opened and closed.
#include <nvtx3/nvToolsExt.h>
#include <stdio.h>
#include <string.h>

static char text[1000];

static void heard(const char *what, const char *name)
{
  size_t n = strlen(text);
  snprintf(text + n, sizeof text - n, "%s%s", what, name);
}

static nvtxDomainHandle_t domain(const char *name)
{
  heard("domain ", name);
  return (nvtxDomainHandle_t)text; // any handle that is not NULL
}

static int push(nvtxDomainHandle_t d, const nvtxEventAttributes_t *a)
{
  heard(d == (nvtxDomainHandle_t)text ? " >" : " elsewhere>", a->message.ascii);
  return 0;
}

static int pop(nvtxDomainHandle_t d)
{
  heard(d == (nvtxDomainHandle_t)text ? " <" : " elsewhere<", "");
  return 0;
}

const char *nvtx_heard(void);
const char *nvtx_heard(void) { return text; }

int InitializeInjectionNvtx2(NvtxGetExportTableFunc_t get);
int InitializeInjectionNvtx2(NvtxGetExportTableFunc_t get)
{
  const NvtxExportTableCallbacks *callbacks = get(NVTX_ETID_CALLBACKS);
  NvtxFunctionTable table = NULL;
  unsigned size = 0;
  if (!callbacks->GetModuleFunctionTable(NVTX_CB_MODULE_CORE2, &table, &size)) return 0;
  *table[NVTX_CBID_CORE2_DomainCreateA] = (NvtxFunctionPointer)domain;
  *table[NVTX_CBID_CORE2_DomainRangePushEx] = (NvtxFunctionPointer)push;
  *table[NVTX_CBID_CORE2_DomainRangePop] = (NvtxFunctionPointer)pop;
  return 1;
}
