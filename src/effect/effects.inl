// Every effect, once, in the order in which they are applied.
CLOTH_EFFECT(gravity)
CLOTH_EFFECT(membrane)
CLOTH_EFFECT(bending)
CLOTH_EFFECT(springs)
CLOTH_EFFECT(damping)
CLOTH_EFFECT(air)
CLOTH_EFFECT(pins)
CLOTH_EFFECT(self_contact)
CLOTH_EFFECT(body_contact)
CLOTH_EFFECT(friction)
#undef CLOTH_EFFECT
