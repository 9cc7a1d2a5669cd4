// Bending, by one of three models: kernels/physics/bend.h, bend_quadratic.h, bend_shape.h.
#include "bend.h"
#include "bend_quadratic.h"
#include "bend_shape.h"
#include "effect/bend_rest.h"
#include "effect/effect.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool wanted(const cloth_sim *sim, char why[160])
{
  if (cloth_is_mass_spring(sim)) {
    snprintf(why, 160, "integrator mass_spring has springs instead");
    return false;
  }
  for (int c = 0; c < sim->def->cloth_count && sim->hinge_count > 0; c++) {
    const cloth_material *m = &sim->def->cloth[c].material;
    if (!(m->bend_warp > 0 || m->bend_weft > 0)) continue;
    snprintf(why, 160, "cloth %s: bend_warp = %g, bend_weft = %g N m", sim->def->cloth[c].name,
             m->bend_warp, m->bend_weft);
    return true;
  }
  snprintf(why, 160,
           sim->hinge_count > 0 ? "no material resists bending" : "no two triangles share an edge");
  return false;
}

static void measured(const cloth_material *m, double *row)
{
  memcpy(row, m->measured_bending, sizeof m->measured_bending);
}

// the tables of measured fabrics, if there is one, and where in them each patch looks
static cloth_status prepare_measured(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  const cloth_bend_rest *r = sim->bend_rest;
  bool any = false;
  int n = part->bend.count;
  for (int c = 0; c < sim->def->cloth_count; c++)
    any |= sim->def->cloth[c].material.measured_bending[0] > 0;
  if (!any || r->corners != 6) return CLOTH_OK;
  double *direction = malloc(sizeof(double) * 6 * (size_t)(n + 1));
  int *material = malloc(sizeof(int) * (size_t)(n + 1));
  cloth_status status = CLOTH_NO_MEMORY;
  if (!direction || !material) {
    cloth_fail(err, status, __FILE__, __LINE__, "measured bending of %d triangles", n);
    goto done;
  }
  for (int i = 0; i < n; i++) {
    int from = part->bend.which[i];
    memcpy(direction + 6 * i, r->direction + 6 * from, sizeof(double) * 6);
    material[i] = r->cloth[from];
  }
  CLOTH_TRY_GOTO(
      cloth_upload_real(sim, part, "direction", direction, 6 * n, &part->bend_direction, err),
      status, done);
  CLOTH_TRY_GOTO(cloth_upload(sim, part, "material", material, sizeof(int) * (size_t)n,
                              &part->bend_material, err),
                 status, done);
  CLOTH_TRY_GOTO(
      cloth_upload_materials(sim, part, "measured", 15, measured, &part->bend_measured, err),
      status, done);
  status = CLOTH_OK;
done:
  free(direction), free(material);
  return status;
}

static cloth_status prepare(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  if (sim->bend_rest == NULL) CLOTH_TRY(cloth_bend_rest_new(sim, &sim->bend_rest, err));
  const cloth_bend_rest *r = sim->bend_rest;
  int sets = r->corners == 6 ? 6 : 1, angles = r->corners == 6 ? 3 : 1;
  CLOTH_TRY(cloth_elements_select(part, r->count, r->corners, r->vertex, true, &part->bend, err));
  part->bend.owner = CLOTH_EFFECT_bending;
  int n = part->bend.count;
  bool constant = sim->params.bending_model == CLOTH_BENDING_QUADRATIC;
  double *stiffness = malloc(sizeof(double) * (size_t)(sets * n + 1));
  double *angle = malloc(sizeof(double) * (size_t)(angles * n + 1));
  double *weight = malloc(sizeof(double) * (size_t)(4 * n + 1));
  cloth_status status = CLOTH_NO_MEMORY;
  if (!stiffness || !angle || !weight) {
    cloth_fail(err, status, __FILE__, __LINE__, "bending of %d elements", n);
    goto done;
  }
  for (int i = 0; i < n; i++) {
    int from = part->bend.which[i];
    memcpy(stiffness + sets * i, r->stiffness + sets * from, sizeof(double) * (size_t)sets);
    memcpy(angle + angles * i, r->angle + angles * from, sizeof(double) * (size_t)angles);
    memcpy(weight + 4 * i, r->weight + 4 * from, sizeof(double) * 4);
  }
  CLOTH_TRY_GOTO(
      cloth_upload_real(sim, part, "stiffness", stiffness, sets * n, &part->bend_stiffness, err),
      status, done);
  if (constant)
    CLOTH_TRY_GOTO(cloth_upload_real(sim, part, "weight", weight, 4 * n, &part->bend_constant, err),
                   status, done);
  else
    CLOTH_TRY_GOTO(
        cloth_upload_real(sim, part, "rest_angle", angle, angles * n, &part->bend_rest, err),
        status, done);
  status = prepare_measured(sim, part, err);
done:
  free(stiffness), free(angle), free(weight);
  return status;
}

static cloth_status upload(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  size_t n = (size_t)part->bend.count, corners = (size_t)part->bend.corners;
  bool patches = corners == 6;
  CLOTH_TRY(cloth_take(sim, part, "damping", sizeof(cloth_real) * n, &part->bend_damping, err));
  CLOTH_TRY(
      cloth_take(sim, part, "force", sizeof(cloth_real) * 3 * corners * n, &part->bend_force, err));
  if (part->bend_constant == NULL)
    CLOTH_TRY(cloth_take(sim, part, "gradient", sizeof(cloth_real) * (patches ? 36 : 12) * n,
                         &part->bend_gradient, err));
  return cloth_take(sim, part, "weight", sizeof(cloth_real) * (patches ? 6 : 1) * n,
                    &part->bend_weight, err);
}

static cloth_status apply(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  int n = p->bend.count;
  if (p->bend.corners == 6) {
    cloth_bend_shape_args a = {
        p->bend.vertex,          p->bend_stiffness, p->bend_rest,     p->bend_damping,
        p->bend_direction,       p->bend_measured,  p->bend_material, p->x,
        cloth_step_from(sim, p), p->free,           p->bend_force,    p->bend_gradient,
        p->bend_weight};
    return cloth_launch(sim, p, CLOTH_KERNEL_bend_shape, n, &a, err);
  }
  if (p->bend_constant) {
    cloth_bend_quadratic_args a = {
        p->bend.vertex,          p->bend_stiffness, p->bend_constant, p->bend_damping, p->x,
        cloth_step_from(sim, p), p->free,           p->bend_force,    p->bend_weight};
    return cloth_launch(sim, p, CLOTH_KERNEL_bend_quadratic, n, &a, err);
  }
  cloth_bend_args a = {
      p->bend.vertex,          p->bend_stiffness, p->bend_rest,  p->bend_damping,  p->x,
      cloth_step_from(sim, p), p->free,           p->bend_force, p->bend_gradient, p->bend_weight};
  return cloth_launch(sim, p, CLOTH_KERNEL_bend, n, &a, err);
}

const cloth_effect cloth_effect_bending = {
    .name = "bending",
    .source = "Grinspun et al. 2003 (hinge) and 2006 (shape), Bergou et al. 2006 (quadratic); "
              "Gauss-Newton tangent",
    .wanted = wanted,
    .prepare = prepare,
    .upload = upload,
    .apply = apply,
};
