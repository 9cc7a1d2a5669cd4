// Slots of all elements and contacts become the block rows, the right-hand side and the
// preconditioner.
#include "assemble_row.h"
#include "effect/effect.h"

static cloth_incidence incidence(const cloth_elements *e)
{
  cloth_incidence i = {e->first, e->corner, e->slot};
  return i;
}

cloth_status cloth_assemble(cloth_sim *sim, cloth_error *err)
{
  const cloth_incidence none = {NULL, NULL, NULL};
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    cloth_assemble_row_args a = {
        .first = p->v0,
        .inverse_step = (cloth_real)(1 / sim->gamma),
        .mass = p->mass,
        .mass_drag = sim->active[CLOTH_EFFECT_damping] ? p->mass_drag : NULL,
        .x = p->x,
        .x_pred = p->x_pred,
        .hold_stiffness = sim->compliant_count > 0 ? p->hold_stiffness : NULL,
        .target = p->target,
        .membrane = incidence(&p->membrane),
        .membrane_force = p->membrane_force,
        .membrane_tangent = p->membrane_tangent,
        .drag = incidence(&p->drag),
        .drag_force = p->drag_force,
        .drag_tangent = p->drag_tangent,
        .bend = p->bend.corners == 4 ? incidence(&p->bend) : none,
        .bend_force = p->bend_force,
        .bend_gradient = p->bend_gradient,
        .bend_weight = p->bend_weight,
        .bend_constant = p->bend_constant,
        .shape = p->bend.corners == 6 ? incidence(&p->bend) : none,
        .shape_force = p->bend_force,
        .shape_gradient = p->bend_gradient,
        .shape_weight = p->bend_weight,
        .contact_first = p->contact_count > 0 ? p->contact_first : NULL,
        .contact_entry = p->contact_entry,
        .contact_slot = p->contact_slot,
        .contact_weight = p->contact_weight,
        .contact_force = p->contact_force,
        .contact_tangent = p->contact_tangent,
        .rows = {p->row_first, p->row_col, p->row_val, p->row_widest},
        .b = p->b,
        .inverse_diagonal = p->inverse_diagonal,
    };
    CLOTH_LAUNCH(sim, p, assemble_row, p->v1 - p->v0, &a, err);
  }
  return CLOTH_OK;
}
