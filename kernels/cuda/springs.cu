// A sub-step of the mass-spring cloth. A particle has some thirty springs, triangles and
// candidates, and a thread that takes one after the other mostly waits for its loads: eight
// neighbouring threads share them and add up what they found in the order of the list, so the bits
// are those of the plain kernel.
#include "launch.h"
#include "reduce.cuh"

namespace {

enum { THREADS = 128, LANES = 8, PARTICLES = THREADS / LANES };
const unsigned EVERYONE = 0xffffffffu;

// entry(first) + ... + entry(end - 1) on all lanes of a particle. All threads of a warp come here.
template <typename Entry>
__device__ cloth_v3 sum_in_order(uint32_t first, uint32_t end, Entry entry)
{
  cloth_v3 f = cloth_v3_make(0, 0, 0);
  for (uint32_t e = first + threadIdx.x % LANES; __any_sync(EVERYONE, first < end);
       first += LANES, e += LANES) {
    cloth_v3 mine = e < end ? entry(e) : cloth_v3_make(0, 0, 0);
    for (int l = 0; l < LANES; l++) // to add nothing changes nothing: the sum is never -0
      f = cloth_v3_add(f, cloth_v3_make(__shfl_sync(EVERYONE, mine.x, l, LANES),
                                        __shfl_sync(EVERYONE, mine.y, l, LANES),
                                        __shfl_sync(EVERYONE, mine.z, l, LANES)));
  }
  return f;
}

__device__ int sum_of_lanes(int n)
{
  for (int width = LANES / 2; width > 0; width /= 2)
    n += __shfl_down_sync(EVERYONE, n, (unsigned)width, LANES);
  return n;
}

__global__ void __launch_bounds__(THREADS)
    step_kernel(int n, const __grid_constant__ cloth_spring_step_args a)
{
  int row = (int)(blockIdx.x * PARTICLES + threadIdx.x / LANES), touch = 0;
  bool there = row < n;
  if (!there) row = 0; // goes along with an empty list
  int i = a.first + row;
  cloth_v3 f = cloth_spring_weight(&a, i), x = cloth_v3_load(a.x, i), v = cloth_v3_load(a.v, i);
  if (a.springs.first) {
    uint32_t first = a.springs.first[row], end = there ? a.springs.first[row + 1] : first;
    f = cloth_v3_add(f, sum_in_order(first, end, [&](uint32_t e) {
                       return cloth_spring_entry(&a.springs, e, x, v, a.x, a.v);
                     }));
  }
  if (a.air.first) {
    uint32_t first = a.air.first[row], end = there ? a.air.first[row + 1] : first;
    f = cloth_v3_add(f, sum_in_order(first, end, [&](uint32_t e) {
                       return cloth_spring_air_entry(&a.air, row, e, a.x, a.v);
                     }));
  }
  if (a.particles.count > 0) {
    uint32_t end = there ? cloth_particle_count(&a.particles, row) : 0;
    f = cloth_v3_add(f, sum_in_order(0, end, [&](uint32_t e) {
                       return cloth_particle_entry(&a.particles, row, e, i, x, a.x, a.v, &touch);
                     }));
    touch = sum_of_lanes(touch);
  }
  if (there && threadIdx.x % LANES == 0) cloth_spring_move(&a, i, f, touch);
}

} // namespace

cudaError_t cloth_cuda_spring_step(cloth_device *, int n, const void *args, cudaStream_t stream)
{
  step_kernel<<<(unsigned)(n + PARTICLES - 1) / PARTICLES, THREADS, 0, stream>>>(
      n, *static_cast<const cloth_spring_step_args *>(args));
  return cudaGetLastError();
}
