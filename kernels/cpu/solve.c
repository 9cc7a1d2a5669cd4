// A whole linear solve in one parallel region. Launched one by one its loops are so short (an
// iteration of 2,600 vertices takes 40 us) that waking the threads for each would cost more than
// the work. The steps and the order of sums are those of src/solve/pcg.c; kernels/cuda/solve.cu is
// the same on a GPU.
#include "solve.h"

#include "backend.h"
#include "loops.h"
#include "team.h"

#include <omp.h>
#include <stdbool.h>
#include <string.h>

// below this many rows waking a second thread costs more than it saves
enum { SERIAL_ROWS = 256 };

typedef struct worker {
  const cloth_pcg_solve_args *a;
  cloth_team *team;
  int index, threads;
  // Each thread adds the chunk sums up for itself: the same numbers in the same order give the
  // same scalars, and nobody waits for one who does it for all.
  cloth_real scalar[CLOTH_PCG_SCALARS];
  cloth_pcg_vectors v; // with these scalars
} worker;

static void share(const worker *w, cloth_kernel k, int n, const void *args)
{
  int64_t i = w->index, threads = w->threads;
  cloth_loops[k].share((int)(n * i / threads), (int)(n * (i + 1) / threads), args);
}

static int chunks(const worker *w) { return (w->v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK; }

static bool done(const worker *w) { return w->scalar[CLOTH_PCG_DONE] > 0; }

static void wait(const worker *w) { cloth_team_wait(w->team, w->threads); }

// the coarse correction: its right-hand side by each thread for itself, which is quick, the rest
// shared
static void correct(worker *w, cloth_real *sums)
{
  cloth_coarse_rest_args rest = w->a->rest;
  cloth_coarse_solve_args coarse = w->a->coarse;
  rest.rest = sums, rest.done = NULL, coarse.rest = sums, coarse.done = NULL;
  cloth_loops[CLOTH_KERNEL_coarse_rest].share(0, rest.aggregates, &rest);
  share(w, CLOTH_KERNEL_coarse_solve, 3 * coarse.aggregates, &coarse);
  wait(w);
}

// the same with levels of hats: the first from r, the others from the first
static void correct_hats(const worker *w)
{
  cloth_hat_rest_args hats = w->a->hats;
  hats.done = NULL;
  share(w, CLOTH_KERNEL_hat_rest, cloth_hat_fine_groups(&hats.hats), &hats);
  wait(w);
  share(w, CLOTH_KERNEL_hat_rest_upper, cloth_hat_groups(&hats.hats), &hats);
  wait(w);
}

static void spread_hats(const worker *w)
{
  cloth_hat_spread_args spread = {w->v.hats, w->scalar + CLOTH_PCG_DONE};
  share(w, CLOTH_KERNEL_hat_spread, w->v.hats.fine, &spread);
  wait(w);
}

// after r, z and their sums: coarse correction, beta, direction
static void turn(worker *w, int start)
{
  cloth_real sums[3 * CLOTH_AGGREGATES_MAX];
  cloth_pcg_beta_args beta = w->a->beta;
  beta.start = start, beta.rest = sums, beta.scalar = w->scalar;
  cloth_pcg_direction_args direction = {w->v};
  wait(w);
  if (w->v.coarse) correct(w, sums);
  if (w->v.hats.nodes > 0) correct_hats(w);
  cloth_pcg_beta(0, &beta);
  if (done(w)) return;
  if (w->v.hats.nodes > 0) spread_hats(w);
  share(w, CLOTH_KERNEL_pcg_direction, chunks(w), &direction);
  wait(w);
}

static void product(worker *w)
{
  bool timed = w->index == 0 && w->a->product_ns != NULL;
  double begin = timed ? omp_get_wtime() : 0;
  int contacts = cloth_pcg_contacts(w->a);
  if (contacts > 0) {
    share(w, CLOTH_KERNEL_contact_product, contacts, &w->a->contact);
    wait(w);
  }
  cloth_pcg_product_args product = w->a->product;
  product.done = NULL, product.partial = w->a->more_partial;
  share(w, CLOTH_KERNEL_pcg_product, chunks(w), &product);
  wait(w);
  cloth_pcg_alpha_args alpha = {w->v.chunks, product.partial, w->scalar};
  cloth_pcg_alpha(0, &alpha);
  if (timed) *w->a->product_ns += (uint64_t)(1e9 * (omp_get_wtime() - begin));
}

static void solve(worker *w)
{
  cloth_pcg_start_args start = {w->v};
  share(w, CLOTH_KERNEL_pcg_start, chunks(w), &start);
  turn(w, 1);
  for (int n = 0; n < w->a->iterations_max && !done(w); n++) {
    product(w);
    if (done(w)) return;
    cloth_pcg_update_args update = {w->v};
    share(w, CLOTH_KERNEL_pcg_update, chunks(w), &update);
    turn(w, 0);
  }
}

void cloth_cpu_solve(const cloth_pcg_solve_args *args, int threads)
{
  cloth_team team = CLOTH_TEAM_INIT;
#pragma omp parallel num_threads(args->v.count < SERIAL_ROWS ? 1 : threads)
  {
    // perhaps fewer threads than asked for
    worker w = {.a = args,
                .team = &team,
                .index = omp_get_thread_num(),
                .threads = omp_get_num_threads(),
                .v = args->v};
    memcpy(w.scalar, args->v.scalar, sizeof w.scalar);
    w.v.scalar = w.scalar;
    solve(&w); // all wait for each other in it: everyone has read the scalars when it ends
    if (w.index == 0) memcpy(args->v.scalar, w.scalar, sizeof w.scalar);
  }
}
