// What a cloth_scene is behind the public interface: a copy of its description, the engine of its
// precision, and the recorder.
#pragma once

#include "budget.h"
#include "engine/engine.h"
#include "record.h"

struct cloth_scene {
  cloth_def *def; // own copy
  const cloth_engine *engine;
  void *sim;
  cloth_recorder *recorder; // NULL: not recording
  cloth_budget budget;
  cloth_tuning chosen; // of this step
  bool tuned;          // by cloth_tune(), for the next step
  bool hash_steps;
  bool fresh;               // no call has changed it since it was built or reset
  double **rest;            // [cloths] of [vertices x 3] m, scene frame
};

/// A deep copy of a description. CLOTH_NO_MEMORY.
cloth_status cloth_def_clone(const cloth_def *def, cloth_def **out, cloth_error *err);
