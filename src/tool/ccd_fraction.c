#include "ccd_fraction.h"

#include "geometry/exact_integer.h"
#include "scene/number.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

// Is value exactly the number whose last 64 bits are `low`, if it is within 2^-53 of it? Yes below
// 2^64, where these are all its bits, and for powers of two up to 2^116: nothing else so near ends
// in 64 zeros.
static bool is_exact(double value, uint64_t low, int digits)
{
  int exponent;
  if (digits <= 19) return value < 0x1p64 && (uint64_t)value == low;
  return low == 0 && frexp(value, &exponent) == 0.5 && exponent <= 117;
}

const char *ccd_whole_read(const char *text, ccd_whole *out)
{
  bool negative = *text == '-';
  const char *at = text + (*text == '-' || *text == '+');
  uint64_t low = 0; // modulo 2^64
  while (*at == '0' && at[1] >= '0' && at[1] <= '9') at++;
  out->text = at;
  for (; *at >= '0' && *at <= '9'; at++) low = 10 * low + (uint64_t)(*at - '0');
  if (at == out->text || at - out->text > CCD_DIGITS_MAX) return NULL;
  out->digits = (int)(at - out->text);
  out->value = (double)low;
  if (out->digits > 19 && cloth_number_read(out->text, &out->value) != at)
    return NULL; // 1.5 and 1e3 are no whole numbers
  out->exact = is_exact(out->value, low, out->digits);
  if (negative) out->value = -out->value;
  return at;
}

static void whole_number(const ccd_whole *w, cloth_exact *out)
{
  cloth_exact product;
  *out = (cloth_exact){0};
  for (int i = 0; i < w->digits;) {
    uint32_t power = 1, value = 0; // nine digits at a time fit
    for (int k = 0; k < 9 && i < w->digits; k++, i++, power *= 10)
      value = 10 * value + (uint32_t)(w->text[i] - '0');
    const cloth_exact scale = {1, 1, {power}}, add = {value > 0, value > 0, {value}};
    cloth_exact_mul(out, &scale, &product);
    cloth_exact_add(&product, &add, 1, out);
  }
}

static int bit_count(const cloth_exact *a)
{
  int bits = 32 * a->count;
  for (uint32_t top = a->limb[a->count - 1]; !(top >> 31); top <<= 1) bits--;
  return bits;
}

// its first 64 bits (a has `bits`), as a number in [2^63, 2^64)
static double leading(const cloth_exact *a, int bits)
{
  double sum = 0;
  for (int i = a->count - 1; i >= 0 && i >= a->count - 4; i--)
    sum += ldexp((double)a->limb[i], 32 * i - bits + 64);
  return sum;
}

// Is q = n / d, for n and d above 0?
static bool is_quotient(double q, const cloth_exact *n, const cloth_exact *d)
{
  if (!(q > 0 && q < INFINITY)) return false;
  int low = cloth_exact_low(q) < cloth_exact_low(1) ? cloth_exact_low(q) : cloth_exact_low(1);
  cloth_exact whole, power, left, right, difference;
  cloth_exact_set(q, low, &whole);
  cloth_exact_set(1, low, &power);
  cloth_exact_mul(&whole, d, &left);
  cloth_exact_mul(n, &power, &right);
  cloth_exact_add(&left, &right, -1, &difference);
  return difference.sign == 0;
}

// |n / d| of numbers of any length. The first digits give it to within two last digits, so that it
// is one of five doubles, if it is one.
static bool long_fraction(const ccd_whole *n, const ccd_whole *d, double *out)
{
  cloth_exact a, b;
  whole_number(n, &a);
  whole_number(d, &b);
  int bits_a = bit_count(&a), bits_b = bit_count(&b);
  *out = ldexp(leading(&a, bits_a) / leading(&b, bits_b), bits_a - bits_b);
  double q = nextafter(nextafter(*out, 0), 0);
  for (int k = 0; k < 5; k++, q = nextafter(q, INFINITY))
    if (is_quotient(q, &a, &b)) return *out = q, true;
  return false;
}

bool ccd_fraction(const ccd_whole *n, const ccd_whole *d, double *out)
{
  if (n->exact && d->exact) {
    *out = n->value / d->value; // the nearest double
    // a product of doubles below 2^117 neither over- nor underflows
    return fma(*out, d->value, -n->value) == 0;
  }
  if (n->value == 0) return *out = 0, true;
  bool negative = (n->value < 0) != (d->value < 0);
  bool exact = long_fraction(n, d, out);
  if (negative) *out = -*out;
  return exact;
}
