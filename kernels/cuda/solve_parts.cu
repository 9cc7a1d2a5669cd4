// A linear solve by several devices: one cooperative kernel on each, all at the same time, in each
// other's memory. kernels/physics/pcg_part.h says who tells whom what. Inside a device it is the
// kernel of solve.cu: loops over chunks by all blocks, with a barrier behind each. A signal to
// other devices is given by every block for itself: it counts up a word in their memory, so nobody
// waits for the last block of a device to pass it on. Sums over all chunks are added up by each
// block for itself (group_sums.cuh), from terms that all devices have.
//
// Nothing hangs: who waits longer than PATIENCE gives up, tells the others, and all leave.
#include "count.cuh"
#include "group_sums.cuh"
#include "launch.h"
#include "pcg_part.h"
#include "stopwatch.cuh"

namespace {

enum {
  RESIDENT = 4,
  THREADS = CLOTH_PCG_LANES,
  CHUNKS = THREADS / CLOTH_CHUNK,
  WARPS = THREADS / CLOTH_WARP,
  POLLS = 1024 // between two looks at the clock
};

constexpr uint64_t PATIENCE = 10000000000u; // ns

using part_args = cloth_pcg_part_args;

// What a block keeps: room for sums, and the scalars as it knows them: the same on every block of
// every device.
struct shared_room {
  cloth_real upper[CHUNKS * CLOTH_CHUNK_SHARED], lanes[CLOTH_HAT_SHARED];
  cloth_tile_room tiles;
  cloth_real scalar[CLOTH_PCG_SCALARS];
};

// Words of a device's flags, a cache line each. The device's own blocks count up NEAR, blocks of
// other devices the word of the signal that they give.
enum word { NEAR, START, RESIDUALS, DIRECTIONS, PRODUCTS, LOST, WORDS };
static_assert((int)WORDS * CLOTH_FLAG_STRIDE <= (int)CLOTH_FLAG_WORDS, "a line each");

struct grid {
  const part_args &a;
  unsigned others;   // blocks of the other devices
  unsigned barriers; // of the device, to which this block came
  int *gone;         // shared: somebody is lost, so nobody is waited for
};

__device__ unsigned *word_of(const grid &g, int part, word w)
{
  return reinterpret_cast<unsigned *>(g.a.peer[part].flag) + (int)w * CLOTH_FLAG_STRIDE;
}

// ---- waiting ------------------------------------------------------------------------------------

__device__ void give_up(const grid &g)
{
  for (int j = 0; j < g.a.parts; j++) *const_cast<volatile unsigned *>(word_of(g, j, LOST)) = 1;
}

// one thread, until ready() or all is lost
template <typename Ready> __device__ void spin(const grid &g, Ready ready)
{
  const volatile unsigned *lost = word_of(g, g.a.me, LOST);
  uint64_t since = 0;
  for (unsigned n = 1; !ready(); n++) {
    if (n % POLLS > 0) continue;
    uint64_t now = cloth_nanoseconds();
    if (since == 0) since = now;
    if (now - since >= PATIENCE) give_up(g);
    if (!*lost) continue;
    *g.gone = 1;
    return;
  }
}

// What the block wrote is seen by the device's other blocks that have waited.
__device__ void arrive(grid &g)
{
  g.barriers++;
  __syncthreads();
  if (threadIdx.x == 0) cloth_count_up(word_of(g, g.a.me, NEAR));
}

// one thread
__device__ void look_for_near(const grid &g)
{
  const unsigned *arrived = word_of(g, g.a.me, NEAR);
  unsigned all = g.barriers * gridDim.x;
  spin(g, [&] { return cloth_count_of(arrived) >= all; });
}

__device__ void wait(const grid &g)
{
  if (threadIdx.x == 0) look_for_near(g);
  __syncthreads();
}

// All blocks of the device meet: they are all resident.
__device__ void barrier(grid &g)
{
  arrive(g);
  wait(g);
}

// What the block wrote, into whose memory ever, is seen by those of others who have awaited it. The
// threads of the block have met since.
__device__ void signal(const grid &g, word w)
{
  int j = (int)threadIdx.x - CLOTH_WARP; // the first warp has its own device to tell
  if (j >= 0 && j < g.a.parts && j != g.a.me) cloth_count_up_far(word_of(g, j, w));
}

// The block goes on when all blocks of the other devices have given a signal `times` times. Nobody
// gives it once more before all have come to a meeting behind it.
__device__ void await(const grid &g, word w, int times)
{
  if (threadIdx.x == CLOTH_WARP) {
    const unsigned *arrived = word_of(g, g.a.me, w);
    unsigned all = (unsigned)times * g.others;
    spin(g, [&] { return cloth_count_of_far(arrived) >= all; });
  }
  __syncthreads();
}

// All blocks of all devices meet.
__device__ void meet(grid &g, word w, int times)
{
  arrive(g);
  signal(g, w);
  if (threadIdx.x == 0) look_for_near(g);
  await(g, w, times);
}

__device__ bool is_lost(const grid &g) { return *g.gone != 0; }

// ---- phases -------------------------------------------------------------------------------------

// sums of r of a chunk, which the same thread wrote, for the others
__device__ void send_chunk(const part_args &a, int chunk)
{
  const cloth_real *from = a.solve.v.partial + CLOTH_PCG_PARTIALS * chunk;
  for (int j = 0; j < a.parts; j++)
    for (int f = 2; j != a.me && f < CLOTH_PCG_PARTIALS; f++)
      a.peer[j].partial[CLOTH_PCG_PARTIALS * chunk + f] = from[f];
}

// r = row(k) for each vertex k of the part, then z and the terms of r'z and r'r, for everybody
template <typename Row> __device__ void for_levels(const part_args &a, shared_room *room, Row row)
{
  const cloth_pcg_vectors &v = a.solve.v;
  int group = cloth_chunk_group(v.chunks), first = cloth_own_groups_begin(&v);
  cloth_for_tiles<2>((v.count + THREADS - 1) / THREADS, group, room->tiles,
                     [&](int tile, cloth_real(&sum)[2]) {
                       int lane = (int)threadIdx.x % CLOTH_CHUNK;
                       int k = v.first + tile * THREADS + (int)threadIdx.x;
                       cloth_v3 r = cloth_v3_make(0, 0, 0);
                       bool there = k < v.first + v.count;
                       if (there) r = row(k);
                       cloth_block_z_sums(&v, k - lane, k, there, r, sum, room->upper);
                       if (lane == 0 && there && v.coarse) send_chunk(a, k / CLOTH_CHUNK);
                     },
                     [&](int tile, int k, const cloth_real(&sum)[2]) {
                       int i = first + tile * CHUNKS / group + k;
                       if (i < cloth_own_groups_end(&v))
                         cloth_residual_terms_send(&a, i, sum[0], sum[1]);
                     });
}

// q = A p of chunks [begin, end) of the order, and the terms of p'q for everybody. Both are whole
// tiles, but for the order's end (halo_group.h). From chunk `wait` of the order on the directions
// of the others are needed.
__device__ void for_rows(const grid &g, int begin, int end, int wait, int times, shared_room *room)
{
  const part_args &a = g.a;
  const cloth_pcg_product_args &product = a.solve.product;
  const cloth_pcg_vectors &v = a.solve.v;
  int group = cloth_chunk_group(v.chunks);
  bool waited = false;
  cloth_for_tiles<1>(
      (end - begin + CHUNKS - 1) / CHUNKS, group, room->tiles,
      [&](int tile, cloth_real(&sum)[1]) {
        int c = begin + tile * CHUNKS, at = c + (int)threadIdx.x / CLOTH_CHUNK;
        if (!waited && c + CHUNKS > wait) {
          await(g, DIRECTIONS, times);
          waited = true;
        }
        int i = at < end ? (int)a.order[at] : 0;
        int row = i * CLOTH_CHUNK + (int)threadIdx.x % CLOTH_CHUNK;
        if (at < end && row < v.count) {
          sum[0] = cloth_pcg_product_row(row, &product,
                                         cloth_block_row_product(&product.rows, row, product.x));
          cloth_hat_row_send(&a, row, 0);
        }
        cloth_block_chunk_sums(sum, room->upper);
      },
      [&](int tile, int k, const cloth_real(&sum)[1]) {
        int at = begin + tile * CHUNKS + k;
        if (at < end)
          cloth_product_term_send(&a, (v.first / CLOTH_CHUNK + (int)a.order[at]) / group, sum[0]);
      });
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
__device__ void product(grid &g, int times, shared_room *room)
{
  const part_args &a = g.a;
  bool contacts = a.solve.contacts > 0, outer = a.outer[1] > 0;
  int chunks = (a.solve.v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
  int inner = chunks - (int)a.outer[0];
  if (!a.overlap) await(g, DIRECTIONS, times);
  for_contacts(g, true, !a.overlap);
  if (contacts) barrier(g);
  if (!a.overlap) {
    for_rows(g, 0, chunks, chunks, times, room);
  } else if (!outer) {
    for_rows(g, 0, chunks, inner, times, room);
  } else {
    for_rows(g, 0, inner, inner, times, room);
    await(g, DIRECTIONS, times);
    for_contacts(g, false, true);
    barrier(g);
    for_rows(g, inner, chunks, chunks, times, room);
  }
}

// own nodes of the hats' first level, for everybody
__device__ void correct_finely(const part_args &a, cloth_real *lanes)
{
  int node = (int)threadIdx.x / CLOTH_HAT_FINE_LANES;
  bool sends = threadIdx.x % CLOTH_HAT_FINE_LANES == 0; // what it stored itself
  for (int i = cloth_hat_share_begin(&a.share) + (int)blockIdx.x; i < cloth_hat_share_end(&a.share);
       i += (int)gridDim.x) {
    int c = i * CLOTH_HAT_FINE_GROUP + node;
    cloth_real rz = cloth_block_hat_rest(&a.solve.hats, i, lanes);
    if (sends && c < a.share.end) cloth_hat_node_send(&a, c);
    if (threadIdx.x == 0) cloth_hat_group_send(&a, i, rz);
  }
}

// The residual as the aggregates see it, and the hats' other levels; every device does all of it.
__device__ void restrict_all(const cloth_pcg_solve_args &a, cloth_real *lanes)
{
  int warp = (int)threadIdx.x / CLOTH_WARP, lane = (int)threadIdx.x % CLOTH_WARP;
  const cloth_hats *h = &a.v.hats;
  cloth_real *rz_of = a.terms.rz + cloth_chunk_groups(a.v.chunks) + cloth_hat_fine_groups(h);
  for (int i = (int)blockIdx.x; h->nodes > 0 && i < cloth_hat_groups(h); i += (int)gridDim.x) {
    cloth_real rz = cloth_block_hat_upper(&a.hats, i, lanes);
    if (threadIdx.x == 0) rz_of[i] = rz;
  }
  for (int k = (int)blockIdx.x * WARPS + warp; a.v.coarse && k < 3 * a.v.aggregates;
       k += (int)gridDim.x * WARPS) {
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

__device__ void directions(const part_args &a, cloth_real beta)
{
  const cloth_pcg_vectors &v = a.solve.v;
  int stride = (int)(gridDim.x * blockDim.x);
  for (int row = (int)(blockIdx.x * blockDim.x + threadIdx.x); row < v.count; row += stride) {
    int k = v.first + row;
    cloth_pcg_direction_row(k, &v, beta, cloth_pcg_coarse_of(k, &v));
    if (cloth_chunk_readers(&a, row / CLOTH_CHUNK)) cloth_direction_send(&a, row);
  }
}

// After r, z and their terms: coarse correction, beta, direction. Is there more to do?
__device__ bool turn(grid &g, int k, shared_room *room)
{
  const cloth_pcg_solve_args &a = g.a.solve;
  bool hats = a.v.hats.nodes > 0;
  int stride = (int)(gridDim.x * blockDim.x);
  if (hats) {
    if (k > 0) barrier(g);
    correct_finely(g.a, room->lanes);
  }
  meet(g, RESIDUALS, k + 1);
  restrict_all(a, room->lanes);
  if (a.v.coarse) {
    barrier(g);
    correct_coarsely(a);
  }
  cloth_beta_sums sums(a, hats ||
                              a.v.coarse); // only those of the hats' upper levels are not there yet
  sums.add_early(a.terms);
  if (hats || a.v.coarse) barrier(g);
  sums.add_rest(a.terms);
  cloth_block_beta(a, k == 0, sums, room->scalar, room->lanes);
  if (room->scalar[CLOTH_PCG_DONE] > 0) return false;
  if (k == a.iterations_max || is_lost(g)) return false;
  for (int c = (int)(blockIdx.x * blockDim.x + threadIdx.x); hats && c < a.v.hats.fine; c += stride)
    if (cloth_hat_is_mine(&g.a, c)) cloth_hat_spread_node(c, &a.v.hats);
  if (hats) barrier(g);
  directions(g.a, room->scalar[CLOTH_PCG_BETA]);
  arrive(g);
  signal(g, DIRECTIONS);
  wait(g);
  return true;
}

// r of the first residual to those whose nodes sum over it
__device__ void start_nodes(grid &g)
{
  int stride = (int)(gridDim.x * blockDim.x);
  barrier(g);
  for (int row = (int)(blockIdx.x * blockDim.x + threadIdx.x); row < g.a.solve.v.count;
       row += stride)
    cloth_hat_row_send(&g.a, row, 1);
  meet(g, START, 1);
}

__device__ void iterate(grid &g, shared_room *room)
{
  const part_args &a = g.a;
  const cloth_pcg_vectors &v = a.solve.v;
  int thread = (int)(blockIdx.x * blockDim.x + threadIdx.x), stride = (int)(gridDim.x * blockDim.x);
  for_levels(a, room, [&](int i) { return cloth_pcg_start_row(i, &v); });
  if (v.hats.nodes > 0) start_nodes(g);
  cloth_stopwatch products(a.solve.product_ns);
  for (int k = 0; turn(g, k, room); k++) {
    products.start();
    product(g, k + 1, room);
    meet(g, PRODUCTS, k + 1);
    cloth_block_alpha(a.solve, room->scalar, room->lanes);
    products.stop();
    if (room->scalar[CLOTH_PCG_DONE] > 0) return;
    cloth_real alpha = room->scalar[CLOTH_PCG_ALPHA];
    for_levels(a, room, [&](int i) { return cloth_pcg_update_row(i, &v, alpha); });
    for (int i = thread; i < a.share.other_count; i += stride) cloth_hat_row_update(&a, i, alpha);
  }
}

__global__ void __launch_bounds__(THREADS, RESIDENT)
    part_kernel(const __grid_constant__ part_args a, unsigned others)
{
  __shared__ shared_room room;
  __shared__ int gone;
  grid g = {a, others, 0, &gone};
  if (threadIdx.x == 0) gone = 0;
  cloth_real *scalar = a.solve.v.scalar;
  if (threadIdx.x < CLOTH_PCG_SCALARS) room.scalar[threadIdx.x] = scalar[threadIdx.x];
  iterate(g, &room);
  __syncthreads();
  // every block has read them: all have met since
  if (blockIdx.x == 0 && threadIdx.x < CLOTH_PCG_LOST)
    scalar[threadIdx.x] = room.scalar[threadIdx.x];
  if (is_lost(g) && threadIdx.x == 0) scalar[CLOTH_PCG_LOST] = 1;
}

cloth_status prepare(cloth_device *d, cloth_error *err)
{
  CUDA_TRY(err, cudaSetDevice(d->index));
  if (d->part_blocks == 0) { // also loads the kernel, which must not happen while others wait
    int each = 0;
    CUDA_TRY(err, cudaOccupancyMaxActiveBlocksPerMultiprocessor(&each, part_kernel, THREADS, 0));
    d->part_blocks = each * d->multiprocessors;
  }
  return CLOTH_OK;
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
  unsigned blocks[CLOTH_PARTS_MAX], all = 0;
  for (int i = 0; i < parts; i++) {
    CLOTH_TRY(prepare(device[i], err));
    blocks[i] = (unsigned)blocks_for(device[i], &args[i]);
    all += blocks[i];
  }
  for (int i = 0; i < parts; i++) {
    CUDA_TRY(err, cudaSetDevice(device[i]->index));
    unsigned others = all - blocks[i];
    void *parameters[] = {const_cast<part_args *>(&args[i]), &others};
    CUDA_TRY(err, cudaLaunchCooperativeKernel(part_kernel, dim3(blocks[i]), dim3(THREADS),
                                              parameters, 0, device[i]->stream[CLOTH_COMPUTE]));
  }
  return CLOTH_OK;
}
