// Whole numbers of any length in text, and their quotients.
#pragma once

#include <stdbool.h>

// Fits the integers of geometry/exact_integer.h, with room to compare products.
enum { CCD_DIGITS_MAX = 1000 };

/// A whole number in text.
typedef struct ccd_whole {
  double value;     // to the nearest double, infinite if too large; exact if `exact`
  bool exact;       // what follows is not needed
  const char *text; // its digits, without sign
  int digits;
} ccd_whole;

/// Read [+-]digits at the start of `text`. Returns what follows, or NULL: none there, or too long.
const char *ccd_whole_read(const char *text, ccd_whole *out);

/// *out = n / d, d not 0. True if that is what the fraction is; else *out is within two of its last
/// digits, infinite where it is too large.
bool ccd_fraction(const ccd_whole *n, const ccd_whole *d, double *out);
