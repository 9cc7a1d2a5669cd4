#include "ccd/blocking.h"

#include "state/sim.h"
#include "state/state.h"

#include <stdlib.h>
#include <string.h>

// scratch of one call
typedef struct naming {
  cloth_sim *sim;
  int *hold_of;         // [vertices] 1 + the rigid hold, 0: none
  unsigned char *stuck; // [vertices] 1: in an impact that is left
} naming;

void cloth_blocking_clear(cloth_sim *sim)
{
  cloth_blocking *b = &sim->blocking;
  if (b->count > 0) memset(b->body, 0, (size_t)sim->def->body_count);
  if (b->hold_count > 0) memset(b->hold, 0, (size_t)b->hold_room);
  b->count = b->hold_count = 0;
}

void cloth_blocking_free(cloth_blocking *b) { free(b->body), free(b->hold); }

static cloth_status reserve(cloth_sim *sim, cloth_error *err)
{
  cloth_blocking *b = &sim->blocking;
  if (b->body == NULL) b->body = calloc((size_t)sim->def->body_count + 1, 1);
  if (b->hold_room < sim->hold_count) {
    unsigned char *hold = realloc(b->hold, (size_t)sim->hold_count);
    if (hold != NULL) {
      memset(hold + b->hold_room, 0, (size_t)(sim->hold_count - b->hold_room));
      b->hold = hold, b->hold_room = sim->hold_count;
    }
  }
  if (b->body == NULL || b->hold_room < sim->hold_count)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "what leaves no room");
  return CLOTH_OK;
}

static void end(naming *n) { free(n->hold_of), free(n->stuck); }

static cloth_status begin(cloth_sim *sim, naming *n, cloth_error *err)
{
  CLOTH_TRY(reserve(sim, err));
  *n = (naming){.sim = sim};
  n->hold_of = calloc((size_t)sim->vertex_count, sizeof *n->hold_of);
  n->stuck = calloc((size_t)sim->vertex_count, 1);
  if (n->hold_of == NULL || n->stuck == NULL) {
    end(n);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "what leaves no room");
  }
  for (int h = 0; h < sim->hold_count; h++)
    for (int i = 0; sim->hold[h].alive && sim->hold[h].rigid && i < sim->hold[h].count; i++)
      n->hold_of[sim->hold[h].vertex[i]] = 1 + h;
  return CLOTH_OK;
}

static void name_body(cloth_blocking *b, int body)
{
  b->count += !b->body[body];
  b->body[body] = 1;
}

static void name(const naming *n, int vertex)
{
  cloth_blocking *b = &n->sim->blocking;
  if (vertex >= n->sim->vertex_count) {
    name_body(b, cloth_body_of_vertex(n->sim, vertex));
  } else if (n->hold_of[vertex] > 0) {
    int hold = n->hold_of[vertex] - 1;
    b->hold_count += !b->hold[hold];
    b->hold[hold] = 1;
  }
}

static void name_pair(const naming *n, uint64_t key)
{
  int v[4];
  cloth_pair_corners(n->sim, key, v);
  for (int k = 0; k < 4; k++) {
    name(n, v[k]);
    if (v[k] < n->sim->vertex_count) n->stuck[v[k]] = 1;
  }
}

// does the zone hold a vertex of an impact that is left?
static bool is_stuck(const cloth_zones *z, int zone, const unsigned char *stuck)
{
  for (int k = z->moving_first[zone]; k < z->moving_first[zone + 1]; k++)
    if (stuck[z->moving[k]]) return true;
  return false;
}

static void name_zones(const naming *n)
{
  const cloth_zones *z = &n->sim->zones;
  for (int i = 0; z->count > 0 && i < z->zones; i++) {
    if (!is_stuck(z, i, n->stuck)) continue;
    for (int m = z->first[i]; m < z->first[i + 1]; m++)
      for (int k = 0; k < 4; k++) name(n, z->vertex[4 * z->member[m] + k]);
  }
}

cloth_status cloth_blocking_add(cloth_sim *sim, cloth_error *err)
{
  const cloth_zones *z = &sim->zones;
  naming n;
  CLOTH_TRY(begin(sim, &n, err));
  for (int i = 0; i < sim->impacts_left; i++) name_pair(&n, z->found[i].key);
  if (sim->impacts_left > 0) name_zones(&n);
  for (int i = 0; i < z->driven_count; i++) name_pair(&n, z->driven[i]);
  end(&n);
  return CLOTH_OK;
}

// is a corner of one of the two triangles held?
static bool is_held(const naming *n, const int *a, const int *b)
{
  for (int k = 0; k < 3; k++)
    if (n->hold_of[a[k]] > 0 || (b[k] < n->sim->vertex_count && n->hold_of[b[k]] > 0)) return true;
  return false;
}

cloth_status cloth_blocking_look(cloth_sim *sim, bool names, cloth_error *err)
{
  cloth_tangle_list *t = &sim->tangles;
  naming n;
  t->held = false;
  if (t->count == 0 || sim->held_count == 0) return CLOTH_OK;
  CLOTH_TRY(begin(sim, &n, err));
  for (int i = 0; i < t->count; i++) {
    cloth_pair pair = cloth_pair_unpack(sim->format, t->list[i].key);
    const int *a = sim->triangle + 3 * pair.a, *b = sim->triangle + 3 * pair.b;
    if (!is_held(&n, a, b)) continue;
    t->held = true;
    for (int k = 0; names && k < 3; k++) name(&n, a[k]), name(&n, b[k]);
  }
  end(&n);
  return CLOTH_OK;
}

// ---- looking on ---------------------------------------------------------------------------------

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

static cloth_hold_view view_of(const cloth_sim *sim, int hold)
{
  const cloth_hold_state *h = &sim->hold[hold];
  if (h->pin < 0) return (cloth_hold_view){h->cloth, NULL, {hold + 1, h->generation}};
  const cloth_pin_def *pin = &sim->def->pin[h->pin];
  return (cloth_hold_view){h->cloth, sim->def->cloth[pin->cloth].group[pin->group].name, {0, 0}};
}

cloth_status cloth_sim_blocking_holds(void *data, cloth_hold_view *out, int capacity, int *count,
                                      cloth_error *err)
{
  const cloth_sim *sim = data;
  const cloth_blocking *b = &sim->blocking;
  (void)err;
  *count = 0;
  for (int i = 0; b->hold_count > 0 && i < b->hold_room && i < sim->hold_count; i++) {
    if (!b->hold[i]) continue;
    if (*count < capacity) out[*count] = view_of(sim, i);
    ++*count;
  }
  return CLOTH_OK;
}
