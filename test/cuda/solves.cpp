// The CUDA sources of the large solves, run on the CPU: what test_solves.c holds against the CPU's
// own.
#include "cuda_runtime_api.h"

#include <atomic>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <thread>
#include <unistd.h>
#include <vector>

#define CLOTH_CHUNK_A_BLOCK // PTX otherwise; here whole blocks are tiles of chunks
extern "C" {
#include "block_rows.h"  // the groups of the CPU's matrix, but
#undef CLOTH_ROW_VECTORS // a thread that has an element to itself
#include "all.h"
#include "backend.h"
}
#include "contact_pull.cuh"
#define cloth_count_up     count_in_ptx
#define cloth_count_of     look_in_ptx
#define cloth_count_up_far count_far_in_ptx
#define cloth_count_of_far look_far_in_ptx
#include "count.cuh"
#undef cloth_count_up
#undef cloth_count_of
#undef cloth_count_up_far
#undef cloth_count_of_far

// Blocks are more than processors: who waits lets others run, of the own block too.
static void let_others_run()
{
  emulated::yield();
  usleep(20);
}

static void cloth_count_up(unsigned *at) { __atomic_fetch_add(at, 1, __ATOMIC_ACQ_REL); }
static void cloth_count_up_far(unsigned *at) { cloth_count_up(at); }

static unsigned cloth_count_of(const unsigned *at)
{
  unsigned now = __atomic_load_n(at, __ATOMIC_ACQUIRE);
  let_others_run();
  return now;
}
static unsigned cloth_count_of_far(const unsigned *at) { return cloth_count_of(at); }

#include "barrier.cuh"
#include "device.h"
#include "group_sums.cuh"
#include "launch.h"
#include "pcg_part.h"

#define cloth_nanoseconds in_ptx
#include "stopwatch.cuh"
#undef cloth_nanoseconds

static uint64_t cloth_nanoseconds() { return 0; }

// the host's half of these files is not run; where there is CUDA it is there
#define HOST __attribute__((weak)) cloth_status
HOST cloth_cuda_fail(cudaError_t, const char *, const char *, int, cloth_error *)
{
  return CLOTH_INTERNAL;
}

HOST cloth_cuda_scratch(cloth_device *, size_t, void **, cloth_error *) { return CLOTH_INTERNAL; }

HOST cloth_cuda_solve_small(cloth_device *, const cloth_pcg_solve_args *, bool *, cloth_error *)
{
  return CLOTH_INTERNAL;
}

namespace one {
#include "solve.cu"
}

namespace several {
#include "solve_parts.cu"
}

// of one cluster, which is waited for in hardware
struct emulated_cluster {
  static std::atomic<unsigned> arrived;
  static thread_local unsigned passed; // by this block

  static void sync()
  {
    __syncthreads();
    if (threadIdx.x == 0) {
      passed++;
      arrived++;
      while (arrived < passed * gridDim.x) let_others_run();
    }
    __syncthreads();
  }
};
std::atomic<unsigned> emulated_cluster::arrived;
thread_local unsigned emulated_cluster::passed;

#define cloth_cluster_barrier emulated_cluster
#define memory                memory_of_kernel // extern in a function there
#undef __shared__
#define __shared__ thread_local
namespace small {
#include "solve_small.cu"
}
#undef memory

namespace {

struct launch {
  const cloth_pcg_solve_args *args;
  cloth_barrier_state state;
  bool sparse;
};

void kernel_of_one(void *l)
{
  launch *of = static_cast<launch *>(l);
  cloth_grid_barrier g(&of->state);
  if (of->sparse)
    one::solve<one::rows_ahead>(*of->args, g);
  else
    one::solve<one::rows_in_memory>(*of->args, g);
}

void kernel_of_small(void *a)
{
  const cloth_pcg_solve_args &args = *static_cast<const cloth_pcg_solve_args *>(a);
  static thread_local char *room;
  if (threadIdx.x == 0) room = new char[small::room_bytes(&args.v.hats)];
  __syncthreads();
  small::worker w(args, room);
  w.solve();
  w.finish();
  w.write_out();
  __syncthreads();
  if (threadIdx.x == 0) delete[] room;
}

struct sums {
  const cloth_real *partial;
  int chunks, more;
  cloth_real *out;
};

void kernel_of_sums(void *a)
{
  static thread_local cloth_real lanes[2 * CLOTH_PCG_LANES];
  const sums *s = static_cast<const sums *>(a);
  cloth_real sum[2];
  cloth_block_partial_sums(s->partial, s->chunks, s->more, sum, lanes);
  if (threadIdx.x == 0) s->out[0] = sum[0], s->out[1] = sum[1];
}

struct part {
  const cloth_pcg_part_args *args;
  unsigned others;
};

void kernel_of_part(void *p)
{
  const part *of = static_cast<const part *>(p);
  several::part_kernel(*of->args, of->others);
}

} // namespace

extern "C" void emulated_solve(const cloth_pcg_solve_args *args, int blocks, int sparse)
{
  launch l = {args, {0}, sparse != 0};
  std::vector<std::thread> all;
  for (int b = 0; b < blocks; b++)
    all.emplace_back(emulated::run_block, b, blocks, one::THREADS, kernel_of_one, &l);
  for (std::thread &t : all) t.join();
}

// by one cluster
extern "C" void emulated_solve_small(const cloth_pcg_solve_args *args, int blocks)
{
  std::vector<std::thread> all;
  emulated_cluster::arrived = 0;
  for (int b = 0; b < blocks; b++)
    all.emplace_back(emulated::run_block, b, blocks, small::THREADS, kernel_of_small,
                     const_cast<cloth_pcg_solve_args *>(args));
  for (std::thread &t : all) t.join();
}

// the sums of fields 0 and 1 as launches have them
extern "C" void emulated_sums(const cloth_real *partial, int chunks, int more, cloth_real *out)
{
  sums s = {partial, chunks, more, out};
  std::thread(emulated::run_block, 0, 1, CLOTH_PCG_LANES, kernel_of_sums, &s).join();
}

// part i by blocks[i] blocks
extern "C" void emulated_solve_parts(int parts, const cloth_pcg_part_args *args, const int *blocks)
{
  std::vector<std::thread> all;
  std::vector<part> of;
  int sum = 0;
  for (int i = 0; i < parts; i++) sum += blocks[i];
  for (int i = 0; i < parts; i++) of.push_back({&args[i], (unsigned)(sum - blocks[i])});
  for (int i = 0; i < parts; i++)
    for (int b = 0; b < blocks[i]; b++)
      all.emplace_back(emulated::run_block, b, blocks[i], several::THREADS, kernel_of_part, &of[i]);
  for (std::thread &t : all) t.join();
}
