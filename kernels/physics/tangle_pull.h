// Working out an intersection: contacts whose side is not where the vertex is but where it has to
// go. What has strayed through a face is pushed on through it. Each is a contact at `pull` below
// its distance, so the cloth moves about that far in a substep, the momentum of cloth with cloth
// stays, and everything else goes on as with any contact. Out of a body a pull may have to lift all
// that hangs below it: its spring is stiffer than a contact's, which moves it no farther. (As stiff
// as a contact it lifts five times the weight of its vertex at 1/60 s; a towel held above came to
// rest halfway off a cube.)
#pragma once

#include "contact_geometry.h"

#define CLOTH_PULL_BODY_STIFFER (cloth_real)4 // times the spring of a contact

CLOTH_FN cloth_v3 cloth_unit_or_zero(cloth_v3 a)
{
  cloth_real length = cloth_v3_length(a);
  return length > 0 ? cloth_v3_scale(1 / length, a) : cloth_v3_make(0, 0, 0);
}

CLOTH_FN cloth_v3 cloth_face_normal(const cloth_contact_scene *s, int t)
{
  const int *c = s->triangle + 3 * t;
  cloth_v3 o = cloth_v3_load(s->x_t0, c[0]);
  return cloth_unit_or_zero(cloth_v3_cross(cloth_v3_sub(cloth_v3_load(s->x_t0, c[1]), o),
                                           cloth_v3_sub(cloth_v3_load(s->x_t0, c[2]), o)));
}

/// Vertices, weights and direction of a pull; the distance is left to the caller.
CLOTH_FN void cloth_tangle_pull(const cloth_contact_scene *s, cloth_pair pair,
                                cloth_contact_geometry *g)
{
  cloth_v3 normal = cloth_face_normal(s, pair.b);
  g->type = CLOTH_VERTEX_FACE;
  g->vertex[0] = pair.a;
  for (int k = 0; k < 3; k++) g->vertex[1 + k] = s->triangle[3 * pair.b + k];
  cloth_contact_measure(s->x_t0, g);
  g->normal = pair.type == CLOTH_PULL_BACK ? cloth_v3_scale(-1, normal) : normal;
}
