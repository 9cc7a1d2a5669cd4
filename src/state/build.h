// Building and freeing a sim; see engine.h for what the functions mean to the front.
#pragma once

#include "state/sim.h"

cloth_status cloth_sim_new(const cloth_def *def, cloth_transport *transport, void **out,
                           cloth_error *err);
void cloth_sim_free(void *sim);
const char *cloth_sim_backend(const void *sim);
const char *cloth_sim_backend_why(const void *sim);
cloth_status cloth_sim_reset(void *sim, cloth_error *err);

/// Internal numbering, rest shape, masses and body ranges (state/number.c). Host arrays only.
cloth_status cloth_number(cloth_sim *sim, cloth_error *err);
