// Pairs of triangles. The workload table by warps: 32 pair tests side by side; what meets is
// collected until a whole warp has something to emit. The list is in another order than a loop's,
// as it may be.
#include "launch.h"

namespace {

enum { WARP = 32, WARPS = 4, LARGE = 16 };

// emit what is collected, 32 at a time, with one atomic for all of them; with `rest`, all of it
__device__ int emit(const cloth_pair_mesh *m, const int2 *found, int count, bool rest)
{
  int lane = (int)threadIdx.x % WARP;
  __syncwarp();
  while (count >= WARP || (rest && count > 0)) {
    int take = count < WARP ? count : WARP;
    count -= take;
    int2 t = lane < take ? found[count + lane] : make_int2(0, 0);
    uint32_t bits = lane < take ? cloth_pair_bits(m, t.x, t.y) : 0, n = (uint32_t)__popc(bits),
             sum = n;
    for (int width = 1; width < WARP; width *= 2) {
      uint32_t before = __shfl_up_sync(0xffffffffu, sum, (unsigned)width);
      if (lane >= width) sum += before;
    }
    uint32_t first = 0;
    if (lane == WARP - 1 && sum > 0) first = atomicAdd(m->count, sum);
    first = __shfl_sync(0xffffffffu, first, WARP - 1);
    cloth_pair_write(m, t.x, t.y, bits, first + sum - n);
    __syncwarp();
  }
  return count;
}

__global__ void __launch_bounds__(WARP *WARPS)
    pair_share_kernel(int n, const __grid_constant__ cloth_pair_share_args a)
{
  __shared__ int2 all_found[WARPS][2 * WARP];
  int warp = (int)threadIdx.x / WARP, lane = (int)threadIdx.x % WARP;
  int share = (int)blockIdx.x * WARPS + warp, count = 0;
  int2 *found = all_found[warp];
  if (share >= n) return;
  uint32_t total = a.work[a.entries], begin = (uint32_t)share * CLOTH_SHARE;
  uint32_t end = begin + CLOTH_SHARE < total ? begin + CLOTH_SHARE : total;
  if (begin >= end) return;
  int e_first = cloth_work_find(a.work, a.entries, begin);
  int e_last = cloth_work_find(a.work, a.entries, end - 1);
  for (uint32_t base = begin; base < end; base += WARP) {
    uint32_t w = base + (uint32_t)lane;
    int hit = 0, ta = 0, tb = 0;
    if (w < end) {
      int e = e_first + cloth_work_find(a.work + e_first, e_last - e_first + 1, w);
      ta = (int)a.triangle[e];
      tb = (int)a.triangle[e + 1 + (int)(w - a.work[e])];
      hit = cloth_pair_meets(&a, e, ta, tb);
    }
    unsigned hits = __ballot_sync(0xffffffffu, hit);
    if (hit) found[count + __popc(hits & ((1u << lane) - 1))] = make_int2(ta, tb);
    count = emit(&a.mesh, found, count + __popc(hits), false);
  }
  emit(&a.mesh, found, count, true);
}

// a thread for each triangle of a chunk, against a few large ones
__global__ void __launch_bounds__(CLOTH_CHUNK)
    pair_large_kernel(int large, const __grid_constant__ cloth_pair_large_args a)
{
  __shared__ int2 all_found[CLOTH_CHUNK / WARP][2 * WARP];
  int chunk = (int)blockIdx.x % a.chunks, t = chunk * CLOTH_CHUNK + (int)threadIdx.x;
  int lane = (int)threadIdx.x % WARP, count = 0, begin = (int)blockIdx.x / a.chunks * LARGE;
  int end = begin + LARGE < large ? begin + LARGE : large;
  int2 *found = all_found[threadIdx.x / WARP];
  if (!cloth_pair_large_near(chunk, &a)) return;
  bool there = t < cloth_chunk_end(0, a.mesh.cloth_triangles, chunk);
  cloth_box box = cloth_box_load(a.mesh.box, there ? t : 0);
  for (int l = begin; l < end; l++) {
    int other = (int)a.large[l];
    bool hit = there && cloth_box_near(box, cloth_box_load(a.mesh.box, other),
                                       cloth_pair_gap(&a.mesh, t, other));
    unsigned hits = __ballot_sync(0xffffffffu, hit);
    if (hit) found[count + __popc(hits & ((1u << lane) - 1))] = make_int2(t, other);
    count = emit(&a.mesh, found, count + __popc(hits), false);
  }
  emit(&a.mesh, found, count, true);
}

} // namespace

cudaError_t cloth_cuda_pair_large(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  const auto *a = static_cast<const cloth_pair_large_args *>(args);
  int large = n / a->chunks;
  unsigned blocks = (unsigned)(large + LARGE - 1) / LARGE * (unsigned)a->chunks;
  pair_large_kernel<<<blocks, CLOTH_CHUNK, 0, stream>>>(large, *a);
  return cudaGetLastError();
}

cudaError_t cloth_cuda_pair_share(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  pair_share_kernel<<<(unsigned)(n + WARPS - 1) / WARPS, WARP * WARPS, 0, stream>>>(
      n, *static_cast<const cloth_pair_share_args *>(args));
  return cudaGetLastError();
}
