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
#include "device.h"
#include "group_sums.cuh"
#include "launch.h"
#include "pcg_part.h"
#include "together.cuh"

#define cloth_nanoseconds in_ptx
#include "stopwatch.cuh"
#undef cloth_nanoseconds

// Blocks are more than processors: who waits lets others run.
static void let_others_run() { usleep(20); }

// who waits asks for the time
static uint64_t cloth_nanoseconds()
{
  let_others_run();
  return 0;
}

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

#define cloth_together_cluster emulated_cluster
#define memory                 memory_of_kernel // extern in a function there
#undef __shared__
#define __shared__ thread_local
namespace small {
#include "solve_small.cu"
}
#undef memory

namespace {

// as cloth_together_grid
struct grid {
  std::atomic<unsigned> *arrived;
  unsigned barriers;

  void arrive()
  {
    barriers++;
    __syncthreads();
    if (threadIdx.x == 0) arrived->fetch_add(1);
  }

  void wait()
  {
    while (threadIdx.x == 0 && arrived->load() < barriers * gridDim.x) let_others_run();
    __syncthreads();
  }

  void sync() { arrive(), wait(); }
};

struct launch {
  const cloth_pcg_solve_args *args;
  std::atomic<unsigned> arrived;
  bool sparse;
};

void kernel_of_one(void *l)
{
  launch *of = static_cast<launch *>(l);
  grid g = {&of->arrived, 0};
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

void kernel_of_part(void *a) { several::part_kernel(*static_cast<const cloth_pcg_part_args *>(a)); }

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
  for (int i = 0; i < parts; i++)
    for (int b = 0; b < blocks[i]; b++)
      all.emplace_back(emulated::run_block, b, blocks[i], several::THREADS, kernel_of_part,
                       const_cast<cloth_pcg_part_args *>(&args[i]));
  for (std::thread &t : all) t.join();
}
