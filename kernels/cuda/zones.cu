// Impact zones, a block for each: its threads close the constraints of one colour side by side, the
// colours one after the other.
#include "launch.h"
#include "zone_solve.h"

namespace {

enum { THREADS = 128, WARP = 32, LAST = CLOTH_ZONE_COLOURS - 1 };

// largest over the block, on every thread
__device__ cloth_real largest(cloth_real v, cloth_real *shared)
{
  for (int width = WARP / 2; width > 0; width /= 2) {
    cloth_real other = __shfl_xor_sync(0xffffffffu, v, width);
    if (other > v) v = other;
  }
  if (threadIdx.x % WARP == 0) shared[threadIdx.x / WARP] = v;
  __syncthreads();
  for (int w = 0; w < THREADS / WARP; w++)
    if (shared[w] > v) v = shared[w];
  __syncthreads(); // before it is written again
  return v;
}

// where each colour begins among the members of a zone; how many there are
__device__ int find_colours(const cloth_zone_solve_args &a, int first, int end, int *begin)
{
  for (int m = first + (int)threadIdx.x; m < end; m += THREADS)
    if (m == first || a.colour[m] != a.colour[m - 1]) begin[a.colour[m]] = m;
  int colours = end > first ? a.colour[end - 1] + 1 : 0; // the lowest free one was taken: no gaps
  if (threadIdx.x == 0) begin[colours] = end;
  __syncthreads();
  return colours;
}

__device__ cloth_real sweep_zone(const cloth_zone_solve_args &a, int colours, const int *begin)
{
  cloth_real worst = 0;
  for (int c = 0; c < colours; c++) {
    bool alone = c == LAST; // these may share vertices
    int step = alone ? 1 : THREADS;
    for (int m = begin[c] + (int)threadIdx.x; m < begin[c + 1]; m += step) {
      if (alone && threadIdx.x > 0) break;
      cloth_real open = cloth_zone_close(&a, m);
      if (open > worst) worst = open;
    }
    __syncthreads();
  }
  return worst;
}

__global__ void __launch_bounds__(THREADS)
    zone_kernel(const __grid_constant__ cloth_zone_solve_args a)
{
  __shared__ int begin[CLOTH_ZONE_COLOURS + 1];
  __shared__ cloth_real shared[THREADS / WARP];
  int z = a.zone[blockIdx.x], t = (int)threadIdx.x, first = a.first[z], end = a.first[z + 1];
  for (int k = a.moving_first[z] + t; k < a.moving_first[z + 1]; k += THREADS)
    cloth_v3_store(a.move, k, cloth_v3_make(0, 0, 0));
  for (int m = first + t; m < end; m += THREADS) cloth_zone_prepare(&a, m);
  int colours = find_colours(a, first, end, begin);
  cloth_real last = 0;
  for (int sweep = 0; sweep < CLOTH_ZONE_SWEEPS; sweep++) {
    cloth_real worst = largest(sweep_zone(a, colours, begin), shared);
    if (cloth_zone_done(sweep, worst, &last)) break;
  }
  for (int k = a.moving_first[z] + t; k < a.moving_first[z + 1]; k += THREADS)
    cloth_zone_place(&a, k);
}

} // namespace

cudaError_t cloth_cuda_zone_solve(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  zone_kernel<<<(unsigned)n, THREADS, 0, stream>>>(
      *static_cast<const cloth_zone_solve_args *>(args));
  return cudaGetLastError();
}
