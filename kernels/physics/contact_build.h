// Contact i as a plane for this substep: normal and weights from the start of the substep, when
// nothing had passed through, so the side is known; the distance along it changes with the solve. A
// pair that came to an impact in spite of that is measured where it did, and that plane takes the
// place of an earlier one.
//
// Stiffness: from mass and step, so that conditioning does not depend on either. That is enough for
// what one vertex weighs; behind the first vertex of a falling towel that meets the floor comes all
// the rest. So a pair that passed in spite of its contact gets a stiffer one in the next system, as
// the penalty of an augmented Lagrangian grows where the constraint is not met.
#pragma once

#include "contact_barrier.h"
#include "tangle_pull.h"

typedef struct cloth_contact_build_args {
  cloth_contact_scene scene;
  int count;
  cloth_real stiffness;    // in units of mass / step^2
  cloth_real share;        // of a step that is not cut, that the stiffness is made from
  cloth_real stiffer;      // factor for each time that the pair came to an impact
  cloth_real inverse_step; // 1/s
  const uint64_t *contact; // [n] sorted; a pair's latest plane is its last
  const uint32_t *toi;     // [n] 0, or the time of an impact of CLOTH_WHOLE
  int *vertex;             // [n x 4], written
  cloth_real *weight;      // [n x 4], written
  cloth_real *normal;      // [n x 3], written
  cloth_real *distance;    // [n] m at the start of the substep, written
  cloth_real *thickness;   // [n] m, written
  cloth_real *k;           // [n] N/m, written
  cloth_real *inertia;     // [n] N/m, mass / step^2 of what the contact moves, written
  cloth_real *relief;      // [n] N that the force is less than the barrier, written
  cloth_real *mu;          // [n] Coulomb coefficient, written
} cloth_contact_build_args;

#define CLOTH_CONTACT_PUSHED ((cloth_real)1e-3) // of the thickness, by a body that moves
#define CLOTH_CONTACT_LEAST  (cloth_real)0.5    // of the thickness, that an impact's contact keeps

// The factor of contact i. The planes of a pair stand one after the other, one for each impact.
CLOTH_FN cloth_real cloth_contact_stiffer(int i, const cloth_contact_build_args *a)
{
  cloth_real factor = 1;
  for (int j = i; j >= 0 && a->contact[j] == a->contact[i]; j--)
    if (a->toi[j] > 0) factor *= a->stiffer;
  return factor;
}

// How far the body of a contact comes nearer to the cloth in this substep [m]. What it sweeps along
// is no store of energy but driven: with the force of a whole step's spring it would come closer
// for being fast, and throw the cloth off in the end.
CLOTH_FN cloth_real cloth_contact_pushed(const cloth_contact_scene *s,
                                         const cloth_contact_geometry *g)
{
  cloth_v3 u = cloth_v3_make(0, 0, 0);
  for (int c = 0; c < 4; c++) {
    int v = g->vertex[c];
    if (v < s->cloth_vertices) continue;
    cloth_v3 way = cloth_v3_sub(cloth_v3_load(s->x, v), cloth_v3_load(s->x_t0, v));
    u = cloth_v3_add_scaled(u, g->weight[c], way);
  }
  return -cloth_v3_dot(u, g->normal);
}

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
  cloth_real d = pulls ? t - s->pull : g.distance;
  if (a->toi[i] > 0) {
    d = cloth_contact_along(&g, s->x_t0);
    // stiff as it is, it stops what meets, and leaves opening a narrow gap to the milder ones
    cloth_real least = t * CLOTH_CONTACT_LEAST;
    t = d < least ? least : d < t ? d : t;
  }
  a->distance[i] = d;
  a->thickness[i] = t;

  int counts = inverse_mass > 0 && !replaced, body = cloth_contact_body(s, &g);
  cloth_real k = counts ? a->stiffness * a->inverse_step * a->inverse_step / inverse_mass : 0;
  a->inertia[i] = k / a->stiffness;
  if (pulls && body >= 0) k *= CLOTH_PULL_BODY_STIFFER;
  a->k[i] = counts ? k * cloth_contact_stiffer(i, a) : 0;
  int relieved = !pulls && !(cloth_contact_pushed(s, &g) > t * CLOTH_CONTACT_PUSHED);
  a->relief[i] = relieved ? cloth_contact_relief(a->k[i], t, d, a->share) : 0;
  a->mu[i] = pulls ? 0 : body >= 0 ? s->body_friction[body] : s->friction;
}
