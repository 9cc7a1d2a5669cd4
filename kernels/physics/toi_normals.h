// Normals along which two features may be apart: for the searches of toi.h and toi_turn.h.
#pragma once

#include "distance.h"

CLOTH_FN cloth_real cloth_toi_largest(cloth_v3 v, cloth_real most)
{
  cloth_real x = cloth_fabs(v.x), y = cloth_fabs(v.y), z = cloth_fabs(v.z);
  most = x > most ? x : most;
  most = y > most ? y : most;
  return z > most ? z : most;
}

// v with its component along e taken out; v where e has no direction
CLOTH_FN cloth_v3 cloth_toi_across(cloth_v3 v, cloth_v3 e)
{
  cloth_real ee = cloth_v3_dot(e, e);
  return ee > 0 ? cloth_v3_add_scaled(v, -cloth_v3_dot(v, e) / ee, e) : v;
}

// Two normals worth trying at the positions x, from the first feature to the second, of any length.
// The first is made of the edges that hold the nearest points: where the distance is small its
// difference vector (the second) is mostly rounding, and an error in n counts with the size of the
// features.
CLOTH_FN void cloth_toi_normals(const cloth_v3 x[4], int split, cloth_v3 n[2])
{
  if (split == 1) {
    cloth_real w[3];
    cloth_distance_vertex_face_sq(x[0], x[1], x[2], x[3], w);
    cloth_v3 d = cloth_v3_scale(w[0], cloth_v3_sub(x[1], x[0]));
    d = cloth_v3_add_scaled(d, w[1], cloth_v3_sub(x[2], x[0]));
    d = cloth_v3_add_scaled(d, w[2], cloth_v3_sub(x[3], x[0]));
    cloth_v3 face = cloth_v3_cross(cloth_v3_sub(x[2], x[1]), cloth_v3_sub(x[3], x[1]));
    n[0] = n[1] = d;
    // beside a face, but little: the plane of a large face is known far better than the difference
    cloth_real lean = cloth_v3_dot(face, d);
    if (lean * lean > (cloth_real)0.81 * cloth_v3_dot(face, face) * cloth_v3_dot(d, d))
      n[1] = cloth_v3_scale(lean < 0 ? -1 : 1, face);
    if (w[0] > 0 && w[1] > 0 && w[2] > 0)
      n[0] = face, n[1] = d;
    else if (w[0] > 0 && w[1] > 0)
      n[0] = cloth_toi_across(d, cloth_v3_sub(x[2], x[1]));
    else if (w[1] > 0 && w[2] > 0)
      n[0] = cloth_toi_across(d, cloth_v3_sub(x[3], x[2]));
    else if (w[2] > 0 && w[0] > 0)
      n[0] = cloth_toi_across(d, cloth_v3_sub(x[1], x[3]));
  } else {
    cloth_real s, t;
    cloth_distance_edge_edge_sq(x[0], x[1], x[2], x[3], &s, &t);
    cloth_v3 u = cloth_v3_sub(x[1], x[0]), v = cloth_v3_sub(x[3], x[2]);
    cloth_v3 d =
        cloth_v3_sub(cloth_v3_add_scaled(cloth_v3_sub(x[2], x[0]), t, v), cloth_v3_scale(s, u));
    int inside_u = s > 0 && s<1, inside_v = t> 0 && t < 1;
    n[0] = n[1] = d;
    if (inside_u && inside_v) {
      n[0] = cloth_v3_cross(u, v);
      n[1] =
          cloth_toi_across(d, cloth_v3_dot(u, u) > cloth_v3_dot(v, v) ? u : v); // nearly parallel
    } else if (inside_u)
      n[0] = cloth_toi_across(d, u);
    else if (inside_v)
      n[0] = cloth_toi_across(d, v);
  }
  if (cloth_v3_dot(n[0], n[1]) < 0) n[0] = cloth_v3_scale(-1, n[0]);
}
