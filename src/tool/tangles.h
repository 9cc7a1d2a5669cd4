// What cloth run says of triangles that intersect and of bodies and holds that leave the cloth no
// room.
#pragma once

#include "cloth.h"

/// Print how many pairs of triangles intersect now, if any do, and the first ten of them. *count is
/// how many.
cloth_status tool_tangles_print(cloth_scene *scene, int *count, cloth_error *err);

/// Which bodies and holds left no room in any step so far; zero it first.
typedef struct tool_blocking {
  int64_t steps;         // in which there were any
  unsigned char *body;   // [bodies] 1: it did
  cloth_hold_view *hold; // [holds] each once
  int holds;
} tool_blocking;

/// Take in those of the last step.
cloth_status tool_blocking_add(tool_blocking *blocking, cloth_scene *scene,
                               const cloth_step_report *report, cloth_error *err);

/// Print them by name, and in how many steps there were any; nothing if there were none.
void tool_blocking_print(const tool_blocking *blocking, const cloth_scene *scene);

void tool_blocking_free(tool_blocking *blocking);
