// Whole files as text, and paths beside a file.
#pragma once

#include "status.h"

/// A file in memory.
typedef struct cloth_text {
  char *data; // [size + 1], the last is NUL
  size_t size;
} cloth_text;

/// Read a whole file; free(out->data) after use. CLOTH_BAD_SCENE: not there, a directory, not
/// readable, above 2 GiB, with the reason; CLOTH_NO_MEMORY.
cloth_status cloth_text_read(const char *path, cloth_text *out, cloth_error *err);

/// `path` seen from the folder of `file`, if it is relative; to be freed. CLOTH_NO_MEMORY.
cloth_status cloth_path_beside(const char *file, const char *path, char **out, cloth_error *err);

/// A copy of a text, to be freed; NULL without memory.
char *cloth_string_copy(const char *text);
