// Bodies near the cloth: only they take part in the broad phase.
#pragma once

#include "state/sim.h"

/// The first near body from body b on, or their number.
int cloth_near_next(const cloth_sim *sim, int b);

/// A run of neighbouring vertices, or triangles, from body b (-1: the cloth) on: with all near
/// bodies behind it. Returns the body of the next run, or their number.
int cloth_near_run(const cloth_sim *sim, int b, bool triangles, int *first, int *count);

/// Writes the triangles of near bodies to part->body_triangle, and their number.
cloth_status cloth_near_list(cloth_sim *sim, cloth_part *part, int *count, cloth_error *err);
