// Drag of one triangle in moving air: with u the velocity of its centroid against the wind, split
// along the normal n and the face, F = -rho/2 A (Cd |u_n| u_n n + Cs |u_t| u_t).
//
// The tangent is that of F in u at fixed area and normal (positive semi-definite), over the step
// length, and lumped: what one corner adds to its own diagonal block. A face moving as a whole gets
// it exactly. The normal part is what lifts a face that meets the wind at an angle.
//
// Sources: S. F.
// Hoerner, Fluid-Dynamic Drag, 1965 (coefficients); D. Baraff and A. Witkin, Large Steps in Cloth
// Simulation, 1998 (drag of a face inside the implicit step).
#pragma once

#include "real.h"

typedef struct cloth_drag_args {
  const int *triangle;     // [n x 3]         corners, local ids
  const int *material;     // [n]             row of drag
  const cloth_real *drag;  // [materials x 2] 1       pressure coefficient, skin coefficient
  cloth_real half_density; //                 kg/m^3  half of the density of air
  cloth_real inverse_step; //                 1/s     1 over the length of the step
  cloth_real wind[3];      //                 m/s     velocity of the air, scene frame
  const cloth_real *x;     // [vertices x 3]  m       positions
  const cloth_real *x_t0;  // [vertices x 3]  m       positions at the start of the step
  cloth_real *force; // [n x 3]         N       on each of the three corners                   (out)
  cloth_real *tangent; // [n x 6]         N/m     for each corner's block: xx yy zz yz zx xy (out)
} cloth_drag_args;

/// A face in moving air: unit normal, velocity along the face, and what each corner's force is per
/// velocity across and along.
typedef struct cloth_drag_face {
  cloth_v3 n, ut;           // 1, m/s
  cloth_real un, slip;      // m/s, velocity along n; |ut|
  cloth_real along, across; // N s/m, a third of rho/2 A C |u|, once for each part
} cloth_drag_face;

// u: velocity of the face against the wind [m/s]; drag: pressure and skin coefficient
CLOTH_FN cloth_drag_face cloth_drag_face_make(cloth_v3 x0, cloth_v3 x1, cloth_v3 x2, cloth_v3 u,
                                              cloth_real half_density, const cloth_real *drag)
{
  cloth_drag_face f;
  f.n = cloth_v3_cross(cloth_v3_sub(x1, x0), cloth_v3_sub(x2, x0));
  cloth_real doubled = cloth_v3_length(f.n); // twice the area
  f.n = cloth_v3_scale(doubled > 0 ? 1 / doubled : 0, f.n);
  f.un = cloth_v3_dot(u, f.n);
  f.ut = cloth_v3_add_scaled(u, -f.un, f.n);
  f.slip = cloth_v3_length(f.ut);
  cloth_real share = half_density * doubled / 6;
  f.along = share * drag[0] * cloth_fabs(f.un), f.across = share * drag[1] * f.slip;
  return f;
}

// on each corner [N]
CLOTH_FN cloth_v3 cloth_drag_face_force(const cloth_drag_face *f)
{
  return cloth_v3_add_scaled(cloth_v3_scale(-f->along * f->un, f->n), -f->across, f->ut);
}

CLOTH_FN void cloth_drag(int i, const cloth_drag_args *a)
{
  const int *v = a->triangle + 3 * i;
  cloth_v3 x0 = cloth_v3_load(a->x, v[0]), x1 = cloth_v3_load(a->x, v[1]),
           x2 = cloth_v3_load(a->x, v[2]);
  // differences first: the positions may be large against the motion
  cloth_v3 motion = cloth_v3_sub(x0, cloth_v3_load(a->x_t0, v[0]));
  motion = cloth_v3_add(motion, cloth_v3_sub(x1, cloth_v3_load(a->x_t0, v[1])));
  motion = cloth_v3_add(motion, cloth_v3_sub(x2, cloth_v3_load(a->x_t0, v[2])));
  cloth_v3 u = cloth_v3_sub(cloth_v3_scale(a->inverse_step / 3, motion),
                            cloth_v3_make(a->wind[0], a->wind[1], a->wind[2]));
  cloth_drag_face f =
      cloth_drag_face_make(x0, x1, x2, u, a->half_density, a->drag + 2 * a->material[i]);
  cloth_v3_store(a->force, i, cloth_drag_face_force(&f));

  // d(|u_n| u_n)/du = 2 |u_n| n n',  d(|u_t| u_t)/du = |u_t| (I - n n') + u_t u_t' / |u_t|
  cloth_sym3 k =
      cloth_sym3_axis(a->inverse_step * f.across, a->inverse_step * (2 * f.along - f.across), f.n);
  cloth_v3 t = cloth_v3_scale(f.slip > 0 ? 1 / f.slip : 0, f.ut);
  cloth_real w = a->inverse_step * f.across;
  k.xx += w * t.x * t.x, k.yy += w * t.y * t.y, k.zz += w * t.z * t.z;
  k.yz += w * t.y * t.z, k.zx += w * t.z * t.x, k.xy += w * t.x * t.y;
  cloth_sym3_store(a->tangent, i, k);
}
