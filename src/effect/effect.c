// The list of effects: which are active and why, and their forces.
#include "effect/effect.h"

#include <stdio.h>
#include <string.h>

const cloth_effect *const cloth_effects[] = {
#define CLOTH_EFFECT(name) &cloth_effect_##name,
#include "effect/effects.inl"
};

static cloth_effect_wish wish_of(const cloth_def *def, const char *name)
{
  for (int i = 0; i < def->effect_count; i++)
    if (strcmp(def->effect[i].name, name) == 0) return def->effect[i].wish;
  return CLOTH_EFFECT_AUTO;
}

static cloth_status check_names(const cloth_def *def, cloth_error *err)
{
  for (int i = 0; i < def->effect_count; i++) {
    bool known = false;
    for (int e = 0; e < CLOTH_EFFECT_COUNT; e++)
      known |= strcmp(def->effect[i].name, cloth_effects[e]->name) == 0;
    if (known) continue;
    char list[256] = "";
    for (int e = 0; e < CLOTH_EFFECT_COUNT; e++)
      snprintf(list + strlen(list), sizeof list - strlen(list), " %s", cloth_effects[e]->name);
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "effects: '%s' is not one of%s", def->effect[i].name, list);
  }
  return CLOTH_OK;
}

cloth_status cloth_effects_choose(cloth_sim *sim, cloth_error *err)
{
  CLOTH_TRY(check_names(sim->def, err));
  for (int e = 0; e < CLOTH_EFFECT_COUNT; e++) {
    cloth_effect_wish wish = wish_of(sim->def, cloth_effects[e]->name);
    bool wanted = cloth_effects[e]->wanted(sim, sim->why[e]);
    sim->active[e] = wanted && wish != CLOTH_EFFECT_OFF;
    if (wanted && wish == CLOTH_EFFECT_OFF)
      snprintf(sim->why[e], sizeof sim->why[e], "switched off in the scene");
    if (!wanted && wish == CLOTH_EFFECT_ON)
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "effects: %s is 'on', but it has nothing to act on: %s",
                 cloth_effects[e]->name, sim->why[e]);
  }
  return CLOTH_OK;
}

void cloth_effect_activate(cloth_sim *sim, cloth_effect_index effect, const char *why)
{
  if (sim->active[effect]) return;
  sim->active[effect] = true;
  snprintf(sim->why[effect], sizeof sim->why[effect], "%s", why);
}

cloth_status cloth_upload_materials(cloth_sim *sim, cloth_part *part, const char *name, int width,
                                    void (*row)(const cloth_material *m, double *out),
                                    cloth_real **out, cloth_error *err)
{
  size_t cloths = (size_t)sim->def->cloth_count, n = (size_t)width * cloths;
  double numbers[CLOTH_MATERIAL_ROW];
  CLOTH_TRY(cloth_staging(sim, n, err));
  for (size_t c = 0; c < cloths; c++) {
    row(&sim->def->cloth[c].material, numbers);
    for (int k = 0; k < width; k++)
      sim->host[(size_t)width * c + (size_t)k] = (cloth_real)numbers[k];
  }
  return cloth_upload(sim, part, name, sim->host, sizeof(cloth_real) * n, out, err);
}

cloth_status cloth_effects_prepare(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  for (int e = 0; e < CLOTH_EFFECT_COUNT; e++) {
    if (!sim->active[e] || cloth_effects[e]->prepare == NULL) continue;
    sim->owner = e;
    CLOTH_TRY(cloth_effects[e]->prepare(sim, part, err));
  }
  sim->owner = CLOTH_CORE;
  CLOTH_TRY(cloth_pattern_build(sim, part, err));
  for (int e = 0; e < CLOTH_EFFECT_COUNT; e++) {
    if (!sim->active[e] || cloth_effects[e]->upload == NULL) continue;
    sim->owner = e;
    CLOTH_TRY(cloth_effects[e]->upload(sim, part, err));
  }
  sim->owner = CLOTH_CORE;
  return CLOTH_OK;
}

cloth_status cloth_effects_apply(cloth_sim *sim, int iteration, cloth_error *err)
{
  for (int e = 0; e < CLOTH_EFFECT_COUNT; e++) {
    if (!sim->active[e] || cloth_effects[e]->apply == NULL) continue;
    sim->owner = e;
    for (int p = 0; p < sim->part_count; p++)
      CLOTH_TRY(cloth_effects[e]->apply(sim, &sim->part[p], err));
  }
  sim->owner = CLOTH_CORE;
  return cloth_contact_apply(sim, iteration, err);
}
