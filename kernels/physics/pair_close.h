// Which candidates can come to an impact at all? Features that are `distance` apart at the start of
// a substep keep at least distance - (what a corner of one moves against one of the other) of it on
// straight ways, for the way between any two of their points is a mean of the ways between corners.
// toi.h sees as much in its first step, along the normal between the nearest points; but rounding
// may turn that normal by a few epsilon size / distance, which takes size times that off, and toi.h
// keeps 128 epsilon size for itself.
#pragma once

#include "contact_geometry.h"

/// What rounding may take off a distance [m] between features that span `size` [m].
CLOTH_FN cloth_real cloth_pair_rounding(cloth_real size, cloth_real distance)
{
  return CLOTH_REAL_EPSILON * size * (160 + 4 * size / distance);
}

/// Does a corner of one feature, on its way u [m], move by `most` [m] or more against one of the
/// other? Also where `most` is not above 0.
CLOTH_FN int cloth_pair_moves(const cloth_v3 u[4], int type, cloth_real most)
{
  int split = type == CLOTH_VERTEX_FACE ? 1 : 2;
  if (!(most > 0)) return 1;
  for (int i = 0; i < split; i++)
    for (int j = split; j < 4; j++) {
      cloth_v3 d = cloth_v3_sub(u[j], u[i]);
      if (!(cloth_v3_dot(d, d) < most * most)) return 1;
    }
  return 0;
}

/// May features, measured at x_t0 (g), come nearer than `reach` [m] on the way to x, as far as
/// rounding lets tell?
CLOTH_FN int cloth_pair_close(const cloth_contact_scene *s, const cloth_contact_geometry *g,
                              cloth_real reach)
{
  cloth_v3 u[4], lo = cloth_v3_load(s->x_t0, g->vertex[0]), hi = lo;
  for (int k = 0; k < 4; k++) {
    cloth_v3 x = cloth_v3_load(s->x_t0, g->vertex[k]);
    u[k] = cloth_v3_sub(cloth_v3_load(s->x, g->vertex[k]), x);
    lo = cloth_v3_min(lo, x), hi = cloth_v3_max(hi, x);
  }
  cloth_real size = hi.x - lo.x + (hi.y - lo.y) + (hi.z - lo.z);
  return cloth_pair_moves(u, g->type, g->distance - reach - cloth_pair_rounding(size, g->distance));
}
