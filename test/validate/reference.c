#include "reference.h"

#include <math.h>

// ---- cantilever ---------------------------------------------------------------------------------

enum { STEPS = 4000 };

typedef struct free_end {
  double gamma, load;
} free_end;

static void bend_rate(const free_end *f, double s, const double y[4], double out[4])
{
  out[0] = y[1];
  out[1] = (f->load + f->gamma * s) * sin(y[0]);
  out[2] = cos(y[0]); // drop
  out[3] = sin(y[0]); // reach
}

// from the free end to the clamp; stops early where the strip has turned past level
static void bend_shoot(const free_end *f, double eps, double y[4])
{
  const double h = 1.0 / STEPS, level = acos(-1) / 2;
  y[0] = eps, y[1] = y[2] = y[3] = 0;
  for (int i = 0; i < STEPS && y[0] < 2 * level; i++) {
    double k[4][4], t[4];
    bend_rate(f, i * h, y, k[0]);
    for (int n = 1; n < 4; n++) {
      double step = n < 3 ? h / 2 : h;
      for (int c = 0; c < 4; c++) t[c] = y[c] + step * k[n - 1][c];
      bend_rate(f, i * h + step, t, k[n]);
    }
    for (int c = 0; c < 4; c++) y[c] += h / 6 * (k[0][c] + 2 * k[1][c] + 2 * k[2][c] + k[3][c]);
  }
}

void reference_cantilever(double gamma, double load, double *drop, double *reach)
{
  // the angle at the clamp grows with that at the free end, which may be tiny: bisect its logarithm
  const double level = acos(-1) / 2;
  const free_end f = {gamma, load};
  double low = log(1e-60), high = log(level), y[4];
  for (int i = 0; i < 200; i++) {
    double middle = (low + high) / 2;
    bend_shoot(&f, exp(middle), y);
    if (y[0] < level)
      low = middle;
    else
      high = middle;
  }
  bend_shoot(&f, exp(low), y);
  *drop = y[2], *reach = y[3];
}

// ---- heart loop ---------------------------------------------------------------------------------

// from the lowest point, to the right and up: theta'' = pull sin(theta) - gamma s cos(theta)
static void loop_rate(double gamma, double pull, double s, const double y[4], double out[4])
{
  out[0] = y[1];
  out[1] = pull * sin(y[0]) - gamma * s * cos(y[0]);
  out[2] = cos(y[0]);
  out[3] = sin(y[0]);
}

// y: angle, curvature, x, z at s = 1/2; path (nullable) [STEPS / 2 + 1][2]
static void loop_shoot(double gamma, double curvature, double pull, double y[4], double (*path)[2])
{
  const double h = 1.0 / STEPS;
  y[0] = y[2] = y[3] = 0, y[1] = curvature;
  for (int i = 0; i <= STEPS / 2; i++) {
    if (path) path[i][0] = y[2], path[i][1] = y[3];
    if (i == STEPS / 2) break;
    double k[4][4], t[4];
    loop_rate(gamma, pull, i * h, y, k[0]);
    for (int n = 1; n < 4; n++) {
      double step = n < 3 ? h / 2 : h;
      for (int c = 0; c < 4; c++) t[c] = y[c] + step * k[n - 1][c];
      loop_rate(gamma, pull, i * h + step, t, k[n]);
    }
    for (int c = 0; c < 4; c++) y[c] += h / 6 * (k[0][c] + 2 * k[1][c] + 2 * k[2][c] + k[3][c]);
  }
}

// what must vanish at the grip: the strip points down, on the axis
static void loop_miss(double gamma, const double p[2], double miss[2])
{
  double y[4];
  loop_shoot(gamma, p[0], p[1], y, 0);
  miss[0] = y[0] - 1.5 * acos(-1), miss[1] = y[2];
}

static void loop_newton(double gamma, double p[2])
{
  for (int i = 0; i < 30; i++) {
    double m[2], j[2][2];
    loop_miss(gamma, p, m);
    if (fabs(m[0]) + fabs(m[1]) < 1e-11) return;
    for (int k = 0; k < 2; k++) {
      double q[2] = {p[0], p[1]}, step = 1e-6 * (1 + fabs(p[k])), n[2];
      q[k] += step;
      loop_miss(gamma, q, n);
      for (int r = 0; r < 2; r++) j[r][k] = (n[r] - m[r]) / step;
    }
    double det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    p[0] -= (j[1][1] * m[0] - j[0][1] * m[1]) / det;
    p[1] -= (j[0][0] * m[1] - j[1][0] * m[0]) / det;
  }
}

void reference_heart_loop(double gamma, double *depth, double *half_width, double *top, int n,
                          double *x, double *z)
{
  static double path[STEPS / 2 + 1][2];
  // the solution without weight, which the others continue
  double p[2] = {5.1117, 35.242}, y[4];
  for (double g = 0; g < gamma; g += fmax(1, g / 100)) loop_newton(g, p); // follow the solution
  loop_newton(gamma, p);
  loop_shoot(gamma, p[0], p[1], y, path);
  *depth = y[3], *half_width = *top = 0;
  for (int i = 0; i <= STEPS / 2; i++) {
    *half_width = fmax(*half_width, path[i][0]);
    *top = fmax(*top, path[i][1] - y[3]);
  }
  for (int i = 0; x && i <= n; i++)
    x[i] = path[i * (STEPS / 2) / n][0], z[i] = path[i * (STEPS / 2) / n][1] - y[3];
}
