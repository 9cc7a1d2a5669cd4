// Contacts of a substep.
#pragma once

#include "contact_geometry.h"
#include "state/sim.h"

/// What the contact and impact kernels need to know of a part.
cloth_contact_scene cloth_contact_scene_of(const cloth_sim *sim, const cloth_part *part);
