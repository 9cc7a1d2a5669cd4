// Springs of the integrator mass_spring, in the place of membrane and bending; src/spring/ acts for
// it.
#include "effect/effect.h"

#include <stdio.h>

static bool wanted(const cloth_sim *sim, char why[160])
{
  snprintf(why, 160, "implicit integrators have membrane and bending instead");
  if (!cloth_is_mass_spring(sim)) return false;
  for (int c = 0; c < sim->def->cloth_count; c++) {
    const cloth_material *m = &sim->def->cloth[c].material;
    if (m->stretch_warp > 0 || m->stretch_weft > 0 || m->shear > 0 || m->bend_warp > 0 ||
        m->bend_weft > 0) {
      snprintf(why, 160, "integrator mass_spring"); // completed when they have been made
      return true;
    }
  }
  snprintf(why, 160, "no material resists stretch, shear or bending");
  return false;
}

const cloth_effect cloth_effect_springs = {
    .name = "springs",
    .source = "Provot 1995, Deformation constraints in a mass-spring model; Van Gelder 1998",
    .wanted = wanted,
};
