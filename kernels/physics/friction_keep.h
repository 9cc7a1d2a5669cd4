// The substep stands: what contact i remembers of it. A contact that opened remembers nothing.
#pragma once

#include "friction_law.h"

typedef struct cloth_friction_keep_args {
  cloth_contact_scene scene;
  const uint64_t *contact;     // [n]
  const int *vertex;           // [n x 4]
  const cloth_real *weight;    // [n x 4]
  const cloth_real *normal;    // [n x 3]
  const cloth_real *distance;  // [n] m, at the start of the substep
  const cloth_real *thickness; // [n] m
  const cloth_real *elastic;   // [n x 3] m
  cloth_real limit;            // m
  uint64_t *kept;              // [n], written
  cloth_real *kept_slip;       // [n x 3] m in the frame of the pair, written
} cloth_friction_keep_args;

CLOTH_FN void cloth_friction_keep(int i, const cloth_friction_keep_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_v3 n = cloth_v3_load(a->normal, i);
  cloth_v3 u = cloth_friction_motion(i, a->vertex, a->weight, s->x_t0, s->x);
  cloth_v3 slip = cloth_v3_add(cloth_v3_load(a->elastic, i), cloth_friction_tangential(u, n));
  cloth_real size = cloth_v3_length(slip);
  if (!(a->distance[i] + cloth_v3_dot(u, n) < a->thickness[i]))
    slip = cloth_v3_make(0, 0, 0);
  else if (!(size <= CLOTH_FRICTION_STATIC * a->limit))
    slip = cloth_v3_scale(CLOTH_FRICTION_KINETIC * a->limit / size, slip);
  cloth_friction_frame f =
      cloth_friction_frame_of(s, cloth_pair_unpack(s->format, a->contact[i]), n);
  a->kept[i] = a->contact[i];
  for (int k = 0; k < 3; k++) a->kept_slip[3 * i + k] = cloth_v3_dot(slip, f.axis[k]);
}
