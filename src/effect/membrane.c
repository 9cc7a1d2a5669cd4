// Stretch and shear of every triangle; kernels/physics/membrane.h holds the model.
#include "membrane.h"

#include "effect/effect.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool wanted(const cloth_sim *sim, char why[160])
{
  if (cloth_is_mass_spring(sim)) {
    snprintf(why, 160, "integrator mass_spring has springs instead");
    return false;
  }
  for (int c = 0; c < sim->def->cloth_count; c++) {
    const cloth_material *m = &sim->def->cloth[c].material;
    if (!(m->stretch_warp > 0 || m->stretch_weft > 0 || m->shear > 0)) continue;
    snprintf(why, 160, "cloth %s: stretch_warp = %g, stretch_weft = %g, shear = %g N/m",
             sim->def->cloth[c].name, m->stretch_warp, m->stretch_weft, m->shear);
    return true;
  }
  snprintf(why, 160, "no material resists stretch or shear");
  return false;
}

static cloth_status prepare(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  CLOTH_TRY(cloth_elements_select(part, sim->triangle_count, 3, sim->triangle, true,
                                  &part->membrane, err));
  part->membrane.owner = CLOTH_EFFECT_membrane;
  size_t n = (size_t)part->membrane.count;
  double *rest = malloc(sizeof *rest * (5 * n + 1));
  int *material = malloc(sizeof *material * (n + 1));
  cloth_status status = CLOTH_NO_MEMORY;
  if (rest == NULL || material == NULL) {
    cloth_fail(err, status, __FILE__, __LINE__, "membrane of %zu triangles", n);
    goto done;
  }
  for (size_t i = 0; i < n; i++) {
    cloth_rest_triangle(sim, part->membrane.which[i], rest + 5 * i);
    material[i] = cloth_of_triangle(sim, part->membrane.which[i]);
  }
  CLOTH_TRY_GOTO(
      cloth_upload_real(sim, part, "rest", rest, (int)(5 * n), &part->membrane_rest, err), status,
      done);
  CLOTH_TRY_GOTO(
      cloth_upload(sim, part, "material", material, sizeof(int) * n, &part->membrane_material, err),
      status, done);
  status = CLOTH_OK;
done:
  free(rest), free(material);
  return status;
}

// c11, c12, c22, c33 of the plane-stress orthotropic law from the engineering constants
static void stiffness(const cloth_material *m, double *c)
{
  double nu = m->poisson;
  double nu_weft = m->stretch_warp > 0 ? nu * m->stretch_weft / m->stretch_warp : 0; // reciprocity
  double s = 1 - nu * nu_weft;
  c[0] = m->stretch_warp / s, c[2] = m->stretch_weft / s;
  c[1] = nu * m->stretch_weft / s;
  c[3] = m->shear;
}

static void measured(const cloth_material *m, double *row)
{
  memcpy(row, m->measured_stretching, sizeof m->measured_stretching);
}

enum { LIMIT_STIFFENING = 100 }; // slope beyond the strain limit, in stretch stiffnesses

// where the fabric locks [Green strain] and how hard [N/m]
static void limit(const cloth_material *m, double *law)
{
  double most = fmax(m->stretch_warp, m->stretch_weft), e = m->strain_limit;
  for (int k = 0; k < 24 && m->measured_stretching[0] > 0; k++)
    if (k % 4 == 0 || k % 4 == 2) most = fmax(most, 2 * m->measured_stretching[k]);
  law[0] = e + e * e / 2;
  law[1] = e > 0 ? LIMIT_STIFFENING * most : 0;
}

static cloth_status upload(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  int cloths = sim->def->cloth_count;
  bool any_measured = false, any_limit = false;
  for (int c = 0; c < cloths; c++) {
    any_measured |= sim->def->cloth[c].material.measured_stretching[0] > 0;
    any_limit |= sim->def->cloth[c].material.strain_limit > 0;
  }
  if (any_measured)
    CLOTH_TRY(
        cloth_upload_materials(sim, part, "measured", 24, measured, &part->membrane_measured, err));
  if (any_limit)
    CLOTH_TRY(cloth_upload_materials(sim, part, "limit", 2, limit, &part->membrane_limit, err));
  CLOTH_TRY(
      cloth_upload_materials(sim, part, "stiffness", 4, stiffness, &part->membrane_stiffness, err));
  size_t n = (size_t)part->membrane.count;
  CLOTH_TRY(cloth_take(sim, part, "damping", sizeof(cloth_real) * (size_t)cloths,
                       &part->membrane_damping, err));
  CLOTH_TRY(cloth_take(sim, part, "force", sizeof(cloth_real) * 9 * n, &part->membrane_force, err));
  CLOTH_TRY(
      cloth_take(sim, part, "tangent", sizeof(cloth_real) * 45 * n, &part->membrane_tangent, err));
  CLOTH_TRY(cloth_take(sim, part, "stretch", sizeof(cloth_real) * n, &part->stretch, err));
  return cloth_take(sim, part, "stretch_largest",
                    sizeof(cloth_real) * (size_t)cloth_chunk_levels((int)n), &part->stretch_largest,
                    err);
}

static cloth_status apply(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  cloth_membrane_args a = {
      p->membrane.vertex,      p->membrane_rest,  p->membrane_material, p->membrane_stiffness,
      p->membrane_measured,    p->membrane_limit, p->membrane_damping,  p->x,
      cloth_step_from(sim, p), p->membrane_force, p->membrane_tangent};
  return cloth_launch(sim, p, CLOTH_KERNEL_membrane, p->membrane.count, &a, err);
}

const cloth_effect cloth_effect_membrane = {
    .name = "membrane",
    .source = "St. Venant-Kirchhoff in material axes; tangent made positive semidefinite as in "
              "Teran et al. 2005",
    .wanted = wanted,
    .prepare = prepare,
    .upload = upload,
    .apply = apply,
};
