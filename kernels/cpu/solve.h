// A whole linear solve of one part on a CPU: backend.h, solve.
#pragma once

#include "pcg_solve.h"

void cloth_cpu_solve(const cloth_pcg_solve_args *args, int threads);
