// Several parts of one solve, taking turns on a CPU: kernels/physics/pcg_part.h as a state machine.
#pragma once

#include "backend.h"
#include "pcg_part.h"

/// Run all parts to their end. Whose turn it is among those that need not wait is thrown with dice
/// of `seed`; it shows in no number. `stopped` is a part that never runs, -1: none (for tests):
/// CLOTH_DEVICE_LOST then, as soon as nobody can go on.
cloth_status cloth_cpu_solve_parts(int parts, const cloth_pcg_part_args *args, int threads,
                                   unsigned seed, int stopped, cloth_error *err);
