// The linear solve over n parts: kernels/physics/pcg.h holds the arithmetic, this file the order of
// launches and exchanges. Dot products are sums of chunks; every part gets all chunk sums and adds
// them in the same order, so the scalars are the same bits on every part and for every number of
// parts.
#include "coarse_chunk.h"
#include "coarse_factor.h"
#include "coarse_inverse.h"
#include "coarse_rest.h"
#include "coarse_solve.h"
#include "coarse_sum.h"
#include "contact/contact.h"
#include "contact/friction.h"
#include "contact_product.h"
#include "correct.h"
#include "pcg_alpha.h"
#include "pcg_beta.h"
#include "pcg_direction.h"
#include "pcg_finish.h"
#include "pcg_part.h"
#include "pcg_product.h"
#include "pcg_residual.h"
#include "pcg_start.h"
#include "pcg_update.h"
#include "solve/hats.h"
#include "solve/solve.h"
#include "state/recut.h"

#include <math.h>

// In float and cloth of a million times its inertia, rounding may have the iteration break down, or
// believe in a residual that is not the true one. A solve has failed that says it converged with a
// true residual above this share of the right-hand side.
#define FAILED_RESIDUAL 0.1

cloth_pcg_vectors cloth_solve_vectors(const cloth_sim *sim, const cloth_part *p)
{
  cloth_pcg_vectors v = {.first = p->v0,
                         .count = p->v1 - p->v0,
                         .free = p->free,
                         .inverse_diagonal = p->inverse_diagonal,
                         .b = p->b,
                         .dx = p->dx,
                         .r = p->r,
                         .z = p->z,
                         .p = p->p,
                         .q = p->q,
                         .partial = p->partial,
                         .coarse = sim->aggregates > 0 ? p->coarse : NULL,
                         .aggregates = sim->aggregates,
                         .chunks = sim->chunks,
                         .hats = p->hats,
                         .scalar = p->scalar};
  return v;
}

static cloth_status exchange_partial(cloth_sim *sim, cloth_error *err)
{
  return cloth_exchange(sim, offsetof(cloth_part, partial), CLOTH_PER_CHUNK,
                        CLOTH_PCG_PARTIALS * sizeof(cloth_real), err);
}

static const cloth_real *done_flag(const cloth_part *p) { return p->scalar + CLOTH_PCG_DONE; }

static cloth_contact_product_args contact_args(const cloth_sim *sim, const cloth_part *p,
                                               const cloth_real *x)
{
  cloth_contact_product_args a = {.cloth_vertices = sim->vertex_count,
                                  .body_first = cloth_contact_body_first(sim),
                                  .vertex = p->contact_vertex,
                                  .weight = p->contact_weight,
                                  .tangent = p->contact_tangent,
                                  .p = x,
                                  .place = p->contact_place,
                                  .entry = p->contact_entry,
                                  .q = p->contact_q};
  return a;
}

static cloth_pcg_product_args product_args(const cloth_part *p, const cloth_real *x,
                                           const cloth_real *done)
{
  cloth_pcg_product_args a = {.rows = {p->row_first, p->row_col, p->row_val, p->row_widest},
                              .first = p->v0,
                              .count = p->v1 - p->v0,
                              .contact_first = p->contact_count > 0 ? p->contact_first : NULL,
                              .contact_q = p->contact_q,
                              .x = x,
                              .q = p->q,
                              .partial = p->partial,
                              .done = done};
  return a;
}

static cloth_coarse_rest_args rest_args(const cloth_sim *sim, const cloth_part *p,
                                        const cloth_real *done)
{
  cloth_coarse_rest_args a = {sim->chunks, sim->aggregates, p->partial, done, p->coarse_rest};
  return a;
}

static cloth_coarse_solve_args coarse_args(const cloth_sim *sim, const cloth_part *p,
                                           const cloth_real *done)
{
  cloth_coarse_solve_args a = {sim->aggregates, p->inverse, p->usable,
                               p->coarse_rest,  done,       p->coarse};
  return a;
}

static cloth_pcg_beta_args beta_args(const cloth_sim *sim, const cloth_part *p, int start)
{
  cloth_pcg_beta_args a = {.chunks = sim->chunks,
                           .more = sim->hat_groups,
                           .start = start,
                           .tolerance = (cloth_real)sim->asked.tolerance,
                           .first = sim->asked.first,
                           .partial = p->partial,
                           .aggregates = sim->aggregates,
                           .rest = p->coarse_rest,
                           .coarse = p->coarse,
                           .scalar = p->scalar};
  return a;
}

// q = A x on every part, with the chunk sums of x'q; x is p or dx, complete on every part
static cloth_status product(cloth_sim *sim, bool of_dx, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    const cloth_real *x = of_dx ? p->dx : p->p;
    cloth_contact_product_args c = contact_args(sim, p, x);
    CLOTH_LAUNCH(sim, p, contact_product, p->contact_count, &c, err);
    cloth_pcg_product_args a = product_args(p, x, of_dx ? NULL : done_flag(p));
    CLOTH_LAUNCH(sim, p, pcg_product, cloth_part_chunks(p), &a, err);
  }
  return CLOTH_OK;
}

// the aggregate that begins with this vertex, where a part does
static int aggregate_at(const cloth_sim *sim, int vertex)
{
  int chunk = (vertex + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
  return cloth_aggregate_from(chunk, sim->chunks, sim->aggregates);
}

// what the coarser levels need, from the first linear system of a substep
static cloth_status coarsen(cloth_sim *sim, cloth_error *err)
{
  if (sim->hat_groups > 0 && sim->iteration == 0) return cloth_hats_update(sim, err);
  if (sim->aggregates == 0 || sim->iteration > 0) return CLOTH_OK;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_coarse_chunk_args a = {.rows = {p->row_first, p->row_col, p->row_val, p->row_widest},
                                 .first = p->v0,
                                 .count = p->v1 - p->v0,
                                 .cloth_vertices = sim->vertex_count,
                                 .chunks = sim->chunks,
                                 .aggregates = sim->aggregates,
                                 .free = p->free,
                                 .contact_first = p->contact_count > 0 ? p->contact_first : NULL,
                                 .contact_entry = p->contact_entry,
                                 .contact_vertex = p->contact_vertex,
                                 .contact_weight = p->contact_weight,
                                 .contact_tangent = p->contact_tangent,
                                 .slice = p->slice};
    CLOTH_LAUNCH(sim, p, coarse_chunk, cloth_part_chunks(p), &a, err);
  }
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    int first = aggregate_at(sim, p->v0), end = aggregate_at(sim, p->v1);
    cloth_coarse_sum_args m = {sim->chunks, sim->aggregates, first, p->slice, p->factor};
    CLOTH_LAUNCH(sim, p, coarse_sum, end - first, &m, err);
  }
  size_t row = sizeof(cloth_real) * 9 * (size_t)sim->aggregates; // three columns
  CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, factor), CLOTH_PER_AGGREGATE, row, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_coarse_factor_args f = {sim->aggregates, p->factor, p->usable};
    CLOTH_LAUNCH(sim, p, coarse_factor, 1, &f, err);
    cloth_coarse_inverse_args a = {sim->aggregates, p->factor, p->usable, p->inverse};
    CLOTH_LAUNCH(sim, p, coarse_inverse, 3 * sim->aggregates, &a, err);
  }
  return CLOTH_OK;
}

static cloth_status beta(cloth_sim *sim, int start, cloth_error *err)
{
  CLOTH_TRY(exchange_partial(sim, err));
  if (sim->hat_groups > 0) CLOTH_TRY(cloth_hats_correct(sim, start, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    const cloth_real *done = start ? NULL : done_flag(p);
    cloth_coarse_rest_args r = rest_args(sim, p, done);
    CLOTH_LAUNCH(sim, p, coarse_rest, sim->aggregates, &r, err);
    cloth_coarse_solve_args c = coarse_args(sim, p, done);
    CLOTH_LAUNCH(sim, p, coarse_solve, 3 * sim->aggregates, &c, err);
    cloth_pcg_beta_args a = beta_args(sim, p, start);
    CLOTH_LAUNCH(sim, p, pcg_beta, 1, &a, err);
  }
  return CLOTH_OK;
}

static cloth_status direction(cloth_sim *sim, cloth_error *err)
{
  if (sim->hat_groups > 0) CLOTH_TRY(cloth_hats_spread(sim, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_pcg_direction_args a = {cloth_solve_vectors(sim, &sim->part[i])};
    CLOTH_LAUNCH(sim, &sim->part[i], pcg_direction, cloth_part_chunks(&sim->part[i]), &a, err);
  }
  return cloth_exchange(sim, offsetof(cloth_part, p), CLOTH_PER_VERTEX, 3 * sizeof(cloth_real),
                        err);
}

static cloth_status start(cloth_sim *sim, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_pcg_start_args a = {cloth_solve_vectors(sim, &sim->part[i])};
    CLOTH_LAUNCH(sim, &sim->part[i], pcg_start, cloth_part_chunks(&sim->part[i]), &a, err);
  }
  CLOTH_TRY(beta(sim, 1, err));
  return direction(sim, err);
}

static cloth_status iterate(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(product(sim, false, err));
  CLOTH_TRY(exchange_partial(sim, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_pcg_alpha_args a = {sim->chunks, p->partial, p->scalar};
    CLOTH_LAUNCH(sim, p, pcg_alpha, 1, &a, err);
    cloth_pcg_update_args u = {cloth_solve_vectors(sim, p)};
    CLOTH_LAUNCH(sim, p, pcg_update, cloth_part_chunks(p), &u, err);
  }
  CLOTH_TRY(beta(sim, 0, err));
  return direction(sim, err);
}

// the true residual, and the reactions of held rows in r
static cloth_status residual(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(
      cloth_exchange(sim, offsetof(cloth_part, dx), CLOTH_PER_VERTEX, 3 * sizeof(cloth_real), err));
  CLOTH_TRY(product(sim, true, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_pcg_residual_args a = {cloth_solve_vectors(sim, &sim->part[i])};
    CLOTH_LAUNCH(sim, &sim->part[i], pcg_residual, cloth_part_chunks(&sim->part[i]), &a, err);
  }
  return exchange_partial(sim, err);
}

static cloth_correct_args correct_args(const cloth_sim *sim, const cloth_part *p)
{
  return (cloth_correct_args){0, sim->vertex_count, p->dx, p->x, p->largest};
}

// x += dx on every part, and the numbers that the host asks for
static cloth_status correct(cloth_sim *sim, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_correct_args a = correct_args(sim, p);
    CLOTH_LAUNCH(sim, p, correct, sim->chunks, &a, err);
  }
  cloth_part *p = &sim->part[0];
  cloth_pcg_finish_args f = {sim->chunks, p->partial, p->largest, p->scalar};
  return cloth_launch(sim, p, CLOTH_KERNEL_pcg_finish, 1, &f, err);
}

static cloth_status read_scalars(cloth_sim *sim, cloth_real scalar[CLOTH_PCG_SCALARS],
                                 cloth_error *err)
{
  return sim->backend->read(sim->part[0].device, scalar, sim->part[0].scalar,
                            sizeof(cloth_real) * CLOTH_PCG_SCALARS, err);
}

// Launch by launch. The host looks at the flag after batches; iterations past the end change
// nothing.
static cloth_status iterate_all(cloth_sim *sim, cloth_error *err)
{
  int most = sim->asked.iterations_max, batch = sim->backend->run_ahead;
  CLOTH_TRY(start(sim, err));
  for (int k = 0; k < most;) {
    cloth_real scalar[CLOTH_PCG_SCALARS];
    CLOTH_TRY(read_scalars(sim, scalar, err));
    if (scalar[CLOTH_PCG_DONE] > 0) break;
    for (int end = most - k < batch ? most : k + batch; k < end; k++) CLOTH_TRY(iterate(sim, err));
  }
  return CLOTH_OK;
}

static cloth_pcg_solve_args solve_args(const cloth_sim *sim, const cloth_part *p)
{
  const cloth_real *done = done_flag(p);
  size_t sums = (size_t)(sim->chunks + sim->hat_groups);
  cloth_pcg_solve_args a = {.v = cloth_solve_vectors(sim, p),
                            .contact = contact_args(sim, p, p->p),
                            .contacts = p->contact_count,
                            .factored = cloth_contact_factored(p),
                            .product = product_args(p, p->p, done),
                            .rest = rest_args(sim, p, done),
                            .coarse = coarse_args(sim, p, done),
                            .hats = cloth_hats_args(sim, p, done),
                            .beta = beta_args(sim, p, 1),
                            .more_partial = p->partial + CLOTH_PCG_PARTIALS * sums,
                            .terms = cloth_pcg_terms_at(p->terms, sim->chunks),
                            .iterations_max = sim->asked.iterations_max,
                            .product_ns = sim->params.profile > 0 ? p->product_ns : NULL,
                            .correct = correct_args(sim, p)};
  return a;
}

// The same in one call, where the backend can and there is nothing to exchange.
static cloth_status solve_at_once(cloth_sim *sim, bool *finished, cloth_error *err)
{
  cloth_pcg_solve_args a = solve_args(sim, &sim->part[0]);
  sim->launches++;
  return sim->backend->solve(sim->part[0].device, &a, finished, err);
}

static cloth_pcg_part_args part_args(const cloth_sim *sim, const cloth_part *p)
{
  cloth_pcg_part_args a = {.solve = solve_args(sim, p),
                           .parts = sim->part_count,
                           .me = p->index,
                           .whole = sim->params.exchange == CLOTH_EXCHANGE_WHOLE,
                           .overlap = sim->params.overlap,
                           .reader = p->reader,
                           .chunk_reader = p->chunk_reader,
                           .order = p->halo_order,
                           .outer = p->halo_outer,
                           .share = p->hat_share};
  for (int j = 0; j < sim->part_count; j++) {
    const cloth_part *o = &sim->part[j];
    a.peer[j] = (cloth_pcg_peer){.p = o->p,
                                 .partial = o->partial,
                                 .terms = cloth_pcg_terms_at(o->terms, sim->chunks),
                                 .r = o->r,
                                 .q = o->q,
                                 .hat_rest = o->hats.rest,
                                 .hat_correction = o->hats.correction,
                                 .flag = o->flag};
  }
  return a;
}

// The same by all parts at once, in each other's memory. All must be through with that before.
static cloth_status solve_together(cloth_sim *sim, cloth_error *err)
{
  cloth_pcg_part_args a[CLOTH_PARTS_MAX];
  cloth_device *device[CLOTH_PARTS_MAX];
  CLOTH_TRY(cloth_halo_update(sim, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(sim->backend->fill(p->device, p->flag, 0, sizeof(int) * CLOTH_FLAG_WORDS, err));
    a[i] = part_args(sim, p), device[i] = p->device;
  }
  CLOTH_TRY(cloth_meet(sim, err));
  sim->launches += sim->part_count;
  return sim->backend->solve_parts(sim->part_count, device, a, err);
}

// of the first part, with `profile`
static cloth_status read_product_time(cloth_sim *sim, cloth_error *err)
{
  cloth_part *p = &sim->part[0];
  uint64_t ns;
  CLOTH_TRY(sim->backend->read(p->device, &ns, p->product_ns, sizeof ns, err));
  sim->report->product_ms += 1e-6 * (double)ns;
  return sim->backend->fill(p->device, p->product_ns, 0, sizeof ns, err);
}

cloth_status cloth_solve(cloth_sim *sim, cloth_real scalar[CLOTH_PCG_SCALARS], cloth_error *err)
{
  bool finished = false;
  if (sim->part_count == 1 && sim->backend->solve != NULL)
    CLOTH_TRY(solve_at_once(sim, &finished, err));
  else if (sim->joined)
    CLOTH_TRY(solve_together(sim, err));
  else
    CLOTH_TRY(iterate_all(sim, err));
  if (sim->params.profile > 0) CLOTH_TRY(read_product_time(sim, err));
  if (!finished) {
    CLOTH_TRY(residual(sim, err));
    CLOTH_TRY(correct(sim, err));
  }
  CLOTH_TRY(cloth_friction_look(sim, err));
  CLOTH_TRY(read_scalars(sim, scalar, err));
  if (scalar[CLOTH_PCG_LOST] > 0)
    CLOTH_FAIL(err, CLOTH_DEVICE_LOST, "a device did not answer the others within a solve");
  int iterations = (int)scalar[CLOTH_PCG_ITERATIONS];
  sim->report->pcg_iterations += iterations;
  for (int i = 0; i < sim->part_count; i++) cloth_work_solve(sim, &sim->part[i], iterations);
  return CLOTH_OK;
}

static double relative_of(const cloth_real scalar[CLOTH_PCG_SCALARS])
{
  double bb = (double)scalar[CLOTH_PCG_BB], rr = (double)scalar[CLOTH_PCG_RESIDUAL];
  return bb <= 0 ? 0 : sqrt(rr / bb); // not a number: no solution either
}

bool cloth_solve_failed(const cloth_sim *sim, const cloth_real scalar[CLOTH_PCG_SCALARS])
{
  return scalar[CLOTH_PCG_DONE] > 0 &&
         !(relative_of(scalar) <= fmax(FAILED_RESIDUAL, 10 * sim->params.pcg_tolerance));
}

cloth_status cloth_pcg(cloth_sim *sim, double *correction, cloth_error *err)
{
  cloth_real scalar[CLOTH_PCG_SCALARS];
  sim->asked = (cloth_asked){.tolerance = sim->params.pcg_tolerance,
                             .iterations_max = sim->params.pcg_iterations_max,
                             .first = sim->iteration == sim->iteration_first,
                             .last = sim->iteration == sim->iteration_last};
  CLOTH_TRY(coarsen(sim, err));
  CLOTH_TRY(cloth_solve(sim, scalar, err));
  *correction = (double)scalar[CLOTH_PCG_LARGEST];
  bool done = scalar[CLOTH_PCG_DONE] > 0, worse;
  CLOTH_TRY(cloth_solve_refine(sim, scalar, correction, &worse, err));

  double relative = relative_of(scalar);
  cloth_step_report *report = sim->report;
  report->newton_iterations++;
  sim->solve_failed = worse || cloth_solve_failed(sim, scalar);
  report->pcg_unconverged += !done || sim->solve_failed;
  if (!(relative <= report->pcg_residual)) report->pcg_residual = relative;
  return CLOTH_OK;
}
