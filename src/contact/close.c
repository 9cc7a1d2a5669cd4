#include "contact/close.h"

#include "ccd/impacts.h"
#include "contact/contact.h"

#include <math.h>

#define STRAY  0.4  // of the thickness
#define MARGIN 0.05 // of the thickness, for rounding

enum {
  SHARE_MOST = 3,    // a list of more than a third of the pairs is not worth its memory
  CLOSE_LEAST = 1024 // room to begin with
};

double cloth_close_stray(const cloth_sim *sim) { return STRAY * sim->params.thickness; }

// toi.h calls an impact what comes within 17/16 of its level
double cloth_close_reach(const cloth_sim *sim)
{
  return 17.0 / 16 * cloth_impact_gap(sim) + 2 * cloth_close_stray(sim) +
         MARGIN * sim->params.thickness;
}

// Is the rounding of coordinates small enough for the margin? (That of features of any size is in
// pair_close.h.)
static bool is_precise(const cloth_sim *sim)
{
  const cloth_box *b = &sim->cloth_box;
  double most = fmax(fmax(fabs((double)b->lo.x), fabs((double)b->hi.x)),
                     fmax(fabs((double)b->lo.y), fabs((double)b->hi.y)));
  most = fmax(most, fmax(fabs((double)b->lo.z), fabs((double)b->hi.z)));
  return 16 * (double)CLOTH_REAL_EPSILON * most < MARGIN * sim->params.thickness;
}

static cloth_status grow(cloth_sim *sim, cloth_part *p, uint32_t n, cloth_error *err)
{
  CLOTH_TRY(cloth_grow(sim, p, "close", 8 * (size_t)n, &p->close, err));
  p->close_capacity = n + n / 2;
  return CLOTH_OK;
}

int64_t cloth_close_worth(const cloth_sim *sim)
{
  int64_t pairs = 0;
  int least = sim->params.close_pairs_from;
  for (int i = 0; i < sim->part_count; i++) pairs += sim->part[i].pair_count;
  // where there are fewer candidates than vertices, keeping positions would cost more than it saves
  bool many = least > 0 && pairs >= least && pairs >= sim->vertex_count;
  bool discrete = sim->params.contact_detection == CLOTH_DISCRETE;
  return many && !discrete && sim->pairs_for_contacts && is_precise(sim) ? pairs : 0;
}

cloth_status cloth_close_begin(cloth_sim *sim, cloth_error *err)
{
  sim->close_covers = false;
  sim->close_known = cloth_close_worth(sim) > 0;
  if (!sim->close_known) return CLOTH_OK;
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    if (p->x_guess == NULL) CLOTH_TRY(cloth_take(sim, p, "x_guess", bytes, &p->x_guess, err));
    CLOTH_TRY(cloth_copy_local(sim, p, p->x_guess, p->x, bytes, err));
    if (p->close == NULL) CLOTH_TRY(grow(sim, p, CLOSE_LEAST, err));
  }
  return CLOTH_OK;
}

cloth_status cloth_close_take(cloth_sim *sim, cloth_part *p, uint32_t found, bool *again,
                              cloth_error *err)
{
  *again = false, p->close_count = 0;
  if (!sim->close_known) return CLOTH_OK;
  if (SHARE_MOST * (int64_t)found > p->pair_count) {
    sim->close_known = false; // on every part
    return CLOTH_OK;
  }
  *again = found > p->close_capacity;
  if (*again) CLOTH_TRY(grow(sim, p, found, err));
  p->close_count = (int)found;
  return CLOTH_OK;
}

const uint64_t *cloth_close_pairs(cloth_sim *sim, const cloth_part *p, int *count)
{
  *count = sim->close_covers ? p->close_count : p->pair_count;
  sim->report->pairs_looked += *count;
  return sim->close_covers ? p->close : p->pair;
}
