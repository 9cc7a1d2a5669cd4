// --precision of the commands that test impacts.
#pragma once

#include "geometry/impact.h"
#include "tool.h"

/// From --precision and --float-only; default double. CLOTH_BAD_ARGUMENT.
cloth_status tool_precision(const tool_arguments *args, cloth_impact_precision *out,
                            cloth_error *err);
