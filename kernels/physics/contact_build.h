// Contact i as a plane for this substep: normal and weights from the start of the substep, when
// nothing had passed through, so the side is known; the distance along it changes with the solve. A
// pair that came to an impact in spite of that is measured where it did, and that plane takes the
// place of an earlier one.
//
// Stiffness: from mass and step, so that conditioning does not depend on either.
#pragma once

#include "tangle_pull.h"

typedef struct cloth_contact_build_args {
  cloth_contact_scene scene;
  int count;
  cloth_real stiffness;    // in units of mass / step^2
  cloth_real inverse_step; // 1/s
  const uint64_t *contact; // [n] sorted; a pair's latest plane is its last
  const uint32_t *toi;     // [n] 0, or the time of an impact of CLOTH_WHOLE
  int *vertex;             // [n x 4], written
  cloth_real *weight;      // [n x 4], written
  cloth_real *normal;      // [n x 3], written
  cloth_real *distance;    // [n] m at the start of the substep, written
  cloth_real *thickness;   // [n] m, written
  cloth_real *k;           // [n] N/m, written
  cloth_real *mu;          // [n] Coulomb coefficient, written
} cloth_contact_build_args;

CLOTH_FN void cloth_contact_build(int i, const cloth_contact_build_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_contact_geometry g;
  cloth_pair pair = cloth_pair_unpack(s->format, a->contact[i]);
  int pulls = pair.type >= CLOTH_PULL_FRONT;
  int replaced = i + 1 < a->count && a->contact[i + 1] == a->contact[i];
  if (pulls)
    cloth_tangle_pull(s, pair, &g);
  else
    cloth_pair_vertices(s, a->contact[i], &g);
  if (a->toi[i] > 0)
    cloth_contact_measure_at(s, (cloth_real)a->toi[i] / (cloth_real)CLOTH_WHOLE, &g);
  else if (!pulls)
    cloth_contact_measure(s->x_t0, &g);

  cloth_real inverse_mass = 0;
  for (int c = 0; c < 4; c++) {
    int v = g.vertex[c];
    a->vertex[4 * i + c] = v;
    a->weight[4 * i + c] = g.weight[c];
    if (v < s->cloth_vertices && s->free[v] > 0)
      inverse_mass += g.weight[c] * g.weight[c] / s->mass[v];
  }
  cloth_v3_store(a->normal, i, g.normal);
  cloth_real t = pulls ? s->thickness : cloth_contact_thickness(s, &g);
  a->distance[i] = pulls           ? t - s->pull
                   : a->toi[i] > 0 ? cloth_contact_along(&g, s->x_t0)
                                   : g.distance;
  a->thickness[i] = t;

  int counts = inverse_mass > 0 && !replaced;
  a->k[i] = counts ? a->stiffness * a->inverse_step * a->inverse_step / inverse_mass : 0;
  int body = cloth_contact_body(s, &g);
  a->mu[i] = pulls ? 0 : body >= 0 ? s->body_friction[body] : s->friction;
}
