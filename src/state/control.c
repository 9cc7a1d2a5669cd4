#include "state/control.h"

#include <math.h>

enum { PARTS_MOST = 100, CUT_MOST = 8, GROWTH_MOST = 4 };

// A step aims at this share of what it may add: less of it with order two, where errors of the
// velocity, which the estimate does not see, weigh more. A substep above so many times what it may
// add is repeated.
#define AIM   0.8
#define AIM_2 0.5
#define SPIKE 2.0
// The parts of the next step: at least half of this one's; fewer only where these are not enough.
#define FALL    0.5
#define AS_GOOD 0.8
// Where a part of the length leaves this share of the error per second, cutting helps; else
// velocities jump (something hit), which no length resolves.
#define CURED 0.75

// m/s: the diagonal of the largest cloth as it lies at the start, times accuracy, per second
static double rate_allowed(const cloth_sim *sim)
{
  return sim->params.accuracy * sim->control.size;
}

static bool is_on(const cloth_sim *sim) { return sim->params.accuracy > 0; }

// cloth that falls: backward Euler is off by h^2 g / 2
static int parts_of_a_fall(const cloth_sim *sim, double h)
{
  double g_sq = 0;
  for (int k = 0; k < 3; k++) g_sq += sim->params.gravity[k] * sim->params.gravity[k];
  double parts = ceil(h / 2 * sqrt(g_sq) / (AIM * rate_allowed(sim)));
  return parts < PARTS_MOST ? (int)fmax(1, parts) : PARTS_MOST;
}

int cloth_control_begin(cloth_sim *sim, double h, int least)
{
  cloth_control *c = &sim->control;
  c->spent = 0;
  c->second_order = true;
  if (!is_on(sim)) return least;
  if (c->parts == 0) c->parts = parts_of_a_fall(sim, h);
  sim->report->accuracy_substeps = c->parts;
  return least > c->parts ? least : c->parts;
}

int cloth_control_cut(const cloth_sim *sim, cloth_cutting *cutting, double share)
{
  if (!is_on(sim)) return 1;
  double rate = sim->error_mean / sim->h, most = SPIKE * rate_allowed(sim);
  bool jumps = cutting->rate > 0 && !(rate <= CURED * cutting->rate);
  int parts = (int)(1 / cutting->share + 0.5),
      cut = (int)fmin(CUT_MOST, ceil(rate / rate_allowed(sim)));
  if (cut > PARTS_MOST / parts) cut = PARTS_MOST / parts;
  // only whole substeps, or the rest of the step would not be of equal ones
  if (!(rate > most) || jumps || cut < 2 || share < cutting->share * (1 - 1e-9)) return 1;
  cutting->rate = rate;
  return cut;
}

void cloth_control_add(cloth_sim *sim, double estimate)
{
  sim->control.spent += estimate;
  if (!sim->bdf2.used) sim->control.second_order = false;
}

// from the parts of this step, which added `share` of what it may: fewer only when it is worth it
static int parts_next(const cloth_sim *sim, double share, int parts)
{
  double want = ceil(parts * (sim->control.second_order ? sqrt(share / AIM_2) : share / AIM));
  if (want >= AS_GOOD * parts && want < parts) want = parts;
  want = fmin(fmax(want, ceil(FALL * parts)), GROWTH_MOST * parts);
  return (int)fmin(fmax(want, 1), PARTS_MOST);
}

void cloth_control_end(cloth_sim *sim, double h, int parts)
{
  cloth_control *c = &sim->control;
  sim->report->accuracy_estimate = c->size > 0 ? c->spent / (c->size * h) : 0;
  if (!is_on(sim)) return;
  double share = c->spent / (h * rate_allowed(sim));
  c->missed += !(share <= 1);
  sim->report->accuracy_missed = c->missed;
  c->parts = parts_next(sim, share, parts);
}

void cloth_control_forget(cloth_sim *sim) { sim->control.parts = 0; }
