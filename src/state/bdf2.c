#include "state/bdf2.h"

#include "bdf2_start.h"

// variable steps are stable up to 1 + sqrt 2; below, a short step after a long one leans on what is
// old
#define RATIO_MOST  2.4
#define RATIO_LEAST 0.1

cloth_status cloth_bdf2_take(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  cloth_real **vector[] = {&p->x_last, &p->v_last,       &p->x_from,
                           &p->v_from, &p->x_last_saved, &p->v_last_saved};
  for (int i = 0; i < 6 && sim->params.integrator == CLOTH_BDF2; i++)
    CLOTH_TRY(cloth_take(sim, p, "bdf2", bytes, vector[i], err));
  return CLOTH_OK;
}

cloth_status cloth_bdf2_begin(cloth_sim *sim, cloth_error *err)
{
  cloth_bdf2 *s = &sim->bdf2;
  double w = s->known ? sim->h / s->h_last : 0;
  s->used = s->known && w >= RATIO_LEAST && w <= RATIO_MOST;
  sim->gamma = s->used ? sim->h * (1 + w) / (1 + 2 * w) : sim->h;
  for (int i = 0; i < sim->part_count && s->used; i++) {
    cloth_part *p = &sim->part[i];
    cloth_bdf2_start_args a = {.x = p->x_t0,
                               .v = p->v,
                               .x_last = p->x_last,
                               .v_last = p->v_last,
                               .b = (cloth_real)(w * w / (1 + 2 * w)),
                               .w = (cloth_real)w,
                               .x_from = p->x_from,
                               .v_from = p->v_from,
                               .v_ahead = p->v_next};
    CLOTH_LAUNCH(sim, p, bdf2_start, sim->vertex_count, &a, err);
  }
  return CLOTH_OK;
}

cloth_status cloth_bdf2_keep(cloth_sim *sim, bool smooth, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  if (sim->params.integrator != CLOTH_BDF2) return CLOTH_OK;
  sim->report->bdf2_substeps += sim->bdf2.used;
  sim->bdf2.known = smooth;
  sim->bdf2.h_last = sim->h;
  for (int i = 0; i < sim->part_count && smooth; i++) {
    cloth_part *p = &sim->part[i];
    CLOTH_TRY(cloth_copy_local(sim, p, p->x_last, p->x_t0, bytes, err));
    CLOTH_TRY(cloth_copy_local(sim, p, p->v_last, p->v, bytes, err));
  }
  return CLOTH_OK;
}

cloth_status cloth_bdf2_save(cloth_sim *sim, bool back, cloth_error *err)
{
  size_t bytes = sizeof(cloth_real) * 3 * (size_t)sim->vertex_count;
  if (sim->params.integrator != CLOTH_BDF2) return CLOTH_OK;
  if (back)
    sim->bdf2.known = sim->bdf2.known_saved, sim->bdf2.h_last = sim->bdf2.h_saved;
  else
    sim->bdf2.known_saved = sim->bdf2.known, sim->bdf2.h_saved = sim->bdf2.h_last;
  for (int i = 0; i < sim->part_count && sim->bdf2.known; i++) {
    cloth_part *p = &sim->part[i];
    cloth_real *x = p->x_last, *v = p->v_last, *x_saved = p->x_last_saved,
               *v_saved = p->v_last_saved;
    CLOTH_TRY(cloth_copy_local(sim, p, back ? x : x_saved, back ? x_saved : x, bytes, err));
    CLOTH_TRY(cloth_copy_local(sim, p, back ? v : v_saved, back ? v_saved : v, bytes, err));
  }
  return CLOTH_OK;
}

bool cloth_bdf2_touches(const cloth_sim *sim)
{
  for (int i = 0; i < sim->part_count; i++)
    if (sim->part[i].contact_count > 0) return true;
  return false;
}
