// Pins of the scene file and grasps: rows that are held, exactly or by a spring (state/hold.c).
// Active from the start when the file has pins, else from the first grasp on.
#include "effect/effect.h"

#include <stdio.h>

static bool wanted(const cloth_sim *sim, char why[160])
{
  if (sim->def->pin_count > 0)
    snprintf(why, 160, "%d pins in the scene", sim->def->pin_count);
  else
    snprintf(why, 160, "no pins in the scene, no grasp yet");
  return sim->def->pin_count > 0;
}

const cloth_effect cloth_effect_pins = {
    .name = "pins",
    .source = "Baraff and Witkin 1998, section 5: constrained rows are masked; the reaction is the "
              "residual",
    .wanted = wanted,
};
