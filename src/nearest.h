// "Did you mean ...?": the known name that is closest to a misspelt one.
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// How many letters must be inserted, removed, changed or swapped with their neighbour to turn a
/// into b; upper and lower case count as the same letter. Names longer than 63 characters are cut
/// there.
int cloth_edit_distance(const char *a, const char *b);

/// Keep `name` in *best if it is closer to `wanted` than what *best holds (NULL: nothing yet).
void cloth_nearest(const char *wanted, const char *name, const char **best);

#ifdef __cplusplus
}
#endif
