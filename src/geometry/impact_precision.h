// The search of impact_search.h in the precision that real.h has: contact itself, no gap. Included
// by impact_f32.c and impact_f64.c.
#pragma once

#include "geometry/impact_search.h"
#include "toi.h"

static inline int cloth_impact_in_precision(int split, const double x[8][3], double *toi)
{
  cloth_v3 point[8];
  cloth_real found = 0;
  for (int k = 0; k < 8; k++)
    point[k] = cloth_v3_make((cloth_real)x[k][0], (cloth_real)x[k][1], (cloth_real)x[k][2]);
  int hit = split == 1 ? cloth_toi_vertex_face(point, point + 4, 0, 0, &found)
                       : cloth_toi_edge_edge(point, point + 4, 0, 0, &found);
  *toi = (double)found;
  return hit;
}
