#include "state/cutting.h"

#include "state/control.h"
#include "state/state.h"

#include <limits.h>
#include <math.h>

// A body that leaves no room is not cured by ever smaller steps: where many impacts are left and
// stiffer contacts were no help either, one is enough to tell.
enum { IMPACT_HALVINGS = 2, ROUGH_HALVINGS = 3, CROWDED_HALVINGS = 5 };

// As many impacts of cloth with cloth as this, and zones would grind: half the step costs less and
// stays nearer to what the solver found. A share of the vertices, and some that any cloth may have.
#define CROWDED_SHARE 0.03
#define CROWDED_LEAST 16
#define CALM          0.25 // below this share of what is crowded, longer substeps are tried again

double cloth_crowded(const cloth_sim *sim)
{
  return CROWDED_LEAST + CROWDED_SHARE * sim->vertex_count;
}

bool cloth_may_cut(const cloth_sim *sim, const cloth_cutting *c, cloth_outcome result)
{
  static const int most[] = {[OUTCOME_ROUGH] = ROUGH_HALVINGS,
                             [OUTCOME_CROWDED] = CROWDED_HALVINGS,
                             [OUTCOME_UNSTABLE] = INT_MAX};
  // holds that have driven cloth through something are not cured by smaller steps either
  if (result != OUTCOME_UNSTABLE && cloth_tangles_forced(sim)) return false;
  return c->depth + c->halvings < most[result] && c->halvings < sim->params.step_halvings_max;
}

cloth_status cloth_cutting_begin(cloth_sim *sim, double h, cloth_cutting *c, cloth_error *err)
{
  int least, crowded = sim->substeps_crowded;
  CLOTH_TRY(cloth_substeps_count(sim, h, &least, err));
  double coarse = least > crowded ? least : crowded;
  least = cloth_control_begin(sim, h, least);
  int parts = least > crowded ? least : crowded;
  *c = (cloth_cutting){.share = 1.0 / parts, .finer = parts / coarse, .left = INT_MAX};
  while (least << (c->depth + 1) <= parts) c->depth++;
  return CLOTH_OK;
}

bool cloth_cut_again(const cloth_sim *sim, cloth_outcome result, cloth_cutting *c)
{
  c->crowd = fmax(c->crowd, sim->crowd);
  if (result != OUTCOME_IMPACTS) return cloth_may_cut(sim, c, result);
  bool many = sim->impacts_left > cloth_crowded(sim);
  bool cures = sim->impacts_left <= c->left / 2 || !many;
  c->left = sim->impacts_left;
  int most = sim->helpless && many ? 1 : IMPACT_HALVINGS;
  return !sim->tangles.settling && cures && c->for_impacts++ < most &&
         c->halvings < sim->params.step_halvings_max;
}

void cloth_cutting_end(cloth_sim *sim, const cloth_cutting *c)
{
  int parts = (int)(1 / (c->share * c->finer) + 0.5);
  if (c->crowd > 1)
    sim->substeps_crowded = parts;
  else if (c->crowd < CALM && c->halvings == 0)
    sim->substeps_crowded = parts / 2;
}
