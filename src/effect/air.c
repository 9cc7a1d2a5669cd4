// Drag of the air on every triangle; kernels/physics/drag.h holds the model.
#include "drag.h"
#include "effect/effect.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static bool wanted(const cloth_sim *sim, char why[160])
{
  bool any = false;
  for (int c = 0; c < sim->def->cloth_count; c++)
    any |= sim->def->cloth[c].material.drag > 0 || sim->def->cloth[c].material.skin_drag > 0;
  const double *w = sim->params.wind;
  snprintf(why, 160, "air_density = %g kg/m^3, wind = %g %g %g m/s%s", sim->params.air_density,
           w[0], w[1], w[2], any ? "" : ", but no material has drag");
  return sim->params.air_density > 0 && any;
}

static cloth_status prepare(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  CLOTH_TRY(
      cloth_elements_select(part, sim->triangle_count, 3, sim->triangle, false, &part->drag, err));
  part->drag.owner = CLOTH_EFFECT_air;
  size_t n = (size_t)part->drag.count;
  int *material = malloc(sizeof *material * (n + 1));
  if (material == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "air on %zu triangles", n);
  for (size_t i = 0; i < n; i++) material[i] = cloth_of_triangle(sim, part->drag.which[i]);
  cloth_status status =
      cloth_upload(sim, part, "material", material, sizeof(int) * n, &part->drag_material, err);
  free(material);
  return status;
}

static void coefficients(const cloth_material *m, double *row)
{
  row[0] = m->drag, row[1] = m->skin_drag;
}

static cloth_status upload(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  size_t n = (size_t)part->drag.count;
  CLOTH_TRY(
      cloth_upload_materials(sim, part, "drag", 2, coefficients, &part->drag_coefficient, err));
  CLOTH_TRY(cloth_take(sim, part, "force", sizeof(cloth_real) * 3 * n, &part->drag_force, err));
  return cloth_take(sim, part, "tangent", sizeof(cloth_real) * 6 * n, &part->drag_tangent, err);
}

double cloth_gust(const cloth_params *params, double time)
{
  const double pi = 3.14159265358979323846;
  return 1 + params->gust * sin(2 * pi * time / params->gust_period);
}

static cloth_status apply(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  const cloth_params *q = &sim->params;
  double gust = cloth_gust(q, sim->time_t0);
  cloth_drag_args a = {.triangle = p->drag.vertex,
                       .material = p->drag_material,
                       .drag = p->drag_coefficient,
                       .half_density = (cloth_real)(q->air_density / 2),
                       .inverse_step = (cloth_real)(1 / sim->gamma),
                       .x = p->x,
                       .x_t0 = cloth_step_from(sim, p),
                       .force = p->drag_force,
                       .tangent = p->drag_tangent};
  for (int k = 0; k < 3; k++) a.wind[k] = (cloth_real)(gust * q->wind[k]);
  return cloth_launch(sim, p, CLOTH_KERNEL_drag, p->drag.count, &a, err);
}

const cloth_effect cloth_effect_air = {
    .name = "air",
    .source = "quadratic pressure and skin drag on a flat plate",
    .wanted = wanted,
    .prepare = prepare,
    .upload = upload,
    .apply = apply,
};
