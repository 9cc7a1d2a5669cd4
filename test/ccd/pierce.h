// What passes through, worked out in double from straight ways alone: edges that pierce faces at a
// time of the substep.
#pragma once

#include "solve/sim.h"

static inline void at(const cloth_sim *sim, int v, double t, double out[3])
{
  const cloth_part *p = &sim->part[0];
  for (int k = 0; k < 3; k++) {
    double a = (double)p->x_t0[3 * v + k], b = (double)p->x[3 * v + k];
    out[k] = a + t * (b - a);
  }
}

// six times the volume of a tetrahedron
static inline double volume(const double a[3], const double b[3], const double c[3],
                            const double d[3])
{
  double u[3], v[3], w[3];
  for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = d[k] - a[k];
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
         u[2] * (v[0] * w[1] - v[1] * w[0]);
}

static inline bool pierces(const cloth_sim *sim, int edge, int face, double t)
{
  const int *e = sim->edge + 2 * edge, *f = sim->triangle + 3 * face;
  double p[2][3], q[3][3];
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 3; j++)
      if (e[i] == f[j]) return false;
  for (int i = 0; i < 2; i++) at(sim, e[i], t, p[i]);
  for (int j = 0; j < 3; j++) at(sim, f[j], t, q[j]);
  if (volume(q[0], q[1], q[2], p[0]) * volume(q[0], q[1], q[2], p[1]) > 0) return false;
  double a = volume(p[0], p[1], q[0], q[1]), b = volume(p[0], p[1], q[1], q[2]),
         c = volume(p[0], p[1], q[2], q[0]);
  return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

static inline int piercings(const cloth_sim *sim, double t)
{
  int n = 0;
  for (int e = 0; e < sim->all_edges; e++)
    for (int f = 0; f < sim->all_triangles; f++) {
      if (e >= sim->edge_count && f >= sim->triangle_count) continue; // body with body
      n += pierces(sim, e, f, t);
    }
  return n;
}
