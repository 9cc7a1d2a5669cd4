// Bending over one inner edge: E = k/2 (theta - theta0)^2, theta the angle between the two faces.
//
// Faces (v0, v1, v2) and (v1, v0, v3); theta = 0 when flat, positive when the faces turn away from
// the side their normals point to. The tangent is the Gauss-Newton part, weight g g' with g = d
// theta / d x. Damping is a moment k damping (theta - theta_t0): what turns as a whole feels
// nothing.
//
// A face whose height is below CLOTH_BEND_SLIVER of the edge has no direction to speak of: g is
// reduced as the square of that height, for both faces alike, so that force and moment still
// balance. An edge folded by 180 degrees is where theta jumps from pi to -pi; the differences are
// taken the short way.
//
// Sources: E. Grinspun, A. Hirani, M. Desbrun, P. Schroeder, Discrete Shells,
// 2003; R. Bridson, S. Marino, R. Fedkiw, Simulation of Clothing with Folds and Wrinkles, 2003 (the
// four gradients).
#pragma once

#include "real.h"

#define CLOTH_BEND_SLIVER ((cloth_real)1e-3)
#define CLOTH_PI          ((cloth_real)3.14159265358979323846)

typedef struct cloth_bend_args {
  const int *hinge; // [n x 4]        v0 v1 the shared edge, v2 v3 opposite corners, local ids
  const cloth_real *stiffness;  // [n]            N m  per rad; see cloth_bend_stiffness
  const cloth_real *rest_angle; // [n]            rad  (-pi, pi]
  const cloth_real *damping;    // [n]            1    damping time over step length
  const cloth_real *x;          // [vertices x 3] m    positions
  const cloth_real *x_t0;       // [vertices x 3] m    positions at the start of the step
  const cloth_real *free;       // [vertices]    1    0: held rigidly; NULL: none is
  cloth_real *force;    // [n x 12]       N    on v0 v1 v2 v3                             (out)
  cloth_real *gradient; // [n x 12]       1/m  d theta / d x of v0 v1 v2 v3               (out)
  cloth_real *weight;   // [n]            N m  tangent block K_ab = weight g_a g_b'       (out)
} cloth_bend_args;

// Hinge stiffness k [N m] for a bending rigidity D [N m], edge length l [m] and face areas A0, A1
// [m^2], all at rest. D is that of the continuum, moment per width over curvature: a cylinder of
// curvature kappa has D/2 kappa^2 per area. The hinge energy k' theta^2 l^2/(A0 + A1) gives D = 2
// k' for cylinders of any direction on equilateral triangles, hence k = D l^2/(A0 + A1). On a grid
// with all diagonals one way the same k is 1 + y + y^2 times as stiff, y = sin(2 phi), phi the
// direction of curvature and 45 degrees that of the diagonal: 0.75 to 3.
CLOTH_FN cloth_real cloth_bend_stiffness(cloth_real D, cloth_real l, cloth_real A0, cloth_real A1)
{
  return D * l * l / (A0 + A1);
}

// Angle of the point (x, y) [rad], (-pi, pi]; 0 for the origin. Written out because the library's
// atan2 differs between machines in the last bit and does not vectorise. After Cephes (S. Moshier,
// 1989), atan.c: the quotient is brought below tan(pi/8) (float) or 0.66 (double) by pi/4, pi/2 and
// pi.
CLOTH_FN cloth_real cloth_bend_atan2(cloth_real y, cloth_real x)
{
  cloth_real ax = cloth_fabs(x), ay = cloth_fabs(y);
  cloth_real large = ay > ax ? ay : ax, small = ay > ax ? ax : ay;
#ifdef CLOTH_SINGLE_PRECISION
  int shift = small > 0.41421356f * large;
#else
  int shift = small > 0.66 * large;
#endif
  // tan(a - pi/4) = (tan a - 1) / (tan a + 1)
  cloth_real num = shift ? small - large : small, den = shift ? small + large : large;
  cloth_real t = den > 0 ? num / den : 0, z = t * t;
#ifdef CLOTH_SINGLE_PRECISION
  cloth_real p =
      ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z - 3.33329491539e-1f;
  cloth_real r = p * z * t + t;
#else
  cloth_real p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z -
                   7.500855792314704667340e1) *
                      z -
                  1.228866684490136173410e2) *
                     z -
                 6.485021904942025371773e1;
  cloth_real q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z +
                   4.328810604912902668951e2) *
                      z +
                  4.853903996359136964868e2) *
                     z +
                 1.945506571482613964425e2;
  cloth_real r = t * (z * p / q) + t;
#endif
  r = shift ? r + CLOTH_PI / 4 : r;
  r = ay > ax ? CLOTH_PI / 2 - r : r;
  r = x < 0 ? CLOTH_PI - r : r;
  return y < 0 ? -r : r;
}

// angle brought into [-pi, pi] when it is within one turn of it [rad]
CLOTH_FN cloth_real cloth_bend_wrap(cloth_real angle)
{
  angle = angle > CLOTH_PI ? angle - 2 * CLOTH_PI : angle;
  return angle < -CLOTH_PI ? angle + 2 * CLOTH_PI : angle;
}

// Angle from the normals n2 of (v0, v1, v2) and n3 of (v1, v0, v3), not normalised, and the edge e
// = x1 - x0.
CLOTH_FN cloth_real cloth_bend_normals_angle(cloth_v3 e, cloth_v3 n2, cloth_v3 n3)
{
  cloth_real length = cloth_v3_length(e);
  cloth_real sine = cloth_v3_dot(cloth_v3_cross(n2, n3), e); // times |n2| |n3| |e|
  return cloth_bend_atan2(sine, cloth_v3_dot(n2, n3) * length);
}

// Angle between the faces (x0, x1, x2) and (x1, x0, x3) [rad], (-pi, pi]; 0 when flat or collapsed.
CLOTH_FN cloth_real cloth_bend_angle(cloth_v3 x0, cloth_v3 x1, cloth_v3 x2, cloth_v3 x3)
{
  cloth_v3 e = cloth_v3_sub(x1, x0);
  cloth_v3 n2 = cloth_v3_cross(e, cloth_v3_sub(x2, x0)),
           n3 = cloth_v3_cross(cloth_v3_sub(x3, x0), e);
  return cloth_bend_normals_angle(e, n2, n3);
}

// Energy of one hinge [J], without damping. Not called by the solver; the tests differentiate it.
CLOTH_FN cloth_real cloth_bend_energy(cloth_v3 x0, cloth_v3 x1, cloth_v3 x2, cloth_v3 x3,
                                      cloth_real k, cloth_real rest_angle)
{
  cloth_real bend = cloth_bend_wrap(cloth_bend_angle(x0, x1, x2, x3) - rest_angle);
  return k * bend * bend / 2;
}

// Angle of the hinge v0 v1 v2 v3 [rad] and its gradient g [1/m] at the four.
CLOTH_FN cloth_real cloth_bend_gradient(const cloth_real *x, const int *v, cloth_v3 *g)
{
  cloth_v3 x0 = cloth_v3_load(x, v[0]), e = cloth_v3_sub(cloth_v3_load(x, v[1]), x0);
  cloth_v3 d2 = cloth_v3_sub(cloth_v3_load(x, v[2]), x0);
  cloth_v3 d3 = cloth_v3_sub(cloth_v3_load(x, v[3]), x0);
  cloth_v3 n2 = cloth_v3_cross(e, d2), n3 = cloth_v3_cross(d3, e);

  // g_2 = -n2 |e| / |n2|^2 (one over the height), g_3 likewise; the edge carries what balances them
  cloth_real ee = cloth_v3_dot(e, e), length = cloth_sqrt(ee);
  cloth_real nn2 = cloth_v3_dot(n2, n2), nn3 = cloth_v3_dot(n3, n3);
  cloth_real sliver = CLOTH_BEND_SLIVER * CLOTH_BEND_SLIVER * ee * ee,
             least = nn2 < nn3 ? nn2 : nn3;
  cloth_real reduce = least < sliver ? least / sliver : 1;
  g[2] = cloth_v3_scale(least > 0 ? -length * reduce / nn2 : 0, n2);
  g[3] = cloth_v3_scale(least > 0 ? -length * reduce / nn3 : 0, n3);
  cloth_real s2 = ee > 0 ? cloth_v3_dot(d2, e) / ee : 0, s3 = ee > 0 ? cloth_v3_dot(d3, e) / ee : 0;
  g[1] = cloth_v3_add_scaled(cloth_v3_scale(-s2, g[2]), -s3, g[3]);
  g[0] = cloth_v3_scale(-1, cloth_v3_add(g[1], cloth_v3_add(g[2], g[3])));
  return cloth_bend_normals_angle(e, n2, n3);
}

// The angle alone.
CLOTH_FN cloth_real cloth_bend_angle_of(const cloth_real *x, const int *v)
{
  return cloth_bend_angle(cloth_v3_load(x, v[0]), cloth_v3_load(x, v[1]), cloth_v3_load(x, v[2]),
                          cloth_v3_load(x, v[3]));
}

// Is the face a b c held rigidly? Then it has no share in the bending of its edges, and all the
// angle that the clamp makes with the next face is bent within that face: half the length, twice
// the stiffness. The clamp is at the last held edge and not half a face before it.
CLOTH_FN int cloth_bend_held(const cloth_real *free, int a, int b, int c)
{
  return free && !(free[a] > 0) && !(free[b] > 0) && !(free[c] > 0);
}

// 2 for a hinge of which one face is held, else 1
CLOTH_FN cloth_real cloth_bend_clamp(const cloth_real *free, const int *v)
{
  return cloth_bend_held(free, v[0], v[1], v[2]) != cloth_bend_held(free, v[0], v[1], v[3]) ? 2 : 1;
}

CLOTH_FN void cloth_bend(int i, const cloth_bend_args *a)
{
  const int *v = a->hinge + 4 * i;
  cloth_v3 g[4];
  cloth_real theta = cloth_bend_gradient(a->x, v, g), theta_t0 = cloth_bend_angle_of(a->x_t0, v);
  cloth_real k = cloth_bend_clamp(a->free, v) * a->stiffness[i], d = a->damping[i];
  cloth_real moment =
      k * (cloth_bend_wrap(theta - a->rest_angle[i]) + d * cloth_bend_wrap(theta - theta_t0));
  for (int c = 0; c < 4; c++) {
    cloth_v3_store(a->gradient, 4 * i + c, g[c]);
    cloth_v3_store(a->force, 4 * i + c, cloth_v3_scale(-moment, g[c]));
  }
  a->weight[i] = k * (1 + d);
}
