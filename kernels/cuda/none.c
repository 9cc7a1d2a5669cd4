// A build without CUDA.
#include "backend.h"

const cloth_backend *cloth_backend_cuda(void) { return NULL; }
