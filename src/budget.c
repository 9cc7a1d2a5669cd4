#include "budget.h"

#include <math.h>
#include <string.h>

// A step is to take this share of what it may: the rest is for what the next one brings.
static const double AIM = 0.75;
// Within this share of the aim nothing is changed, or the choice would swing.
static const double CALM = 0.1;
// Change of the level per halving or doubling of the time: down at once, up with patience.
static const double DOWN = 0.5, UP = 0.05;
enum { LEAST_NEWTON = 1 };
// A solve may always take so many iterations: with fewer cloth hangs through like rubber.
enum { LEAST_ITERATIONS = 20 };
// Of pair_slack: fewer pairs to test where layers lie on each other, for more searches.
static const double LEAST_SLACK = 0.25;
// Solves may take the step up to this share of what it may.
static const double SPEND = 0.9;
static const double LOOSEST = 0.1; // pcg_tolerance; the parameter's own upper end
// With accuracy: a tenth of it, and no more than what cloth that whips bears. Less than that
// changes no error any more (doc/budget.md).
static const double OF_ACCURACY = 0.1, WHIPS = 1e-3, TIGHTEST = 1e-7;

void cloth_budget_reset(cloth_budget *b) { *b = (cloth_budget){.level = 1}; }

double cloth_budget_allowed(const cloth_params *params, double h)
{
  return params->time_budget < 0 ? 1e3 * h : params->time_budget;
}

static int between(int least, int most, double level)
{
  return most <= least ? most : least + (int)floor(level * (most - least) + 0.5);
}

// how many fit, in each of so many systems
static int iterations_that_fit(const cloth_budget *b, const cloth_params *p, double allowed,
                               int systems)
{
  int most = p->pcg_iterations_max;
  if (!(b->each > 0) || most <= LEAST_ITERATIONS) return most;
  if (systems > 1 && b->systems > systems) systems = b->systems; // one alone is never added to
  double fit = floor((SPEND * allowed - b->other) / (b->each * systems));
  return fit < most ? (int)fmax(LEAST_ITERATIONS, fit) : most;
}

cloth_tuning cloth_budget_choose(const cloth_budget *b, const cloth_params *p, double allowed)
{
  double asked = p->pcg_tolerance;
  int systems = between(LEAST_NEWTON, p->newton_iterations_max, b->level);
  return (cloth_tuning){
      .pcg_tolerance = asked < LOOSEST ? asked * pow(LOOSEST / asked, 1 - b->level) : asked,
      .newton_iterations = systems,
      .contact_rounds = between(1, p->contact_rounds_max, b->level),
      .pcg_iterations = iterations_that_fit(b, p, allowed, systems),
      // in few steps: each change costs a search
      .pair_slack = p->pair_slack * (b->level > 0.75   ? 1
                                     : b->level > 0.25 ? 0.5
                                                       : LEAST_SLACK),
  };
}

double cloth_accuracy_tolerance(const cloth_params *p)
{
  return fmin(fmin(p->pcg_tolerance, WHIPS), fmax(OF_ACCURACY * p->accuracy, TIGHTEST));
}

// ---- the window ---------------------------------------------------------------------------------

// index of the first that is not smaller
static int place_of(const double *sorted, int n, double ms)
{
  int low = 0;
  for (int high = n; low < high;) {
    int middle = (low + high) / 2;
    if (sorted[middle] < ms)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void window_add(cloth_budget *b, double ms)
{
  if (b->count == CLOTH_BUDGET_WINDOW) {
    int at = place_of(b->sorted, b->count--, b->ring[b->next]);
    memmove(b->sorted + at, b->sorted + at + 1, sizeof *b->sorted * (size_t)(b->count - at));
  }
  int at = place_of(b->sorted, b->count, ms);
  memmove(b->sorted + at + 1, b->sorted + at, sizeof *b->sorted * (size_t)(b->count - at));
  b->sorted[at] = ms;
  b->count++;
  b->ring[b->next] = ms;
  b->next = (b->next + 1) % CLOTH_BUDGET_WINDOW;
}

// the least time that at least this share of the steps kept to
static double percentile(const cloth_budget *b, double share)
{
  if (b->count == 0) return 0;
  int i = (int)ceil(share * b->count) - 1;
  return b->sorted[i < 0 ? 0 : i];
}

// ---- control ------------------------------------------------------------------------------------

static double mean_of_eight(double mean, double now)
{
  return mean > 0 ? mean + (now - mean) / 8 : now;
}

static void learn(cloth_budget *b, const cloth_budget_time *t)
{
  double other = t->ms - t->solve_ms;
  b->systems = t->systems;
  b->other = fmax(other, mean_of_eight(b->other, other));
  if (t->iterations > 0 && t->solve_ms > 0)
    b->each = mean_of_eight(b->each, t->solve_ms / t->iterations);
}

void cloth_budget_measured(cloth_budget *b, double allowed, const cloth_budget_time *time)
{
  double ms = time->ms;
  if (!(ms >= 0) || !(allowed > 0)) return;
  learn(b, time);
  window_add(b, ms);
  b->missed += ms > allowed;
  b->smooth = mean_of_eight(b->smooth, ms);
  // one long step counts at once, one short step does not
  double load = fmax(ms, b->smooth) / (AIM * allowed);
  if (load > 1 + CALM)
    b->level -= DOWN * log2(load);
  else if (load < 1 - CALM)
    b->level += UP * fmin(1, -log2(fmax(load, 1e-3)));
  b->level = fmin(1, fmax(0, b->level));
}

void cloth_budget_report(const cloth_budget *b, double allowed, const cloth_tuning *chosen,
                         cloth_step_report *r)
{
  r->budget_ms = allowed;
  r->budget_level = b->level;
  r->chosen_pcg_tolerance = chosen->pcg_tolerance;
  r->chosen_newton_iterations = chosen->newton_iterations;
  r->chosen_contact_rounds = chosen->contact_rounds;
  r->chosen_pcg_iterations = chosen->pcg_iterations;
  r->deadlines_missed = b->missed;
  int over = b->count - place_of(b->sorted, b->count, nextafter(allowed, INFINITY));
  r->deadline_miss_share = b->count > 0 ? (double)over / b->count : 0;
  r->wall_p50 = percentile(b, 0.5);
  r->wall_p99 = percentile(b, 0.99);
  r->wall_worst = b->count > 0 ? b->sorted[b->count - 1] : 0;
}
