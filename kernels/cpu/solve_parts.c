// The protocol of kernels/physics/pcg_part.h where parts are arrays of one process. A part runs
// from one wait to the next in one go; then any part whose signals have come may be next.
#include "solve_parts.h"

#include "loops.h"

#include <omp.h>

typedef enum phase { START, FINE, TURN, INNER, OUTER, UPDATE, ENDED } phase;

typedef struct machine {
  const cloth_pcg_part_args *a;
  phase next;
  int iteration, threads;
} machine;

static void run(const machine *m, cloth_kernel k, int n, const void *args)
{
  if (n > 0) cloth_loops[k].run(n, m->threads, args);
}

static int chunks_of(const machine *m)
{
  return (m->a->solve.v.count + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
}

// ---- signals ------------------------------------------------------------------------------------

static void signal(const machine *m, int number)
{
  for (int j = 0; j < m->a->parts; j++) m->a->peer[j].flag[m->a->me * CLOTH_FLAG_STRIDE] = number;
}

static bool have(const machine *m, int number)
{
  const int *flag = m->a->peer[m->a->me].flag;
  for (int j = 0; j < m->a->parts; j++)
    if (flag[j * CLOTH_FLAG_STRIDE] < number) return false;
  return true;
}

static bool may_run(const machine *m)
{
  int k = m->iteration;
  switch (m->next) {
  case FINE:
    return have(m, CLOTH_START_SIGNAL);
  case TURN:
    return have(m, cloth_residuals_signal(k));
  case INNER:
    return m->a->overlap || have(m, cloth_directions_signal(k));
  case OUTER:
    return have(m, cloth_directions_signal(k));
  case UPDATE:
    return have(m, cloth_products_signal(k));
  case START:
    return true;
  default:
    return false;
  }
}

// ---- what is sent -------------------------------------------------------------------------------

// r at the start, else q, of rows that others' nodes sum over
static void send_to_nodes(const machine *m, bool start)
{
  for (int row = 0; row < m->a->solve.v.count; row++) cloth_hat_row_send(m->a, row, start);
}

// a group's sum of a field of `partial`
static cloth_real term_of(const cloth_pcg_vectors *v, int field, int group)
{
  return cloth_group_sum(v->partial + field, v->chunks, CLOTH_PCG_PARTIALS, group);
}

// the sums of r of the part's chunks
static void send_residuals(const machine *m)
{
  const cloth_pcg_vectors *v = &m->a->solve.v;
  int begin = v->first / CLOTH_CHUNK, end = begin + chunks_of(m);
  for (int i = cloth_own_groups_begin(v); i < cloth_own_groups_end(v); i++)
    cloth_residual_terms_send(m->a, i, term_of(v, 0, i), term_of(v, 1, i));
  for (int j = 0; j < m->a->parts && v->coarse; j++)
    for (int c = begin; j != m->a->me && c < end; c++)
      for (int f = 2; f < CLOTH_PCG_PARTIALS; f++) {
        size_t at = (size_t)c * CLOTH_PCG_PARTIALS + (size_t)f;
        m->a->peer[j].partial[at] = v->partial[at];
      }
  signal(m, cloth_residuals_signal(m->iteration));
}

static void send_directions(const machine *m)
{
  for (int i = 0; i < chunks_of(m); i++) {
    if (!cloth_chunk_readers(m->a, i)) continue;
    for (int row = i * CLOTH_CHUNK, end = cloth_chunk_end(0, m->a->solve.v.count, i); row < end;
         row++)
      cloth_direction_send(m->a, row);
  }
  signal(m, cloth_directions_signal(m->iteration));
}

// the sums of p'q of the part's chunks, which the product left in `partial`
static void send_products(const machine *m)
{
  const cloth_pcg_vectors *v = &m->a->solve.v;
  send_to_nodes(m, false);
  for (int i = cloth_own_groups_begin(v); i < cloth_own_groups_end(v); i++)
    cloth_product_term_send(m->a, i, term_of(v, 0, i));
  signal(m, cloth_products_signal(m->iteration));
}

// ---- phases -------------------------------------------------------------------------------------

static void multiply(const machine *m, bool outer)
{
  const cloth_pcg_solve_args *s = &m->a->solve;
  int inner = chunks_of(m) - (int)m->a->outer[0];
  double start = s->product_ns ? omp_get_wtime() : 0;
  for (int i = 0; i < s->contacts; i++)
    if (cloth_contact_is_outer(m->a, i) == outer) cloth_contact_product(i, &s->contact);
  int begin = outer ? inner : 0, end = outer ? chunks_of(m) : inner;
  for (int k = begin; k < end; k++) cloth_pcg_product((int)m->a->order[k], &s->product);
  if (s->product_ns) *s->product_ns += (uint64_t)(1e9 * (omp_get_wtime() - start));
}

static bool has_hats(const machine *m) { return m->a->solve.v.hats.nodes > 0; }

// own nodes of the hats' first level, and all that others know after the residuals
static phase fine(const machine *m)
{
  const cloth_hat_share *s = &m->a->share;
  cloth_hat_rest_args hats = m->a->solve.hats;
  hats.done = NULL;
  for (int i = cloth_hat_share_begin(s); has_hats(m) && i < cloth_hat_share_end(s); i++) {
    cloth_hat_rest(i, &hats);
    cloth_hat_group_send(m->a, i, hats.partial[(size_t)i * CLOTH_PCG_PARTIALS]);
  }
  for (int c = s->begin; has_hats(m) && c < s->end; c++) cloth_hat_node_send(m->a, c);
  send_residuals(m);
  return TURN;
}

static void spread(const machine *m)
{
  const cloth_hats *h = &m->a->solve.v.hats;
  for (int c = 0; has_hats(m) && c < h->fine; c++)
    if (cloth_hat_is_mine(m->a, c)) cloth_hat_spread_node(c, h);
}

// beta from the terms, of which those of the hats' other levels are the part's own
static void set_beta(const machine *m)
{
  const cloth_pcg_solve_args *s = &m->a->solve;
  const cloth_hats *h = &s->v.hats;
  int groups = cloth_chunk_groups(s->v.chunks), fine_groups = cloth_hat_fine_groups(h);
  cloth_real *rz_of = s->terms.rz + groups;
  for (int i = fine_groups; has_hats(m) && i < s->beta.more; i++)
    rz_of[i] = s->hats.partial[(size_t)i * CLOTH_PCG_PARTIALS];
  cloth_real rz = cloth_terms_sum(s->terms.rz, groups + s->beta.more);
  if (s->v.coarse) rz += cloth_coarse_rz(s->beta.rest, s->beta.coarse, s->v.aggregates);
  cloth_pcg_beta_args beta = s->beta;
  beta.start = m->iteration == 0;
  cloth_pcg_beta_set(&beta, rz, cloth_terms_sum(s->terms.rr, groups));
}

// what is left after the residuals: coarse correction, beta, direction
static phase turn(const machine *m)
{
  const cloth_pcg_solve_args *s = &m->a->solve;
  cloth_pcg_direction_args direction = {s->v};
  cloth_coarse_rest_args rest = s->rest;
  cloth_coarse_solve_args coarse = s->coarse;
  cloth_hat_rest_args hats = s->hats;
  hats.done = NULL;
  if (m->iteration == 0) rest.done = coarse.done = NULL; // it is still that of the solve before
  if (s->v.coarse) {
    run(m, CLOTH_KERNEL_coarse_rest, s->v.aggregates, &rest);
    run(m, CLOTH_KERNEL_coarse_solve, 3 * s->v.aggregates, &coarse);
  }
  if (has_hats(m)) run(m, CLOTH_KERNEL_hat_rest_upper, cloth_hat_groups(&hats.hats), &hats);
  set_beta(m);
  if (s->v.scalar[CLOTH_PCG_DONE] > 0 || m->iteration == s->iterations_max) return ENDED;
  spread(m);
  run(m, CLOTH_KERNEL_pcg_direction, chunks_of(m), &direction);
  send_directions(m);
  return INNER;
}

static phase update(machine *m)
{
  const cloth_pcg_solve_args *s = &m->a->solve;
  cloth_pcg_update_args u = {s->v};
  int groups = cloth_chunk_groups(s->v.chunks);
  cloth_pcg_alpha_set(s->v.scalar, cloth_terms_sum(s->terms.pq, groups));
  if (s->v.scalar[CLOTH_PCG_DONE] > 0) return ENDED;
  run(m, CLOTH_KERNEL_pcg_update, chunks_of(m), &u);
  for (int i = 0; i < m->a->share.other_count; i++)
    cloth_hat_row_update(m->a, i, s->v.scalar[CLOTH_PCG_ALPHA]);
  m->iteration++;
  return fine(m);
}

static phase go_on(machine *m)
{
  cloth_pcg_start_args start = {m->a->solve.v};
  switch (m->next) {
  case START:
    run(m, CLOTH_KERNEL_pcg_start, chunks_of(m), &start);
    send_to_nodes(m, true);
    signal(m, CLOTH_START_SIGNAL);
    return has_hats(m) ? FINE : fine(m);
  case FINE:
    return fine(m);
  case TURN:
    return turn(m);
  case INNER:
    multiply(m, false);
    return OUTER;
  case OUTER:
    multiply(m, true);
    send_products(m);
    return UPDATE;
  case UPDATE:
    return update(m);
  default:
    return ENDED;
  }
}

// ---- whose turn it is ---------------------------------------------------------------------------

// the part that goes on; -1: none can
static int choose(const machine *m, int parts, int stopped, unsigned *dice)
{
  *dice = *dice * 1664525u + 1013904223u;
  for (int k = 0; k < parts; k++) {
    int i = (int)((*dice >> 16) + (unsigned)k) % parts;
    if (i != stopped && may_run(&m[i])) return i;
  }
  return -1;
}

cloth_status cloth_cpu_solve_parts(int parts, const cloth_pcg_part_args *args, int threads,
                                   unsigned seed, int stopped, cloth_error *err)
{
  machine m[CLOTH_PARTS_MAX];
  int left = parts;
  for (int i = 0; i < parts; i++) m[i] = (machine){.a = &args[i], .threads = threads};
  while (left > 0) {
    int i = choose(m, parts, stopped, &seed);
    if (i < 0)
      CLOTH_FAIL(err, CLOTH_DEVICE_LOST, "%d of %d parts wait for each other", left, parts);
    m[i].next = go_on(&m[i]);
    left -= m[i].next == ENDED;
  }
  return CLOTH_OK;
}
