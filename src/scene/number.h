// Numbers in text, read the same way whatever the locale of the program is.
#pragma once

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Read one decimal number at the start of `text`: [+-]digits[.digits][e[+-]digits], or inf, nan in
/// any case, also with YAML's dot (.inf). Returns the first character behind it, or NULL if there
/// is none. The text must end with a NUL somewhere. Correctly rounded.
const char *cloth_number_read(const char *text, double *out);

/// Read a whole text (blanks around it allowed) as one number. False if it is something else.
bool cloth_number_parse(const char *text, double *out);

/// Likewise, a whole number that fits an int.
bool cloth_integer_parse(const char *text, int *out);

#ifdef __cplusplus
}
#endif
