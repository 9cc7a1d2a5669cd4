// Whole numbers as long as sums of products of three coordinates need, on the stack. A double is a
// whole number of 2^low for the last of its digits; with a common `low` the coordinates of a
// predicate are whole numbers, and nothing that is added or multiplied from them rounds, under- or
// overflows, from the least denormal to the largest double.
#pragma once

#include <stdint.h>

// A coordinate has at most 1024 + 1074 bits and a difference one more: 66 limbs. A product of three
// and the sum of six such products take 2 more than 3 * 66.
enum { CLOTH_EXACT_LIMBS = 200 };

/// sign * sum of limb[i] 2^(32 i)
typedef struct cloth_exact {
  int sign;  // -1, 0, 1
  int count; // limbs in use, the last is not 0
  uint32_t limb[CLOTH_EXACT_LIMBS];
} cloth_exact;

/// The exponent of the last of the 53 digits of x (finite), INT_MAX for 0.
int cloth_exact_low(double x);

/// out = x / 2^low; low is at most cloth_exact_low(x).
void cloth_exact_set(double x, int low, cloth_exact *out);

/// out = a + sign_of_b * b. out may be neither a nor b.
void cloth_exact_add(const cloth_exact *a, const cloth_exact *b, int sign_of_b, cloth_exact *out);

/// out = a b. out may be neither a nor b.
void cloth_exact_mul(const cloth_exact *a, const cloth_exact *b, cloth_exact *out);
