// Threads of a block as fibers of one thread of the host. They are started by ucontext, and change
// places without a system call.
#include "cuda_runtime_api.h"

#include <setjmp.h>
#include <stdlib.h>
#include <ucontext.h>

thread_local dim3 threadIdx, blockIdx, blockDim, gridDim;

namespace {

enum { THREADS_MAX = 256, WARP = 32, STACK = 64 * 1024 };

struct meeting { // of those who are not through
  unsigned arrived, passed;
};

struct block {
  unsigned threads, left, now;
  bool ended[THREADS_MAX];
  unsigned left_of_warp[THREADS_MAX / WARP];
  jmp_buf at[THREADS_MAX], home;
  ucontext_t start[THREADS_MAX], starter;
  char *stacks;
  void (*kernel)(void *);
  void *args;
  meeting all, warp[THREADS_MAX / WARP];
  uint64_t slot[THREADS_MAX];
};

thread_local block *here;

void go_to(unsigned thread)
{
  here->now = threadIdx.x = thread;
  _longjmp(here->at[thread], 1);
}

unsigned next_thread()
{
  unsigned k = here->now;
  do k = (k + 1) % here->threads;
  while (here->ended[k]);
  return k;
}

void fiber()
{
  unsigned me = here->now;
  if (!_setjmp(here->at[me])) swapcontext(&here->start[me], &here->starter);
  here->kernel(here->args);
  here->ended[me] = true, here->left--, here->left_of_warp[me / WARP]--;
  if (here->left == 0) _longjmp(here->home, 1);
  go_to(next_thread());
}

void meet(meeting *m, unsigned of)
{
  unsigned turn = m->passed;
  if (++m->arrived == of)
    m->arrived = 0, m->passed++;
  else
    while (m->passed == turn) emulated::yield();
}

} // namespace

void emulated::yield()
{
  if (!_setjmp(here->at[here->now])) go_to(next_thread());
}

void emulated::meet_block() { meet(&here->all, here->left); }

void emulated::meet_warp()
{
  unsigned w = here->now / WARP;
  meet(&here->warp[w], here->left_of_warp[w]);
}

uint64_t *emulated::lane_slot(unsigned lane) { return &here->slot[here->now / WARP * WARP + lane]; }

void emulated::run_block(unsigned index, unsigned blocks, unsigned threads, void (*kernel)(void *),
                         void *args)
{
  block *b = static_cast<block *>(calloc(1, sizeof *b));
  here = b;
  b->threads = b->left = threads, b->kernel = kernel, b->args = args;
  b->stacks = static_cast<char *>(malloc((size_t)threads * STACK));
  blockIdx = dim3(index), gridDim = dim3(blocks), blockDim = dim3(threads);
  for (unsigned k = 0; k < threads; k++) {
    b->left_of_warp[k / WARP]++;
    getcontext(&b->start[k]);
    b->start[k].uc_stack.ss_sp = b->stacks + (size_t)k * STACK;
    b->start[k].uc_stack.ss_size = STACK;
    makecontext(&b->start[k], fiber, 0);
    b->now = threadIdx.x = k;
    swapcontext(&b->starter, &b->start[k]);
  }
  if (!_setjmp(b->home)) go_to(0);
  free(b->stacks), free(b);
}
