#include "geometry/impact.h"

#include "geometry/impact_search.h"

#include <math.h>
#include <string.h>

static double largest_of(const double x[8][3])
{
  double largest = 0;
  for (int p = 0; p < 8; p++)
    for (int k = 0; k < 3; k++) largest = fabs(x[p][k]) > largest ? fabs(x[p][k]) : largest;
  return largest;
}

// Times a power of two after which the largest of |x| is in [0.5, 1), so that squares and cubes
// neither over- nor underflow where it matters; left alone where it is within 2^-allowed and
// 2^allowed. Exact, but for bits 2^-1022 below the largest.
static void scale(double x[8][3], int allowed)
{
  double largest = largest_of((const double(*)[3])x);
  int exponent;
  frexp(largest, &exponent);
  if (largest == 0 || (exponent >= -allowed && exponent <= allowed)) return;
  // in two factors: one alone may be out of range
  double half = ldexp(1, -exponent / 2), rest = ldexp(1, -exponent - -exponent / 2);
  for (int p = 0; p < 8; p++)
    for (int k = 0; k < 3; k++) x[p][k] = x[p][k] * half * rest;
}

// The largest float that is not above t in [0, 1].
static double round_down(double t)
{
  float single = (float)t;
  return (double)((double)single > t ? nextafterf(single, 0) : single);
}

// Positions relative to one of the points: what float then rounds away, at most half a last digit
// of each, is among what toi.h allows for (4 epsilon of the largest coordinate as given; its "X").
// The subtraction rounds too, by 2^-29 of that; what the coordinates were off before it may be much
// more, where they are far from 0.
static bool may_touch_in_float(int split, const double x[8][3], bool rounded, double *toi)
{
  double y[8][3];
  for (int p = 0; p < 8; p++)
    for (int k = 0; k < 3; k++) y[p][k] = x[p][k] - x[1][k];
  if (rounded && largest_of(x) > 0x1p24 * largest_of((const double(*)[3])y)) return *toi = 0, true;
  scale(y, 0);
  return cloth_impact_search_f32(split, (const double(*)[3])y, toi);
}

static cloth_impact_result test(cloth_impact_kind kind, cloth_impact_precision precision,
                                const double x[8][3], bool rounded)
{
  cloth_impact_result r = {false, false, 0};
  double y[8][3], in_float = 0;
  // among denormals a rounding is no share of the number
  if (rounded && largest_of(x) < 0x1p-1000) return r.hit = true, r;
  memcpy(y, x, sizeof y);
  scale(y, 100);
  if (precision != CLOTH_IMPACT_DOUBLE) {
    r.hit = may_touch_in_float((int)kind, (const double(*)[3])y, rounded, &in_float);
    r.toi = in_float;
    if (!r.hit || precision == CLOTH_IMPACT_FLOAT_ALONE) return r;
    r.asked_again = true;
  }
  r.hit = (rounded ? cloth_impact_search_rounded_f64
                   : cloth_impact_search_f64)((int)kind, (const double(*)[3])y, &r.toi);
  // neither time is late, so the later is the better one
  if (r.asked_again) r.toi = round_down(fmax(r.toi, in_float));
  return r;
}

cloth_impact_result cloth_impact_test(cloth_impact_kind kind, cloth_impact_precision precision,
                                      const double x[8][3])
{
  return test(kind, precision, x, false);
}

cloth_impact_result cloth_impact_test_rounded(cloth_impact_kind kind,
                                              cloth_impact_precision precision,
                                              const double x[8][3])
{
  return test(kind, precision, x, true);
}
