// One whole solve on one part, for a backend that runs it without coming back to the host after
// each launch (backend.h, solve). The steps and their order are those of src/solve/pcg.c.
#pragma once

#include "coarse_rest.h"
#include "coarse_solve.h"
#include "contact_product.h"
#include "correct.h"
#include "hat_rest_upper.h"
#include "hat_spread.h"
#include "pcg_beta.h"
#include "pcg_direction.h"
#include "pcg_product.h"
#include "pcg_residual.h"
#include "pcg_start.h"
#include "pcg_update.h"

typedef struct cloth_pcg_solve_args {
  cloth_pcg_vectors v;
  cloth_contact_product_args contact;
  int contacts;
  const uint32_t *factored; // [1] how many of them the product takes: contact_entry.h
  cloth_pcg_product_args product;
  cloth_coarse_rest_args rest; // with aggregates only
  cloth_coarse_solve_args coarse;
  cloth_hat_rest_args hats; // with levels of hats only
  cloth_pcg_beta_args beta; // its `start` is not read
  cloth_real *more_partial; // [chunks x CLOTH_PCG_PARTIALS] for who adds p'q up while others go on
  cloth_pcg_terms terms;    // for who has them side by side instead of those two
  int iterations_max;
  uint64_t *product_ns; // [1] ns, counts up: products, with what they wait for; NULL: not asked for
  cloth_correct_args correct; // for who finishes, too: x += dx behind the iterations
} cloth_pcg_solve_args;

/// Contacts that the product goes through: none where all lie in the matrix.
CLOTH_FN int cloth_pcg_contacts(const cloth_pcg_solve_args *a)
{
  return a->contacts > 0 && *a->factored > 0 ? a->contacts : 0;
}
