// Coulomb friction as a spring that yields: what the friction kernels share.
//
// Each contact remembers its elastic slip s [m], the part of its tangential motion that has not
// slid away, in a frame that moves with its features. The force is mu N s / limit while |s| stays
// below the limit and mu N against s once it yields; then s is dragged along at the limit (radial
// return). So what sticks does not creep, and the threshold is mu N. Cundall and Strack 1979, A
// discrete numerical model for granular assemblies; return mapping: Wriggers 2006, Computational
// contact mechanics, chapter 5.
#pragma once

#include "contact_geometry.h"

// A contact yields at 1.005 mu N and slides at 1.001 mu N, as static friction exceeds kinetic
// friction: what rounding and the solver's tolerance set in motion on a slope of just mu comes to
// rest, and what rests there is not set off.
#define CLOTH_FRICTION_STATIC  ((cloth_real)1.005)
#define CLOTH_FRICTION_KINETIC ((cloth_real)1.001)

enum { CLOTH_FRICTION_NONE = 0, CLOTH_FRICTION_STICKS = 1, CLOTH_FRICTION_SLIDES = 2 };

/// Axes of the frame in which elastic slip is kept: of the face, or of the first edge and the
/// normal.
typedef struct cloth_friction_frame {
  cloth_v3 axis[3]; // unit and orthogonal, or zero where the features have no size
} cloth_friction_frame;

CLOTH_FN cloth_v3 cloth_v3_unit(cloth_v3 a)
{
  cloth_real length = cloth_v3_length(a);
  return length > 0 ? cloth_v3_scale(1 / length, a) : cloth_v3_make(0, 0, 0);
}

CLOTH_FN cloth_v3 cloth_friction_side(const cloth_real *x, int from, int to)
{
  return cloth_v3_sub(cloth_v3_load(x, to), cloth_v3_load(x, from));
}

CLOTH_FN cloth_v3 cloth_friction_face_normal(const cloth_contact_scene *s, const cloth_real *x,
                                             int face)
{
  const int *c = s->triangle + 3 * face;
  return cloth_v3_unit(
      cloth_v3_cross(cloth_friction_side(x, c[0], c[1]), cloth_friction_side(x, c[0], c[2])));
}

/// At the start of the substep. `normal` of the contact counts for edge-edge pairs alone.
CLOTH_FN cloth_friction_frame cloth_friction_frame_of(const cloth_contact_scene *s, cloth_pair p,
                                                      cloth_v3 normal)
{
  cloth_friction_frame f;
  if (p.type != CLOTH_EDGE_EDGE) { // also what pulls a vertex through a face
    const int *c = s->triangle + 3 * p.b;
    f.axis[0] = cloth_v3_unit(cloth_friction_side(s->x_t0, c[0], c[1]));
    f.axis[2] = cloth_friction_face_normal(s, s->x_t0, p.b);
  } else {
    const int *e = s->edge + 2 * p.a;
    f.axis[0] = cloth_v3_unit(cloth_friction_side(s->x_t0, e[0], e[1]));
    f.axis[2] =
        cloth_v3_unit(cloth_v3_add_scaled(normal, -cloth_v3_dot(normal, f.axis[0]), f.axis[0]));
  }
  f.axis[1] = cloth_v3_cross(f.axis[2], f.axis[0]);
  return f;
}

CLOTH_FN cloth_v3 cloth_friction_tangential(cloth_v3 a, cloth_v3 normal)
{
  return cloth_v3_add_scaled(a, -cloth_v3_dot(a, normal), normal);
}

/// Where `key` would stand in a sorted list.
CLOTH_FN int cloth_friction_lower(const uint64_t *list, int count, uint64_t key)
{
  int lo = 0, hi = count;
  while (lo < hi) {
    int mid = lo + (hi - lo) / 2;
    if (list[mid] < key)
      lo = mid + 1;
    else
      hi = mid;
  }
  return lo;
}

CLOTH_FN int cloth_friction_has(const uint64_t *list, int count, uint64_t key)
{
  int at = cloth_friction_lower(list, count, key);
  return at < count && list[at] == key;
}

/// How far the closest points of contact i move apart in the substep [m].
CLOTH_FN cloth_v3 cloth_friction_motion(int i, const int *vertex, const cloth_real *weight,
                                        const cloth_real *x_t0, const cloth_real *x)
{
  cloth_v3 u = cloth_v3_make(0, 0, 0);
  for (int c = 0; c < 4; c++) {
    int v = vertex[4 * i + c];
    u = cloth_v3_add_scaled(u, weight[4 * i + c],
                            cloth_v3_sub(cloth_v3_load(x, v), cloth_v3_load(x_t0, v)));
  }
  return u;
}
