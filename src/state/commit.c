#include "state/commit.h"

#include "chunk.h"
#include "commit_chunk.h"
#include "state/bdf2.h"
#include "state/state.h"

#include <math.h>

cloth_status cloth_commit_sums(cloth_sim *sim, bool *good, cloth_change *change, cloth_error *err)
{
  size_t n = CLOTH_COMMIT_FIELDS * (size_t)sim->chunks;
  double worst = 0, speed = 0, largest = 0, energy = 0, drift = 0;
  CLOTH_TRY(cloth_staging(sim, n, err));
  CLOTH_TRY(sim->backend->read(sim->part[0].device, sim->host, sim->part[0].commit,
                               sizeof(cloth_real) * n, err));
  for (int c = 0; c < sim->chunks && worst <= sim->params.bounds; c++) { // no calls: they are many
    const cloth_real *f = sim->host + CLOTH_COMMIT_FIELDS * c;
    if (!((double)f[CLOTH_COMMIT_WORST] <= worst)) worst = (double)f[CLOTH_COMMIT_WORST];
    if ((double)f[CLOTH_COMMIT_SPEED] > speed) speed = (double)f[CLOTH_COMMIT_SPEED];
    if ((double)f[CLOTH_COMMIT_CHANGE] > largest) largest = (double)f[CLOTH_COMMIT_CHANGE];
    energy += (double)f[CLOTH_COMMIT_ENERGY];
    drift += (double)f[CLOTH_COMMIT_DRIFT];
  }
  change->largest = largest;
  change->mean = sqrt(drift / sim->mass_total);
  *good = worst <= sim->params.bounds;
  sim->report->speed_max = sim->speed_last = speed;
  sim->report->energy_kinetic = energy;
  return CLOTH_OK;
}

cloth_status cloth_commit(cloth_sim *sim, bool *good, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) {
    cloth_part *p = &sim->part[i];
    const cloth_real *v = sim->bdf2.used ? p->v_next : p->v; // expected: where the change starts
    cloth_commit_chunk_args a = {0,        sim->vertex_count, cloth_step_from(sim, p),
                                 p->x,     p->mass,           (cloth_real)(1 / sim->gamma),
                                 v,        p->free,           p->v_next,
                                 p->commit};
    CLOTH_LAUNCH(sim, p, commit_chunk, sim->chunks, &a, err);
  }
  cloth_change change;
  CLOTH_TRY(cloth_commit_sums(sim, good, &change, err));
  // the leading error of backward Euler is h^2 / 2 times the acceleration (Hairer and Wanner 1996)
  // and that of BDF2 2/9 h^3 times its derivative
  double factor = sim->h * (sim->bdf2.used ? 2.0 / 9 : 0.5);
  sim->error_estimate = factor * change.largest;
  sim->error_mean = factor * change.mean;
  return CLOTH_OK;
}

void cloth_mean_motion(cloth_sim *sim)
{
  const cloth_real *field = sim->host + CLOTH_COMMIT_VELOCITY;
  for (int cloth = 0, c = 0; cloth < sim->def->cloth_count; cloth++) {
    double sum[3] = {0, 0, 0};
    int count = 0;
    for (; c < sim->chunks && c * CLOTH_CHUNK < sim->cloth_first[cloth + 1]; c++) {
      int rows = sim->vertex_count - c * CLOTH_CHUNK;
      count += rows < CLOTH_CHUNK ? rows : CLOTH_CHUNK;
      for (int k = 0; k < 3; k++) sum[k] += (double)field[CLOTH_COMMIT_FIELDS * c + k];
    }
    for (int k = 0; k < 3 && count > 0; k++) {
      double *mean = &sim->mean_velocity[3 * cloth + k], v = sum[k] / count;
      if (sim->mean_known) sim->acceleration[3 * cloth + k] = (v - *mean) / sim->h;
      *mean = v;
    }
  }
  sim->mean_known = true;
}
