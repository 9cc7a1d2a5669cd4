// Material points: where a place of the cloth at t = 0 lies in any mesh of it.
#include "accuracy.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void sub(const double a[3], const double b[3], double out[3])
{
  for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// closest point to p on the segment a b, as share of the way
static double on_segment(const double p[3], const double a[3], const double b[3])
{
  double ab[3], ap[3];
  sub(b, a, ab);
  sub(p, a, ap);
  double length_sq = dot(ab, ab);
  return length_sq > 0 ? fmin(1, fmax(0, dot(ap, ab) / length_sq)) : 0;
}

static double distance_sq_at(const double p[3], const double *const x[3], const double w[3])
{
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    double d = w[0] * x[0][k] + w[1] * x[1][k] + w[2] * x[2][k] - p[k];
    sum += d * d;
  }
  return sum;
}

// barycentric weights of the closest point of a triangle: the foot of the perpendicular if it is
// inside, else the best of the three sides
static double closest(const double p[3], const double *const x[3], double w[3])
{
  double e[3], f[3], q[3];
  sub(x[1], x[0], e);
  sub(x[2], x[0], f);
  sub(p, x[0], q);
  double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), qe = dot(q, e), qf = dot(q, f);
  double det = ee * ff - ef * ef;
  if (det > 0) {
    w[1] = (ff * qe - ef * qf) / det;
    w[2] = (ee * qf - ef * qe) / det;
    w[0] = 1 - w[1] - w[2];
    if (w[0] >= 0 && w[1] >= 0 && w[2] >= 0) return distance_sq_at(p, x, w);
  }
  double best = DBL_MAX;
  for (int i = 0; i < 3; i++) {
    int a = i, b = (i + 1) % 3;
    double t = on_segment(p, x[a], x[b]), v[3] = {0, 0, 0};
    v[a] = 1 - t, v[b] = t;
    double d = distance_sq_at(p, x, v);
    if (d < best) best = d, memcpy(w, v, sizeof v);
  }
  return best;
}

cloth_status accuracy_points_choose(const cloth_scene *scene, int most, int *count, double **place,
                                    int **cloth, cloth_error *err)
{
  int total = 0, n = cloth_count(scene);
  *place = calloc(3 * (size_t)(most * n) + 3, sizeof **place);
  *cloth = calloc((size_t)(most * n) + 1, sizeof **cloth);
  if (!*place || !*cloth) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for material points");
  for (int c = 0; c < n; c++) {
    int vertices = cloth_vertex_count(scene, c), chosen = vertices < most ? vertices : most;
    const double *rest = cloth_rest_positions(scene, c);
    for (int i = 0; i < chosen; i++, total++) {
      int v = (int)((int64_t)i * (vertices - 1) / (chosen > 1 ? chosen - 1 : 1));
      memcpy(*place + 3 * (size_t)total, rest + 3 * (size_t)v, 3 * sizeof **place);
      (*cloth)[total] = c;
    }
  }
  *count = total;
  return CLOTH_OK;
}

void accuracy_points_locate(const cloth_scene *scene, int count, const double *place,
                            const int *cloth, material_point *out)
{
  for (int i = 0; i < count; i++) {
    const double *rest = cloth_rest_positions(scene, cloth[i]);
    const int *triangle = cloth_triangles(scene, cloth[i]);
    double best = DBL_MAX;
    out[i].cloth = cloth[i];
    for (int t = 0; t < cloth_triangle_count(scene, cloth[i]) && best > 0; t++) {
      const int *v = triangle + 3 * (size_t)t;
      const double *const x[3] = {rest + 3 * (size_t)v[0], rest + 3 * (size_t)v[1],
                                  rest + 3 * (size_t)v[2]};
      double w[3], d = closest(place + 3 * (size_t)i, x, w);
      if (!(d < best)) continue;
      best = d;
      memcpy(out[i].vertex, v, sizeof out[i].vertex);
      memcpy(out[i].weight, w, sizeof w);
    }
  }
}

double accuracy_size(const cloth_scene *scene)
{
  double size = 0;
  for (int c = 0; c < cloth_count(scene); c++) {
    const double *x = cloth_rest_positions(scene, c);
    double low[3], high[3], span[3];
    memcpy(low, x, sizeof low);
    memcpy(high, x, sizeof high);
    for (int v = 1; v < cloth_vertex_count(scene, c); v++)
      for (int k = 0; k < 3; k++) {
        low[k] = fmin(low[k], x[3 * (size_t)v + (size_t)k]);
        high[k] = fmax(high[k], x[3 * (size_t)v + (size_t)k]);
      }
    sub(high, low, span);
    size = fmax(size, sqrt(dot(span, span)));
  }
  return size;
}
