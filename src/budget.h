// The time budget (doc/budget.md): what a step may cost, what it chooses for that, and how often it
// did not hold. A pure function of the times it is told: it reads no clock.
#pragma once

#include "cloth.h"

enum { CLOTH_BUDGET_WINDOW = 500 }; // steps

typedef struct cloth_budget {
  double level;  // 1: all that the parameters ask for, 0: the least within the bounds
  double smooth; // ms, running mean of a step; 0: none yet
  double other;  // ms, of the last step without its solves, or their running mean if that is more
  double each;   // ms, running mean of a solver iteration; 0: not known
  int systems;   // of the last step, which may have been more than chosen
  int64_t missed;
  int count, next;                    // of the window
  double ring[CLOTH_BUDGET_WINDOW];   // ms, in order of time
  double sorted[CLOTH_BUDGET_WINDOW]; // the same, ascending
} cloth_budget;

/// What a step took.
typedef struct cloth_budget_time {
  double ms, solve_ms; // all of it; its linear solves
  int iterations;      // of the solves
  int systems;         // solves
} cloth_budget_time;

/// Nothing measured yet; starts with all that the parameters ask for.
void cloth_budget_reset(cloth_budget *b);

/// What a step may take [ms]; 0: no budget. h: length of the step [s].
double cloth_budget_allowed(const cloth_params *params, double h);

/// What the level stands for. Bounds: pcg_tolerance from the parameter's up to 0.1 (on a
/// logarithmic scale), Newton iterations from the parameter's down to 1, contact rounds down to 1;
/// solver iterations as many as fit into what is left of `allowed` [ms], 20 at least.
cloth_tuning cloth_budget_choose(const cloth_budget *b, const cloth_params *params, double allowed);

/// A step took so much of `allowed`: count it and move the level.
void cloth_budget_measured(cloth_budget *b, double allowed, const cloth_budget_time *time);

/// The pcg_tolerance of the parameter accuracy: a tenth of it, 1e-3, or the parameter's,
/// whichever is least.
double cloth_accuracy_tolerance(const cloth_params *params);

/// The fields of the report.
void cloth_budget_report(const cloth_budget *b, double allowed, const cloth_tuning *chosen,
                         cloth_step_report *report);
