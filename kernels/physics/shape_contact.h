// Particles against bodies: no approach beyond the surface, Coulomb friction along it.
//
// Within a sub-step the particle's velocity against the body loses what would take it beyond the
// surface, and friction takes at most mu times that from its slip; what is left of the penetration
// (curved surfaces, several bodies) is taken out of the position alone, so it adds no energy.
#pragma once

#include "body_vertex.h"
#include "shape.h"

typedef struct cloth_shapes {
  int count;
  const int *kind;            // [count] cloth_shape_kind
  const cloth_real *size;     // [count x 3] m
  const cloth_real *friction; // [count] 1
  const cloth_real *pose_t0;  // [count x 12] rotation, row-major, and translation [m] at the start
  const cloth_real *pose_t1;  //              and at the end of the sub-step
  cloth_real gap;             // m, radius of a particle
} cloth_shapes;

CLOTH_FN cloth_v3 cloth_pose_turn(const cloth_real *pose, cloth_v3 p)
{
  return cloth_v3_make(pose[0] * p.x + pose[1] * p.y + pose[2] * p.z,
                       pose[3] * p.x + pose[4] * p.y + pose[5] * p.z,
                       pose[6] * p.x + pose[7] * p.y + pose[8] * p.z);
}

CLOTH_FN cloth_v3 cloth_pose_inverse(const cloth_real *pose, cloth_v3 p)
{
  cloth_v3 d = cloth_v3_make(p.x - pose[9], p.y - pose[10], p.z - pose[11]);
  return cloth_v3_make(pose[0] * d.x + pose[3] * d.y + pose[6] * d.z,
                       pose[1] * d.x + pose[4] * d.y + pose[7] * d.z,
                       pose[2] * d.x + pose[5] * d.y + pose[8] * d.z);
}

// where a particle came from, in the frame of body b; who comes into a box by which face depends on
// it, other shapes do not ask
CLOTH_FN cloth_v3 cloth_shape_from(const cloth_shapes *s, int b, cloth_v3 x_t0)
{
  if (s->kind[b] != CLOTH_SHAPE_KIND_BOX) return cloth_v3_make(0, 0, 0);
  return cloth_pose_inverse(s->pose_t0 + 12 * b, x_t0);
}

/// What body b makes of the velocity v [m/s] of a particle at x [m], h [s] before the end. Returns
/// 1 if they meet.
CLOTH_FN int cloth_shape_velocity(const cloth_shapes *s, int b, cloth_real h, cloth_v3 x,
                                  cloth_v3 *v)
{
  const cloth_real *t0 = s->pose_t0 + 12 * b, *t1 = s->pose_t1 + 12 * b;
  cloth_v3 from = cloth_shape_from(s, b, x), body = cloth_v3_make(0, 0, 0), n;
  cloth_v3 to = cloth_pose_inverse(t1, cloth_v3_add_scaled(x, h, *v));
  if (!cloth_shape_resolve(s->kind[b], s->size + 3 * b, s->gap, from, &to, &n)) return 0;
  from = cloth_pose_inverse(t0, x);
  // distance that may still be gone along the normal, and the velocity of the body's point
  cloth_real room = cloth_v3_dot(n, cloth_v3_sub(from, to));
  n = cloth_pose_turn(t1, n);
  if (t0 != t1) // where all bodies rest, there is one row of poses
    body = cloth_v3_scale(1 / h, cloth_v3_sub(cloth_pose_apply(t1, to), cloth_pose_apply(t0, to)));
  cloth_v3 w = cloth_v3_sub(*v, body);
  cloth_real along = cloth_v3_dot(w, n), least = room > 0 ? -room / h : 0;
  if (!(along < least)) return 1;
  cloth_real taken = least - along;
  cloth_v3 slip = cloth_v3_add_scaled(w, -along, n);
  cloth_real size = cloth_v3_length(slip), rub = s->friction[b] * taken;
  *v = cloth_v3_add_scaled(*v, taken, n);
  if (size > 0) *v = cloth_v3_add_scaled(*v, rub < size ? -rub / size : -1, slip);
  return 1;
}

/// Push a particle that came from x_t0 out of body b [m].
CLOTH_FN void cloth_shape_position(const cloth_shapes *s, int b, cloth_v3 x_t0, cloth_v3 *x)
{
  const cloth_real *t1 = s->pose_t1 + 12 * b;
  cloth_v3 from = cloth_shape_from(s, b, x_t0);
  cloth_v3 at = cloth_pose_inverse(t1, *x), to = at, n;
  if (cloth_shape_resolve(s->kind[b], s->size + 3 * b, s->gap, from, &to, &n))
    *x = cloth_v3_add(*x, cloth_pose_turn(t1, cloth_v3_sub(to, at)));
}

/// End of the sub-step for a particle with velocity *v: its position; *v and *touch follow.
CLOTH_FN cloth_v3 cloth_shapes_move(const cloth_shapes *s, cloth_real h, cloth_v3 x, cloth_v3 *v,
                                    int *touch)
{
  for (int b = 0; b < s->count; b++) *touch += cloth_shape_velocity(s, b, h, x, v);
  cloth_v3 end = cloth_v3_add_scaled(x, h, *v);
  for (int b = 0; b<s->count && * touch> 0; b++) cloth_shape_position(s, b, x, &end);
  return end;
}
