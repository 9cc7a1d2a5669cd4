// What a pair of features looks like: four vertices, weights that give the vector between the
// closest points as sum w_k x_k, the unit normal and the distance. Shared by every contact and
// impact kernel.
#pragma once

#include "box.h"
#include "distance.h"
#include "pair_key.h"

enum {
  CLOTH_WHOLE = 1 << 20
}; // all of a substep, in fixed point: a minimum of integers has no order

typedef struct cloth_contact_scene {
  int cloth_vertices;       // vertices from here on belong to bodies
  const int *triangle;      // [triangles x 3]
  const int *edge;          // [edges x 2]
  const int *triangle_edge; // [triangles x 3] edge k joins corners k and k + 1
  const int *edge_side;     // [edges x 2] the triangles on it; -1: none
  const unsigned char
      *edge_flat; // [edges] 1: a seam between two faces of a body that lie in one plane
  const unsigned char *vertex_flat; // [body vertices] 1: all edges at it are such seams
  const cloth_real *x_t0;           // [vertices x 3] m, start of the substep
  const cloth_real *x;              // [vertices x 3] m, predicted or solved end
  const cloth_real *x_pred;         // [cloth vertices x 3] m, where inertia and gravity alone lead
  const cloth_real *rest;           // [cloth vertices x 3] m, rest shape
  const cloth_real *free;           // [cloth vertices] 1: moves, 0: held rigidly
  const cloth_real *mass;           // [cloth vertices] kg
  const int *cloth_of;              // [cloth vertices] index of the cloth
  const int *body_of;               // [body vertices] index of the body
  const cloth_real *body_friction;  // [bodies]
  const int *grasp_of;              // [cloth vertices] 0: none, else 1 + grasp
  const unsigned char
      *ignore;             // [grasps x bodies] 1: contacts of held vertices with the body are off
  const uint32_t *carrier; // [vertices] what they ride on, carrier.h; NULL outside of the failsafe
  const int *stray;        // [cloth vertices] CLOTH_TANGLED and its like; NULL: nothing intersects
  int let_cloth, let_body; // 1: what has strayed through cloth, a body, may come back
  int bodies;
  cloth_real thickness; // m
  cloth_real pull;      // m, how far a substep works an intersection out
  cloth_real reach;     // m, how far free flight may end from x
  cloth_real friction;  // cloth on cloth
  cloth_key_format format;
} cloth_contact_scene;

/// Where intersections are (contact/stray.c): a vertex is a corner of a triangle that intersects
/// cloth; it is, or may be, on the wrong side of cloth; of a body. From CLOTH_STRAY_OF bits up: 1 +
/// the body of which it is on the wrong side, 0 for any.
enum { CLOTH_TANGLED = 1, CLOTH_STRAY_CLOTH = 2, CLOTH_STRAY_BODY = 4, CLOTH_STRAY_OF = 3 };

typedef struct cloth_contact_geometry {
  int type;
  int vertex[4];        // vertex-face: v, corners; edge-edge: ends of a, ends of b
  cloth_real weight[4]; // sum 0; positive side first
  cloth_v3 normal;      // unit, from the second feature to the first; zero if they coincide
  cloth_real distance;  // m
  int proper; // 0: an edge-edge pair whose closest points are not inside both edges, which
              // some vertex-face pair covers
} cloth_contact_geometry;

CLOTH_FN void cloth_pair_vertices(const cloth_contact_scene *s, uint64_t key,
                                  cloth_contact_geometry *g)
{
  cloth_pair p = cloth_pair_unpack(s->format, key);
  g->type = p.type;
  if (p.type == CLOTH_VERTEX_FACE) {
    g->vertex[0] = p.a;
    for (int k = 0; k < 3; k++) g->vertex[1 + k] = s->triangle[3 * p.b + k];
  } else {
    g->vertex[0] = s->edge[2 * p.a], g->vertex[1] = s->edge[2 * p.a + 1];
    g->vertex[2] = s->edge[2 * p.b], g->vertex[3] = s->edge[2 * p.b + 1];
  }
}

/// Is the vertex nearest to the inside of the face?
CLOTH_FN int cloth_contact_inside(const cloth_contact_geometry *g)
{
  return g->type == CLOTH_VERTEX_FACE && g->weight[1] < 0 && g->weight[2] < 0 && g->weight[3] < 0;
}

/// Inside a face the normal of the contact is that of the face, on the side of d, the vector
/// between the closest points [m]. Rounding turns d by (size of the numbers) / |d|, and the normal
/// of the face by the same over its height: on the floor of a hall, float has d lean by 1 in 300 at
/// a thickness of 1 mm, which carries as much as friction holds, and lie anywhere at a hundredth of
/// that. Slivers, less high than d is long, keep d.
CLOTH_FN void cloth_contact_face_normal(const cloth_v3 r[4], cloth_v3 d, cloth_contact_geometry *g)
{
  if (!cloth_contact_inside(g)) return;
  cloth_v3 u = cloth_v3_sub(r[2], r[1]), v = cloth_v3_sub(r[3], r[1]), w = cloth_v3_sub(v, u);
  cloth_v3 n = cloth_v3_cross(u, v);
  cloth_real uu = cloth_v3_dot(u, u), vv = cloth_v3_dot(v, v), ww = cloth_v3_dot(w, w);
  cloth_real longest_sq = uu > vv ? uu : vv;
  longest_sq = ww > longest_sq ? ww : longest_sq;
  cloth_real nn = cloth_v3_dot(n, n), side = cloth_v3_dot(n, d);
  if (!(cloth_v3_dot(d, d) * longest_sq < nn)) return;
  cloth_real length = cloth_sqrt(nn);
  if (side > 0) g->normal = cloth_v3_scale(1 / length, n);
  if (side < 0) g->normal = cloth_v3_scale(-1 / length, n);
}

// positions relative to the first vertex: float keeps its digits far from the origin
CLOTH_FN void cloth_contact_measure(const cloth_real *x, cloth_contact_geometry *g)
{
  cloth_v3 o = cloth_v3_load(x, g->vertex[0]), r[4];
  r[0] = cloth_v3_make(0, 0, 0);
  for (int k = 1; k < 4; k++) r[k] = cloth_v3_sub(cloth_v3_load(x, g->vertex[k]), o);

  cloth_real d_sq;
  g->proper = 1;
  if (g->type == CLOTH_VERTEX_FACE) {
    cloth_real bary[3];
    d_sq = cloth_distance_vertex_face_sq(r[0], r[1], r[2], r[3], bary);
    g->weight[0] = 1, g->weight[1] = -bary[0], g->weight[2] = -bary[1], g->weight[3] = -bary[2];
  } else {
    cloth_real s, t;
    d_sq = cloth_distance_edge_edge_sq(r[0], r[1], r[2], r[3], &s, &t);
    g->weight[0] = 1 - s, g->weight[1] = s, g->weight[2] = t - 1, g->weight[3] = -t;
    g->proper = s > 0 && s < 1 && t > 0 && t < 1;
  }
  cloth_v3 d = cloth_v3_make(0, 0, 0);
  for (int k = 1; k < 4; k++) d = cloth_v3_add_scaled(d, g->weight[k], r[k]);
  cloth_real length = cloth_v3_length(d);
  g->normal = length > 0 ? cloth_v3_scale(1 / length, d) : d;
  g->distance = cloth_sqrt(d_sq);
  cloth_contact_face_normal(r, d, g);
}

// sum w_k (x_k - x_t0_k): how far the closest points move apart in the substep
CLOTH_FN cloth_v3 cloth_contact_motion(const cloth_contact_geometry *g, const cloth_real *x_t0,
                                       const cloth_real *x)
{
  cloth_v3 u = cloth_v3_make(0, 0, 0);
  for (int k = 0; k < 4; k++) {
    int v = g->vertex[k];
    u = cloth_v3_add_scaled(u, g->weight[k],
                            cloth_v3_sub(cloth_v3_load(x, v), cloth_v3_load(x_t0, v)));
  }
  return u;
}

// normal of the face whose corners are at places 1 to 3, not of unit length
CLOTH_FN cloth_v3 cloth_contact_face_cross(const cloth_real *at)
{
  cloth_v3 a = cloth_v3_load(at, 1);
  return cloth_v3_cross(cloth_v3_sub(cloth_v3_load(at, 2), a),
                        cloth_v3_sub(cloth_v3_load(at, 3), a));
}

// A vertex that has come nearer to a face than rounding can tell is on the side where it was.
CLOTH_FN void cloth_contact_keep_side(const cloth_real *start, const cloth_real *at,
                                      cloth_contact_geometry *g)
{
  cloth_real size = 0;
  for (int k = 0; k < 12; k++) size = cloth_fabs(at[k]) > size ? cloth_fabs(at[k]) : size;
  if (!cloth_contact_inside(g) || g->distance > 16 * CLOTH_REAL_EPSILON * size) return;
  cloth_v3 up = cloth_v3_sub(cloth_v3_load(start, 0), cloth_v3_load(start, 1));
  cloth_real above = cloth_v3_dot(cloth_contact_face_cross(start), up);
  cloth_v3 n = cloth_contact_face_cross(at);
  cloth_real length = cloth_v3_length(n);
  if (length > 0 && above != 0) g->normal = cloth_v3_scale((above > 0 ? 1 : -1) / length, n);
}

/// As cloth_contact_measure(), at `share` of the way from x_t0 to x.
CLOTH_FN void cloth_contact_measure_at(const cloth_contact_scene *s, cloth_real share,
                                       cloth_contact_geometry *g)
{
  cloth_real start[12], at[12];
  cloth_v3 o = cloth_v3_load(s->x_t0, g->vertex[0]);
  cloth_contact_geometry there = *g;
  for (int k = 0; k < 4; k++) {
    cloth_v3 x_t0 = cloth_v3_sub(cloth_v3_load(s->x_t0, g->vertex[k]), o);
    cloth_v3 x = cloth_v3_sub(cloth_v3_load(s->x, g->vertex[k]), o);
    cloth_v3_store(start, k, x_t0);
    cloth_v3_store(at, k, cloth_v3_add_scaled(x_t0, share, cloth_v3_sub(x, x_t0)));
    there.vertex[k] = k;
  }
  cloth_contact_measure(at, &there);
  cloth_contact_keep_side(start, at, &there);
  for (int k = 0; k < 4; k++) g->weight[k] = there.weight[k];
  g->normal = there.normal, g->distance = there.distance, g->proper = there.proper;
}

/// n . sum w_k x_k, positions relative to the first vertex.
CLOTH_FN cloth_real cloth_contact_along(const cloth_contact_geometry *g, const cloth_real *x)
{
  cloth_v3 o = cloth_v3_load(x, g->vertex[0]), d = cloth_v3_make(0, 0, 0);
  for (int k = 1; k < 4; k++)
    d = cloth_v3_add_scaled(d, g->weight[k], cloth_v3_sub(cloth_v3_load(x, g->vertex[k]), o));
  return cloth_v3_dot(g->normal, d);
}

/// The body in the pair, or -1. There is at most one: bodies do not touch each other.
CLOTH_FN int cloth_contact_body(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  for (int k = 0; k < 4; k++)
    if (g->vertex[k] >= s->cloth_vertices) return s->body_of[g->vertex[k] - s->cloth_vertices];
  return -1;
}

/// Is the pair switched off: does a gripper meet what it holds? (Keeping the triangles that are
/// held at one corner off the fingers was tried: without impact zones they are torn between the
/// hold and the finger.)
CLOTH_FN int cloth_contact_grasped(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  int body = cloth_contact_body(s, g);
  for (int k = 0; k < 4 && body >= 0; k++) {
    int v = g->vertex[k];
    if (v >= s->cloth_vertices) continue;
    if (s->grasp_of[v] > 0 && s->ignore[(s->grasp_of[v] - 1) * s->bodies + body]) return 1;
  }
  return 0;
}

/// Does nothing in the pair give way? All of it are bodies and held vertices, which go where they
/// are told.
CLOTH_FN int cloth_contact_driven(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  for (int k = 0; k < 4; k++)
    if (g->vertex[k] < s->cloth_vertices && s->free[g->vertex[k]] > 0) return 0;
  return 1;
}

#define CLOTH_TOUCH_SHARE (cloth_real)5e-5 // of the thickness

/// Are the features so close that no side is to be told?
CLOTH_FN int cloth_contact_touches(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  cloth_contact_geometry now = *g;
  cloth_contact_measure(s->x_t0, &now);
  cloth_v3 o = cloth_v3_load(s->x_t0, g->vertex[0]);
  cloth_real size = cloth_fabs(o.x) + cloth_fabs(o.y) + cloth_fabs(o.z);
  return !(now.distance > CLOTH_TOUCH_SHARE * s->thickness &&
           now.distance > 16 * CLOTH_REAL_EPSILON * size);
}

/// Has one side of the pair strayed through the other, or do they touch where cloth intersects?
/// What distance and normal say is then the wrong way round, so no contact force acts on the pair.
CLOTH_FN int cloth_contact_strayed(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  if (!s->stray) return 0;
  int body = cloth_contact_body(s, g), split = g->type == CLOTH_VERTEX_FACE ? 1 : 2;
  int stray = 0, tangled[2] = {0, 0};
  for (int k = 0; k < 4; k++) {
    if (g->vertex[k] >= s->cloth_vertices) continue;
    int mark = s->stray[g->vertex[k]], of = mark >> CLOTH_STRAY_OF;
    if (body >= 0) stray |= mark & CLOTH_STRAY_BODY && (of == 0 || of == 1 + body);
    if (body < 0) stray |= (mark & CLOTH_STRAY_CLOTH) != 0;
    if (mark & CLOTH_TANGLED) tangled[k >= split] = 1;
  }
  if (body >= 0) return stray;
  return tangled[0] && tangled[1] && (stray || cloth_contact_touches(s, g));
}

#define CLOTH_CONTACT_FINEST (cloth_real)1e-3 // of the thickness

/// The distance that this pair keeps [m]: the thickness, or less where the cloth's own mesh is
/// finer than that, so that neighbours at rest do not push each other apart. What coincides at rest
/// keeps some. (A twentieth of the thickness was too much: of a triangle with edges of 1e-6 m the
/// corners were pushed apart to 75 times their distance, and the membrane's force grows by its
/// cube.)
CLOTH_FN cloth_real cloth_contact_thickness(const cloth_contact_scene *s,
                                            const cloth_contact_geometry *g)
{
  int cloth = -1;
  for (int k = 0; k < 4; k++) {
    if (g->vertex[k] >= s->cloth_vertices) return s->thickness;
    int c = s->cloth_of[g->vertex[k]];
    if (cloth >= 0 && c != cloth) return s->thickness;
    cloth = c;
  }
  cloth_contact_geometry rest = *g;
  cloth_contact_measure(s->rest, &rest);
  cloth_real t = rest.distance * (cloth_real)0.7, least = s->thickness * CLOTH_CONTACT_FINEST;
  return t < least ? least : t < s->thickness ? t : s->thickness;
}

// squared distance of vertex v from triangle t; is it above its inside?
CLOTH_FN cloth_real cloth_contact_distance_sq(const cloth_contact_scene *s, int v, int t,
                                              int *inside)
{
  const int *c = s->triangle + 3 * t;
  cloth_v3 o = cloth_v3_load(s->x_t0, v);
  cloth_real bary[3];
  cloth_real d_sq = cloth_distance_vertex_face_sq(
      cloth_v3_make(0, 0, 0), cloth_v3_sub(cloth_v3_load(s->x_t0, c[0]), o),
      cloth_v3_sub(cloth_v3_load(s->x_t0, c[1]), o), cloth_v3_sub(cloth_v3_load(s->x_t0, c[2]), o),
      bary);
  *inside = bary[0] > 0 && bary[1] > 0 && bary[2] > 0;
  return d_sq;
}

/// Is an edge-edge pair told by vertex-face pairs alone? It is on a seam inside a flat face of a
/// body: a straight edge is nearest to a plane at one of its ends.
CLOTH_FN int cloth_contact_on_seam(const cloth_contact_scene *s, cloth_pair p)
{
  return p.type == CLOTH_EDGE_EDGE && (s->edge_flat[p.a] || s->edge_flat[p.b]);
}

/// Is it a vertex inside a flat face of a body against a face of cloth? That is nearest to the
/// plane at one of its corners, or across the border of the flat face. The vertex would only be a
/// bump: before the edge of a sheet that slides towards it, even a wall.
CLOTH_FN int cloth_contact_on_flat(const cloth_contact_scene *s, cloth_pair p)
{
  return p.type == CLOTH_VERTEX_FACE && p.a >= s->cloth_vertices &&
         s->vertex_flat[p.a - s->cloth_vertices];
}

// The face across edge k of a face, or -1.
CLOTH_FN int cloth_contact_across(const cloth_contact_scene *s, int face, int k)
{
  int e = s->triangle_edge[3 * face + k];
  return s->edge_side[2 * e] == face ? s->edge_side[2 * e + 1] : s->edge_side[2 * e];
}

// Is face `other` nearer to vertex v than `face` is? In one order, so that of several one is left.
CLOTH_FN int cloth_contact_nearer(const cloth_contact_scene *s, int v, int face, int other)
{
  const int *c = s->triangle + 3 * other;
  if (c[0] == v || c[1] == v || c[2] == v) return 0;
  int inside;
  cloth_real here = cloth_contact_distance_sq(s, v, face, &inside),
             there = cloth_contact_distance_sq(s, v, other, &inside);
  // what is above the inside of a face is nearer to it than to its edges, whatever rounding says
  return inside || there < here || (!(here < there) && other < face);
}

enum { CLOTH_FAN_MOST = 32 }; // faces at a vertex that are looked at, each way round

// As cloth_contact_told_across(), for all faces at corner `at`, which is the closest point.
CLOTH_FN int cloth_contact_told_around(const cloth_contact_scene *s, int v, int face, int at)
{
  int corner = s->triangle[3 * face + at];
  for (int way = 0; way < 2; way++) {
    int now = face, k = way ? (at + 2) % 3 : at; // the two edges at the corner
    for (int n = 0; n < CLOTH_FAN_MOST; n++) {
      int crossed = s->triangle_edge[3 * now + k];
      now = cloth_contact_across(s, now, k);
      if (now == face) return 0; // once round
      if (now < 0) break;        // a border: the other way round
      if (cloth_contact_nearer(s, v, face, now)) return 1;
      int j = s->triangle[3 * now] == corner ? 0 : s->triangle[3 * now + 1] == corner ? 1 : 2;
      k = s->triangle_edge[3 * now + j] == crossed ? (j + 2) % 3 : j;
    }
  }
  return 0;
}

/// Is a vertex-face pair whose closest point lies on an edge or a corner of the face better told by
/// the face across that edge, or another one at that corner? Otherwise a flat surface pushes
/// sideways along its own seams, and many times over.
CLOTH_FN int cloth_contact_told_across(const cloth_contact_scene *s,
                                       const cloth_contact_geometry *g, int face)
{
  int off[3], count = 0; // corners that have no part in the closest point
  for (int k = 0; k < 3; k++)
    if (!(g->weight[1 + k] < 0)) off[count++] = k;
  if (count == 2) return cloth_contact_told_around(s, g->vertex[0], face, 3 - off[0] - off[1]);
  if (count != 1) return 0;
  int other = cloth_contact_across(s, face, (off[0] + 1) % 3);
  return other >= 0 && cloth_contact_nearer(s, g->vertex[0], face, other);
}
