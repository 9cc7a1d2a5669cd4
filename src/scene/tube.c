// A procedural tube.
#include "scene/mesh.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

static cloth_status check_tube(double radius, double length, const int resolution[2],
                               cloth_error *err)
{
  const double size[2] = {radius, length};
  for (int i = 0; i < 2; i++) {
    if (!(size[i] >= 1e-6 && size[i] <= 1e4))
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s = %g [m] is not in [1e-06, 10000]",
                 i ? "length" : "radius", size[i]);
    if (resolution[i] < 3 - i || resolution[i] > 10000)
      CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                 "resolution = (%d, %d) [vertices]: the number %s is not in [%d, 10000]",
                 resolution[0], resolution[1], i ? "along" : "around", 3 - i);
  }
  if ((double)resolution[0] * resolution[1] > 2.5e7)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "resolution = (%d, %d): more than 25 million vertices",
               resolution[0], resolution[1]);
  return CLOTH_OK;
}

// Corners and material of triangle t of the mesh; `side` of the triangle lies along a ring at
// height v, the third corner at `apex`. Material as long as the ring's chords: no strain at rest.
static void put_triangle(cloth_mesh *m, int t, const int corner[3], double u, double chord,
                         double v, double apex)
{
  double *w = m->material + 6 * (size_t)t;
  for (int k = 0; k < 3; k++) m->triangle[3 * t + k] = corner[k];
  bool up = apex > v; // the order that keeps the outside outside
  w[0] = up ? u : u + chord, w[1] = v;
  w[2] = up ? u + chord : u, w[3] = v;
  w[4] = u + chord / 2, w[5] = apex;
}

cloth_status cloth_mesh_tube(double radius, double length, const int resolution[2], cloth_mesh *out,
                             cloth_error *err)
{
  *out = (cloth_mesh){0};
  CLOTH_TRY(check_tube(radius, length, resolution, err));
  int around = resolution[0], along = resolution[1], t = 0;
  CLOTH_TRY(cloth_mesh_new(around * along, 2 * around * (along - 1), true, out, err));
  for (int ring = 0; ring < along; ring++)
    for (int i = 0; i < around; i++) {
      double angle = 2 * PI * (i + 0.5 * (ring % 2)) / around;
      double *x = out->position + 3 * ((size_t)ring * (size_t)around + (size_t)i);
      x[0] = radius * cos(angle), x[1] = radius * sin(angle);
      x[2] = length * ((double)(2 * ring - (along - 1)) / (2.0 * (along - 1)));
    }
  // between chords of neighbouring rings; half a spacing apart, they also differ in depth
  double chord = 2 * radius * sin(PI / around), depth = radius * (1 - cos(PI / around));
  double rise = hypot(length / (along - 1), depth);
  for (int ring = 0; ring + 1 < along; ring++) {
    int below = ring * around, above = below + around, odd = ring % 2;
    for (int i = 0; i < around; i++) {
      int j = (i + 1) % around;
      double u = chord * (i + 0.5 * odd), v = rise * ring;
      // an odd ring is half a spacing ahead
      int over = odd ? j : i, under = odd ? i : j;
      const int up[3] = {below + i, below + j, above + over};
      const int down[3] = {above + j, above + i, below + under};
      put_triangle(out, t++, up, u, chord, v, v + rise);
      put_triangle(out, t++, down, u + (odd ? -0.5 : 0.5) * chord, chord, v + rise, v);
    }
  }
  return CLOTH_OK;
}
