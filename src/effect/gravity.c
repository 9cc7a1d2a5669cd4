// Free fall. It acts in the prediction x* = x + h v + h^2 g (kernels/physics/predict.h).
#include "effect/effect.h"

#include <stdio.h>

static bool wanted(const cloth_sim *sim, char why[160])
{
  const double *g = sim->params.gravity;
  snprintf(why, 160, "gravity = %g %g %g m/s^2", g[0], g[1], g[2]);
  return g[0] != 0 || g[1] != 0 || g[2] != 0;
}

const cloth_effect cloth_effect_gravity = {
    .name = "gravity",
    .source = "Newton 1687",
    .wanted = wanted,
};
