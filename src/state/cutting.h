// How a step is cut into substeps, and when one is repeated at half its length. A step begins as
// finely as bodies, holds and the steps before it ask for. Why: doc/engine.md.
#pragma once

#include "state/sim.h"

/// How a substep ended.
typedef enum cloth_outcome {
  OUTCOME_GOOD,    // it stands
  OUTCOME_IMPACTS, // impacts are left that nothing could resolve
  OUTCOME_ROUGH,   // far from what was linearised: a large last correction, or vertices moved far
  OUTCOME_CROWDED, // so many impacts of cloth with cloth that zones would grind
  OUTCOME_TOUCHES, // no substep of order 2, because contact acts: again with backward Euler
  OUTCOME_UNSTABLE // a vertex is not finite, or beyond all that the cloth spans
} cloth_outcome;

/// How a step is cut.
typedef struct cloth_cutting {
  double share;        // of the step, of one substep
  double finer;        // that many substeps, because of accuracy, are one that the rest asked for
  int depth, halvings; // times it was halved: as the last step was, and in this one
  int for_impacts;     // times because impacts were left
  int left;            // impacts that were left when it was halved last because of them
  double crowd;        // most crowded substep, repeated or not
  double rate;         // m/s, error of the substep that was last cut because of it; 0: none was
} cloth_cutting;

/// What accuracy asks for comes and goes with the motion, so the stiffness of contacts leaves it
/// out: each change of that throws cloth that lies off its contacts, and it slides.
cloth_status cloth_cutting_begin(cloth_sim *sim, double h, cloth_cutting *out, cloth_error *err);

/// Impacts that are many.
double cloth_crowded(const cloth_sim *sim);

/// May a substep with this outcome, impacts left aside, be repeated at half its length?
bool cloth_may_cut(const cloth_sim *sim, const cloth_cutting *cutting, cloth_outcome result);

/// Is the substep repeated at half its length? Where earlier impacts were left or a body was
/// placed, or where half the length left more than half of the impacts, and many, there is no room,
/// and smaller steps make none. (What intersected at the start is kept as it is: there they may.)
bool cloth_cut_again(const cloth_sim *sim, cloth_outcome result, cloth_cutting *cutting);

/// Steps that follow begin as finely as this one ended: most of them are as crowded.
void cloth_cutting_end(cloth_sim *sim, const cloth_cutting *cutting);
