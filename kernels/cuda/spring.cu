// A block of sub-steps of the mass-spring cloth as one kernel, with a barrier behind each sub-step
// instead of a launch. Four threads share a particle; what they need of its springs, triangles and
// candidates does not change within a block and stays in shared memory, so that all loads of a
// sub-step are of states, and none waits for another. What a thread adds up is the physics
// headers'; sums go along the same trees, so the bits are those of spring_step.h one by one.
#include "launch.h"
#include "spring_block.h"
#include "together.cuh"

namespace {

enum {
  LANES = CLOTH_SPRING_LANES,
  WARP = 32,
  THREADS = sizeof(cloth_real) == 4 ? 800 : 512, // most of a block: the registers of a thread
  CLUSTER_BLOCKS = 16,                           // for nets that few blocks hold
  CLUSTER_THREADS = 256,
  SPRINGS = 3, // of a thread in shared memory, as many as a particle of a lattice has
  TRIANGLES = 2,
  CANDIDATES = 4,
  TO = 0, // what a thread has there: names of particles
  CORNER = TO + SPRINGS,
  CANDIDATE = CORNER + 3 * TRIANGLES,
  NAMES = CANDIDATE + CANDIDATES,
  LAW = 0, // and numbers
  DRAG = LAW + CLOTH_SPRING_LAW * SPRINGS,
  X_REF = DRAG + 2,
  NUMBERS = X_REF + 3,
  BODIES = 16,        // in shared memory
  POSE_NUMBERS = 1536 // in shared memory
};

constexpr uint32_t NOBODY = 0xffffffffu;

// three numbers as one load
struct __align__(16) cell { cloth_real x, y, z, unused; };

struct states {
  cell *x, *v;
};

__device__ __forceinline__ cloth_v3 get(const cell *c, int i)
{
  cell k = c[i];
  return cloth_v3_make(k.x, k.y, k.z);
}

__device__ __forceinline__ void put(cell *c, int i, cloth_v3 v)
{
  cell k = {v.x, v.y, v.z, 0};
  c[i] = k;
}

// ---- one particle, as one of its threads has it ------------------------------------------------

// shared memory of a thread: neighbours lie side by side
template <typename T> struct column {
  T *at;
  __device__ __forceinline__ T &operator[](int k) const { return at[k * (int)blockDim.x]; }
  __device__ __forceinline__ column beside(int threads) const { return {at + threads}; }
};

struct share {
  cloth_spring_particle p;
  bool there; // threads behind the last particle go along with nothing
  int lane;
  cloth_v3 x, v;
  column<int> name;
  column<cloth_real> number;
  uint32_t spring, spring_end, triangle, triangle_end; // what is left in memory
  uint32_t listed;

  __device__ __forceinline__ explicit share(void *shared)
  {
    auto *numbers = static_cast<cloth_real *>(shared);
    number.at = numbers + threadIdx.x;
    name.at = reinterpret_cast<int *>(numbers + NUMBERS * (int)blockDim.x) + threadIdx.x;
    lane = (int)threadIdx.x % LANES;
  }

  __device__ __forceinline__ void load(const cloth_spring_block_args &b, int row, states now)
  {
    const cloth_spring_step_args &a = b.step;
    there = row < b.rows;
    int i = there ? row : 0;
    p = cloth_spring_particle_of(&a, i);
    if (!there) p.slot = -1;
    x = get(now.x, i), v = get(now.v, i);
    for (int c = 0; c < 3 && b.x_ref; c++) number[X_REF + c] = b.x_ref[3 * i + c];
    load_springs(a.springs, i);
    load_triangles(a.air, i);
    listed = !there ? 0 : a.particles.listed ? a.particles.listed[i] : (uint32_t)a.particles.count;
    for (int k = 0; k < CANDIDATES; k++) name[CANDIDATE + k] = candidate(a.particles, k);
  }

  // A spring to itself pulls with zero, a triangle of one corner has no drag.
  __device__ __forceinline__ void load_springs(const cloth_spring_rows &r, int i)
  {
    spring = spring_end = 0;
    if (r.first && there) spring = r.first[i] + (uint32_t)lane, spring_end = r.first[i + 1];
    for (int k = 0; k < SPRINGS; k++, spring += LANES) {
      bool is = spring < spring_end;
      name[TO + k] = is ? r.to[spring] : i;
      for (int c = 0; c < CLOTH_SPRING_LAW; c++)
        number[LAW + CLOTH_SPRING_LAW * k + c] = is ? r.law[CLOTH_SPRING_LAW * spring + c] : 0;
    }
  }

  __device__ __forceinline__ void load_triangles(const cloth_spring_air &a, int i)
  {
    bool any = a.first && there;
    triangle = any ? a.first[i] + (uint32_t)lane : 0, triangle_end = any ? a.first[i + 1] : 0;
    for (int c = 0; c < 2; c++) number[DRAG + c] = any ? a.drag[2 * i + c] : 0;
    for (int k = 0; k < TRIANGLES; k++, triangle += LANES)
      for (int c = 0; c < 3; c++)
        name[CORNER + 3 * k + c] = triangle < triangle_end ? a.triangle[3 * triangle + c] : i;
  }

  // the thread's k-th candidate; -1: there is none
  __device__ __forceinline__ int candidate(const cloth_particles &a, int k) const
  {
    uint32_t e = (uint32_t)(LANES * k + lane);
    if (e >= listed) return -1;
    int j = a.listed ? (int)a.candidate[(uint64_t)p.i * a.room + e] : (int)e;
    return j == p.i ? -1 : j;
  }

  // the thread's springs and triangles
  __device__ __forceinline__ cloth_v3 gather(const cloth_spring_step_args &a, states now) const
  {
    cloth_v3 f = cloth_v3_make(0, 0, 0);
    if (a.springs.first) {
#pragma unroll
      for (int k = 0; k < SPRINGS; k++) {
        cloth_real law[CLOTH_SPRING_LAW];
        for (int c = 0; c < CLOTH_SPRING_LAW; c++) law[c] = number[LAW + CLOTH_SPRING_LAW * k + c];
        f = cloth_v3_add(f, pull(now, name[TO + k], law));
      }
      for (uint32_t e = spring; e < spring_end; e += LANES)
        f = cloth_v3_add(f, pull(now, a.springs.to[e], a.springs.law + CLOTH_SPRING_LAW * e));
    }
    if (a.air.first) {
      cloth_v3 air = cloth_v3_make(0, 0, 0);
      cloth_real drag[2] = {number[DRAG], number[DRAG + 1]};
#pragma unroll
      for (int k = 0; k < TRIANGLES; k++) {
        int corner[3];
        for (int c = 0; c < 3; c++) corner[c] = name[CORNER + 3 * k + c];
        air = cloth_v3_add(air, wind(a.air, drag, now, corner));
      }
      for (uint32_t e = triangle; e < triangle_end; e += LANES)
        air = cloth_v3_add(air, wind(a.air, drag, now, a.air.triangle + 3 * e));
      f = cloth_v3_add(f, air);
    }
    return f;
  }

  __device__ __forceinline__ cloth_v3 pull(states now, int j, const cloth_real *law) const
  {
    return cloth_spring_force(cloth_v3_sub(get(now.x, j), x), cloth_v3_sub(get(now.v, j), v), law);
  }

  __device__ __forceinline__ static cloth_v3 wind(const cloth_spring_air &a, const cloth_real *drag,
                                                  states now, const int *t)
  {
    return cloth_spring_air_force(&a, drag, get(now.x, t[0]), get(now.x, t[1]), get(now.x, t[2]),
                                  get(now.v, t[0]), get(now.v, t[1]), get(now.v, t[2]));
  }

  // LANES candidates tested side by side; those that touch are added in their order
  __device__ __forceinline__ void meet(const cloth_particles &a, states now, int j, cloth_v3 *f,
                                       int *touch) const
  {
    cloth_v3 d = cloth_v3_make(0, 0, 0);
    cloth_real most = 0;
    if (j >= 0) {
      d = cloth_v3_sub(x, get(now.x, j));
      most = cloth_particle_touch(&a, p.i, j, d);
    }
    unsigned hits = __ballot_sync(0xffffffffu, most > 0);
    if (hits == 0) return;
    cloth_v3 g = cloth_v3_make(0, 0, 0);
    if (most > 0) g = cloth_particle_force(&a, p.i, j, most, d, cloth_v3_sub(v, get(now.v, j)));
    for (int l = 0; l < LANES; l++)
      *f = cloth_v3_add(*f, cloth_v3_make(__shfl_sync(0xffffffffu, g.x, l, LANES),
                                          __shfl_sync(0xffffffffu, g.y, l, LANES),
                                          __shfl_sync(0xffffffffu, g.z, l, LANES)));
    int group = (int)threadIdx.x % WARP - lane;
    *touch += __popc(hits >> group & ((1u << LANES) - 1));
  }

  __device__ __forceinline__ cloth_v3 meet_all(const cloth_particles &a, states now,
                                               int *touch) const
  {
    cloth_v3 f = cloth_v3_make(0, 0, 0);
#pragma unroll
    for (int k = 0; k < CANDIDATES; k++) meet(a, now, name[CANDIDATE + k], &f, touch);
    for (int k = CANDIDATES; __any_sync(0xffffffffu, (uint32_t)(LANES * k) < listed); k++)
      meet(a, now, candidate(a, k), &f, touch);
    return f;
  }

  // a sub-step; how far the particle had strayed at its start
  __device__ __forceinline__ int step(const cloth_spring_step_args &a, states now)
  {
    int with_particles = 0, with_bodies = 0, far = 0;
    cloth_v3 sum = gather(a, now), impulse = cloth_v3_make(0, 0, 0);
    for (int width = LANES / 2; width > 0; width /= 2) {
      sum.x += __shfl_xor_sync(0xffffffffu, sum.x, width);
      sum.y += __shfl_xor_sync(0xffffffffu, sum.y, width);
      sum.z += __shfl_xor_sync(0xffffffffu, sum.z, width);
    }
    cloth_v3 g = cloth_v3_make(a.gravity[0], a.gravity[1], a.gravity[2]);
    cloth_v3 f = cloth_v3_add(cloth_v3_scale(p.mass, g), sum);
    if (a.particles.count > 0) f = cloth_v3_add(f, meet_all(a.particles, now, &with_particles));
    if (a.x_ref && there)
      far = cloth_spring_strayed(
          &a, x, cloth_v3_make(number[X_REF], number[X_REF + 1], number[X_REF + 2]));
    cloth_spring_move(&a, &p, f, &x, &v, &impulse, &with_bodies);
    if (!there || lane > 0) return far;
    if (p.slot >= 0) cloth_spring_impulse_add(&a, p.slot, impulse);
    if (a.touch) {
      a.touch[2 * p.i] = (uint32_t)with_particles;
      a.touch[2 * p.i + 1] = (uint32_t)with_bodies;
    }
    return far;
  }
};

// ---- a block of sub-steps -----------------------------------------------------------------------

struct shared_room {
  cloth_spring_told told[CLOTH_SPRING_BLOCK_MAX];
  cloth_real pose[POSE_NUMBERS], size[3 * BODIES], friction[BODIES];
  int kind[BODIES];
};

// what is told, where every thread has it at hand
__device__ void bring(cloth_spring_block_args &b, shared_room *room)
{
  cloth_shapes &s = b.step.shapes;
  int numbers = 12 * (b.body_rows > 0 ? b.body_rows * (b.count + 1) : s.count);
  bool fits = s.count <= BODIES, poses = numbers <= POSE_NUMBERS;
  int t = (int)threadIdx.x, threads = (int)blockDim.x;
  for (int k = t; k < b.count; k += threads) room->told[k] = cloth_spring_told_at(&b, k);
  for (int k = t; k < numbers && poses; k += threads) room->pose[k] = s.pose_t0[k];
  for (int k = t; k < s.count && fits; k += threads) {
    for (int c = 0; c < 3; c++) room->size[3 * k + c] = s.size[3 * k + c];
    room->friction[k] = s.friction[k], room->kind[k] = s.kind[k];
  }
  if (fits) s.size = room->size, s.friction = room->friction, s.kind = room->kind;
  if (poses) s.pose_t0 = room->pose;
  __syncthreads();
}

// the state as the sub-steps read it, and where they may go back to; places that nobody is in
__device__ void begin(const cloth_spring_block_args &b, states now)
{
  int first = (int)(blockIdx.x * blockDim.x + threadIdx.x), stride = (int)(gridDim.x * blockDim.x);
  for (int i = first; i < b.rows; i += stride) {
    cloth_v3 x = cloth_v3_load(b.x, i), v = cloth_v3_load(b.v, i);
    put(now.x, i, x), put(now.v, i, v);
    if (b.x_ref) cloth_v3_store(b.x_ref, i, x), cloth_v3_store(b.v_ref, i, v);
    if (b.x_saved) cloth_v3_store(b.x_saved, i, x), cloth_v3_store(b.v_saved, i, v);
  }
  for (int k = first; b.head && k <= (int)b.find.bins.mask; k += stride) b.head[k] = NOBODY;
  for (int k = first; b.head && k < 4; k += stride) b.find.sums[k] = 0;
}

// ---- candidates ---------------------------------------------------------------------------------

// Everybody into the list of a place. Its order is that in which threads came, and shows nowhere:
// what is found is sorted.
__device__ void insert(const cloth_spring_block_args &b)
{
  int first = (int)(blockIdx.x * blockDim.x + threadIdx.x), stride = (int)(gridDim.x * blockDim.x);
  for (int i = first; i < b.rows; i += stride) {
    cloth_bin c = cloth_bin_of(&b.find.bins, cloth_v3_load(b.x, i));
    b.next[i] = atomicExch(b.head + cloth_bin_place(&b.find.bins, c.x, c.y, c.z), (unsigned)i);
  }
}

// calls found(j) for all near particle i in cells `from`, from + step, ... of the 27 around it
template <typename Found>
__device__ void look_around(const cloth_spring_block_args &b, int i, int from, int step,
                            Found found)
{
  cloth_v3 p = cloth_v3_load(b.x, i);
  cloth_bin c = cloth_bin_of(&b.find.bins, p);
  for (int k = from; k < 27; k += step) {
    int x = c.x + k % 3 - 1, y = c.y + k / 3 % 3 - 1, z = c.z + k / 9 - 1;
    for (uint32_t j = b.head[cloth_bin_place(&b.find.bins, x, y, z)]; j != NOBODY; j = b.next[j])
      if (cloth_bin_is_near(&b.find.bins, i, p, x, y, z, (int)j, cloth_v3_load(b.x, (int)j)))
        found((int)j);
  }
}

// The candidates of particle i by its threads: each keeps what it finds in its column, and every
// one goes to its rank among all. More than the columns hold are found by the first thread alone.
__device__ uint32_t find_row(const cloth_spring_block_args &b, int i, bool there, int lane,
                             column<int> name)
{
  int mine = 0, all = 0, most = 0;
  uint32_t *list = b.find.candidate + (uint64_t)i * b.find.room, n = 0;
  if (there)
    look_around(b, i, lane, LANES, [&](int j) {
      if (mine < NAMES) name[mine] = j;
      mine++;
    });
  __syncwarp();
  int count[LANES];
  for (int l = 0; l < LANES; l++) {
    count[l] = __shfl_sync(0xffffffffu, mine, l, LANES);
    all += count[l];
    if (count[l] > most) most = count[l];
  }
  if (most <= NAMES) {
    for (int k = 0; k < mine; k++) {
      uint32_t rank = 0;
      for (int l = 0; l < LANES; l++)
        for (int m = 0; m < count[l]; m++) rank += name.beside(l - lane)[m] < name[k];
      if (rank < b.find.room) list[rank] = (uint32_t)name[k];
    }
  } else if (there && lane == 0) {
    look_around(b, i, 0, 1, [&](int j) { n = cloth_bin_insert(&b.find, (uint32_t)j, n, list); });
  }
  if (there && lane == 0)
    b.find.count[i] = (uint32_t)all < b.find.room ? (uint32_t)all : b.find.room;
  __syncwarp(); // its threads read the list and fill the columns
  return there && lane == 0 ? (uint32_t)all : 0;
}

__device__ void find(const cloth_spring_block_args &b, int row, int stride, const share &mine)
{
  uint32_t found = 0, full = 0;
  for (int from = 0; from < b.rows; from += stride) {
    bool there = from + row < b.rows;
    uint32_t n = find_row(b, there ? from + row : 0, there, mine.lane, mine.name);
    found += n, full += n > b.find.room;
  }
  for (int width = WARP / 2; width > 0; width /= 2) {
    found += __shfl_xor_sync(0xffffffffu, found, width);
    full += __shfl_xor_sync(0xffffffffu, full, width);
  }
  if (threadIdx.x % WARP > 0) return;
  cloth_atomic_add(b.find.sums, found);
  if (full > 0) cloth_atomic_add(b.find.sums + 1, full);
}

template <typename Together>
__device__ void run(const cloth_spring_block_args &args, cell *cells, Together g)
{
  __shared__ shared_room room;
  extern __shared__ double kept[];
  cloth_spring_block_args b = args;
  cloth_spring_step_args a = args.step;
  states now = {cells, cells + b.rows}, next = {cells + 2 * b.rows, cells + 3 * b.rows};
  int stride = (int)(gridDim.x * blockDim.x) / LANES, far = 0;
  int row = (int)(blockIdx.x * blockDim.x + threadIdx.x) / LANES;
  share mine(kept);
  begin(b, now);
  bring(b, &room);
  a.shapes = b.step.shapes;
  g.sync();
  if (args.head) {
    insert(args);
    g.sync();
    find(args, row, stride, mine);
    if (b.count == 1) g.sync(); // the only sub-step writes what others still search
  }
  mine.load(args, row, now);
  for (int k = 0; k < b.count; k++) {
    bool last = k + 1 == b.count;
    cloth_spring_tell(&b, k, &room.told[k], &a);
    for (int from = 0; from < b.rows; from += stride) {
      if (stride < b.rows) mine.load(args, from + row, now);
      int strayed = mine.step(a, now);
      if (strayed > far) far = strayed;
      if (!mine.there || mine.lane > 0) continue;
      if (last)
        cloth_v3_store(b.x, mine.p.i, mine.x), cloth_v3_store(b.v, mine.p.i, mine.v);
      else
        put(next.x, mine.p.i, mine.x), put(next.v, mine.p.i, mine.v);
    }
    if (!last) g.sync();
    states other = now;
    now = next, next = other;
  }
  if (far > 0) cloth_spring_strayed_tell(&args.step, far);
}

__global__ void __launch_bounds__(THREADS, 1)
    block_by_grid(const __grid_constant__ cloth_spring_block_args b, cell *cells,
                  cloth_together_state *state)
{
  run(b, cells, cloth_together_grid(state));
}

__global__ void __launch_bounds__(CLUSTER_THREADS, 1)
    block_by_cluster(const __grid_constant__ cloth_spring_block_args b, cell *cells)
{
  run(b, cells, cloth_together_cluster());
}

// ---- launches -----------------------------------------------------------------------------------

int rounded(int threads) { return (threads + WARP - 1) / WARP * WARP; }

size_t kept_bytes(int threads)
{
  return (size_t)threads * (NUMBERS * sizeof(cloth_real) + NAMES * sizeof(int));
}

// most threads of a block, and blocks of the largest cluster that the device runs; 1: it has none
cloth_status ask_device(cloth_device *d, cloth_error *err)
{
  int major = 0, threads = THREADS;
  while (threads > WARP && kept_bytes(threads) + sizeof(shared_room) + 1024 > d->shared_bytes)
    threads -= WARP;
  CUDA_TRY(err, cudaFuncSetAttribute(block_by_grid, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                     (int)kept_bytes(threads)));
  d->spring_threads = threads, d->spring_blocks = 1;
  CUDA_TRY(err, cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, d->index));
  if (major < 9) return CLOTH_OK;
  CUDA_TRY(err, cudaFuncSetAttribute(block_by_cluster,
                                     cudaFuncAttributeNonPortableClusterSizeAllowed, 1));
  CUDA_TRY(err, cudaFuncSetAttribute(block_by_cluster, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                     (int)kept_bytes(CLUSTER_THREADS)));
  for (int blocks = CLUSTER_BLOCKS; blocks > 1 && d->spring_blocks == 1; blocks /= 2) {
    cloth_cluster_launch l;
    int clusters = 0;
    cloth_cluster_of(&l, blocks, CLUSTER_THREADS, kept_bytes(CLUSTER_THREADS),
                     d->stream[CLOTH_COMPUTE]);
    if (cudaOccupancyMaxActiveClusters(&clusters, block_by_cluster, &l.config) == cudaSuccess &&
        clusters > 0)
      d->spring_blocks = blocks;
  }
  cudaGetLastError();
  return CLOTH_OK;
}

cudaError_t launch_cluster(cloth_device *d, const cloth_spring_block_args &b, cell *cells)
{
  cloth_cluster_launch l;
  int wanted = LANES * b.rows, blocks = 1;
  while (blocks < d->spring_blocks && blocks * CLUSTER_THREADS / 2 < wanted) blocks *= 2;
  int threads = rounded((wanted + blocks - 1) / blocks);
  cloth_cluster_of(&l, blocks, threads, kept_bytes(threads), d->stream[CLOTH_COMPUTE]);
  return cudaLaunchKernelEx(&l.config, block_by_cluster, b, cells);
}

cudaError_t launch_grid(cloth_device *d, const cloth_spring_block_args &b, cell *cells, void *state)
{
  int wanted = LANES * b.rows, most = d->multiprocessors;
  int threads = rounded((wanted + most - 1) / most);
  if (threads > d->spring_threads) threads = d->spring_threads;
  int blocks = (wanted + threads - 1) / threads;
  void *parameters[] = {const_cast<cloth_spring_block_args *>(&b), &cells, &state};
  return cudaLaunchCooperativeKernel(reinterpret_cast<const void *>(block_by_grid),
                                     dim3((unsigned)(blocks < most ? blocks : most)),
                                     dim3((unsigned)threads), parameters, kept_bytes(threads),
                                     d->stream[CLOTH_COMPUTE]);
}

} // namespace

cloth_status cloth_cuda_spring_block(cloth_device *d, const cloth_spring_block_args *args,
                                     cloth_error *err)
{
  enum : size_t { HEAD = 256 }; // of the scratch memory: the barrier
  CUDA_TRY(err, cudaSetDevice(d->index));
  if (d->spring_blocks == 0) CLOTH_TRY(ask_device(d, err));
  void *scratch = nullptr;
  CLOTH_TRY(cloth_cuda_scratch(d, HEAD + 4 * sizeof(cell) * (size_t)args->rows, &scratch, err));
  auto *cells = reinterpret_cast<cell *>(static_cast<char *>(scratch) + HEAD);
  if (d->spring_blocks > 1 && LANES * args->rows <= d->spring_blocks * CLUSTER_THREADS) {
    CUDA_TRY(err, launch_cluster(d, *args, cells));
    return CLOTH_OK;
  }
  CUDA_TRY(err,
           cudaMemsetAsync(scratch, 0, sizeof(cloth_together_state), d->stream[CLOTH_COMPUTE]));
  CUDA_TRY(err, launch_grid(d, *args, cells, scratch));
  return CLOTH_OK;
}
