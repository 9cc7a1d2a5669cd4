// Closest points of a vertex and a face, and of two edges.
//
// What is returned is always the distance between two points that lie on the two features (weights
// in [0, 1] that sum to 1), so rounding cannot make it less than the true distance; and it is the
// least over enough candidates that a sliver, a face or an edge without extent, or parallel edges
// cannot make it more, but for the rounding of the coordinates' differences (a few epsilon of the
// largest).
//
// Pass positions relative to one of the points where they are float and far from the origin.
//
// Sources: C. Ericson, Real-Time Collision Detection, 2005, chapter 5.1 (regions); the interior
// points are found in other ways than his, which lose half the digits on slivers and on edges that
// are nearly parallel.
#pragma once

#include "real.h"

// v within [0, 1]; 0 for NaN
CLOTH_FN cloth_real cloth_distance_clamp(cloth_real v) { return v > 0 ? (v < 1 ? v : 1) : 0; }

// Place of the point of edge x0 x1 nearest to v: 0 at x0, 1 at x1. An edge without extent gives 0.
CLOTH_FN cloth_real cloth_distance_vertex_edge_place(cloth_v3 v, cloth_v3 x0, cloth_v3 x1)
{
  cloth_v3 e = cloth_v3_sub(x1, x0);
  cloth_real ee = cloth_v3_dot(e, e);
  return ee > 0 ? cloth_distance_clamp(cloth_v3_dot(cloth_v3_sub(v, x0), e) / ee) : 0;
}

// Square of the distance from v to x0 + s (x1 - x0) [m^2].
CLOTH_FN cloth_real cloth_distance_vertex_point_sq(cloth_v3 v, cloth_v3 x0, cloth_v3 x1,
                                                   cloth_real s)
{
  cloth_v3 d = cloth_v3_add_scaled(cloth_v3_sub(x0, v), s, cloth_v3_sub(x1, x0));
  return cloth_v3_dot(d, d);
}

// Square of the distance between vertex v and face a b c [m^2]; bary gets the weights of a, b, c at
// the nearest point of the face: each in [0, 1], their sum 1 within rounding, exactly 0 off the
// nearest part.
CLOTH_FN cloth_real cloth_distance_vertex_face_sq(cloth_v3 v, cloth_v3 a, cloth_v3 b, cloth_v3 c,
                                                  cloth_real bary[3])
{
  cloth_real s = cloth_distance_vertex_edge_place(v, a, b);
  cloth_real best = cloth_distance_vertex_point_sq(v, a, b, s);
  bary[0] = 1 - s, bary[1] = s, bary[2] = 0;
  s = cloth_distance_vertex_edge_place(v, b, c);
  cloth_real d = cloth_distance_vertex_point_sq(v, b, c, s);
  if (d < best) best = d, bary[0] = 0, bary[1] = 1 - s, bary[2] = s;
  s = cloth_distance_vertex_edge_place(v, c, a);
  d = cloth_distance_vertex_point_sq(v, c, a, s);
  if (d < best) best = d, bary[0] = s, bary[1] = 0, bary[2] = 1 - s;

  // The foot on the plane: first along an edge, then what is left along the height. In this order a
  // sliver, whose normal and whose weights are poorly known, loses nothing.
  cloth_v3 e = cloth_v3_sub(b, a), height = cloth_v3_sub(c, a), up = cloth_v3_sub(v, a);
  cloth_real ee = cloth_v3_dot(e, e);
  cloth_real shift = cloth_v3_dot(height, e) / ee, along = cloth_v3_dot(up, e) / ee;
  height = cloth_v3_add_scaled(height, -shift, e), up = cloth_v3_add_scaled(up, -along, e);
  cloth_real wc = cloth_v3_dot(up, height) / cloth_v3_dot(height, height);
  cloth_real wb = along - wc * shift, wa = 1 - wb - wc;
  if (!(wa > 0 && wb > 0 && wc > 0)) return best; // outside, or no face (NaN)
  up = cloth_v3_add_scaled(up, -wc, height);
  d = cloth_v3_dot(up, up);
  if (d < best) best = d, bary[0] = wa, bary[1] = wb, bary[2] = wc;
  return best;
}

// Square of the distance between the edges a0 a1 and b0 b1 [m^2]; s and t get the places of the
// nearest points: a0 + s (a1 - a0), b0 + t (b1 - b0), each in [0, 1].
CLOTH_FN cloth_real cloth_distance_edge_edge_sq(cloth_v3 a0, cloth_v3 a1, cloth_v3 b0, cloth_v3 b1,
                                                cloth_real *s, cloth_real *t)
{
  // Where the lines pass each other, clamped; then look from one edge to the other and back. With
  // the normal instead of dot products, what rounding does to s near parallel moves along the edges
  // only. Parallel: from anywhere, the same two looks end at the nearest points.
  cloth_v3 u = cloth_v3_sub(a1, a0), v = cloth_v3_sub(b1, b0), w = cloth_v3_sub(b0, a0);
  cloth_v3 n = cloth_v3_cross(u, v);
  cloth_real nn = cloth_v3_dot(n, n);
  *s = nn > 0 ? cloth_distance_clamp(cloth_v3_dot(cloth_v3_cross(w, v), n) / nn) : 0;
  *t = cloth_distance_vertex_edge_place(cloth_v3_add_scaled(a0, *s, u), b0, b1);
  *s = cloth_distance_vertex_edge_place(cloth_v3_add_scaled(b0, *t, v), a0, a1);
  cloth_v3 d = cloth_v3_sub(cloth_v3_add_scaled(w, *t, v), cloth_v3_scale(*s, u));
  return cloth_v3_dot(d, d);
}
