// Iterative refinement: where the true residual of a linear solve is too long (pcg_residual.h says
// how it is a length), the same system is solved for it. (Wilkinson 1963, Rounding errors in
// algebraic processes.)
#include "effect/effect.h"
#include "solve/solve.h"

#include <math.h>

// Where cloth may touch, no solve leaves a vertex farther from its place than ABOVE of the
// thickness: two that meet then have half of the room between them. Otherwise contacts close that
// are none, raise the residual that the next tolerance is relative to, and so on. Refined to AIM of
// that, in at most so many iterations more.
#define ABOVE 0.25
#define AIM   0.5
enum { FURTHER_ITERATIONS = 500 };

static bool touches(const cloth_sim *sim)
{
  return sim->active[CLOTH_EFFECT_self_contact] || sim->active[CLOTH_EFFECT_body_contact];
}

// Solve for what is left, to `share` of it. It is measured against what the solve before was, so
// that the next ones find that.
static cloth_status solve_rest(cloth_sim *sim, cloth_real scalar[CLOTH_PCG_SCALARS], double share,
                               cloth_error *err)
{
  double rr = (double)scalar[CLOTH_PCG_RESIDUAL] / (double)scalar[CLOTH_PCG_BB];
  double rz = (double)scalar[CLOTH_PCG_RZ] / (double)scalar[CLOTH_PCG_RZ_FIRST];
  sim->asked.tolerance = share * sqrt(fmin(rr, rz));
  sim->asked.first = false;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    size_t at = 3 * (size_t)p->v0, bytes = sizeof(cloth_real) * 3 * (size_t)(p->v1 - p->v0);
    CLOTH_TRY(cloth_copy_local(sim, p, p->b + at, p->r + at, bytes, err));
  }
  return cloth_solve(sim, scalar, err);
}

// How many iterations more. A time budget that has chosen fewer than the scene allows is kept to:
// they are what fits into the step.
static int iterations_more(const cloth_sim *sim, const cloth_real scalar[CLOTH_PCG_SCALARS])
{
  int chosen = sim->params.pcg_iterations_max;
  if (chosen >= sim->def->params.pcg_iterations_max) return FURTHER_ITERATIONS;
  return chosen - (int)scalar[CLOTH_PCG_ITERATIONS];
}

cloth_status cloth_solve_refine(cloth_sim *sim, cloth_real scalar[CLOTH_PCG_SCALARS],
                                double *correction, bool *worse, cloth_error *err)
{
  *worse = false;
  double enough = ABOVE * sim->params.thickness;
  if (!touches(sim)) return CLOTH_OK;
  sim->asked.iterations_max = iterations_more(sim, scalar);
  while (sim->asked.iterations_max > 0 && (double)scalar[CLOTH_PCG_RESIDUAL_LENGTH] > enough &&
         !cloth_solve_failed(sim, scalar)) {
    double length = (double)scalar[CLOTH_PCG_RESIDUAL_LENGTH];
    CLOTH_TRY(solve_rest(sim, scalar, AIM * enough / length, err));
    int iterations = (int)scalar[CLOTH_PCG_ITERATIONS];
    *correction += (double)scalar[CLOTH_PCG_LARGEST];
    sim->asked.iterations_max -= iterations > 0 ? iterations : FURTHER_ITERATIONS;
    *worse = !((double)scalar[CLOTH_PCG_RESIDUAL_LENGTH] < length);
    if (*worse) break;
  }
  return CLOTH_OK;
}
