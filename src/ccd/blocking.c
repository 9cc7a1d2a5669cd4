#include "ccd/blocking.h"

#include "state/sim.h"
#include "state/state.h"

#include <stdlib.h>
#include <string.h>

void cloth_blocking_clear(cloth_sim *sim)
{
  cloth_blocking *b = &sim->blocking;
  if (b->count > 0) memset(b->body, 0, (size_t)sim->def->body_count);
  b->count = 0;
}

static void name(cloth_sim *sim, int vertex)
{
  cloth_blocking *b = &sim->blocking;
  if (vertex < sim->vertex_count) return;
  int body = cloth_body_of_vertex(sim, vertex);
  b->count += !b->body[body];
  b->body[body] = 1;
}

// does the zone hold a vertex of an impact that is left?
static bool is_stuck(const cloth_zones *z, int zone, const unsigned char *stuck)
{
  for (int k = z->moving_first[zone]; k < z->moving_first[zone + 1]; k++)
    if (stuck[z->moving[k]]) return true;
  return false;
}

cloth_status cloth_blocking_add(cloth_sim *sim, cloth_error *err)
{
  cloth_blocking *b = &sim->blocking;
  const cloth_zones *z = &sim->zones;
  if (sim->def->body_count == 0 || z->found_count == 0) return CLOTH_OK;
  if (b->body == NULL) b->body = calloc((size_t)sim->def->body_count, 1);
  unsigned char *stuck = calloc((size_t)sim->vertex_count, 1);
  if (b->body == NULL || stuck == NULL) {
    free(stuck);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "bodies that leave no room");
  }
  for (int i = 0; i < z->found_count; i++) {
    int v[4];
    cloth_pair_corners(sim, z->found[i].key, v);
    for (int k = 0; k < 4; k++) {
      name(sim, v[k]);
      if (v[k] < sim->vertex_count) stuck[v[k]] = 1;
    }
  }
  for (int i = 0; z->count > 0 && i < z->zones; i++) {
    if (!is_stuck(z, i, stuck)) continue;
    for (int m = z->first[i]; m < z->first[i + 1]; m++)
      for (int k = 0; k < 4; k++) name(sim, z->vertex[4 * z->member[m] + k]);
  }
  free(stuck);
  return CLOTH_OK;
}

cloth_status cloth_sim_blocking_bodies(void *data, int *out, int capacity, int *count,
                                       cloth_error *err)
{
  const cloth_sim *sim = data;
  const cloth_blocking *b = &sim->blocking;
  (void)err;
  *count = 0;
  for (int i = 0; b->count > 0 && i < sim->def->body_count; i++) {
    if (!b->body[i]) continue;
    if (*count < capacity) out[*count] = i;
    ++*count;
  }
  return CLOTH_OK;
}
