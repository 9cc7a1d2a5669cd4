// A linear solve by several devices: one cooperative kernel on each, all at the same time, in each
// other's memory. kernels/physics/pcg_part.h says who tells whom what. Inside a device it is the
// kernel of solve.cu: loops over chunks by all blocks, with a barrier behind each; the block that
// comes last to a barrier gives the signal to the other devices and waits for theirs.
//
// Nothing hangs: who waits longer than PATIENCE gives up, tells the others, and all leave.
#include "launch.h"
#include "pcg_part.h"
#include "reduce.cuh"

namespace {

enum {
  RESIDENT = 4,
  THREADS = CLOTH_PCG_LANES,
  CHUNKS = THREADS / CLOTH_CHUNK,
  WARPS = THREADS / CLOTH_WARP,
  POLLS = 1024 // between two looks at the clock
};

constexpr unsigned long long PATIENCE = 10000000000ull; // ns

using part_args = cloth_pcg_part_args;

struct grid {
  const part_args &a;
  int *flag;         // signals of the others
  unsigned *arrived; // blocks at barriers
  volatile unsigned *passed;
  volatile int *lost;
  unsigned barriers; // passed by this block
};

// ---- waiting ------------------------------------------------------------------------------------

__device__ unsigned long long nanoseconds(void)
{
  unsigned long long t;
  asm volatile("mov.u64 %0, %globaltimer;" : "=l"(t));
  return t;
}

__device__ void tell(const grid &g, int part, int number)
{
  *static_cast<volatile int *>(g.a.peer[part].flag + g.a.me * CLOTH_FLAG_STRIDE) = number;
}

__device__ void give_up(const grid &g)
{
  *g.lost = 1;
  for (int j = 0; j < g.a.parts; j++)
    if (j != g.a.me) tell(g, j, CLOTH_FLAG_LOST);
}

// one thread, until ready() or all is lost
template <typename Ready> __device__ void spin(const grid &g, Ready ready)
{
  unsigned long long since = 0;
  for (unsigned n = 1; !ready(); n++) {
    if (n % POLLS > 0) continue;
    if (*g.lost) return;
    unsigned long long now = nanoseconds();
    if (since == 0) since = now;
    if (now - since < PATIENCE) continue;
    give_up(g);
    return;
  }
}

// The block goes on when all parts have given this signal; what they wrote before is seen.
__device__ void await(const grid &g, int number)
{
  int j = (int)threadIdx.x;
  if (j < g.a.parts && j != g.a.me) {
    const volatile int *flag = g.flag + j * CLOTH_FLAG_STRIDE;
    spin(g, [&] {
      int told = *flag;
      if (told == CLOTH_FLAG_LOST) *g.lost = 1;
      return told >= number;
    });
    __threadfence_system();
  }
  __syncthreads();
}

// By one block, when all blocks of the device have written: so have they on the others' memory.
__device__ void signal(const grid &g, int number)
{
  int j = (int)threadIdx.x;
  if (j < g.a.parts && j != g.a.me) {
    __threadfence_system();
    tell(g, j, number);
  }
}

__device__ bool is_lost(const grid &g)
{
  __shared__ int lost;
  __syncthreads();
  if (threadIdx.x == 0) lost = *g.lost;
  __syncthreads();
  return lost != 0;
}

// All blocks of the device meet (they are all resident), and `last` runs on the whole block that
// arrives last before any goes on. far: what was written to other devices is there before.
template <typename Last> __device__ void barrier(grid &g, bool far, Last last)
{
  __shared__ int is_last;
  g.barriers++;
  __syncthreads();
  if (threadIdx.x == 0) {
    if (far)
      __threadfence_system(); // of the whole block: the barrier above came first
    else
      __threadfence();
    is_last = atomicAdd(g.arrived, 1) == g.barriers * gridDim.x - 1;
    __threadfence();
  }
  __syncthreads();
  if (is_last) {
    last();
    __syncthreads();
    if (threadIdx.x == 0) {
      __threadfence();
      *g.passed = g.barriers;
    }
  } else if (threadIdx.x == 0) {
    unsigned number = g.barriers;
    spin(g, [&] { return *g.passed >= number; });
    __threadfence();
  }
  __syncthreads();
}

__device__ void barrier(grid &g)
{
  barrier(g, false, [] {});
}

// ---- phases -------------------------------------------------------------------------------------

// r = row(k) for each vertex k of the part, then z and the partial sums of each chunk, for
// everybody
template <typename Row> __device__ void for_levels(const part_args &a, cloth_real *upper, Row row)
{
  const cloth_pcg_vectors &v = a.solve.v;
  int chunks = (v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK, lane = (int)threadIdx.x % CLOTH_CHUNK;
  for (int c = (int)blockIdx.x * CHUNKS; c < chunks; c += (int)gridDim.x * CHUNKS) {
    int i = c + (int)threadIdx.x / CLOTH_CHUNK, k = v.first + i * CLOTH_CHUNK + lane;
    cloth_real sum[CLOTH_PCG_PARTIALS];
    cloth_v3 r = cloth_v3_make(0, 0, 0);
    bool there = k < v.first + v.count;
    if (there) r = row(k);
    cloth_block_z(&v, k, there, r, sum, upper);
    if (lane == 0 && i < chunks)
      for (int j = 0; j < a.parts; j++) {
        cloth_real *to = a.peer[j].partial + CLOTH_PCG_PARTIALS * (k / CLOTH_CHUNK);
        for (int f = 0; f < CLOTH_PCG_PARTIALS; f++) to[f] = sum[f];
      }
  }
}

// q = A p of chunks [begin, end) of the order, and their sums p'q for everybody. From chunk `wait`
// of the order on the directions of the others are needed.
__device__ void for_rows(const grid &g, int begin, int end, int wait, int number, cloth_real *upper)
{
  const part_args &a = g.a;
  const cloth_pcg_product_args &product = a.solve.product;
  int lane = (int)threadIdx.x % CLOTH_CHUNK;
  bool waited = false;
  for (int c = begin + (int)blockIdx.x * CHUNKS; c < end; c += (int)gridDim.x * CHUNKS) {
    if (!waited && c + CHUNKS > wait) {
      await(g, number);
      waited = true;
    }
    int at = c + (int)threadIdx.x / CLOTH_CHUNK;
    int i = at < end ? (int)a.order[at] : 0, row = i * CLOTH_CHUNK + lane;
    cloth_real sum[1] = {};
    if (at < end && row < a.solve.v.count)
      sum[0] = cloth_pcg_product_row(row, &product,
                                     cloth_block_row_product(&product.rows, row, product.x));
    cloth_block_chunk_sums(sum, upper);
    if (lane == 0 && at < end)
      for (int j = 0; j < a.parts; j++) a.peer[j].pq[a.solve.v.first / CLOTH_CHUNK + i] = sum[0];
  }
}

__device__ void for_contacts(const grid &g, bool inner, bool outer)
{
  int stride = (int)(gridDim.x * blockDim.x);
  for (int i = (int)(blockIdx.x * blockDim.x + threadIdx.x); i < g.a.solve.contacts; i += stride)
    if (cloth_contact_is_outer(&g.a, i) ? outer : inner)
      cloth_contact_product(i, &g.a.solve.contact);
}

// Own rows while the others' directions travel. Contacts that need these have a barrier of their
// own.
__device__ void product(grid &g, int number, cloth_real *upper)
{
  const part_args &a = g.a;
  bool contacts = a.solve.contacts > 0, outer = a.outer[1] > 0;
  int chunks = (a.solve.v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
  int inner = chunks - (int)a.outer[0];
  if (!a.overlap) await(g, number);
  for_contacts(g, true, !a.overlap);
  if (contacts) barrier(g);
  if (!a.overlap) {
    for_rows(g, 0, chunks, chunks, number, upper);
  } else if (!outer) {
    for_rows(g, 0, chunks, inner, number, upper);
  } else {
    for_rows(g, 0, inner, inner, number, upper);
    await(g, number);
    for_contacts(g, false, true);
    barrier(g);
    for_rows(g, inner, chunks, chunks, number, upper);
  }
}

// the sum of p'q over all chunks, as cloth_chunks_sum() has it, on thread 0
__device__ cloth_real sum_of_chunks(const cloth_real *number, int chunks, cloth_real *shared)
{
  int l = (int)threadIdx.x, lane = l % CLOTH_WARP, warp = l / CLOTH_WARP;
  cloth_real sum = 0;
#pragma unroll 16
  for (int c = l; c < chunks; c += CLOTH_PCG_LANES) sum += number[c];
  for (int width = WARPS / 2; width > 0; width /= 2) {
    __syncthreads();
    if (warp >= width && warp < 2 * width) shared[(warp - width) * CLOTH_WARP + lane] = sum;
    __syncthreads();
    if (warp < width) sum += shared[warp * CLOTH_WARP + lane];
  }
  return warp == 0 ? cloth_warp_sum(sum) : sum;
}

__device__ void alpha_of(const grid &g, cloth_real *lanes)
{
  cloth_real pq = sum_of_chunks(g.a.peer[g.a.me].pq, g.a.solve.v.chunks, lanes);
  if (threadIdx.x == 0) cloth_pcg_alpha_set(g.a.solve.v.scalar, pq);
}

// by one block; sums [2]: r'z of the block Jacobi part, r'r
__device__ void beta_of(const cloth_pcg_solve_args &a, const volatile cloth_real *sums, int start)
{
  cloth_real rz = sums[0], rr = sums[1];
  if (a.v.coarse && threadIdx.x < CLOTH_WARP) { // cloth_coarse_rz() by a warp
    cloth_real sum = 0;
    for (int k = (int)threadIdx.x; k < 3 * a.v.aggregates; k += CLOTH_COARSE_LANES)
      sum += a.beta.rest[k] * a.beta.coarse[k];
    rz += cloth_warp_sum(sum);
  }
  if (threadIdx.x > 0) return;
  cloth_pcg_beta_args beta = a.beta;
  beta.start = start;
  cloth_pcg_beta_set(&beta, rz, rr);
}

// The first block adds up r'z and r'r while the others restrict r to the aggregates; every device
// does all of both.
__device__ void restrict_and_sum(const cloth_pcg_solve_args &a, cloth_real *sums, cloth_real *lanes)
{
  int helpers = gridDim.x > 1 ? 1 : 0, warp = (int)threadIdx.x / CLOTH_WARP;
  if (blockIdx.x == 0) {
    cloth_real two[2];
    cloth_block_partial_sums(a.beta.partial, a.beta.chunks, two, lanes);
    if (threadIdx.x == 0) sums[0] = two[0], sums[1] = two[1];
  }
  if (!a.v.coarse || (int)blockIdx.x < helpers) return;
  for (int k = ((int)blockIdx.x - helpers) * WARPS + warp; k < 3 * a.v.aggregates;
       k += ((int)gridDim.x - helpers) * WARPS) {
    int lane = (int)threadIdx.x % CLOTH_WARP;
    cloth_real sum = cloth_warp_sum(cloth_coarse_rest_lane(&a.rest, k / 3, k % 3, lane));
    if (lane == 0) a.rest.rest[k] = sum;
  }
}

__device__ void correct_coarsely(const cloth_pcg_solve_args &a)
{
  int warp = (int)threadIdx.x / CLOTH_WARP, lane = (int)threadIdx.x % CLOTH_WARP;
  for (int i = (int)blockIdx.x * WARPS + warp; i < 3 * a.v.aggregates;
       i += (int)gridDim.x * WARPS) {
    cloth_real sum = cloth_warp_sum(cloth_coarse_lane(&a.coarse, i, lane));
    if (lane == 0) a.coarse.coarse[i] = *a.coarse.usable > 0 ? sum : 0;
  }
}

__device__ void directions(const part_args &a)
{
  const cloth_pcg_vectors &v = a.solve.v;
  cloth_real beta = v.scalar[CLOTH_PCG_BETA];
  int stride = (int)(gridDim.x * blockDim.x);
  for (int row = (int)(blockIdx.x * blockDim.x + threadIdx.x); row < v.count; row += stride) {
    int k = v.first + row;
    cloth_pcg_direction_row(k, &v, beta, cloth_pcg_coarse_of(k, &v));
    if (cloth_chunk_readers(&a, row / CLOTH_CHUNK)) cloth_direction_send(&a, row);
  }
}

// After r, z and their sums: coarse correction, beta, direction. Is there more to do?
__device__ bool turn(grid &g, int k, cloth_real *sums, cloth_real *lanes)
{
  const cloth_pcg_solve_args &a = g.a.solve;
  barrier(g, true, [&] {
    signal(g, cloth_residuals_signal(k));
    await(g, cloth_residuals_signal(k));
  });
  restrict_and_sum(a, sums, lanes);
  if (a.v.coarse) {
    barrier(g);
    correct_coarsely(a);
  }
  barrier(g, false, [&] { beta_of(a, sums, k == 0); });
  if (*static_cast<volatile cloth_real *>(a.v.scalar + CLOTH_PCG_DONE) > 0) return false;
  if (k == a.iterations_max || is_lost(g)) return false;
  directions(g.a);
  barrier(g, true, [&] { signal(g, cloth_directions_signal(k)); });
  return true;
}

__device__ void iterate(grid &g, cloth_real *sums, cloth_real *upper, cloth_real *lanes)
{
  const part_args &a = g.a;
  const cloth_pcg_vectors &v = a.solve.v;
  for_levels(a, upper, [&](int i) { return cloth_pcg_start_row(i, &v); });
  for (int k = 0; turn(g, k, sums, lanes); k++) {
    product(g, cloth_directions_signal(k), upper);
    barrier(g, true, [&] {
      signal(g, cloth_products_signal(k));
      await(g, cloth_products_signal(k));
      alpha_of(g, lanes);
    });
    if (*static_cast<volatile cloth_real *>(v.scalar + CLOTH_PCG_DONE) > 0) return;
    cloth_real alpha = v.scalar[CLOTH_PCG_ALPHA];
    for_levels(a, upper, [&](int i) { return cloth_pcg_update_row(i, &v, alpha); });
  }
}

__global__ void __launch_bounds__(THREADS, RESIDENT)
    part_kernel(const __grid_constant__ part_args a, cloth_real *sums)
{
  __shared__ cloth_real upper[CHUNKS * CLOTH_CHUNK_SHARED], lanes[CLOTH_PCG_LANES / 2];
  int *flag = a.peer[a.me].flag, *own = flag + CLOTH_PARTS_MAX * CLOTH_FLAG_STRIDE;
  grid g = {
      a,        flag, reinterpret_cast<unsigned *>(own), reinterpret_cast<unsigned *>(own + 8),
      own + 16, 0};
  iterate(g, sums, upper, lanes);
  if (is_lost(g) && threadIdx.x == 0) a.solve.v.scalar[CLOTH_PCG_LOST] = 1;
}

cloth_status prepare(cloth_device *d, void **sums, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  if (d->part_blocks == 0) { // also loads the kernel, which must not happen while others wait
    int each = 0;
    CUDA_TRY(err, cudaOccupancyMaxActiveBlocksPerMultiprocessor(&each, part_kernel, THREADS, 0));
    d->part_blocks = each * d->multiprocessors;
  }
  return cloth_cuda_scratch(d, 2 * sizeof(cloth_real), sums, err);
}

int blocks_for(const cloth_device *d, const part_args *a)
{
  int most = a->solve.v.count > a->solve.contacts ? a->solve.v.count : a->solve.contacts;
  int wanted = (most + THREADS - 1) / THREADS;
  if (wanted < 1) wanted = 1;
  return wanted < d->part_blocks ? wanted : d->part_blocks;
}

} // namespace

bool cloth_cuda_joined(int parts, cloth_device *const *device)
{
  if (parts > CLOTH_PARTS_MAX) return false;
  bool joined = true;
  for (int i = 0; i < parts; i++)
    for (int j = 0; j < parts; j++) {
      int can = 0;
      if (i == j) continue;
      if (device[i]->index == device[j]->index || // two kernels that wait for each other on one
          cudaDeviceCanAccessPeer(&can, device[i]->index, device[j]->index) != cudaSuccess)
        joined = false;
      joined = joined && can;
    }
  cudaGetLastError();
  return joined;
}

cloth_status cloth_cuda_solve_parts(int parts, cloth_device *const *device,
                                    const cloth_pcg_part_args *args, cloth_error *err)
{
  void *sums[CLOTH_PARTS_MAX];
  for (int i = 0; i < parts; i++) CLOTH_TRY(prepare(device[i], &sums[i], err));
  for (int i = 0; i < parts; i++) {
    CUDA_TRY(err, cudaSetDevice(device[i]->index));
    void *parameters[] = {const_cast<part_args *>(&args[i]), &sums[i]};
    CUDA_TRY(err, cudaLaunchCooperativeKernel(
                      part_kernel, dim3((unsigned)blocks_for(device[i], &args[i])), dim3(THREADS),
                      parameters, 0, device[i]->stream[CLOTH_COMPUTE]));
  }
  return CLOTH_OK;
}
