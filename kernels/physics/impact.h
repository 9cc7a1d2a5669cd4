// Does a candidate pair come to an impact on the straight way from the start to the end of the
// substep?
#pragma once

#include "contact_find.h"
#include "toi.h"

#define CLOTH_IMPACT_SHARE                                                                         \
  (cloth_real)0.1 // a pair that starts closer keeps this much of its distance

/// 1 if the pair's distance falls to min(gap, CLOTH_IMPACT_SHARE times that at the start), with the
/// time, never late, in *toi [0, 1] and the four vertices in *g. moved: [cloth vertices] pairs
/// without a vertex so marked are known to be free; NULL tests all.
CLOTH_FN int cloth_impact(const cloth_contact_scene *s, uint64_t key, cloth_real gap,
                          const unsigned char *moved, cloth_contact_geometry *g, cloth_real *toi)
{
  // an edge cannot cross a flat face of a body but with an end, which a vertex-face pair sees
  if (cloth_contact_on_seam(s, cloth_pair_unpack(s->format, key))) return 0;
  cloth_pair_vertices(s, key, g);
  if (moved) {
    int any = 0;
    for (int k = 0; k < 4; k++) any |= g->vertex[k] < s->cloth_vertices && moved[g->vertex[k]];
    if (!any) return 0;
  }
  if (!cloth_pair_near(s, g, gap) || cloth_contact_ignored(s, g)) return 0;
  cloth_v3 p[4], q[4]; // as stored: toi.h accounts for their rounding
  for (int k = 0; k < 4; k++) {
    p[k] = cloth_v3_load(s->x_t0, g->vertex[k]);
    q[k] = cloth_v3_load(s->x, g->vertex[k]);
  }
  return g->type == CLOTH_VERTEX_FACE ? cloth_toi_vertex_face(p, q, gap, CLOTH_IMPACT_SHARE, toi)
                                      : cloth_toi_edge_edge(p, q, gap, CLOTH_IMPACT_SHARE, toi);
}
