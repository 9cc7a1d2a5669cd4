// Viscous damping, proportional to stiffness inside the membrane and bending kernels, and to mass
// in the prediction. This module only fills the numbers that those kernels read: beta / h for this
// substep.
#include "effect/bend_rest.h"
#include "effect/effect.h"

#include <stdio.h>
#include <stdlib.h>

static bool wanted(const cloth_sim *sim, char why[160])
{
  for (int c = 0; c < sim->def->cloth_count; c++) {
    const cloth_material *m = &sim->def->cloth[c].material;
    if (!(m->damping_stretch > 0 || m->damping_bend > 0 || m->damping_mass > 0)) continue;
    snprintf(why, 160,
             "cloth %s: damping_stretch = %g s, damping_bend = %g s, damping_mass = %g 1/s",
             sim->def->cloth[c].name, m->damping_stretch, m->damping_bend, m->damping_mass);
    return true;
  }
  snprintf(why, 160, "no material is damped");
  return false;
}

static cloth_status upload(cloth_sim *sim, cloth_part *part, cloth_error *err)
{
  bool any = false;
  for (int c = 0; c < sim->def->cloth_count; c++)
    any |= sim->def->cloth[c].material.damping_mass > 0;
  if (!any) return CLOTH_OK;
  double *drag = malloc(sizeof *drag * (size_t)sim->vertex_count);
  if (drag == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "damping");
  for (int c = 0; c < sim->def->cloth_count; c++)
    for (int v = sim->cloth_first[c]; v < sim->cloth_first[c + 1]; v++)
      drag[v] = sim->def->cloth[c].material.damping_mass;
  cloth_status status =
      cloth_upload_real(sim, part, "mass_drag", drag, sim->vertex_count, &part->mass_drag, err);
  free(drag);
  return status;
}

cloth_status cloth_damping_set(cloth_sim *sim, double h, cloth_error *err)
{
  if (!sim->active[CLOTH_EFFECT_damping] || sim->damping_h == h) return CLOTH_OK;
  sim->damping_h = h;
  CLOTH_TRY(cloth_staging(
      sim, (size_t)(sim->hinge_count + sim->triangle_count + sim->def->cloth_count), err));
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    if (part->membrane.count > 0) {
      for (int c = 0; c < sim->def->cloth_count; c++)
        sim->host[c] = (cloth_real)(sim->def->cloth[c].material.damping_stretch / h);
      CLOTH_TRY(sim->backend->write(part->device, part->membrane_damping, sim->host,
                                    sizeof(cloth_real) * (size_t)sim->def->cloth_count, err));
    }
    if (part->bend.count == 0) continue;
    const cloth_bend_rest *r = sim->bend_rest;
    for (int i = 0, n = 0; i < r->count; i++) { // the part's elements, in the same order
      bool mine = false;
      for (int k = 0; k < r->corners; k++) {
        int v = r->vertex[r->corners * i + k];
        mine |= v >= part->v0 && v < part->v1;
      }
      if (mine)
        sim->host[n++] = (cloth_real)(sim->def->cloth[r->cloth[i]].material.damping_bend / h);
    }
    CLOTH_TRY(sim->backend->write(part->device, part->bend_damping, sim->host,
                                  sizeof(cloth_real) * (size_t)part->bend.count, err));
  }
  return CLOTH_OK;
}

const cloth_effect cloth_effect_damping = {
    .name = "damping",
    .source = "Baraff and Witkin 1998, section 4.5; Rayleigh",
    .wanted = wanted,
    .upload = upload,
};
