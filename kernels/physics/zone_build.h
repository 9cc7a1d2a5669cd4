// An impact as a constraint on where the substep ends: at its time of impact the closest points of
// the two features and the direction between them are taken, and along that direction the same
// points must be apart at the end (Harmon, Vouga, Tamstorf, Grinspun, Robust treatment of
// simultaneous collisions, 2008, with a gap: the direction is known however thin the cloth).
#pragma once

#include "impact.h"

typedef struct cloth_zone_build_args {
  cloth_contact_scene scene;
  cloth_real gap;      // m, distance that counts as an impact
  const int *fresh;    // [n] constraints found in this round
  const uint64_t *key; // [constraints]
  const uint32_t *toi; // [constraints] of CLOTH_WHOLE
  int *vertex;         // [constraints x 4], written
  cloth_real *weight;  // [constraints x 4], written
  cloth_real *normal;  // [constraints x 3], written
  cloth_real *apart;   // [constraints] m, least sum w_k n . x_k at the end, written
} cloth_zone_build_args;

// How far apart what started at a distance [m] has to end: twice what counts as an impact, or half
// of what there was, five times what impact.h asks for. Features that were nearer than an impact is
// wide have to open again: a pair that halves its distance with each substep in which it is pressed
// together comes to where rounding decides on which side it is. So has all that has strayed, which
// no contact force opens.
CLOTH_FN cloth_real cloth_zone_apart(cloth_real distance, cloth_real gap, int strayed)
{
  cloth_real opened = distance * (cloth_real)1.25, apart = distance / 2;
  if (strayed) return opened < 2 * gap ? opened : 2 * gap;
  if (apart < gap) apart = opened < gap ? opened : gap;
  return apart < 2 * gap ? apart : 2 * gap;
}

CLOTH_FN void cloth_zone_build(int i, const cloth_zone_build_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  int c = a->fresh[i];
  cloth_contact_geometry g;
  cloth_pair_vertices(s, a->key[c], &g);
  cloth_contact_measure(s->x_t0, &g);
  a->apart[c] = cloth_zone_apart(g.distance, a->gap, cloth_contact_strayed(s, &g));
  cloth_contact_measure_at(s, (cloth_real)a->toi[c] / (cloth_real)CLOTH_WHOLE, &g);
  for (int k = 0; k < 4; k++) {
    a->vertex[4 * c + k] = g.vertex[k];
    a->weight[4 * c + k] = g.weight[k];
  }
  cloth_v3_store(a->normal, c, g.normal);
}
