#include "geometry/exact_integer.h"

#include <limits.h>
#include <string.h>

// |x| = mantissa 2^exponent, read from the bits of an IEEE 754 double
static uint64_t take_apart(double x, int *exponent)
{
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  int field = (int)(bits >> 52 & 0x7ff);
  uint64_t fraction = bits & (((uint64_t)1 << 52) - 1);
  *exponent = field ? field - 1075 : -1074;
  return field ? fraction | (uint64_t)1 << 52 : fraction; // denormals have no leading 1
}

int cloth_exact_low(double x)
{
  int exponent;
  if (x == 0) return INT_MAX;
  take_apart(x, &exponent);
  return exponent;
}

static void trim(cloth_exact *a)
{
  while (a->count > 0 && a->limb[a->count - 1] == 0) a->count--;
  if (a->count == 0) a->sign = 0;
}

void cloth_exact_set(double x, int low, cloth_exact *out)
{
  out->sign = (x > 0) - (x < 0);
  out->count = 0;
  if (x == 0) return;
  int exponent;
  uint64_t mantissa = take_apart(x, &exponent);
  int shift = exponent - low, limb = shift / 32, bit = shift % 32;
  for (int i = 0; i < limb; i++) out->limb[i] = 0;
  out->limb[limb] = (uint32_t)(mantissa << bit);
  mantissa >>= 32 - bit; // bit < 32, so this shift is at least 1
  out->limb[limb + 1] = (uint32_t)mantissa;
  out->limb[limb + 2] = (uint32_t)(mantissa >> 32);
  out->count = limb + 3;
  trim(out);
}

// -1, 0, 1 as the magnitude of a is below, equal to, above that of b
static int compare_magnitude(const cloth_exact *a, const cloth_exact *b)
{
  if (a->count != b->count) return a->count < b->count ? -1 : 1;
  for (int i = a->count - 1; i >= 0; i--)
    if (a->limb[i] != b->limb[i]) return a->limb[i] < b->limb[i] ? -1 : 1;
  return 0;
}

// |out| = |a| + |b|, a the one with more limbs
static void add_magnitude(const cloth_exact *a, const cloth_exact *b, cloth_exact *out)
{
  uint64_t carry = 0;
  for (int i = 0; i < a->count; i++) {
    carry += (uint64_t)a->limb[i] + (i < b->count ? b->limb[i] : 0);
    out->limb[i] = (uint32_t)carry;
    carry >>= 32;
  }
  out->count = a->count;
  if (carry) out->limb[out->count++] = (uint32_t)carry;
}

// |out| = |a| - |b|, a the larger one
static void sub_magnitude(const cloth_exact *a, const cloth_exact *b, cloth_exact *out)
{
  int64_t borrow = 0;
  for (int i = 0; i < a->count; i++) {
    int64_t digit = (int64_t)a->limb[i] - (i < b->count ? b->limb[i] : 0) - borrow;
    borrow = digit < 0;
    out->limb[i] = (uint32_t)(digit + (borrow << 32));
  }
  out->count = a->count;
}

void cloth_exact_add(const cloth_exact *a, const cloth_exact *b, int sign_of_b, cloth_exact *out)
{
  int sign_b = sign_of_b * b->sign;
  int order = compare_magnitude(a, b);
  const cloth_exact *large = order < 0 ? b : a, *small = order < 0 ? a : b;
  out->sign = order < 0 ? sign_b : a->sign;
  if (a->sign == sign_b || small->sign == 0)
    add_magnitude(large, small, out);
  else
    sub_magnitude(large, small, out);
  trim(out);
}

void cloth_exact_mul(const cloth_exact *a, const cloth_exact *b, cloth_exact *out)
{
  out->sign = a->sign * b->sign;
  out->count = out->sign ? a->count + b->count : 0;
  for (int i = 0; i < out->count; i++) out->limb[i] = 0;
  if (out->sign == 0) return;
  for (int i = 0; i < a->count; i++) {
    uint64_t carry = 0;
    for (int j = 0; j < b->count; j++) {
      carry += (uint64_t)a->limb[i] * b->limb[j] + out->limb[i + j];
      out->limb[i + j] = (uint32_t)carry;
      carry >>= 32;
    }
    out->limb[i + b->count] = (uint32_t)carry;
  }
  trim(out);
}
