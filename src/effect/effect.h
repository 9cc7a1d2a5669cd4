// An effect is one physical model that a scene may call for. A module is one constant table,
// defined in effect/<name>.c, and usually one element kernel in kernels/physics/. How to add one:
// doc/engine.md, "Where a new effect goes".
//
// What is not wanted allocates no byte and launches no kernel: `prepare` and `apply` are only
// called for active effects, and everything taken or launched inside them is charged to the effect.
#pragma once

#include "state/sim.h"

typedef struct cloth_effect {
  const char *name;   // key under `effects:` in a scene file
  const char *source; // the publication it implements

  /// Does the scene call for it? Writes the reason either way. Pure.
  bool (*wanted)(const cloth_sim *sim, char why[160]);

  /// Choose elements and compute rest quantities of one part, once. NULL: nothing to hold.
  cloth_status (*prepare)(cloth_sim *sim, cloth_part *part, cloth_error *err);

  /// After the rows are built: what needs the elements on the device. NULL: nothing.
  cloth_status (*upload)(cloth_sim *sim, cloth_part *part, cloth_error *err);

  /// Forces and tangents at the present iterate, into the effect's slots. NULL: another stage acts.
  cloth_status (*apply)(cloth_sim *sim, cloth_part *part, cloth_error *err);
} cloth_effect;

typedef enum cloth_effect_index {
#define CLOTH_EFFECT(name) CLOTH_EFFECT_##name,
#include "effect/effects.inl"
  CLOTH_EFFECT_COUNT
} cloth_effect_index;

#define CLOTH_EFFECT(name) extern const cloth_effect cloth_effect_##name;
#include "effect/effects.inl"

/// [CLOTH_EFFECT_COUNT]
extern const cloth_effect *const cloth_effects[];

/// Decide which effects are active and why. CLOTH_BAD_SCENE: the file names an effect there is not.
cloth_status cloth_effects_choose(cloth_sim *sim, cloth_error *err);

/// Prepare and build the rows of one part.
cloth_status cloth_effects_prepare(cloth_sim *sim, cloth_part *part, cloth_error *err);

/// Switch on an effect that a running scene came to need (the first grasp).
void cloth_effect_activate(cloth_sim *sim, cloth_effect_index effect, const char *why);

/// Who is charged with what contact of cloth with cloth and with bodies have in common.
static inline int cloth_contact_owner(const cloth_sim *sim)
{
  return sim->active[CLOTH_EFFECT_self_contact] ? CLOTH_EFFECT_self_contact
                                                : CLOTH_EFFECT_body_contact;
}

enum { CLOTH_MATERIAL_ROW = 24 }; // most numbers of a row

/// A row [width] of each cloth, made of its material, to a part: *out [cloths x width].
cloth_status cloth_upload_materials(cloth_sim *sim, cloth_part *part, const char *name, int width,
                                    void (*row)(const cloth_material *m, double *out),
                                    cloth_real **out, cloth_error *err);

/// Factor on the mean wind at a time [s].
double cloth_gust(const cloth_params *params, double time);
