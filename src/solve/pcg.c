// The linear solve over n parts: kernels/physics/pcg.h holds the arithmetic, this file the order of
// launches and exchanges. Dot products are sums of chunks; every part gets all chunk sums and adds
// them in the same order, so the scalars are the same bits on every part and for every number of
// parts.
#include "coarse_chunk.h"
#include "coarse_factor.h"
#include "coarse_solve.h"
#include "contact_product.h"
#include "correct.h"
#include "pcg_alpha.h"
#include "pcg_beta.h"
#include "pcg_direction.h"
#include "pcg_product.h"
#include "pcg_residual.h"
#include "pcg_start.h"
#include "pcg_update.h"
#include "state/sim.h"

#include <math.h>

static cloth_pcg_vectors vectors(const cloth_sim *sim, const cloth_part *p)
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
                         .scalar = p->scalar};
  return v;
}

static cloth_status exchange_partial(cloth_sim *sim, cloth_error *err)
{
  return cloth_exchange(sim, offsetof(cloth_part, partial), true,
                        CLOTH_PCG_PARTIALS * sizeof(cloth_real), err);
}

// q = A x on every part, with the chunk sums of x'q; x is p or dx, complete on every part
static cloth_status product(cloth_sim *sim, bool of_dx, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_real *x = of_dx ? p->dx : p->p;
    cloth_contact_product_args c = {
        sim->vertex_count, p->contact_vertex, p->contact_weight, p->contact_tangent, x,
        p->contact_q};
    CLOTH_LAUNCH(sim, p, contact_product, p->contact_count, &c, err);
    cloth_pcg_product_args a = {.rows = {p->row_first, p->row_col, p->row_val},
                                .first = p->v0,
                                .count = p->v1 - p->v0,
                                .contact_first = p->contact_count > 0 ? p->contact_first : NULL,
                                .contact_entry = p->contact_entry,
                                .contact_weight = p->contact_weight,
                                .contact_q = p->contact_q,
                                .x = x,
                                .q = p->q,
                                .partial = p->partial};
    CLOTH_LAUNCH(sim, p, pcg_product, cloth_part_chunks(p), &a, err);
  }
  return CLOTH_OK;
}

// the coarse matrix and its factor, from the first linear system of a substep
static cloth_status coarsen(cloth_sim *sim, cloth_error *err)
{
  if (sim->aggregates == 0 || sim->iteration > 0) return CLOTH_OK;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_coarse_chunk_args a = {.rows = {p->row_first, p->row_col, p->row_val},
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
  size_t row = sizeof(cloth_real) * 9 * (size_t)sim->aggregates;
  CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, slice), true, row, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_coarse_factor_args a = {sim->chunks, sim->aggregates, p->slice,
                                  p->lower,    p->upper,        p->usable};
    CLOTH_LAUNCH(sim, p, coarse_factor, 1, &a, err);
  }
  return CLOTH_OK;
}

static cloth_status beta(cloth_sim *sim, int start, cloth_error *err)
{
  CLOTH_TRY(exchange_partial(sim, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_coarse_solve_args c = {sim->chunks, sim->aggregates, p->partial, p->lower, p->upper,
                                 p->usable,   p->coarse_rest,  p->coarse,  p->scalar};
    if (sim->aggregates > 0) CLOTH_LAUNCH(sim, p, coarse_solve, 1, &c, err);
    cloth_pcg_beta_args a = {.chunks = sim->chunks,
                             .start = start,
                             .tolerance = (cloth_real)sim->params.pcg_tolerance,
                             .first = sim->iteration == 0,
                             .partial = p->partial,
                             .scalar = p->scalar};
    CLOTH_LAUNCH(sim, p, pcg_beta, 1, &a, err);
  }
  return CLOTH_OK;
}

static cloth_status direction(cloth_sim *sim, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_pcg_direction_args a = {vectors(sim, &sim->part[i])};
    CLOTH_LAUNCH(sim, &sim->part[i], pcg_direction, cloth_part_chunks(&sim->part[i]), &a, err);
  }
  return cloth_exchange(sim, offsetof(cloth_part, p), false, 3 * sizeof(cloth_real), err);
}

static cloth_status start(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(coarsen(sim, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_pcg_start_args a = {vectors(sim, &sim->part[i])};
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
    cloth_pcg_update_args u = {vectors(sim, p)};
    CLOTH_LAUNCH(sim, p, pcg_update, cloth_part_chunks(p), &u, err);
  }
  CLOTH_TRY(beta(sim, 0, err));
  return direction(sim, err);
}

// the true residual, and the reactions of held rows in r
static cloth_status residual(cloth_sim *sim, double bb, double *relative, cloth_error *err)
{
  CLOTH_TRY(cloth_exchange(sim, offsetof(cloth_part, dx), false, 3 * sizeof(cloth_real), err));
  CLOTH_TRY(product(sim, true, err));
  for (int i = 0; i < sim->part_count; i++) {
    cloth_pcg_residual_args a = {vectors(sim, &sim->part[i])};
    CLOTH_LAUNCH(sim, &sim->part[i], pcg_residual, cloth_part_chunks(&sim->part[i]), &a, err);
  }
  CLOTH_TRY(exchange_partial(sim, err));
  CLOTH_TRY(cloth_staging(sim, CLOTH_PCG_PARTIALS * (size_t)sim->chunks, err));
  CLOTH_TRY(sim->backend->read(sim->part[0].device, sim->host, sim->part[0].partial,
                               sizeof(cloth_real) * CLOTH_PCG_PARTIALS * (size_t)sim->chunks, err));
  double rr = 0;
  for (int c = 0; c < sim->chunks; c++) rr += (double)sim->host[CLOTH_PCG_PARTIALS * c];
  *relative = bb > 0 ? sqrt(rr / bb) : 0;
  return CLOTH_OK;
}

// x += dx on every part; the largest correction
static cloth_status correct(cloth_sim *sim, double *correction, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_correct_args a = {0, sim->vertex_count, p->dx, p->x, p->largest};
    CLOTH_LAUNCH(sim, p, correct, sim->chunks, &a, err);
  }
  CLOTH_TRY(sim->backend->read(sim->part[0].device, sim->host, sim->part[0].largest,
                               sizeof(cloth_real) * (size_t)sim->chunks, err));
  *correction = 0;
  for (int c = 0; c < sim->chunks; c++)
    if (!((double)sim->host[c] <= *correction)) *correction = (double)sim->host[c];
  return CLOTH_OK;
}

cloth_status cloth_pcg(cloth_sim *sim, double *correction, cloth_error *err)
{
  cloth_real scalar[CLOTH_PCG_SCALARS];
  CLOTH_TRY(start(sim, err));
  for (int k = 0; k < sim->params.pcg_iterations_max; k++) {
    CLOTH_TRY(
        sim->backend->read(sim->part[0].device, scalar, sim->part[0].scalar, sizeof scalar, err));
    if (scalar[CLOTH_PCG_DONE] > 0) break;
    CLOTH_TRY(iterate(sim, err));
  }
  CLOTH_TRY(
      sim->backend->read(sim->part[0].device, scalar, sim->part[0].scalar, sizeof scalar, err));
  double relative;
  CLOTH_TRY(residual(sim, (double)scalar[CLOTH_PCG_BB], &relative, err));

  cloth_step_report *report = sim->report;
  report->newton_iterations++;
  report->pcg_iterations += (int)scalar[CLOTH_PCG_ITERATIONS];
  report->pcg_unconverged += !(scalar[CLOTH_PCG_DONE] > 0);
  if (!(relative <= report->pcg_residual)) report->pcg_residual = relative;
  return correct(sim, correction, err);
}
