// A sim without a front, for tests of the engine's internals: compiled for float and for double.
#pragma once

#include "effect/effect.h"
#include "engine/scene.h"
#include "state/build.h"
#include "state/state.h"

#ifdef CLOTH_SINGLE_PRECISION
#define PRECISION "float"
#else
#define PRECISION "double"
#endif

/// `def` must outlive the sim.
static inline cloth_sim *sim_new(const cloth_def *def)
{
  cloth_error err = {0};
  void *sim = NULL;
  must(cloth_sim_new(def, NULL, &sim, &err), &err);
  return sim;
}

static inline cloth_step_report sim_step(cloth_sim *sim, int steps)
{
  cloth_step_report report = {0};
  cloth_error err = {0};
  for (int i = 0; i < steps; i++) must(cloth_sim_step(sim, 1.0 / 60, &report, &err), &err);
  return report;
}

static inline uint32_t roll(uint32_t *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return *seed >> 8;
}

/// In [-1, 1).
static inline double roll_real(uint32_t *seed) { return (double)roll(seed) / (1 << 23) - 1; }

// Are the positions of all parts those in first [vertices x 3]? `set`: of the first run, which sets
// them.
static inline bool same_positions(const cloth_sim *sim, cloth_real *first, bool set)
{
  size_t bytes = sizeof *first * 3 * (size_t)sim->vertex_count;
  if (set) memcpy(first, sim->part[0].x, bytes);
  for (int p = 0; p < sim->part_count; p++)
    if (memcmp(first, sim->part[p].x, bytes) != 0) return false;
  return true;
}
