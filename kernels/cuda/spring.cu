// A block of sub-steps of the mass-spring cloth as one kernel, with a barrier behind each sub-step
// instead of a launch. A sub-step is: fetch the states of others that the block feels; LANES
// threads gather for each particle; one thread moves it. If a particle has strayed too far, on
// which blocks vote at the barrier, candidates are found anew before they are used. The bits are
// those of spring_step.h one by one, for any cut.
#include "barrier.cuh"
#include "spring_find.cuh"
#include "spring_share.cuh"
#include "vote_barrier.cuh"

namespace {

enum {
  THREADS = sizeof(cloth_real) == 4 ? 800 : 512, // most of a block: the registers of a thread
  CLUSTER_BLOCKS = 16,                           // for nets that few blocks hold
  CLUSTER_THREADS = 256
};

// the state as the sub-steps read it, and where they may go back to
__device__ void begin(const cloth_spring_block_args &b, record *now, int own_row, int stride)
{
  bool moves = (int)threadIdx.x < (int)blockDim.x / LANES;
  for (int i = own_row; moves && i < b.rows; i += stride) {
    cloth_v3 x = cloth_v3_load(b.x, i), v = cloth_v3_load(b.v, i);
    now[i].x = cell_of(x), now[i].v = cell_of(v);
    if (b.x_ref) cloth_v3_store(b.x_ref, i, x), cloth_v3_store(b.v_ref, i, v);
    if (b.x_saved) cloth_v3_store(b.x_saved, i, x), cloth_v3_store(b.v_saved, i, v);
  }
}

// A block of threads at work. AtOnce: it has a thread for each of its particles; else they are
// taken in several goes, and what does not change is read again in each.
template <typename Barrier, bool AtOnce> struct worker {
  const cloth_spring_block_args &args; // of the launch
  cloth_spring_block_args b;           // with what was brought
  cloth_spring_step_args a;            // of the sub-step
  const cloth_spring_inputs *inputs;
  tile here;
  record *next;
  kept *keep;
  int row, own_row, stride; // the thread's as one that gathers, as one that moves; of a go
  int searched, searches;   // sub-step of the last one; how many
  Barrier g;
  gatherer mine;
  mover own;

  __device__ worker(const cloth_spring_block_args &launch_args, record *records, tile_size size,
                    shared_room *room, void *kept_room, Barrier barrier)
      : args(launch_args), b(launch_args), a(launch_args.step), inputs(room->inputs), g(barrier)
  {
    int particles = (int)blockDim.x / LANES, thread = (int)threadIdx.x;
    stride = particles * (int)gridDim.x;
    row = (int)blockIdx.x * particles + thread / LANES;
    own_row = (int)blockIdx.x * particles + thread;
    here = tile_of(kept_room, particles, b.rows, size, AtOnce);
    keep = here.kept_of_other(static_cast<kept *>(kept_room), thread);
    here.now = records, next = records + b.rows;
    searched = searches = 0;
    begin(b, records, own_row, stride);
    bring(b, room);
    a.shapes = b.step.shapes;
    if (AtOnce) settle();
  }

  // the block's own particles, and what they hang on
  __device__ void settle()
  {
    here.forget_all();
    own.take(args, own_row);
    own.load(args, here);
    if (own.there) own.x = get(here.now[own_row].x), own.v = get(here.now[own_row].v);
    show();
    __syncthreads();
    mine.load(args, here, row, &keep->share);
    __syncthreads();
    here.keep_all();
  }

  // what is felt from sub-step k on
  __device__ void look(int k)
  {
    here.forget_candidates();
    if (args.head)
      search(args, here, row, own_row, stride, k > 0, keep, g);
    else
      g.sync();
    searched = k, searches++;
    if (!AtOnce) return;
    mine.load_near(args.step.particles, here, keep);
    own.look(here, own.x);
    __syncthreads();
  }

  // the block's own states
  __device__ __forceinline__ void show()
  {
    if (own.there) here.x[threadIdx.x] = cell_of(own.x), here.v[threadIdx.x] = cell_of(own.v);
  }

  // how far the thread's particle has strayed at the start of the next sub-step
  __device__ __forceinline__ int strayed(int next_step)
  {
    for (int c = 0; c < 3; c++) a.drift[c] = inputs[next_step].drift[c] - inputs[searched].drift[c];
    return cloth_spring_strayed(&a, own.x, cloth_v3_load(here.kept_of[threadIdx.x].x_ref, 0));
  }

  // sub-step k of the particles from `from` on
  __device__ __forceinline__ int go(int k, int from)
  {
    bool last = k + 1 == b.count;
    if (!AtOnce) {
      mine.load(args, here, from + row, &keep->share);
      mine.load_near(args.step.particles, here, keep);
      own.take(args, from + own_row);
      own.load(args, here);
      if (b.x_ref && own.there) own.look(here, cloth_v3_load(b.x_ref, own.row));
    }
    mine.gather(a, here, keep);
    __syncthreads();
    int far = 0;
    if (own.there) {
      int i = own.row;
      own.move(a, here, AtOnce ? (int)threadIdx.x : -2 - i);
      if (last)
        cloth_v3_store(b.x, i, own.x), cloth_v3_store(b.v, i, own.v);
      else
        next[i].x = cell_of(own.x), next[i].v = cell_of(own.v);
      if (b.head && !last) far = strayed(k + 1);
    }
    if (!AtOnce) __syncthreads(); // what was gathered may be overwritten
    return far;
  }

  __device__ void run()
  {
    int far = 0;
    bool again = true;
    for (int k = 0;; k++) {
      if (again) look(k);
      here.fetch_others();
      __syncthreads();
      cloth_spring_inputs_set(&b, k, inputs + k, &a);
      int strayed = 0;
      for (int from = 0; from < (AtOnce ? 1 : b.rows); from += stride) {
        int f = go(k, from);
        if (f > strayed) strayed = f;
      }
      if (strayed > far) far = strayed;
      if (k + 1 == b.count) break;
      g.arrive(AtOnce && strayed > 1);
      if (AtOnce) show();
      again = g.wait();
      record *other = const_cast<record *>(here.now);
      here.now = next, next = other;
    }
    if (!AtOnce && far > 0) cloth_spring_strayed_note(&args.step, far);
    if (args.head && blockIdx.x == 0 && threadIdx.x == 0)
      args.find.sums[CLOTH_SPRING_AGAIN] = (uint32_t)(searches - 1);
  }
};

template <bool AtOnce>
__global__ void __launch_bounds__(THREADS, 1)
    block_by_grid(const __grid_constant__ cloth_spring_block_args b, record *records,
                  tile_size size, cloth_vote_state *state)
{
  __shared__ shared_room room;
  extern __shared__ __align__(16) double kept_room[];
  cloth_grid_vote g(state);
  worker<cloth_grid_vote, AtOnce>(b, records, size, &room, kept_room, g).run();
}

__global__ void __launch_bounds__(CLUSTER_THREADS, 1)
    block_by_cluster(const __grid_constant__ cloth_spring_block_args b, record *records,
                     tile_size size)
{
  __shared__ shared_room room;
  extern __shared__ __align__(16) double kept_room[];
  cloth_cluster_vote g(room.heard);
  worker<cloth_cluster_vote, true>(b, records, size, &room, kept_room, g).run();
}

// ---- launches -----------------------------------------------------------------------------------

int rounded(int threads) { return (threads + WARP - 1) / WARP * WARP; }

bool fits(const cloth_device *d, int threads, tile_size size)
{
  return tile_bytes(threads, size) + sizeof(shared_room) + 1024 <= d->shared_bytes;
}

// Places for others in a block's tile: cloth in one layer asks for about one a thread. What is left
// is for candidates.
tile_size size_of(const cloth_device *d, int threads)
{
  tile_size size = {2 * WARP, ROOM_LEAST};
  while (size.slots < 2 * threads) size.slots *= 2;
  while (size.slots > WARP && !fits(d, threads, size)) size.slots /= 2;
  while (size.room + ROOM_MORE <= ROOM_MOST &&
         fits(d, threads, {size.slots, size.room + ROOM_MORE}))
    size.room += ROOM_MORE;
  return size;
}

// most threads of a block, and blocks of the largest cluster that the device runs; 1: it has none
cloth_status ask_device(cloth_device *d, cloth_error *err)
{
  int major = 0, threads = THREADS;
  tile_size size = size_of(d, CLUSTER_THREADS);
  int bytes = (int)(d->shared_bytes - sizeof(shared_room) - 1024);
  while (threads > WARP && !fits(d, threads, {threads, ROOM_LEAST})) threads -= WARP;
  CUDA_TRY(err, cudaFuncSetAttribute(block_by_grid<true>,
                                     cudaFuncAttributeMaxDynamicSharedMemorySize, bytes));
  CUDA_TRY(err, cudaFuncSetAttribute(block_by_grid<false>,
                                     cudaFuncAttributeMaxDynamicSharedMemorySize, bytes));
  d->spring_threads = threads, d->spring_blocks = 1;
  CUDA_TRY(err, cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, d->index));
  if (major < 9) return CLOTH_OK;
  CUDA_TRY(err, cudaFuncSetAttribute(block_by_cluster,
                                     cudaFuncAttributeNonPortableClusterSizeAllowed, 1));
  CUDA_TRY(err, cudaFuncSetAttribute(block_by_cluster, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                     bytes));
  for (int blocks = CLUSTER_BLOCKS; blocks > 1 && d->spring_blocks == 1; blocks /= 2) {
    cloth_cluster_launch l;
    int clusters = 0;
    cloth_cluster_of(&l, blocks, CLUSTER_THREADS, tile_bytes(CLUSTER_THREADS, size),
                     d->stream[CLOTH_COMPUTE]);
    if (cudaOccupancyMaxActiveClusters(&clusters, block_by_cluster, &l.config) == cudaSuccess &&
        clusters > 0)
      d->spring_blocks = blocks;
  }
  cudaGetLastError();
  return CLOTH_OK;
}

cudaError_t launch_cluster(cloth_device *d, const cloth_spring_block_args &b, record *records)
{
  cloth_cluster_launch l;
  int wanted = LANES * b.rows, blocks = 1;
  while (blocks < d->spring_blocks && blocks * CLUSTER_THREADS / 2 < wanted) blocks *= 2;
  int threads = rounded((wanted + blocks - 1) / blocks);
  tile_size size = size_of(d, threads);
  cloth_cluster_of(&l, blocks, threads, tile_bytes(threads, size), d->stream[CLOTH_COMPUTE]);
  return cudaLaunchKernelEx(&l.config, block_by_cluster, b, records, size);
}

cudaError_t launch_grid(cloth_device *d, const cloth_spring_block_args &b, record *records,
                        void *state)
{
  int wanted = LANES * b.rows, most = d->multiprocessors;
  int threads = rounded((wanted + most - 1) / most);
  if (threads > d->spring_threads) threads = d->spring_threads;
  int blocks = (wanted + threads - 1) / threads;
  bool at_once = blocks <= most;
  tile_size size = at_once ? size_of(d, threads) : tile_size{0, ROOM_LEAST};
  void *parameters[] = {const_cast<cloth_spring_block_args *>(&b), &records, &size, &state};
  auto kernel = at_once ? block_by_grid<true> : block_by_grid<false>;
  return cudaLaunchCooperativeKernel(
      reinterpret_cast<const void *>(kernel), dim3((unsigned)(at_once ? blocks : most)),
      dim3((unsigned)threads), parameters, tile_bytes(threads, size), d->stream[CLOTH_COMPUTE]);
}

} // namespace

cloth_status cloth_cuda_spring_block(cloth_device *d, const cloth_spring_block_args *args,
                                     cloth_error *err)
{
  enum : size_t { HEAD = 256 }; // of the scratch memory: the barrier
  CUDA_TRY(err, cudaSetDevice(d->index));
  if (d->spring_blocks == 0) CLOTH_TRY(ask_device(d, err));
  void *scratch = nullptr;
  CLOTH_TRY(cloth_cuda_scratch(d, HEAD + 2 * sizeof(record) * (size_t)args->rows, &scratch, err));
  auto *records = reinterpret_cast<record *>(static_cast<char *>(scratch) + HEAD);
  if (d->spring_blocks > 1 && LANES * args->rows <= d->spring_blocks * CLUSTER_THREADS) {
    CUDA_TRY(err, launch_cluster(d, *args, records));
    return CLOTH_OK;
  }
  CUDA_TRY(err, cudaMemsetAsync(scratch, 0, sizeof(cloth_vote_state), d->stream[CLOTH_COMPUTE]));
  CUDA_TRY(err, launch_grid(d, *args, records, scratch));
  return CLOTH_OK;
}
