// The files of `cloth run`: meshes, meshes.csv (which is a cloth, which a body) and report.csv.
// Every file is written under a name that ends in .part and renamed when it is complete, so that a
// reader never meets half of one.
#pragma once

#include "tool.h"

typedef struct tool_output tool_output;

/// Make the directory, refuse one that is not empty (unless force: earlier output in it is
/// removed), and start report.csv. The scene says what the files will be called.
/// CLOTH_BAD_ARGUMENT: not empty; CLOTH_IO: cannot be made or written; CLOTH_NO_MEMORY.
cloth_status tool_output_new(const char *dir, bool force, const cloth_scene *scene,
                             tool_output **out, cloth_error *err);

/// One row of report.csv. CLOTH_IO.
cloth_status tool_output_report(tool_output *o, const cloth_step_report *report, cloth_error *err);

/// DIR/<cloth>_<step>.obj and DIR/<body>_<step>.obj of the present state, in the scene frame.
/// CLOTH_IO.
cloth_status tool_output_meshes(tool_output *o, cloth_scene *scene, int64_t step, cloth_error *err);

/// Give report.csv its name and free everything. NULL is allowed. CLOTH_IO.
cloth_status tool_output_close(tool_output *o, cloth_error *err);

/// Leave nothing behind: for a run that was refused before its first step. NULL is allowed.
void tool_output_abandon(tool_output *o);
