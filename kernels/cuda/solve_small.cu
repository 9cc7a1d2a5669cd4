// A whole linear solve of a small cloth on one cluster of blocks: a thread for each row, which
// stays in its registers, and whatever a block alone reads in its shared memory. What is left of an
// iteration's time are its barriers and the loads behind them, so there are four: blocks tell each
// other residuals, sums of the first level of hats, directions and products. Everything between
// is done by every block for itself, in one order, which is quicker than to wait for one: scalars,
// the upper levels of hats, the right-hand side of the coarse level.
#include "barrier.cuh"
#include "launch.h"
#include "small_room.cuh"
#include "stopwatch.cuh"

namespace {

static_assert((int)CLOTH_FEW_CHUNKS >= (int)CLOTH_PCG_LANES, "sums have a chunk each");

// One thread and its block. What can be worked out again is not kept: registers are for the row.
struct worker {
  const cloth_pcg_solve_args &a;
  char *memory;
  int row, k, lane; // the thread's row, its vertex, its place in its warp
  bool there;       // has it a row?
  cloth_kept_row<KEPT_SLOTS> mine;
  cloth_real scalar[CLOTH_PCG_SCALARS]; // each thread knows them

  __device__ worker(const cloth_pcg_solve_args &args, char *room) : a(args), memory(room)
  {
    int chunks = (a.v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK, thread = (int)threadIdx.x;
    int each = (chunks + (int)gridDim.x - 1) / (int)gridDim.x;
    row = (int)blockIdx.x * each * CLOTH_CHUNK + thread, k = a.v.first + row;
    lane = thread % CLOTH_WARP, there = thread / CLOTH_CHUNK < each && row < a.v.count;
    mine.load(&a.product.rows, there ? row : a.v.count, a.v.count);
    for (int s = 0; s < CLOTH_PCG_SCALARS; s++) scalar[s] = a.v.scalar[s];
    if (there) {
      own()->free[thread] = a.v.free[k];
      cloth_sym3_store(own()->inverse_diagonal, thread, cloth_sym3_load(a.v.inverse_diagonal, k));
    }
    if (a.v.hats.nodes > 0) keep_hats();
    __syncthreads();
  }

  __device__ own_room *own() const { return reinterpret_cast<own_room *>(memory); }

  __device__ hats_room upper() const { return hats_room_at(memory + sizeof(own_room), &a.v.hats); }

  // the block's rows
  __device__ cloth_pcg_vectors vectors() const
  {
    cloth_pcg_vectors v = a.v;
    own_room *room = own();
    int first = k - (int)threadIdx.x;
    v.dx = room->dx - 3 * first, v.r = room->r - 3 * first, v.z = room->z - 3 * first;
    v.p = room->p - 3 * first, v.q = room->q - 3 * first, v.free = room->free - first;
    v.inverse_diagonal = room->inverse_diagonal - 6 * first;
    v.hats = hats();
    return v;
  }

  // the levels as the block has them: what its rows and the upper nodes read
  __device__ cloth_hats hats() const
  {
    cloth_hats h = a.v.hats;
    hats_room room = upper();
    int first = CLOTH_HAT_CORNERS * (k - (int)threadIdx.x);
    h.corner = own()->corner - first, h.weight = own()->weight - first;
    h.inverse = room.inverse - 6 * h.fine, h.first = room.first - h.fine;
    h.child = room.child, h.child_weight = room.child_weight;
    h.upper = room.upper, h.upper_weight = room.upper_weight;
    h.rest = room.rest, h.correction = room.correction;
    return h;
  }

  __device__ void keep_hats() const
  {
    const cloth_hats *h = &a.v.hats;
    hats_room room = upper();
    int uppers = h->nodes - h->fine, shared = h->fine * h->uppers, begin = h->first[h->fine];
    copy_in(room.inverse, h->inverse + 6 * h->fine, 6 * uppers);
    for (int i = (int)threadIdx.x; i <= uppers; i += THREADS)
      room.first[i] = h->first[h->fine + i] - begin;
    copy_in(room.child, h->child + begin, h->first[h->nodes] - begin);
    copy_in(room.child_weight, h->child_weight + begin, h->first[h->nodes] - begin);
    copy_in(room.upper, h->upper, shared);
    copy_in(room.upper_weight, h->upper_weight, shared);
    for (int i = uppers + (int)threadIdx.x; i < upper_shares(h); i += THREADS) room.share[i] = 0;

    int thread = (int)threadIdx.x, group = (int)blockIdx.x * CLOTH_HAT_FINE_GROUP;
    for (int c = 0; c < CLOTH_HAT_CORNERS && there; c++) {
      int to = CLOTH_HAT_CORNERS * thread + c, from = CLOTH_HAT_CORNERS * k + c;
      own()->corner[to] = h->corner[from], own()->weight[to] = h->weight[from];
    }
    int nodes = h->fine - group < CLOTH_HAT_FINE_GROUP ? h->fine - group : CLOTH_HAT_FINE_GROUP;
    copy_in(own()->node_inverse, h->inverse + 6 * group, 6 * nodes);
    own()->node.load(h, group + thread / CLOTH_HAT_FINE_LANES, thread % CLOTH_HAT_FINE_LANES,
                     CLOTH_HAT_FINE_LANES);
  }

  // ---- an iteration -----------------------------------------------------------------------------

  __device__ static void meet() { cloth_cluster_barrier().sync(); }

  // r = of(k), z, and the sums of the block's chunks
  template <typename Row> __device__ void residuals(Row of)
  {
    cloth_pcg_vectors v = vectors();
    cloth_v3 r = cloth_v3_make(0, 0, 0);
    if (there) r = of(k, &v);
    if (there && a.v.hats.nodes > 0) cloth_v3_store(a.v.r, k, r); // nodes of others read it
    cloth_block_z(&v, k - (int)threadIdx.x % CLOTH_CHUNK, k, there, r, own()->upper);
    meet();
  }

  __device__ void set_fine_term(int i, cloth_real rz) const
  {
    if (threadIdx.x == 0) a.hats.partial[CLOTH_PCG_PARTIALS * i] = rz;
  }

  // the first level of hats, from r; group i by block i
  __device__ void fine_hats()
  {
    int i = (int)blockIdx.x, groups = cloth_hat_fine_groups(&a.v.hats);
    if (i < groups) {
      int begin = i * CLOTH_HAT_FINE_GROUP, end = begin + CLOTH_HAT_FINE_GROUP;
      cloth_hats fine = a.v.hats;
      fine.inverse = own()->node_inverse - 6 * begin;
      cloth_v3 rest = cloth_lanes_v3<CLOTH_HAT_FINE_LANES>(
          own()->node.rest(&fine, a.v.r, CLOTH_HAT_FINE_LANES));
      cloth_real sum = cloth_block_hats_set<CLOTH_HAT_FINE_LANES, CLOTH_HAT_FINE_GROUP>(
          &fine, rest, begin, end < fine.fine ? end : fine.fine, own()->shares);
      set_fine_term(i, sum);
    }
    for (i += (int)gridDim.x; i < groups; i += (int)gridDim.x)
      set_fine_term(i, cloth_block_hat_rest(&a.hats, i, own()->shares));
    meet();
  }

  // the other levels, from the first
  __device__ void upper_hats() const
  {
    cloth_hats levels = hats();
    const cloth_hats *h = &levels;
    cloth_real *share = upper().share;
    copy_in(h->rest, a.v.hats.rest, h->correction, a.v.hats.correction, 3 * h->fine);
    __syncthreads();
    int warp = (int)threadIdx.x / CLOTH_WARP;
    for (int c = h->fine + warp; c < h->nodes; c += WARPS * NODES_AT_ONCE) {
      cloth_v3 rest[NODES_AT_ONCE], mine = cloth_v3_make(0, 0, 0);
#pragma unroll
      for (int n = 0; n < NODES_AT_ONCE; n++) {
        rest[n] = cloth_v3_make(0, 0, 0);
        if (c + WARPS * n < h->nodes)
          rest[n] = cloth_hat_rest_lane(h, h->rest, c + WARPS * n, lane, CLOTH_HAT_LANES);
      }
#pragma unroll
      for (int n = 0; n < NODES_AT_ONCE; n++) {
        rest[n] = cloth_warp_v3(rest[n]);
        if (lane == n) mine = rest[n];
      }
      int node = c + WARPS * lane; // a lane for each
      if (lane < NODES_AT_ONCE && node < h->nodes)
        share[node - h->fine] = cloth_hat_rest_set(h, node, mine);
    }
    __syncthreads();
  }

  // the group's share of r'z
  __device__ cloth_real upper_group(int i) const
  {
    cloth_real share[CLOTH_HAT_GROUP];
    const cloth_real *all = upper().share + i * CLOTH_HAT_GROUP;
    for (int c = 0; c < CLOTH_HAT_GROUP; c++) share[c] = all[c];
    return cloth_lanes_sum(share, CLOTH_HAT_GROUP);
  }

  // the coarse level's correction; its right-hand side by each block for itself
  __device__ void coarse_level()
  {
    cloth_coarse_rest_args rest = a.rest;
    cloth_coarse_solve_args coarse = a.coarse;
    rest.rest = own()->coarse_rest, rest.done = nullptr, coarse.rest = own()->coarse_rest;
    if ((int)threadIdx.x < rest.aggregates) cloth_coarse_rest((int)threadIdx.x, &rest);
    __syncthreads();
    int warp = (int)(blockIdx.x * WARPS + threadIdx.x / CLOTH_WARP);
    for (int i = warp; i < 3 * coarse.aggregates; i += (int)gridDim.x * WARPS) {
      cloth_real sum = cloth_warp_sum(cloth_coarse_lane(&coarse, i, lane));
      if (lane == 0) coarse.coarse[i] = *coarse.usable > 0 ? sum : 0;
    }
    meet();
  }

  // with the upper levels of hats, which come while the sums do
  __device__ void set_beta(int start)
  {
    int sums = a.v.chunks + a.beta.more;
    int shared = sums - cloth_hat_groups(&a.v.hats); // the others know the block itself
    cloth_real rz_of[CLOTH_LANES_EACH], rr_of[CLOTH_LANES_EACH];
    const cloth_real *partial = a.beta.partial;
    cloth_warp_lanes(rz_of,
                     [&](int l) { return l < shared ? partial[CLOTH_PCG_PARTIALS * l] : 0; });
    cloth_warp_lanes(rr_of,
                     [&](int l) { return l < shared ? partial[CLOTH_PCG_PARTIALS * l + 1] : 0; });
    if (a.v.hats.nodes > 0) upper_hats();
#pragma unroll
    for (int j = 0; j < CLOTH_LANES_EACH; j++) {
      int l = lane + j * CLOTH_WARP;
      if (l >= shared && l < sums) rz_of[j] = upper_group(l - shared);
    }
    cloth_real rz = cloth_warp_lanes_sum(rz_of), rr = cloth_warp_lanes_sum(rr_of);
    cloth_pcg_beta_args beta = a.beta;
    beta.start = start, beta.rest = own()->coarse_rest, beta.scalar = scalar;
    if (a.v.coarse) rz += __shfl_sync(0xffffffffu, cloth_warp_coarse_rz(beta), 0);
    cloth_pcg_beta_set(&beta, rz, rr);
  }

  __device__ void directions()
  {
    cloth_pcg_vectors v = vectors();
    for (int i = (int)threadIdx.x; i < v.hats.fine; i += THREADS) cloth_hat_spread_node(i, &v.hats);
    if (v.hats.nodes > 0) __syncthreads();
    if (there) {
      cloth_pcg_direction_row(k, &v, scalar[CLOTH_PCG_BETA], cloth_pcg_coarse_of(k, &v));
      cloth_v3_store(a.v.p, k, cloth_v3_load(v.p, k));
    }
    meet();
  }

  // after r, z and their sums: corrections, beta, directions
  __device__ void turn(int start)
  {
    if (a.v.coarse) coarse_level();
    if (a.v.hats.nodes > 0) fine_hats();
    set_beta(start);
    if (!(scalar[CLOTH_PCG_DONE] > 0)) directions();
  }

  // q = A p with the contacts that are not in the matrix
  __device__ cloth_v3 product_row()
  {
    cloth_v3 q = mine.product(&a.product.rows, row, a.v.p);
    const uint32_t *first = a.product.contact_first;
    for (uint32_t n = first ? first[2 * row + 1] : 0; n < (first ? first[2 * row + 2] : 0); n++) {
      int e = (int)a.contact.entry[n];
      q = cloth_v3_add(q,
                       cloth_v3_scale(a.contact.weight[e], cloth_contact_pull(e / 4, &a.contact)));
    }
    return q;
  }

  __device__ void products()
  {
    cloth_pcg_vectors v = vectors();
    cloth_pcg_product_args product = a.product;
    product.contact_first = nullptr, product.q = v.q, product.x = v.p;
    cloth_real sum[1] = {};
    if (there) sum[0] = cloth_pcg_product_row(row, &product, product_row());
    cloth_block_chunk_sums(sum, own()->upper);
    if (there && threadIdx.x % CLOTH_CHUNK == 0)
      a.more_partial[CLOTH_PCG_PARTIALS * (k / CLOTH_CHUNK)] = sum[0];
    meet();
    cloth_real pq[CLOTH_LANES_EACH];
    cloth_warp_lanes(
        pq, [&](int l) { return l < a.v.chunks ? a.more_partial[CLOTH_PCG_PARTIALS * l] : 0; });
    cloth_pcg_alpha_set(scalar, cloth_warp_lanes_sum(pq));
  }

  __device__ void solve()
  {
    residuals([](int at, const cloth_pcg_vectors *v) { return cloth_pcg_start_row(at, v); });
    turn(1);
    cloth_stopwatch watch(a.product_ns);
    for (int n = 0; n < a.iterations_max && !(scalar[CLOTH_PCG_DONE] > 0); n++) {
      watch.start();
      products();
      watch.stop();
      if (scalar[CLOTH_PCG_DONE] > 0) return;
      cloth_real alpha = scalar[CLOTH_PCG_ALPHA];
      residuals(
          [=](int at, const cloth_pcg_vectors *v) { return cloth_pcg_update_row(at, v, alpha); });
      turn(0);
    }
  }

  // The true residual, and x += dx: the launches of src/solve/pcg.c behind the iterations.
  __device__ void finish()
  {
    if (there) cloth_v3_store(a.v.dx, k, cloth_v3_load(own()->dx, (int)threadIdx.x));
    meet();
    cloth_contact_product_args contact = a.contact;
    contact.p = a.v.dx;
    int contacts = cloth_pcg_contacts(&a), stride = (int)gridDim.x * THREADS;
    for (int i = (int)(blockIdx.x * THREADS + threadIdx.x); i < contacts; i += stride)
      cloth_contact_product(i, &contact);
    if (contacts > 0) meet();

    cloth_real rr[1] = {0}, size = 0, length_sq = 0;
    if (there) {
      cloth_pcg_product_args product = a.product;
      product.x = a.v.dx;
      cloth_pcg_product_row(row, &product, mine.product(&a.product.rows, row, a.v.dx));
      rr[0] = cloth_pcg_residual_row(k, &a.v, &length_sq);
      size = cloth_correct_vertex(k, &a.correct);
    }
    cloth_block_chunk_sums(rr, own()->upper);
    size = cloth_warp_larger(size), length_sq = cloth_warp_larger(length_sq);
    static_assert(2 * THREADS / CLOTH_WARP <= CLOTH_HAT_FINE_GROUP, "shares has room for both");
    cloth_real *sizes = own()->shares, *lengths = sizes + THREADS / CLOTH_WARP;
    int warp = (int)threadIdx.x / CLOTH_WARP;
    if (lane == 0) sizes[warp] = size, lengths[warp] = length_sq;
    __syncthreads();
    if (there && threadIdx.x % CLOTH_CHUNK == 0) {
      cloth_real *partial = a.v.partial + CLOTH_PCG_PARTIALS * (k / CLOTH_CHUNK);
      partial[0] = rr[0], partial[1] = cloth_larger(lengths[warp], lengths[warp + 1]);
      a.correct.largest[k / CLOTH_CHUNK] = cloth_larger(sizes[warp], sizes[warp + 1]);
    }
    meet();
    cloth_real all[CLOTH_LANES_EACH], largest = 0;
    length_sq = 0;
    cloth_warp_lanes(
        all, [&](int l) { return l < a.v.chunks ? a.v.partial[CLOTH_PCG_PARTIALS * l] : 0; });
    for (int l = lane; l < a.v.chunks; l += CLOTH_WARP) {
      largest = cloth_larger(largest, a.correct.largest[l]);
      length_sq = cloth_larger(length_sq, a.v.partial[CLOTH_PCG_PARTIALS * l + 1]);
    }
    scalar[CLOTH_PCG_RESIDUAL] = cloth_warp_lanes_sum(all);
    scalar[CLOTH_PCG_LARGEST] = cloth_warp_larger(largest); // lane 0 writes it
    scalar[CLOTH_PCG_RESIDUAL_LENGTH] = cloth_sqrt(cloth_warp_larger(length_sq));
  }

  // what others will read, and what the launches of a solve leave behind
  __device__ void write_out()
  {
    if (there) cloth_v3_store(a.v.z, k, cloth_v3_load(own()->z, (int)threadIdx.x));
    if (blockIdx.x > 0) return;
    const cloth_hats *h = &a.v.hats;
    hats_room room = upper();
    for (int i = (int)threadIdx.x; i < 3 * h->nodes; i += THREADS)
      h->rest[i] = room.rest[i], h->correction[i] = room.correction[i];
    for (int i = (int)threadIdx.x; i < cloth_hat_groups(h); i += THREADS)
      a.hats.partial[CLOTH_PCG_PARTIALS * (cloth_hat_fine_groups(h) + i)] = upper_group(i);
    if (threadIdx.x == 0)
      for (int s = 0; s < CLOTH_PCG_SCALARS; s++) a.v.scalar[s] = scalar[s];
  }
};

__global__ void __launch_bounds__(THREADS, 1)
    solve_by_cluster(const __grid_constant__ cloth_pcg_solve_args a)
{
  extern __shared__ __align__(16) char memory[];
  worker w(a, memory);
  w.solve();
  w.finish();
  w.write_out();
}

// ---- starting it --------------------------------------------------------------------------------

// blocks of the largest cluster that the device runs with all the shared memory that it has
cloth_status ask_device(cloth_device *d, cloth_error *err)
{
  int major = 0;
  d->cluster_blocks = 1;
  CUDA_TRY(err, cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, d->index));
  if (major < 9) return CLOTH_OK;
  CUDA_TRY(err, cudaFuncSetAttribute(solve_by_cluster,
                                     cudaFuncAttributeNonPortableClusterSizeAllowed, 1));
  CUDA_TRY(err, cudaFuncSetAttribute(solve_by_cluster, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                     (int)d->shared_bytes));
  for (int blocks = BLOCKS; blocks > 1 && d->cluster_blocks == 1; blocks /= 2) {
    cloth_cluster_launch l;
    int clusters = 0;
    cloth_cluster_of(&l, blocks, THREADS, d->shared_bytes, d->stream[CLOTH_COMPUTE]);
    if (cudaOccupancyMaxActiveClusters(&clusters, solve_by_cluster, &l.config) == cudaSuccess &&
        clusters > 0)
      d->cluster_blocks = blocks;
  }
  cudaGetLastError();
  return CLOTH_OK;
}

// a thread for each row, shared memory for the hats, and sums that a warp adds up at once
bool fits(const cloth_device *d, const cloth_pcg_solve_args *args)
{
  bool wide = args->v.hats.wide < args->v.hats.nodes; // by whole blocks
  return d->cluster_blocks > 1 && !wide && args->v.count <= d->cluster_blocks * THREADS &&
         args->v.chunks + args->beta.more <= CLOTH_PCG_LANES &&
         room_bytes(&args->v.hats) <= d->shared_bytes;
}

} // namespace

cloth_status cloth_cuda_solve_small(cloth_device *d, const cloth_pcg_solve_args *args, bool *taken,
                                    cloth_error *err)
{
  if (d->cluster_blocks == 0) CLOTH_TRY(ask_device(d, err));
  *taken = fits(d, args);
  if (!*taken) return CLOTH_OK;
  cloth_cluster_launch l;
  cloth_cluster_of(&l, d->cluster_blocks, THREADS, room_bytes(&args->v.hats),
                   d->stream[CLOTH_COMPUTE]);
  CUDA_TRY(err, cudaLaunchKernelEx(&l.config, solve_by_cluster, *args));
  return CLOTH_OK;
}
