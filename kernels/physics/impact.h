// Does a candidate pair come to an impact on the straight way from the start to the end of the
// substep?
#pragma once

#include "carrier.h"
#include "contact_find.h"
#include "toi.h"
#include "triangle_cross.h"

#define CLOTH_IMPACT_SHARE                                                                         \
  (cloth_real)0.1 // a pair that starts closer keeps this much of its distance

// likewise of features that have strayed: no contact force opens them again
#define CLOTH_IMPACT_SHARE_STRAYED (cloth_real)0.5

// May strayed features pass through each other? They may while they are being worked out, or if
// they touch, so that they have no side. Otherwise each is kept on the side where it is, and no
// edge comes to pierce a face that it did not pierce.
CLOTH_FN int cloth_impact_let(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  return (cloth_contact_body(s, g) >= 0 ? s->let_body : s->let_cloth) ||
         cloth_contact_touches(s, g);
}

enum { CLOTH_NO_IMPACT = 0, CLOTH_IMPACT = 1, CLOTH_IMPACT_DRIVEN = 2 };

// Does nothing in the pair move? Then it has no impact, however near it is: what the failsafe has
// stopped is clean, and toi.h cannot tell (in float, from 8 um off a face of 0.5 m, it counts any).
CLOTH_FN int cloth_impact_rests(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 3; c++)
      if (!(s->x_t0[3 * g->vertex[k] + c] == s->x[3 * g->vertex[k] + c])) return 0;
  return 1;
}

// Does all of the pair ride on one carrier? Then it moves as one, but for rounding.
CLOTH_FN int cloth_impact_rides(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  if (!s->carrier) return 0;
  uint32_t first = s->carrier[g->vertex[0]];
  int same = (first & CLOTH_RIDES) != 0;
  for (int k = 1; k < 4; k++) same &= s->carrier[g->vertex[k]] == first;
  return same;
}

// Is all of the pair in one hold?
CLOTH_FN int cloth_impact_in_one_hold(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  int hold = 0;
  for (int k = 0; k < 4; k++) {
    int of = g->vertex[k] < s->cloth_vertices ? s->grasp_of[g->vertex[k]] : 0;
    if (of == 0 || (k > 0 && of != hold)) return 0;
    hold = of;
  }
  return 1;
}

// Which way round the four points are at the end (1) or the start (0): 1, -1, or 0 in one plane. In
// double: in float a vertex that is held a hair above a large floor would be told to be in it.
CLOTH_FN int cloth_impact_turn(const cloth_contact_scene *s, const cloth_contact_geometry *g,
                               int end)
{
  const cloth_real *x = end ? s->x : s->x_t0;
  double at[4][3];
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 3; c++) at[k][c] = (double)x[3 * g->vertex[k] + c];
  return cloth_side_of_plane(at[1], at[2], at[3], at[0]);
}

// Does a pair in which nothing gives way pass through, or end in touch? It may come as near as it
// is told: nothing is to be kept apart, so only what happens counts.
CLOTH_FN int cloth_impact_driven(const cloth_contact_scene *s, const cloth_contact_geometry *g,
                                 const cloth_v3 p[4], const cloth_v3 q[4])
{
  cloth_real toi;
  int meets = g->type == CLOTH_VERTEX_FACE ? cloth_toi_vertex_face(p, q, 0, 0, &toi)
                                           : cloth_toi_edge_edge(p, q, 0, 0, &toi);
  if (!meets) return CLOTH_NO_IMPACT;
  int turn = cloth_impact_turn(s, g, 0);
  return turn == 0 || turn != cloth_impact_turn(s, g, 1) ? CLOTH_IMPACT_DRIVEN : CLOTH_NO_IMPACT;
}

/// CLOTH_IMPACT if the pair's distance falls to min(gap, CLOTH_IMPACT_SHARE times that at the
/// start), with the time, never late, in *toi [0, 1] and the four vertices in *g.
/// CLOTH_IMPACT_DRIVEN, without a time, if nothing in the pair gives way and it passes through.
/// moved: [cloth vertices] pairs without a vertex so marked are known to be free; NULL tests all.
CLOTH_FN int cloth_impact(const cloth_contact_scene *s, uint64_t key, cloth_real gap,
                          const unsigned char *moved, cloth_contact_geometry *g, cloth_real *toi)
{
  // an edge cannot cross a flat face of a body but with an end, which a vertex-face pair sees
  if (cloth_contact_on_seam(s, cloth_pair_unpack(s->format, key))) return CLOTH_NO_IMPACT;
  cloth_pair_vertices(s, key, g);
  if (moved) {
    int any = 0;
    for (int k = 0; k < 4; k++) any |= g->vertex[k] < s->cloth_vertices && moved[g->vertex[k]];
    if (!any) return CLOTH_NO_IMPACT;
  }
  if (!cloth_pair_near(s, g, gap) || cloth_contact_grasped(s, g)) return CLOTH_NO_IMPACT;
  int driven = cloth_contact_driven(s, g);
  if (cloth_impact_rests(s, g) || (driven && cloth_impact_in_one_hold(s, g)))
    return CLOTH_NO_IMPACT;
  cloth_real share = CLOTH_IMPACT_SHARE;
  if (cloth_contact_strayed(s, g)) {
    if (cloth_impact_let(s, g)) return CLOTH_NO_IMPACT;
    share = CLOTH_IMPACT_SHARE_STRAYED;
  }
  cloth_v3 p[4], q[4]; // as stored: toi.h accounts for their rounding
  for (int k = 0; k < 4; k++) {
    p[k] = cloth_v3_load(s->x_t0, g->vertex[k]);
    q[k] = cloth_v3_load(s->x, g->vertex[k]);
  }
  if (driven) return cloth_impact_driven(s, g, p, q);
  if (cloth_impact_rides(s, g)) {
    *toi = 0;
    return cloth_impact_driven(s, g, p, q) == CLOTH_NO_IMPACT ? CLOTH_NO_IMPACT : CLOTH_IMPACT;
  }
  return g->type == CLOTH_VERTEX_FACE ? cloth_toi_vertex_face(p, q, gap, share, toi)
                                      : cloth_toi_edge_edge(p, q, gap, share, toi);
}
