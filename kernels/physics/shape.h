// The bodies that a particle can collide with: half-space, sphere, box, cylinder, in closed form.
//
// A particle is kept `gap` away: what is inside of the shape grown by the gap (rounded at edges)
// goes to the nearest point of that surface. A centre inside a box leaves by the face through which
// it came, and a box that was crossed within one sub-step is noticed; the other shapes are left by
// the nearest way.
#pragma once

#include "real.h"

typedef enum cloth_shape_kind {
  CLOTH_SHAPE_KIND_HALF_SPACE, // z <= 0 is solid
  CLOTH_SHAPE_KIND_SPHERE,     // size: radius
  CLOTH_SHAPE_KIND_BOX,        // size: half edges
  CLOTH_SHAPE_KIND_CYLINDER    // size: radius, half length along z
} cloth_shape_kind;

CLOTH_FN cloth_real cloth_shape_get(cloth_v3 v, int axis)
{
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

CLOTH_FN cloth_v3 cloth_shape_axis(int axis, cloth_real value)
{
  return cloth_v3_make(axis == 0 ? value : 0, axis == 1 ? value : 0, axis == 2 ? value : 0);
}

// p moved along a coordinate axis to `value`
CLOTH_FN cloth_v3 cloth_shape_put(cloth_v3 p, int axis, cloth_real value)
{
  return cloth_v3_make(axis == 0 ? value : p.x, axis == 1 ? value : p.y, axis == 2 ? value : p.z);
}

// p at distance `gap` from its nearest point of the shape, which lies at p - d
CLOTH_FN int cloth_shape_round(cloth_v3 *p, cloth_v3 d, cloth_real gap, cloth_v3 *n)
{
  cloth_real length = cloth_v3_length(d);
  if (!(length < gap)) return 0;
  *n = cloth_v3_scale(1 / length, d);
  *p = cloth_v3_add_scaled(*p, gap - length, *n);
  return 1;
}

CLOTH_FN int cloth_shape_sphere(cloth_real radius, cloth_real gap, cloth_v3 *p, cloth_v3 *n)
{
  cloth_real r = cloth_v3_length(*p);
  if (!(r < radius + gap)) return 0;
  *n = r > 0 ? cloth_v3_scale(1 / r, *p) : cloth_v3_make(0, 0, 1);
  *p = cloth_v3_scale(radius + gap, *n);
  return 1;
}

CLOTH_FN int cloth_shape_cylinder(const cloth_real *size, cloth_real gap, cloth_v3 *p, cloth_v3 *n)
{
  cloth_real r = cloth_sqrt(p->x * p->x + p->y * p->y);
  cloth_real side = r - size[0], cap = cloth_fabs(p->z) - size[1], up = p->z < 0 ? -1 : 1;
  if (!(side < gap && cap < gap)) return 0;
  cloth_v3 out = r > 0 ? cloth_v3_make(p->x / r, p->y / r, 0) : cloth_v3_make(1, 0, 0);
  if (side > 0 || cap > 0) {
    cloth_v3 d = cloth_v3_scale(side > 0 ? side : 0, out);
    d.z = cap > 0 ? up * cap : 0;
    return cloth_shape_round(p, d, gap, n);
  }
  if (side > cap) {
    *n = out;
    *p = cloth_v3_make((size[0] + gap) * out.x, (size[0] + gap) * out.y, p->z);
  } else {
    *n = cloth_v3_make(0, 0, up);
    p->z = up * (size[1] + gap);
  }
  return 1;
}

// does the way from a to b cross the box? then *axis is that of the face where it enters
CLOTH_FN int cloth_shape_crosses(const cloth_real *half, cloth_v3 a, cloth_v3 b, int *axis)
{
  cloth_real enter = 0, leave = 1;
  int found = 0;
  for (int k = 0; k < 3; k++) {
    cloth_real from = cloth_shape_get(a, k), way = cloth_shape_get(b, k) - from;
    if (way == 0) {
      if (!(cloth_fabs(from) < half[k])) return 0;
      continue;
    }
    cloth_real near = ((way > 0 ? -half[k] : half[k]) - from) / way;
    cloth_real far = ((way > 0 ? half[k] : -half[k]) - from) / way;
    if (near > enter) enter = near, *axis = k, found = 1;
    if (far < leave) leave = far;
  }
  return found && enter < leave;
}

CLOTH_FN int cloth_shape_box(const cloth_real *half, cloth_real gap, cloth_v3 from, cloth_v3 *p,
                             cloth_v3 *n)
{
  cloth_v3 d = cloth_v3_make(0, 0, 0);
  int inside = 1, out = 0, axis = 0;
  cloth_real least = 0;
  for (int k = 0; k < 3; k++) {
    cloth_real c = cloth_shape_get(*p, k), depth = half[k] - cloth_fabs(c);
    if (!(depth > -gap)) out = 1;
    if (depth < 0) {
      d = cloth_v3_add(d, cloth_shape_axis(k, c < 0 ? depth : -depth));
      inside = 0;
    }
    if (k == 0 || depth < least) least = depth, axis = k;
  }
  cloth_v3 by = *p; // which side of the axis the face is on
  if (cloth_shape_crosses(half, from, *p, &axis))
    by = from;
  else if (out)
    return 0;
  else if (!inside)
    return cloth_shape_round(p, d, gap, n);
  cloth_real side = cloth_shape_get(by, axis) < 0 ? -1 : 1;
  *n = cloth_shape_axis(axis, side);
  *p = cloth_shape_put(*p, axis, side * (half[axis] + gap));
  return 1;
}

/// Put a particle that went from `from` to *p outside of a shape, `gap` away from it. All in the
/// frame of the body, m. Returns 1 and the outward normal if it had to move.
CLOTH_FN int cloth_shape_resolve(int kind, const cloth_real *size, cloth_real gap, cloth_v3 from,
                                 cloth_v3 *p, cloth_v3 *n)
{
  if (kind == CLOTH_SHAPE_KIND_SPHERE) return cloth_shape_sphere(size[0], gap, p, n);
  if (kind == CLOTH_SHAPE_KIND_BOX) return cloth_shape_box(size, gap, from, p, n);
  if (kind == CLOTH_SHAPE_KIND_CYLINDER) return cloth_shape_cylinder(size, gap, p, n);
  if (!(p->z < gap)) return 0;
  *n = cloth_v3_make(0, 0, 1);
  p->z = gap;
  return 1;
}
