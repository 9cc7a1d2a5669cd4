// Reading and writing the state in the order of the file.
#include "contact/friction.h"
#include "effect/effect.h"
#include "state/build.h"
#include "state/state.h"

#include <stdio.h>
#include <string.h>

double cloth_sim_time(const void *sim) { return ((const cloth_sim *)sim)->time; }

static cloth_status read_vector(cloth_sim *sim, size_t field, int cloth, double *out,
                                cloth_error *err)
{
  const cloth_part *part = cloth_rescue_part(sim);
  cloth_real *vector;
  memcpy(&vector, (const char *)part + field, sizeof vector);
  int first = sim->cloth_first[cloth], n = sim->cloth_first[cloth + 1] - first;
  CLOTH_TRY(cloth_staging(sim, 3 * (size_t)n, err));
  CLOTH_TRY(sim->backend->read(part->device, sim->host, vector + 3 * first,
                               sizeof(cloth_real) * 3 * (size_t)n, err));
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) out[3 * sim->order[first + i] + k] = (double)sim->host[3 * i + k];
  return CLOTH_OK;
}

cloth_status cloth_sim_positions(void *data, int cloth, double *out, cloth_error *err)
{
  return read_vector(data, offsetof(cloth_part, x_t0), cloth, out, err);
}

cloth_status cloth_sim_velocities(void *data, int cloth, double *out, cloth_error *err)
{
  return read_vector(data, offsetof(cloth_part, v), cloth, out, err);
}

cloth_status cloth_sim_held(const void *data, int cloth, uint8_t *out, cloth_error *err)
{
  const cloth_sim *sim = data;
  (void)err;
  memset(out, 0, (size_t)(sim->cloth_first[cloth + 1] - sim->cloth_first[cloth]));
  for (int h = 0; h < sim->hold_count; h++)
    for (int i = 0; sim->hold[h].alive && sim->hold[h].cloth == cloth && i < sim->hold[h].count;
         i++)
      out[sim->order[sim->hold[h].vertex[i]]] = 1;
  return CLOTH_OK;
}

// file order to internal order; every part holds the whole vector
static cloth_status write_vector(cloth_sim *sim, size_t field, int cloth, const double *in,
                                 cloth_error *err)
{
  int first = sim->cloth_first[cloth], n = sim->cloth_first[cloth + 1] - first;
  CLOTH_TRY(cloth_staging(sim, 3 * (size_t)n, err));
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      sim->host[3 * i + k] = (cloth_real)in[3 * sim->order[first + i] + k];
  for (int p = 0; p < sim->part_count; p++) {
    cloth_real *vector;
    memcpy(&vector, (char *)&sim->part[p] + field, sizeof vector);
    CLOTH_TRY(sim->backend->write(sim->part[p].device, vector + 3 * first, sim->host,
                                  sizeof(cloth_real) * 3 * (size_t)n, err));
  }
  return CLOTH_OK;
}

cloth_status cloth_sim_state_set(void *data, int cloth, const double *position,
                                 const double *velocity, cloth_error *err)
{
  cloth_sim *sim = data;
  sim->pairs_valid = false;
  cloth_guess_free_fall(sim);
  if (position != NULL) cloth_friction_forget(sim); // it is somewhere else now
  if (position != NULL)
    CLOTH_TRY(write_vector(sim, offsetof(cloth_part, x_t0), cloth, position, err));
  if (position != NULL) cloth_tangles_suspect(sim);
  if (velocity != NULL) CLOTH_TRY(write_vector(sim, offsetof(cloth_part, v), cloth, velocity, err));
  return CLOTH_OK;
}

cloth_status cloth_sim_reset(void *data, cloth_error *err)
{
  cloth_sim *sim = data;
  size_t n = 3 * (size_t)sim->vertex_count;
  sim->pairs_valid = false;
  sim->time = 0, sim->step = 0, sim->speed_last = 0, sim->control.missed = 0;
  sim->tangles.settling = false;
  cloth_blocking_clear(sim);
  cloth_guess_free_fall(sim);
  cloth_friction_forget(sim);
  CLOTH_TRY(cloth_staging(sim, n, err));
  for (size_t i = 0; i < n; i++) sim->host[i] = (cloth_real)sim->rest[i];
  for (int p = 0; p < sim->part_count; p++)
    CLOTH_TRY(sim->backend->write(sim->part[p].device, sim->part[p].x_t0, sim->host,
                                  sizeof(cloth_real) * n, err));
  for (int c = 0; c < sim->def->cloth_count; c++)
    for (int v = sim->cloth_first[c]; v < sim->cloth_first[c + 1]; v++)
      for (int k = 0; k < 3; k++) sim->host[3 * v + k] = (cloth_real)sim->def->cloth[c].velocity[k];
  for (int p = 0; p < sim->part_count; p++)
    CLOTH_TRY(sim->backend->write(sim->part[p].device, sim->part[p].v, sim->host,
                                  sizeof(cloth_real) * n, err));
  for (int b = 0; b < sim->def->body_count; b++) {
    const cloth_body_def *d = &sim->def->body[b];
    sim->body[b].now = sim->body[b].target = cloth_motion_at(&d->motion, d->pose, 0);
    sim->body[b].commanded = false;
  }
  memset(sim->pin_broken, 0, (size_t)sim->def->pin_count);
  for (int h = 0; h < sim->hold_count; h++) sim->hold[h].alive = false;
  CLOTH_TRY(cloth_holds_refresh(sim, err));
  return cloth_pins_update(sim, 0, err);
}

cloth_pose cloth_sim_body_pose(const void *sim, int body)
{
  return ((const cloth_sim *)sim)->body[body].now;
}

cloth_status cloth_sim_body_move(void *data, int body, const cloth_pose *pose, cloth_error *err)
{
  cloth_sim *sim = data;
  (void)err;
  sim->body[body].target = *pose;
  sim->body[body].commanded = true;
  return CLOTH_OK;
}

cloth_status cloth_sim_body_place(void *data, int body, const cloth_pose *pose, cloth_error *err)
{
  cloth_sim *sim = data;
  (void)err;
  sim->body[body].now = sim->body[body].target = *pose;
  sim->body[body].commanded = true;
  sim->pairs_valid = false;
  cloth_body_settle(sim);
  return CLOTH_OK;
}

int cloth_sim_effect_count(void) { return CLOTH_EFFECT_COUNT; }

cloth_status cloth_sim_effect_describe(const void *data, int effect, cloth_effect_info *out,
                                       cloth_error *err)
{
  const cloth_sim *sim = data;
  (void)err;
  *out = (cloth_effect_info){.name = cloth_effects[effect]->name,
                             .source = cloth_effects[effect]->source,
                             .active = sim->active[effect],
                             .memory_bytes = sim->effect_bytes[effect],
                             .launches = sim->effect_launches[effect],
                             .ms = sim->effect_ms[effect]};
  snprintf(out->why, sizeof out->why, "%s", sim->why[effect]);
  return CLOTH_OK;
}
