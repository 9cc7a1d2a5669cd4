// Contacts of a substep.
#pragma once

#include "contact_geometry.h"
#include "state/sim.h"

enum { CLOTH_DISCRETE = 1 }; // of the parameter contact_detection

/// What the contact and impact kernels need to know of a part.
/// How far free flight may end from the predicted end of the substep, m: pairs are searched up to the
/// thickness and this, so that which of them touch does not depend on when they were searched.
double cloth_contact_reach(const cloth_sim *sim);

cloth_contact_scene cloth_contact_scene_of(const cloth_sim *sim, const cloth_part *part);

/// Stiffness of a contact in units of vertex mass / substep^2: the parameter's, of a whole step.
double cloth_contact_stiffness(const cloth_sim *sim);

/// The first vertex whose contacts go into the matrix (contact_entry.h): the bodies' first, but
/// without a membrane the matrix has no blocks between the corners of a face.
int cloth_contact_body_first(const cloth_sim *sim);

/// [1] on the part's device: contacts in factors; not written where there are none at all.
const uint32_t *cloth_contact_factored(const cloth_part *part);

/// Pairs of the last cloth_impacts_find() become contacts at their times of impact, for another
/// solve.
cloth_status cloth_contact_add_impacts(cloth_sim *sim, cloth_error *err);
