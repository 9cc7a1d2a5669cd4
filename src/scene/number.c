#ifndef _GNU_SOURCE
#define _GNU_SOURCE // strtod_l, newlocale
#endif
#include "scene/number.h"

#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct decimal {
  uint64_t digits; // the first 19 significant digits
  int digit_count; // significant digits, all of them
  int exponent;    // of ten, that `digits` is multiplied with
  bool negative;
} decimal;

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

static const char *read_word(const char *at, bool negative, double *out)
{
  if (*at == '.') at++;
  if (strncasecmp(at, "nan", 3) == 0) return *out = NAN, at + 3;
  if (strncasecmp(at, "inf", 3) != 0) return NULL;
  *out = negative ? -INFINITY : INFINITY;
  return strncasecmp(at, "infinity", 8) == 0 ? at + 8 : at + 3;
}

static const char *read_digits(const char *at, decimal *d, bool *any)
{
  bool point = false;
  for (;; at++) {
    if (*at == '.' && !point) {
      point = true;
      continue;
    }
    if (!is_digit(*at)) return at;
    *any = true;
    if (d->digit_count < 19)
      d->digits = 10 * d->digits + (uint64_t)(*at - '0');
    else
      d->exponent++;
    if (d->digits > 0) d->digit_count++;
    if (point) d->exponent--;
  }
}

static const char *read_exponent(const char *at, decimal *d)
{
  if (*at != 'e' && *at != 'E') return at;
  const char *digit = at + 1;
  bool negative = *digit == '-';
  if (*digit == '-' || *digit == '+') digit++;
  if (!is_digit(*digit)) return at; // "1e" is the number 1 and the letter e
  int value = 0;
  for (; is_digit(*digit); digit++)
    if (value < 100000) value = 10 * value + (*digit - '0');
  d->exponent += negative ? -value : value;
  return digit;
}

const char *cloth_number_read(const char *text, double *out)
{
  static const double ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                               1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                               1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  decimal d = {0};
  const char *at = text;
  d.negative = *at == '-';
  if (*at == '-' || *at == '+') at++;
  if (!is_digit(*at) && !(*at == '.' && is_digit(at[1]))) return read_word(at, d.negative, out);

  bool any = false;
  at = read_digits(at, &d, &any);
  at = read_exponent(at, &d);

  // up to 15 digits and 10^22 both factors are exact, so the one rounding is the right one
  if (d.digit_count <= 15 && d.exponent >= -22 && d.exponent <= 22) {
    double value = (double)d.digits;
    value = d.exponent < 0 ? value / ten[-d.exponent] : value * ten[d.exponent];
    *out = d.negative ? -value : value;
    return at;
  }
  locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  if (c == (locale_t)0) return NULL;
  *out = strtod_l(text, NULL, c);
  freelocale(c);
  return at;
}

bool cloth_number_parse(const char *text, double *out)
{
  double value;
  while (is_blank(*text)) text++;
  const char *end = cloth_number_read(text, &value);
  if (end == NULL) return false;
  while (is_blank(*end)) end++;
  if (*end != '\0') return false;
  *out = value;
  return true;
}

bool cloth_integer_parse(const char *text, int *out)
{
  while (is_blank(*text)) text++;
  bool negative = *text == '-';
  if (*text == '-' || *text == '+') text++;
  if (!is_digit(*text)) return false;
  long long value = 0;
  for (; is_digit(*text); text++) {
    value = 10 * value + (*text - '0');
    if (value > (long long)INT_MAX + 1) return false;
  }
  while (is_blank(*text)) text++;
  if (*text != '\0') return false;
  if (negative) value = -value;
  if (value > INT_MAX) return false;
  *out = (int)value;
  return true;
}
