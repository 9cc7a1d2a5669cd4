// What a recording says about the scene it was made of: one line for each cloth and body, one
// number or three for each parameter. The recorder writes them, the replay compares them.
#pragma once

#include "record.h"
#include "scene/def.h"

#define CLOTH_RECORD_VERSION "robot_cloth recording 1"

enum { CLOTH_RECORD_LINE_SIZE = 256 };

/// How many cloths and bodies there are, and the line of one, without line end: kind, index,
/// vertices, triangles, hash of the mesh, name.
int cloth_record_line_count(const cloth_record_subject *subject);
void cloth_record_line(const cloth_record_subject *subject, int i,
                       char out[CLOTH_RECORD_LINE_SIZE]);

/// Can the parameter change the result? All can but the number of threads.
bool cloth_record_param_counts(const cloth_param_info *p);

/// All that as one number, with the precision, the effects asked for and the materials.
uint64_t cloth_record_digest(const cloth_record_subject *subject, const cloth_def *def);

/// The value of a parameter as numbers; returns how many there are: 1 or 3.
int cloth_record_param(const cloth_params *params, const cloth_param_info *p, double out[3]);
