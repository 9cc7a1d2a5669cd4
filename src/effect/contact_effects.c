// The three effects of contact; contact/contact.c acts for them.
#include "effect/effect.h"

#include <stdio.h>

static bool self_wanted(const cloth_sim *sim, char why[160])
{
  snprintf(why, 160, "cloth can touch cloth: %d triangles, thickness = %g m", sim->triangle_count,
           sim->params.thickness);
  return sim->triangle_count > 1;
}

static bool body_wanted(const cloth_sim *sim, char why[160])
{
  snprintf(why, 160, "%d bodies", sim->def->body_count);
  return sim->def->body_count > 0;
}

static bool friction_wanted(const cloth_sim *sim, char why[160])
{
  bool contact = sim->active[CLOTH_EFFECT_self_contact] || sim->active[CLOTH_EFFECT_body_contact];
  double most = sim->active[CLOTH_EFFECT_self_contact] ? sim->params.friction : 0;
  for (int b = 0; b < sim->def->body_count; b++)
    if (sim->def->body[b].friction > most) most = sim->def->body[b].friction;
  snprintf(why, 160, contact ? "largest coefficient %g" : "no contact (largest coefficient %g)",
           most);
  return contact && most > 0;
}

const cloth_effect cloth_effect_self_contact = {
    .name = "self_contact",
    .source = "Bridson et al. 2002; Otaduy et al. 2009; Tang et al. 2016",
    .wanted = self_wanted,
};

const cloth_effect cloth_effect_body_contact = {
    .name = "body_contact",
    .source = "Bridson et al. 2002; Otaduy et al. 2009; Tang et al. 2016",
    .wanted = body_wanted,
};

const cloth_effect cloth_effect_friction = {
    .name = "friction",
    .source = "Cundall and Strack 1979: a tangential spring that yields at mu N",
    .wanted = friction_wanted,
};
