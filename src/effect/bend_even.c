// What shape operators measure of a constant curvature, evened out.
//
// Take a height field of constant curvature k = (ww, ff, sqrt(2) wf) over a triangle and those
// across its edges. The operator of bend_shape.h measures C k of it. On a grid with all diagonals
// one way C is the unit matrix. Elsewhere it is so in the mean alone, and as energy goes with the
// square, |C k|^2 > |k|^2, cloth is too stiff: by 12 % on the Delaunay mesh of scattered points, by
// half at 45 degrees on alternating diagonals. So each triangle measures M^-1/2 of what it did, M
// the mean of C'C around it: then constant curvature has the energy of the plate, whatever its
// direction. M of one triangle alone would be too much of it: moments that were in balance between
// neighbours would not be, and small folds would make the cloth soft.
#include "effect/bend_rest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PASSES = 3 };             // of means over a triangle and those across its edges
static const double LEAST = 0.5; // no stiffness is more than doubled, of whatever sliver

typedef struct form {
  double m[3][3]; // times the area
  double area;    // m^2; 0: a triangle at the border, which does not see all of a curvature
} form;

static void product(double a[3][3], double b[3][3], double out[3][3])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

static void transposed(double a[3][3], double out[3][3])
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) out[i][j] = a[j][i];
}

// ---- the measure of one triangle ----------------------------------------------------------------

// Place of the corner across edge i, unfolded into the triangle's plane, (warp, weft) from corner 0
static void unfold(const cloth_sim *sim, const int patch[6], int i, double p[6][2], const double *n)
{
  double e[3], d[3], length_sq = 0, along = 0, far_sq = 0, size = sqrt(n[0] * n[0] + n[1] * n[1]);
  const double *from = p[(i + 1) % 3], *to = p[(i + 2) % 3];
  for (int k = 0; k < 3; k++) {
    e[k] = sim->rest[3 * patch[(i + 2) % 3] + k] - sim->rest[3 * patch[(i + 1) % 3] + k];
    d[k] = sim->rest[3 * patch[3 + i] + k] - sim->rest[3 * patch[(i + 1) % 3] + k];
    length_sq += e[k] * e[k], along += e[k] * d[k];
  }
  along /= length_sq;
  for (int k = 0; k < 3; k++) far_sq += (d[k] - along * e[k]) * (d[k] - along * e[k]);
  for (int k = 0; k < 2; k++)
    p[3 + i][k] = from[k] + along * (to[k] - from[k]) + sqrt(far_sq) * n[k] / size;
}

// angle over edge i of a height field, of which a corner is at height[corner]
static double angle_of(double p[6][2], int i, const double height[6])
{
  const double *a = p[(i + 1) % 3], *b = p[(i + 2) % 3];
  double e[2] = {b[0] - a[0], b[1] - a[1]}, length_sq = e[0] * e[0] + e[1] * e[1], sum = 0;
  for (int side = 0; side < 2; side++) {
    int c = i + 3 * side;
    double d[2] = {p[c][0] - a[0], p[c][1] - a[1]};
    double along = (d[0] * e[0] + d[1] * e[1]) / length_sq;
    double far = fabs(e[0] * d[1] - e[1] * d[0]) / sqrt(length_sq);
    sum += (height[c] - height[(i + 1) % 3] * (1 - along) - height[(i + 2) % 3] * along) / far;
  }
  return sum;
}

// C'C times the area; nothing of a triangle at the border
static form measure(const cloth_sim *sim, const cloth_bend_rest *r, int t)
{
  const int *patch = r->vertex + 6 * t;
  const double *n = r->direction + 6 * t;
  double p[6][2] = {{0, 0}}, seen[3][3] = {{0}}, back[3][3], rest[5];
  form f = {.area = 0};
  for (int i = 0; i < 3; i++)
    if (patch[3 + i] == patch[i]) return f;
  cloth_rest_triangle(sim, t, rest);
  cloth_bend_corners(sim, t, p);
  for (int i = 0; i < 3; i++) unfold(sim, patch, i, p, n + 2 * i);
  for (int k = 0; k < 3; k++) { // heights of curvature 1 in ww, ff, sqrt(2) wf
    double height[6], strain[3];
    for (int c = 0; c < 6; c++)
      height[c] = k == 2 ? p[c][0] * p[c][1] / sqrt(2) : p[c][k] * p[c][k] / 2;
    for (int i = 0; i < 3; i++) {
      double theta = angle_of(p, i, height);
      cloth_bend_strain(n + 2 * i, strain);
      for (int j = 0; j < 3; j++) seen[j][k] += theta * strain[j];
    }
  }
  transposed(seen, back);
  product(back, seen, f.m);
  f.area = rest[4];
  for (int i = 0; i < 9; i++) f.m[i / 3][i % 3] *= f.area;
  return f;
}

// ---- means --------------------------------------------------------------------------------------

// the form of a neighbour in this triangle's warp and weft: turned about the edge that they share,
// whose normal is a here and b there
static void add_turned(const form *f, const double *a, const double *b, form *out)
{
  double size = sqrt((a[0] * a[0] + a[1] * a[1]) * (b[0] * b[0] + b[1] * b[1]));
  double c = (a[0] * b[0] + a[1] * b[1]) / size, s = (b[0] * a[1] - b[1] * a[0]) / size;
  double q = sqrt(2) * c * s, sum[3][3], half[3][3], back[3][3];
  double turn[3][3] = {{c * c, s * s, -q}, {s * s, c * c, q}, {q, -q, c * c - s * s}};
  double own[3][3];
  memcpy(own, f->m, sizeof own);
  transposed(turn, back);
  product(turn, own, half);
  product(half, back, sum);
  for (int i = 0; i < 9; i++) out->m[i / 3][i % 3] += sum[i / 3][i % 3];
  out->area += f->area;
}

static form mean(const cloth_sim *sim, const cloth_bend_rest *r, const form *all, int t)
{
  form sum = all[t];
  for (int i = 0; i < 3; i++) {
    int e = sim->triangle_edge[3 * t + (i + 1) % 3];
    const int *side = sim->edge_side + 2 * e;
    int u = side[0] == t ? side[1] : side[0], k = 0;
    if (u < 0) continue;
    while (sim->triangle_edge[3 * u + (k + 1) % 3] != e) k++;
    add_turned(&all[u], r->direction + 6 * t + 2 * i, r->direction + 6 * u + 2 * k, &sum);
  }
  return sum;
}

// m^-1/2 by Jacobi's rotations
static void inverse_root(double m[3][3], double out[3][3])
{
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int turn = 0; turn < 18; turn++) {
    int p = turn % 3, q = (p + 1) % 3;
    if (m[p][q] == 0) continue;
    double half = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    double t = (half < 0 ? -1 : 1) / (fabs(half) + sqrt(half * half + 1));
    double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; k++) {
      double a = m[k][p], b = m[k][q], x = v[k][p], y = v[k][q];
      m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
      v[k][p] = c * x - s * y, v[k][q] = s * x + c * y;
    }
    for (int k = 0; k < 3; k++) {
      double a = m[p][k], b = m[q][k];
      m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
    }
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      out[i][j] = 0;
      for (int k = 0; k < 3; k++) out[i][j] += v[i][k] * v[j][k] / sqrt(fmax(LEAST, m[k][k]));
    }
}

double *cloth_bend_even(const cloth_sim *sim, const cloth_bend_rest *rest)
{
  size_t n = (size_t)rest->count + 1;
  form *now = malloc(sizeof *now * n), *next = malloc(sizeof *next * n);
  double *out = malloc(sizeof(double) * 9 * n);
  for (int t = 0; now && next && out && t < rest->count; t++) now[t] = measure(sim, rest, t);
  for (int pass = 0; now && next && out && pass < PASSES; pass++) {
    for (int t = 0; t < rest->count; t++) next[t] = mean(sim, rest, now, t);
    form *other = now;
    now = next, next = other;
  }
  for (int t = 0; now && next && out && t < rest->count; t++) {
    double m[3][3], root[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 9; i++) m[i / 3][i % 3] = now[t].m[i / 3][i % 3] / now[t].area;
    if (now[t].area > 0) inverse_root(m, root);
    memcpy(out + 9 * t, root, sizeof root);
  }
  bool ok = now && next;
  free(now), free(next);
  if (ok) return out;
  free(out);
  return NULL;
}
