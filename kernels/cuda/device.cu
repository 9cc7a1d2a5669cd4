// The CUDA backend: devices, memory, copies, events. Plain device memory only; one stream for each
// queue. A CUDA error is a status, never the end of the process.
#include "block_rows.h"
#include "device.h"

#include <atomic>
#include <cstdlib>
#include <cstring>

namespace {

enum : size_t {
  PINNED_BYTES = 1 << 20, // for data; behind them lies the number of the last read
  FEW_BYTES = 1 << 13     // of a run that a kernel hands to the host
};
enum { POST_THREADS = 256, LOOKS = 1 << 14 };
static_assert(CLOTH_POSTS * FEW_BYTES <= PINNED_BYTES, "room for all runs");

const char *name_of(cudaError_t e) { return cudaGetErrorString(e); }

cloth_status status_of(cudaError_t e)
{
  switch (e) {
  case cudaErrorMemoryAllocation:
    return CLOTH_NO_MEMORY;
  case cudaErrorNoDevice:
  case cudaErrorInsufficientDriver:
  case cudaErrorInitializationError:
  case cudaErrorNoKernelImageForDevice:
  case cudaErrorUnsupportedPtxVersion:
  case cudaErrorInvalidDevice:
    return CLOTH_UNSUPPORTED;
  case cudaErrorInvalidValue:
  case cudaErrorInvalidConfiguration:
  case cudaErrorLaunchOutOfResources:
    return CLOTH_INTERNAL;
  default:
    return CLOTH_DEVICE_LOST; // an error of the device sticks: no later call can succeed
  }
}

int device_count(void)
{
  int n = 0;
  if (cudaGetDeviceCount(&n) != cudaSuccess) {
    cudaGetLastError();
    return 0;
  }
  return n;
}

void close_device(cloth_device *d)
{
  if (d == nullptr) return;
  cudaSetDevice(d->index);
  for (cudaStream_t &s : d->stream)
    if (s) cudaStreamDestroy(s);
  if (d->scratch) cudaFree(d->scratch);
  if (d->pinned) cudaFreeHost(d->pinned);
  cudaGetLastError();
  std::free(d);
}

// devices of one host that can reach each other's memory do; the driver copies through the host
// where they cannot
void enable_peers(int index)
{
  for (int other = 0; other < device_count(); other++) {
    int can = 0;
    if (other == index || cudaDeviceCanAccessPeer(&can, index, other) != cudaSuccess || !can)
      continue;
    cudaDeviceEnablePeerAccess(other, 0); // enabled before: not an error to us
  }
  cudaGetLastError();
}

cloth_status prepare(cloth_device *d, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  for (cudaStream_t &s : d->stream)
    CUDA_TRY(err, cudaStreamCreateWithFlags(&s, cudaStreamNonBlocking));
  CUDA_TRY(err, cudaMallocHost(&d->pinned, PINNED_BYTES + sizeof(unsigned)));
  std::memset(static_cast<char *>(d->pinned) + PINNED_BYTES, 0, sizeof(unsigned));
  int shared = 0;
  CUDA_TRY(err,
           cudaDeviceGetAttribute(&d->multiprocessors, cudaDevAttrMultiProcessorCount, d->index));
  CUDA_TRY(err, cudaDeviceGetAttribute(&shared, cudaDevAttrMaxSharedMemoryPerBlockOptin, d->index));
  d->shared_bytes = (size_t)shared;
  enable_peers(d->index);
  return CLOTH_OK;
}

cloth_status open_device(int index, int, cloth_device **out, cloth_error *err)
{
  *out = nullptr;
  auto *d = static_cast<cloth_device *>(std::calloc(1, sizeof(cloth_device)));
  if (d == nullptr) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "cuda device %d: host memory", index);
  d->index = index;
  cloth_status status = prepare(d, err);
  if (status != CLOTH_OK)
    close_device(d);
  else
    *out = d;
  return status;
}

// ---- memory -------------------------------------------------------------------------------------

cloth_status alloc(cloth_device *d, size_t bytes, void **out, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  cudaError_t e = cudaMalloc(out, bytes ? bytes : 1);
  if (e == cudaSuccess) return CLOTH_OK;
  size_t left = 0, all = 0;
  cudaGetLastError();
  if (e == cudaErrorMemoryAllocation && cudaMemGetInfo(&left, &all) == cudaSuccess)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "cuda device %d: %zu bytes wanted, %zu of %zu are left",
               d->index, bytes, left, all);
  return cloth_cuda_fail(e, "cudaMalloc", __FILE__, __LINE__, err);
}

void release(cloth_device *d, void *memory)
{
  cudaSetDevice(d->index);
  cudaFree(memory);
  cudaGetLastError();
}

cloth_status transfer(cloth_device *d, void *dst, const void *src, size_t bytes, bool to_host,
                      cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  cudaStream_t stream = d->stream[CLOTH_COMPUTE];
  auto *to = static_cast<char *>(dst);
  auto *from = static_cast<const char *>(src);
  for (size_t at = 0; at < bytes; at += PINNED_BYTES) {
    size_t n = bytes - at < PINNED_BYTES ? bytes - at : PINNED_BYTES;
    if (!to_host) std::memcpy(d->pinned, from + at, n);
    CUDA_TRY(err, cudaMemcpyAsync(to_host ? d->pinned : to + at, to_host ? from + at : d->pinned, n,
                                  cudaMemcpyDefault, stream));
    CUDA_TRY(err, cudaStreamSynchronize(stream));
    if (to_host) std::memcpy(to + at, d->pinned, n);
  }
  return CLOTH_OK;
}

cloth_status write_device(cloth_device *d, void *dst, const void *host, size_t bytes,
                          cloth_error *err)
{
  return transfer(d, dst, host, bytes, false, err);
}

// A few numbers go faster when a kernel writes them where the host looks: a copy would have to be
// started, and the host be told of its end.
struct posts {
  cloth_post run[CLOTH_POSTS];
};

__global__ void post_kernel(const __grid_constant__ posts p, int runs, uint32_t *to,
                            unsigned *posted, unsigned number)
{
  for (int r = 0; r < runs; to += p.run[r].words, r++)
    for (int k = (int)threadIdx.x; k < p.run[r].words; k += (int)blockDim.x)
      to[k] = p.run[r].from[k];
  __threadfence_system();
  __syncthreads();
  if (threadIdx.x == 0) *static_cast<volatile unsigned *>(posted) = number;
}

// all that is to be read
cloth_status read_few(cloth_device *d, cloth_error *err)
{
  posts p = {};
  int runs = d->posts;
  CUDA_TRY(err, cudaSetDevice(d->index));
  cudaStream_t stream = d->stream[CLOTH_COMPUTE];
  auto *posted = reinterpret_cast<unsigned *>(static_cast<char *>(d->pinned) + PINNED_BYTES);
  unsigned number = ++d->reads;
  std::memcpy(p.run, d->post, sizeof p.run);
  d->posts = 0; // also where it fails: nothing is left to a later read
  post_kernel<<<1, POST_THREADS, 0, stream>>>(p, runs, static_cast<uint32_t *>(d->pinned), posted,
                                              number);
  CUDA_TRY(err, cudaGetLastError());
  for (int look = 1; *static_cast<volatile unsigned *>(posted) != number; look++) {
    if (look % LOOKS > 0) continue; // now and then: is the device still there?
    cudaError_t e = cudaStreamQuery(stream);
    if (e != cudaSuccess && e != cudaErrorNotReady) CUDA_TRY(err, e);
  }
  std::atomic_thread_fence(std::memory_order_acquire);
  const char *from = static_cast<const char *>(d->pinned);
  for (int r = 0; r < runs; from += sizeof(uint32_t) * (size_t)p.run[r].words, r++)
    std::memcpy(p.run[r].host, from, sizeof(uint32_t) * (size_t)p.run[r].words);
  return CLOTH_OK;
}

// Put it on the list; false: it is not few words.
bool post(cloth_device *d, void *host, const void *src, size_t bytes)
{
  bool words = bytes % 4 == 0 && reinterpret_cast<uintptr_t>(src) % 4 == 0;
  if (bytes == 0 || bytes > FEW_BYTES || !words) return false;
  d->post[d->posts++] = {static_cast<const uint32_t *>(src), host, (int)(bytes / 4)};
  return true;
}

cloth_status read_device(cloth_device *d, void *host, const void *src, size_t bytes,
                         cloth_error *err)
{
  if (post(d, host, src, bytes)) return read_few(d, err);
  if (d->posts > 0) CLOTH_TRY(read_few(d, err));
  return transfer(d, host, src, bytes, true, err);
}

cloth_status read_with(cloth_device *d, void *host, const void *src, size_t bytes, cloth_error *err)
{
  if (d->posts < CLOTH_POSTS - 1 && post(d, host, src, bytes)) return CLOTH_OK;
  return read_device(d, host, src, bytes, err);
}

cloth_status copy(cloth_device *from, cloth_device *to, void *dst, const void *src, size_t bytes,
                  cloth_error *err)
{
  if (bytes == 0) return CLOTH_OK;
  cudaStream_t stream = from->stream[CLOTH_COPY];
  CUDA_TRY(err, cudaSetDevice(from->index));
  if (from->index == to->index)
    CUDA_TRY(err, cudaMemcpyAsync(dst, src, bytes, cudaMemcpyDeviceToDevice, stream));
  else
    CUDA_TRY(err, cudaMemcpyPeerAsync(dst, to->index, src, from->index, bytes, stream));
  return CLOTH_OK;
}

cloth_status move(cloth_device *d, void *dst, const void *src, size_t bytes, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  if (bytes > 0)
    CUDA_TRY(err,
             cudaMemcpyAsync(dst, src, bytes, cudaMemcpyDeviceToDevice, d->stream[CLOTH_COMPUTE]));
  return CLOTH_OK;
}

cloth_status fill(cloth_device *d, void *dst, int byte, size_t bytes, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  if (bytes > 0) CUDA_TRY(err, cudaMemsetAsync(dst, byte, bytes, d->stream[CLOTH_COMPUTE]));
  return CLOTH_OK;
}

// ---- order --------------------------------------------------------------------------------------

void event_free(cloth_event *e)
{
  if (e == nullptr) return;
  cudaSetDevice(e->device);
  if (e->event) cudaEventDestroy(e->event);
  cudaGetLastError();
  std::free(e);
}

cloth_status event_new(cloth_device *d, cloth_event **out, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  auto *e = static_cast<cloth_event *>(std::calloc(1, sizeof(cloth_event)));
  *out = e;
  if (e == nullptr) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "cuda device %d: event", d->index);
  e->device = d->index;
  CUDA_TRY(err, cudaEventCreate(&e->event));
  return CLOTH_OK;
}

cloth_status record(cloth_device *d, cloth_queue q, cloth_event *e, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  CUDA_TRY(err, cudaEventRecord(e->event, d->stream[q]));
  return CLOTH_OK;
}

cloth_status wait(cloth_device *d, cloth_queue q, const cloth_event *e, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  CUDA_TRY(err, cudaStreamWaitEvent(d->stream[q], e->event, 0));
  return CLOTH_OK;
}

cloth_status elapsed(const cloth_event *from, const cloth_event *to, double *ms, cloth_error *err)
{
  float time = 0;
  CUDA_TRY(err, cudaSetDevice(to->device));
  CUDA_TRY(err, cudaEventSynchronize(to->event));
  CUDA_TRY(err, cudaEventElapsedTime(&time, from->event, to->event));
  *ms = time;
  return CLOTH_OK;
}

void *stream_of(cloth_device *d, int *ordinal)
{
  *ordinal = d->index;
  return d->stream[CLOTH_COMPUTE];
}

cloth_status finish(cloth_device *d, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  for (cudaStream_t s : d->stream) CUDA_TRY(err, cudaStreamSynchronize(s));
  return CLOTH_OK;
}

} // namespace

cloth_status cloth_cuda_fail(cudaError_t e, const char *what, const char *file, int line,
                             cloth_error *err)
{
  cudaGetLastError(); // an error that does not stick is reported once
  return cloth_fail(err, status_of(e), file, line, "cuda: %s (%s)", name_of(e), what);
}

cloth_status cloth_cuda_scratch(cloth_device *d, size_t bytes, void **out, cloth_error *err)
{
  if (bytes > d->scratch_bytes) {
    CUDA_TRY(err, cudaSetDevice(d->index));
    CUDA_TRY(err, cudaStreamSynchronize(d->stream[CLOTH_COMPUTE]));
    if (d->scratch) CUDA_TRY(err, cudaFree(d->scratch));
    d->scratch = nullptr, d->scratch_bytes = 0;
    CLOTH_TRY(alloc(d, bytes + bytes / 2, &d->scratch, err));
    d->scratch_bytes = bytes + bytes / 2;
  }
  *out = d->scratch;
  return CLOTH_OK;
}

extern "C" const cloth_backend *cloth_backend_cuda(void)
{
  static const cloth_backend backend = [] {
    cloth_backend b = {};
    b.name = "cuda";
    b.row_group = CLOTH_ROW_GROUP, b.run_ahead = 8;
    b.device_count = device_count;
    b.open = open_device, b.close = close_device;
    b.alloc = alloc, b.release = release;
    b.write = write_device, b.read = read_device, b.read_with = read_with;
    b.copy = copy, b.move = move, b.fill = fill;
    b.solve = cloth_cuda_solve;
    b.joined = cloth_cuda_joined, b.solve_parts = cloth_cuda_solve_parts;
    b.spring_block = cloth_cuda_spring_block;
    b.launch = cloth_cuda_launch;
    b.sort = cloth_cuda_sort, b.scan = cloth_cuda_scan;
    b.event_new = event_new, b.event_free = event_free;
    b.record = record, b.wait = wait, b.elapsed = elapsed;
    b.range_begin = cloth_cuda_range_begin, b.range_end = cloth_cuda_range_end;
    b.finish = finish, b.stream = stream_of;
    return b;
  }();
  return &backend;
}
