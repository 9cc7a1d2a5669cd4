#include "geometry/impact.h"

#include "geometry/impact_search.h"

#include <math.h>
#include <string.h>

static double largest_along(const double x[8][3], int axis)
{
  double largest = 0;
  for (int p = 0; p < 8; p++) largest = fabs(x[p][axis]) > largest ? fabs(x[p][axis]) : largest;
  return largest;
}

static double largest_of(const double x[8][3])
{
  return fmax(largest_along(x, 0), fmax(largest_along(x, 1), largest_along(x, 2)));
}

// An axis times a power of two after which the largest of |x| along it is in [0.5, 1), so that
// squares and cubes neither over- nor underflow where it matters. Exact, but for bits 2^-1022 below
// the largest.
static void scale_axis(double x[8][3], int axis, double largest)
{
  int exponent;
  frexp(largest, &exponent);
  // in two factors: one alone may be out of range
  double half = ldexp(1, -exponent / 2), rest = ldexp(1, -exponent - -exponent / 2);
  for (int p = 0; p < 8; p++) x[p][axis] = x[p][axis] * half * rest;
}

// Whether points in straight motion meet, and when, is the same in other units along each axis.
// Left alone are those of which the largest is within 2^-100 and 2^100.
static void scale_axes(double x[8][3])
{
  for (int k = 0; k < 3; k++) {
    double largest = largest_along((const double(*)[3])x, k);
    if (largest > 0 && (largest < 0x1p-100 || largest > 0x1p100)) scale_axis(x, k, largest);
  }
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
  double largest = largest_of((const double(*)[3])y);
  for (int k = 0; k < 3 && largest > 0; k++) scale_axis(y, k, largest);
  return cloth_impact_search_f32(split, (const double(*)[3])y, toi);
}

static cloth_impact_result test(cloth_impact_kind kind, cloth_impact_precision precision,
                                const double x[8][3], bool rounded)
{
  cloth_impact_result r = {false, false, 0};
  double y[8][3], in_float = 0;
  for (int k = 0; k < 3 && rounded; k++) {
    double largest = largest_along(x, k); // among denormals a rounding is no share of the number
    if (largest > 0 && largest < 0x1p-1000) return r.hit = true, r;
  }
  memcpy(y, x, sizeof y);
  scale_axes(y);
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
