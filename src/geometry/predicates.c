#include "geometry/predicates.h"

#include "geometry/exact_integer.h"

#include <float.h>
#include <math.h>

// The bounds of the filter are relative and hold where nothing over- or underflows. With
// differences below 2^300 nothing overflows, and what underflow takes away is below 2^-1074 times
// one of them a few times over, far below the least result that is believed.
#define LARGEST 0x1p300
#define LEAST   0x1p-700

static int sign_of(double x) { return (x > 0) - (x < 0); }

// the exponent of the lowest bit among n coordinates
static int common_low(const double *const x[], int n)
{
  int low = 0x7fffffff;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      int l = cloth_exact_low(x[i][k]);
      if (l < low) low = l;
    }
  return low;
}

// out = x / 2^low - start
static void exact_difference(double x, const cloth_exact *start, int low, cloth_exact *out)
{
  cloth_exact p;
  cloth_exact_set(x, low, &p);
  cloth_exact_add(&p, start, -1, out);
}

// out = a d - b c
static void exact_minor(const cloth_exact *a, const cloth_exact *b, const cloth_exact *c,
                        const cloth_exact *d, cloth_exact *out)
{
  cloth_exact p, q;
  cloth_exact_mul(a, d, &p);
  cloth_exact_mul(b, c, &q);
  cloth_exact_add(&p, &q, -1, out);
}

static int exact_orient3d(const double *const x[4])
{
  cloth_exact start, e[3][3], minor, product, sum[2];
  int low = common_low(x, 4);
  for (int k = 0; k < 3; k++) {
    cloth_exact_set(x[0][k], low, &start);
    for (int i = 0; i < 3; i++) exact_difference(x[i + 1][k], &start, low, &e[i][k]);
  }
  sum[0].sign = sum[0].count = 0;
  for (int k = 0; k < 3; k++) {
    int p = (k + 1) % 3, q = (k + 2) % 3;
    if (e[2][k].sign == 0) {
      sum[(k + 1) % 2] = sum[k % 2];
      continue;
    }
    exact_minor(&e[0][p], &e[0][q], &e[1][p], &e[1][q], &minor);
    cloth_exact_mul(&e[2][k], &minor, &product);
    cloth_exact_add(&sum[k % 2], &product, 1, &sum[(k + 1) % 2]);
  }
  return sum[1].sign;
}

int cloth_orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
{
  double u[3], v[3], w[3], largest = 0, sum = 0, size = 0;
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = d[k] - a[k];
    double most = fmax(fabs(u[k]), fmax(fabs(v[k]), fabs(w[k])));
    if (most == 0) return 0; // a plane across the axis; differences of unequal doubles are not 0
    largest = fmax(largest, most);
  }
  for (int k = 0; k < 3; k++) {
    int p = (k + 1) % 3, q = (k + 2) % 3;
    double left = u[p] * v[q], right = u[q] * v[p];
    sum += w[k] * (left - right);
    size += fabs(w[k]) * (fabs(left) + fabs(right));
  }
  // Shewchuk's bound is (7 + 56 e) e, with e half of DBL_EPSILON
  if (largest < LARGEST && fabs(sum) > 4 * DBL_EPSILON * size + LEAST) return sign_of(sum);
  const double *const x[4] = {a, b, c, d};
  return exact_orient3d(x);
}

int cloth_orient2d(const double a[3], const double b[3], const double c[3], int axis)
{
  int p = (axis + 1) % 3, q = (axis + 2) % 3;
  double up = b[p] - a[p], uq = b[q] - a[q], vp = c[p] - a[p], vq = c[q] - a[q];
  double left = up * vq, right = uq * vp, sum = left - right;
  double largest = fmax(fmax(fabs(up), fabs(uq)), fmax(fabs(vp), fabs(vq)));
  // Shewchuk's bound is (3 + 16 e) e, with e half of DBL_EPSILON
  if (largest < LARGEST && fabs(sum) > 2 * DBL_EPSILON * (fabs(left) + fabs(right)) + LEAST)
    return sign_of(sum);
  const double *const x[3] = {a, b, c};
  int low = common_low(x, 3);
  cloth_exact start[2], e[4], minor;
  cloth_exact_set(a[p], low, &start[0]);
  cloth_exact_set(a[q], low, &start[1]);
  exact_difference(b[p], &start[0], low, &e[0]);
  exact_difference(b[q], &start[1], low, &e[1]);
  exact_difference(c[p], &start[0], low, &e[2]);
  exact_difference(c[q], &start[1], low, &e[3]);
  exact_minor(&e[0], &e[1], &e[2], &e[3], &minor);
  return minor.sign;
}
