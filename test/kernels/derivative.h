// Oracles of the kernel tests: derivatives of a function given in double by finite differences,
// eigenvalues, and random numbers that are the same everywhere.
#pragma once

#include <math.h>
#include <stdint.h>
#include <string.h>

typedef double test_function(const double *x);

// uniform in [-1, 1]; after Knuth's MMIX generator
static inline double test_random(void)
{
  static uint64_t state = 1;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 11) / 4503599627370496.0 - 1;
}

// five-point formula: exact for polynomials of degree 4, else an error of order h^4
static inline double test_derivative(test_function *f, const double *x, int n, int c, double h)
{
  double y[18], v[4];
  memcpy(y, x, (size_t)n * sizeof *y);
  for (int k = 0; k < 4; k++) {
    y[c] = x[c] + h * (double)(k < 2 ? k - 2 : k - 1);
    v[k] = f(y);
  }
  return (v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * h);
}

static inline double test_second_derivative(test_function *f, const double *x, int n, int r, int c,
                                            double h)
{
  double y[18], v[4];
  memcpy(y, x, (size_t)n * sizeof *y);
  for (int k = 0; k < 4; k++) {
    y[r] = x[r] + h * (double)(k < 2 ? k - 2 : k - 1);
    v[k] = test_derivative(f, y, n, c, h);
  }
  return (v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * h);
}

// least eigenvalue of the symmetric n x n matrix a (overwritten), n <= 12, by Jacobi rotations
static inline double test_least_eigenvalue(double *a, int n)
{
  for (int sweep = 0; sweep < 60; sweep++) {
    for (int p = 0; p < n; p++) {
      for (int q = p + 1; q < n; q++) {
        double apq = a[p * n + q];
        if (!(fabs(apq) > 0)) continue;
        double angle = atan2(2 * apq, a[q * n + q] - a[p * n + p]) / 2, c = cos(angle),
               s = sin(angle);
        for (int k = 0; k < n; k++) {
          double kp = a[k * n + p], kq = a[k * n + q];
          a[k * n + p] = c * kp - s * kq, a[k * n + q] = s * kp + c * kq;
        }
        for (int k = 0; k < n; k++) {
          double pk = a[p * n + k], qk = a[q * n + k];
          a[p * n + k] = c * pk - s * qk, a[q * n + k] = s * pk + c * qk;
        }
      }
    }
  }
  double least = a[0];
  for (int p = 1; p < n; p++) least = fmin(least, a[p * n + p]);
  return least;
}

// a rotation matrix, row by row, from three angles
static inline void test_rotation(double a, double b, double c, double r[9])
{
  double ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b), cc = cos(c), sc = sin(c);
  r[0] = ca * cb, r[1] = ca * sb * sc - sa * cc, r[2] = ca * sb * cc + sa * sc;
  r[3] = sa * cb, r[4] = sa * sb * sc + ca * cc, r[5] = sa * sb * cc - ca * sc;
  r[6] = -sb, r[7] = cb * sc, r[8] = cb * cc;
}
