// What cloth run says of triangles that intersect and of bodies that leave the cloth no room.
#pragma once

#include "cloth.h"

/// Print how many pairs of triangles intersect now, if any do, and the first ten of them. *count is
/// how many.
cloth_status tool_tangles_print(cloth_scene *scene, int *count, cloth_error *err);

/// Mark the bodies that left no room in the last step. blocking: [bodies].
cloth_status tool_blocking_add(cloth_scene *scene, unsigned char *blocking, cloth_error *err);

/// Print the marked bodies by name; steps: in how many there were any.
void tool_blocking_print(const cloth_scene *scene, const unsigned char *blocking, int64_t steps);
