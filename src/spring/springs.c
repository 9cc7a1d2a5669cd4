// What the mass-spring cloth is made of: its springs, the radius of its particles, and the largest
// sub-step with which it is stable.
//
// Limit. With symplectic Euler a mode of frequency w and damping g (force - g m v) is stable when
// h^2 w^2 + 2 h g < 4. Every spring's stiffness is at most its k in any direction, however the
// cloth is deformed, so rows bound w^2 <= 2 sum(k) / m and g <= 2 sum(c) / m (Gershgorin). Contacts
// of particles take their share of the 4; their stiffness is in units of 1 / h^2.
#include "effect/effect.h"
#include "particle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SUB_STEPS_MOST = 1000000 }; // in a step: beyond, it is no use to wait for its end

#define AUTOMATIC_STEP   0.9 // of the limit
#define AUTOMATIC_RADIUS 0.4 // of the mean edge
// a particle of the densest packing has 12 neighbours: along a direction the squared cosines of
// their normals sum to 4, across it to 8; two equal particles have half the mass of one
#define CONTACT_SHARE                                                                              \
  (2 * 4 * 0.5 * (double)CLOTH_PARTICLE_PUSH + 2 * 2 * 8 * 0.5 * (double)CLOTH_PARTICLE_RUB)

cloth_status cloth_spring_add(cloth_springs *s, const cloth_spring *spring, cloth_error *err)
{
  if (!(spring->stiffness > 0) || !(spring->rest > 0)) return CLOTH_OK;
  if (s->count == s->capacity) {
    int capacity = s->capacity ? 2 * s->capacity : 256;
    cloth_spring *list = realloc(s->list, sizeof *list * (size_t)capacity);
    if (list == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%d springs", capacity);
    s->list = list, s->capacity = capacity;
  }
  s->list[s->count++] = *spring;
  s->of_kind[spring->kind]++;
  s->stiffness[spring->a] += spring->stiffness, s->stiffness[spring->b] += spring->stiffness;
  s->damping[spring->a] += spring->damping, s->damping[spring->b] += spring->damping;
  return CLOTH_OK;
}

void cloth_springs_free(cloth_springs *s)
{
  free(s->list), free(s->stiffness), free(s->damping), free(s->rest_pose);
}

// ---- step limit ---------------------------------------------------------------------------------

// rate at which the wind takes hold of a cloth, at its mean speed [1/s]
static double air_rate(const cloth_sim *sim, int vertex)
{
  if (!sim->active[CLOTH_EFFECT_air]) return 0;
  const cloth_params *p = &sim->params;
  const cloth_material *m = &sim->def->cloth[cloth_of_vertex(sim, vertex)].material;
  double wind = sqrt(p->wind[0] * p->wind[0] + p->wind[1] * p->wind[1] + p->wind[2] * p->wind[2]);
  return p->air_density * fmax(m->drag, m->skin_drag) * wind * (1 + p->gust) / m->density;
}

double cloth_spring_limit(const cloth_sim *sim, int vertex, double held)
{
  double m = sim->mass[vertex];
  double w_sq = (2 * sim->springs.stiffness[vertex] + held) / m;
  double g = 2 * sim->springs.damping[vertex] / m + air_rate(sim, vertex);
  double room = sim->active[CLOTH_EFFECT_self_contact] ? 4 - CONTACT_SHARE : 4;
  if (w_sq > 0) return (sqrt(g * g + room * w_sq) - g) / w_sq;
  return g > 0 ? room / (2 * g) : INFINITY;
}

static cloth_status choose_step(cloth_sim *sim, cloth_error *err)
{
  cloth_springs *s = &sim->springs;
  s->limit = INFINITY;
  for (int v = 0; v < sim->vertex_count; v++) {
    double limit = cloth_spring_limit(sim, v, 0);
    if (limit < s->limit) s->limit = limit, s->limited_by = v;
  }
  for (int i = 0; i < sim->def->pin_count; i++) {
    const cloth_pin_def *pin = &sim->def->pin[i];
    const cloth_group_def *g = &sim->def->cloth[pin->cloth].group[pin->group];
    for (int k = 0; k < g->count && pin->stiffness > 0; k++) {
      int v = sim->internal[sim->cloth_first[pin->cloth] + g->vertex[k]];
      double limit = cloth_spring_limit(sim, v, pin->stiffness);
      if (limit < s->limit) s->limit = limit, s->limited_by = v;
    }
  }
  s->step = sim->params.spring_step;
  if (s->step == 0) s->step = fmin(AUTOMATIC_STEP * s->limit, 0.1);
  if (!(s->step <= s->limit)) {
    int v = s->limited_by;
    const cloth_cloth_def *c = &sim->def->cloth[cloth_of_vertex(sim, v)];
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
               "spring_step = %g [s] is above the stable limit %.4g: vertex %d of cloth %s has "
               "%.4g kg, springs of %.4g N/m and %.4g N s/m; take a smaller step (0: automatic), "
               "softer or less damped material, or a coarser mesh",
               s->step, s->limit, sim->order[v], c->name, sim->mass[v], s->stiffness[v],
               s->damping[v]);
  }
  int count;
  return cloth_spring_sub_steps(sim, sim->params.time_step, &count, err);
}

cloth_status cloth_spring_sub_steps(const cloth_sim *sim, double h, int *count, cloth_error *err)
{
  const cloth_springs *s = &sim->springs;
  double n = ceil(h / fmin(s->step, h) - 1e-9);
  if (!(n <= SUB_STEPS_MOST)) {
    int v = s->limited_by;
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
               "a step of %g s needs %.3g sub-steps of %.3g s, and at most %d are taken: vertex %d "
               "of cloth %s has %.4g kg, springs of %.4g N/m and %.4g N s/m; take softer or less "
               "damped material, or a coarser mesh",
               h, n, s->step, SUB_STEPS_MOST, sim->order[v],
               sim->def->cloth[cloth_of_vertex(sim, v)].name, sim->mass[v], s->stiffness[v],
               s->damping[v]);
  }
  *count = n < 1 ? 1 : (int)n;
  return CLOTH_OK;
}

// ---- making -------------------------------------------------------------------------------------

static cloth_status check_bodies(const cloth_sim *sim, cloth_error *err)
{
  for (int b = 0; b < sim->def->body_count && sim->active[CLOTH_EFFECT_body_contact]; b++)
    if (sim->def->body[b].shape == CLOTH_SHAPE_MESH)
      CLOTH_FAIL(err, CLOTH_UNSUPPORTED,
                 "body %s is a mesh: integrator mass_spring collides with boxes, spheres, "
                 "cylinders and planes (or switch the effect body_contact off)",
                 sim->def->body[b].name);
  return CLOTH_OK;
}

static void describe(cloth_sim *sim)
{
  const cloth_springs *s = &sim->springs;
  char *why = sim->why[CLOTH_EFFECT_springs];
  snprintf(why, sizeof sim->why[0],
           "%d stretch, %d shear, %d bend springs; sub-step %.4g s, stable up to %.4g s; particles "
           "of %.3g m",
           s->of_kind[CLOTH_SPRING_STRETCH], s->of_kind[CLOTH_SPRING_SHEAR],
           s->of_kind[CLOTH_SPRING_BEND], s->step, s->limit, s->radius);
}

cloth_status cloth_springs_make(cloth_sim *sim, cloth_error *err)
{
  if (!cloth_is_mass_spring(sim)) return CLOTH_OK;
  cloth_springs *s = &sim->springs;
  CLOTH_TRY(check_bodies(sim, err));
  s->stiffness = calloc((size_t)sim->vertex_count + 1, sizeof *s->stiffness);
  s->damping = calloc((size_t)sim->vertex_count + 1, sizeof *s->damping);
  if (!s->stiffness || !s->damping)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "springs of %d particles", sim->vertex_count);
  s->radius = sim->params.particle_radius;
  if (s->radius == 0) s->radius = AUTOMATIC_RADIUS * sim->mean_edge;
  if (sim->active[CLOTH_EFFECT_springs]) CLOTH_TRY(cloth_springs_net(sim, err));
  CLOTH_TRY(choose_step(sim, err));
  if (sim->active[CLOTH_EFFECT_springs]) describe(sim);
  return CLOTH_OK;
}
