// A YAML file whose values know their place: every refusal is "FILE:LINE: key 'x': ...".
#pragma once

#include "scene/file.h"

#include <stdbool.h>
#include <yaml.h>

typedef struct cloth_yaml {
  char *path;
  cloth_text text;
  yaml_document_t document;
  double resolution; // factor on the cells of grids that the caller asked for; 0 or 1: none
} cloth_yaml;

/// A value in an open file. Borrows the file.
typedef struct cloth_value {
  cloth_yaml *file;
  yaml_node_t *node;
  const char *key; // under which it, or the list it is in, stands; borrowed from the file
} cloth_value;

/// Read a file that holds one document. Call _close() also after a failure.
/// CLOTH_BAD_SCENE: not there, not YAML, empty, more than one document.
cloth_status cloth_yaml_open(const char *path, cloth_yaml *out, cloth_error *err);

/// The same with the text of a file that is not on disk; `name` stands for its path in messages.
cloth_status cloth_yaml_open_text(const char *name, const char *text, cloth_yaml *out,
                                  cloth_error *err);

/// A zeroed struct is allowed.
void cloth_yaml_close(cloth_yaml *file);

cloth_value cloth_yaml_root(cloth_yaml *file);

#if defined(__GNUC__)
__attribute__((format(printf, 5, 6)))
#endif
cloth_status
cloth_yaml_fail(cloth_error *err, const char *file, int line, cloth_value at, const char *format,
                ...);

/// Refuse a value: CLOTH_BAD_SCENE with file, line and key in front.
#define CLOTH_YAML_FAIL(err, at, ...)                                                              \
  return cloth_yaml_fail(err, __FILE__, __LINE__, at, __VA_ARGS__)

/// Pass on the failure of something that knows nothing of files: its text, placed at a value.
cloth_status cloth_yaml_blame(cloth_error *err, cloth_value at, cloth_status status,
                              const cloth_error *cause);

// ---- shapes -------------------------------------------------------------------------------------

/// Is it a mapping with no key twice, and, unless `known` (ended by NULL) is NULL, only with known
/// keys?
cloth_status cloth_yaml_mapping(cloth_value at, const char *const *known, cloth_error *err);

/// Is it a list of at least `least` and, unless negative, at most `most` items?
cloth_status cloth_yaml_list(cloth_value at, int least, int most, cloth_error *err);

bool cloth_yaml_is_word(cloth_value at, const char *word);
bool cloth_yaml_is_mapping(cloth_value at);
bool cloth_yaml_is_list(cloth_value at);

/// Items of a list, pairs of a mapping; 0 for a scalar.
int cloth_yaml_count(cloth_value at);
cloth_value cloth_yaml_item(cloth_value list, int i);

/// The i-th value of a mapping; its key is in .key.
cloth_value cloth_yaml_pair(cloth_value mapping, int i);

/// The value under a key; false if there is none.
bool cloth_yaml_find(cloth_value mapping, const char *key, cloth_value *out);

/// The value under a key, or the refusal that it is missing.
cloth_status cloth_yaml_need(cloth_value mapping, const char *key, cloth_value *out,
                             cloth_error *err);

// ---- scalars ------------------------------------------------------------------------------------

/// Text that is not empty; borrowed from the file.
cloth_status cloth_yaml_text(cloth_value at, const char **out, cloth_error *err);

/// A number in [least, most].
cloth_status cloth_yaml_number(cloth_value at, const char *unit, double least, double most,
                               double *out, cloth_error *err);
cloth_status cloth_yaml_int(cloth_value at, const char *unit, int least, int most, int *out,
                            cloth_error *err);

/// A list of `count` numbers, each in [-most, most].
cloth_status cloth_yaml_numbers(cloth_value at, int count, const char *unit, double most,
                                double *out, cloth_error *err);

/// One of some words (ended by NULL): its index.
cloth_status cloth_yaml_choice(cloth_value at, const char *const *words, int *out,
                               cloth_error *err);
