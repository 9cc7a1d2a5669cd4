#include "ccd/zones.h"

#include "contact/contact.h"
#include "state/sim.h"
#include "zone_build.h"
#include "zone_mark.h"
#include "zone_solve.h"

#include <stdlib.h>
#include <string.h>

// ---- host lists ---------------------------------------------------------------------------------

static cloth_status grow(void *list, size_t bytes, cloth_error *err)
{
  void *old;
  memcpy(&old, list, sizeof old);
  void *data = realloc(old, bytes);
  if (data == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "impact zones: %zu bytes", bytes);
  memcpy(list, &data, sizeof data);
  return CLOTH_OK;
}

static cloth_status reserve(cloth_sim *sim, int n, cloth_error *err)
{
  cloth_zones *z = &sim->zones;
  if (z->owner == NULL) {
    CLOTH_TRY(grow(&z->owner, sizeof(int) * (size_t)sim->vertex_count, err));
    for (int v = 0; v < sim->vertex_count; v++) z->owner[v] = -1;
    CLOTH_TRY(grow(&z->fixed, (size_t)sim->vertex_count, err));
    memset(z->fixed, 0, (size_t)sim->vertex_count);
  }
  if (n <= z->capacity) return CLOTH_OK;
  size_t room = (size_t)n + (size_t)n / 2 + 64, i = sizeof(int);
  CLOTH_TRY(grow(&z->key, sizeof(uint64_t) * room, err));
  CLOTH_TRY(grow(&z->toi, sizeof(uint32_t) * room, err));
  CLOTH_TRY(grow(&z->vertex, 4 * i * room, err));
  CLOTH_TRY(grow(&z->by_key, i * room, err));
  CLOTH_TRY(grow(&z->spare, i * room, err));
  CLOTH_TRY(grow(&z->fresh, i * room, err));
  CLOTH_TRY(grow(&z->parent, i * room, err));
  CLOTH_TRY(grow(&z->member, i * room, err));
  CLOTH_TRY(grow(&z->local, 4 * i * room, err));
  CLOTH_TRY(grow(&z->zone_rank, i * room, err));
  CLOTH_TRY(grow(&z->first, i * (room + 1), err));
  CLOTH_TRY(grow(&z->moving_first, i * (room + 1), err));
  CLOTH_TRY(grow(&z->moving, 4 * i * room, err));
  CLOTH_TRY(grow(&z->deal, i * room, err));
  CLOTH_TRY(grow(&z->colour, room, err));
  CLOTH_TRY(grow(&z->taken, 4 * sizeof(uint64_t) * room, err));
  z->capacity = (int)room;
  return CLOTH_OK;
}

void cloth_zones_free(cloth_zones *z)
{
  free(z->found), free(z->read_key), free(z->read_toi), free(z->driven);
  free(z->key), free(z->toi), free(z->vertex), free(z->parent), free(z->member), free(z->local);
  free(z->zone_rank), free(z->first), free(z->moving_first), free(z->moving), free(z->deal);
  free(z->by_key), free(z->spare), free(z->fresh), free(z->owner), free(z->fixed);
  free(z->colour), free(z->taken);
}

// ---- grouping -----------------------------------------------------------------------------------

void cloth_pair_corners(const cloth_sim *sim, uint64_t key, int v[4])
{
  cloth_pair p = cloth_pair_unpack(sim->format, key);
  if (p.type == CLOTH_VERTEX_FACE) {
    v[0] = p.a;
    for (int k = 0; k < 3; k++) v[1 + k] = sim->triangle[3 * p.b + k];
  } else {
    for (int k = 0; k < 2; k++) v[k] = sim->edge[2 * p.a + k], v[2 + k] = sim->edge[2 * p.b + k];
  }
}

// The root is the lowest constraint of its group, so the order of joining does not show.
static int root(int *parent, int c)
{
  while (parent[c] != c) c = parent[c] = parent[parent[c]];
  return c;
}

static void join(cloth_zones *z, int c, int v)
{
  if (z->owner[v] < 0) {
    z->owner[v] = c;
    return;
  }
  int a = root(z->parent, c), b = root(z->parent, z->owner[v]);
  if (a < b)
    z->parent[b] = a;
  else
    z->parent[a] = b;
}

static void mark_fixed(cloth_sim *sim, unsigned char fixed)
{
  for (int h = 0; h < sim->hold_count; h++)
    for (int i = 0; sim->hold[h].alive && sim->hold[h].rigid && i < sim->hold[h].count; i++)
      sim->zones.fixed[sim->hold[h].vertex[i]] = fixed;
}

static bool moves(const cloth_sim *sim, int v)
{
  return v < sim->vertex_count && !sim->zones.fixed[v];
}

// constraints zone by zone, zones in the order of their first constraint
static void order_members(cloth_zones *z)
{
  z->zones = 0;
  for (int c = 0; c < z->count; c++)
    if (root(z->parent, c) == c) z->zone_rank[c] = z->zones++;
  memset(z->first, 0, sizeof(int) * ((size_t)z->zones + 1));
  for (int c = 0; c < z->count; c++) z->first[z->zone_rank[root(z->parent, c)] + 1]++;
  for (int i = 0; i < z->zones; i++) z->first[i + 1] += z->first[i];
  for (int c = 0; c < z->count; c++) z->member[z->first[z->zone_rank[root(z->parent, c)]]++] = c;
  for (int i = z->zones; i > 0; i--) z->first[i] = z->first[i - 1];
  z->first[0] = 0;
}

// the moving vertices of each zone, in the order in which its constraints name them
static void list_moving(cloth_sim *sim)
{
  cloth_zones *z = &sim->zones;
  z->moving_count = 0;
  for (int i = 0; i < 4 * z->count; i++)
    if (moves(sim, z->vertex[i])) z->owner[z->vertex[i]] = -1;
  for (int i = 0; i < z->zones; i++) {
    z->moving_first[i] = z->moving_count;
    for (int m = z->first[i]; m < z->first[i + 1]; m++)
      for (int k = 0; k < 4; k++) {
        int v = z->vertex[4 * z->member[m] + k];
        z->local[4 * m + k] = -1;
        if (!moves(sim, v)) continue;
        if (z->owner[v] < 0) {
          z->owner[v] = z->moving_count;
          z->moving[z->moving_count++] = v;
        }
        z->local[4 * m + k] = z->owner[v];
      }
  }
  z->moving_first[z->zones] = z->moving_count;
  for (int i = 0; i < z->moving_count; i++) z->owner[z->moving[i]] = -1;
}

// the lowest colour that no earlier constraint at the member's moving vertices has, or the last
static int pick_colour(cloth_zones *z, int m)
{
  uint64_t taken = 0;
  int colour = 0;
  for (int k = 0; k < 4; k++)
    if (z->local[4 * m + k] >= 0) taken |= z->taken[z->local[4 * m + k]];
  while (colour + 1 < CLOTH_ZONE_COLOURS && (taken >> colour & 1)) colour++;
  for (int k = 0; k < 4; k++)
    if (z->local[4 * m + k] >= 0) z->taken[z->local[4 * m + k]] |= (uint64_t)1 << colour;
  return colour;
}

// members of a zone in the order of their colours, else as they were
static void sort_by_colour(cloth_zones *z)
{
  memset(z->taken, 0, sizeof *z->taken * (size_t)z->moving_count);
  for (int m = 0; m < z->count; m++) z->colour[m] = (unsigned char)pick_colour(z, m);
  memcpy(z->spare, z->member, sizeof *z->spare * (size_t)z->count);
  for (int i = 0; i < z->zones; i++) {
    int at[CLOTH_ZONE_COLOURS + 1] = {0}, place[CLOTH_ZONE_COLOURS] = {0};
    int first = z->first[i], end = z->first[i + 1];
    for (int m = first; m < end; m++) at[z->colour[m] + 1]++;
    for (int c = 0; c < CLOTH_ZONE_COLOURS; c++) at[c + 1] += at[c];
    for (int m = first; m < end; m++) {
      int c = z->colour[m];
      z->member[first + at[c] + place[c]++] = z->spare[m];
    }
    for (int c = 0; c < CLOTH_ZONE_COLOURS; c++)
      memset(z->colour + first + at[c], c, (size_t)(at[c + 1] - at[c]));
  }
}

// found pairs become constraints, or take the place of the pair's earlier one
static void take_found(cloth_sim *sim)
{
  cloth_zones *z = &sim->zones;
  int known = z->count, n = 0, k = 0;
  for (int i = 0; i < z->found_count; i++) {
    uint64_t key = z->found[i].key;
    while (k < known && z->key[z->by_key[k]] < key) z->spare[n++] = z->by_key[k++];
    int c = k < known && z->key[z->by_key[k]] == key ? z->by_key[k++] : z->count++;
    z->key[c] = key, z->toi[c] = z->found[i].toi;
    cloth_pair_corners(sim, key, z->vertex + 4 * c);
    z->spare[n++] = z->fresh[i] = c;
  }
  while (k < known) z->spare[n++] = z->by_key[k++];
  int *list = z->by_key;
  z->by_key = z->spare, z->spare = list;
}

cloth_status cloth_zones_add(cloth_sim *sim, cloth_error *err)
{
  cloth_zones *z = &sim->zones;
  CLOTH_TRY(reserve(sim, z->count + z->found_count, err));
  take_found(sim);
  mark_fixed(sim, 1);
  for (int c = 0; c < z->count; c++) z->parent[c] = c;
  for (int c = 0; c < z->count; c++)
    for (int k = 0; k < 4; k++)
      if (moves(sim, z->vertex[4 * c + k])) join(z, c, z->vertex[4 * c + k]);
  order_members(z);
  list_moving(sim);
  sort_by_colour(z);
  list_moving(sim); // what a member's corners are follows the members
  mark_fixed(sim, 0);
  return CLOTH_OK;
}

int cloth_zones_largest(const cloth_zones *z)
{
  int most = 0;
  for (int i = 0; i < z->zones; i++) {
    int n = z->moving_first[i + 1] - z->moving_first[i];
    if (n > most) most = n;
  }
  return most;
}

// ---- on the parts -------------------------------------------------------------------------------

static cloth_status grow_part(cloth_sim *sim, cloth_part *p, cloth_error *err)
{
  cloth_zone_part *z = &p->zone;
  size_t n = (size_t)sim->zones.capacity, i = sizeof(int), real = sizeof(cloth_real);
  if (sim->zones.capacity <= z->capacity) return CLOTH_OK;
  // geometry of earlier rounds stays
  size_t kept = (size_t)z->capacity;
  CLOTH_TRY(cloth_extend(sim, p, "zone_vertex", 4 * i * n, 4 * i * kept, &z->vertex, err));
  CLOTH_TRY(cloth_extend(sim, p, "zone_weight", 4 * real * n, 4 * real * kept, &z->weight, err));
  CLOTH_TRY(cloth_extend(sim, p, "zone_normal", 3 * real * n, 3 * real * kept, &z->normal, err));
  CLOTH_TRY(cloth_extend(sim, p, "zone_apart", real * n, real * kept, &z->apart, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_fresh", i * n, &z->fresh, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_key", 8 * n, &z->key, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_toi", 4 * n, &z->toi, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_member", i * n, &z->member, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_colour", n, &z->colour, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_local", 4 * i * n, &z->local, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_first", i * (n + 1), &z->first, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_moving_first", i * (n + 1), &z->moving_first, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_moving", 4 * i * n, &z->moving, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_deal", i * n, &z->deal, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_multiplier", real * n, &z->multiplier, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_need", 2 * real * n, &z->need, err));
  CLOTH_TRY(cloth_grow(sim, p, "zone_move", 12 * real * n, &z->move, err));
  z->capacity = sim->zones.capacity;
  return CLOTH_OK;
}

// zones with a vertex that the part owns; a zone across a border is solved by each of its parts
static int deal(cloth_zones *z, const cloth_part *p)
{
  int n = 0;
  for (int i = 0; i < z->zones; i++) {
    bool own = false;
    for (int k = z->moving_first[i]; k < z->moving_first[i + 1] && !own; k++)
      own = z->moving[k] >= p->v0 && z->moving[k] < p->v1;
    if (own) z->deal[n++] = i;
  }
  return n;
}

static cloth_status send(cloth_sim *sim, cloth_part *p, int dealt, cloth_error *err)
{
  const cloth_backend *be = sim->backend;
  const cloth_zones *z = &sim->zones;
  cloth_zone_part *d = &p->zone;
  size_t n = (size_t)z->count, zones = (size_t)z->zones + 1, i = sizeof(int);
  CLOTH_TRY(be->write(p->device, d->key, z->key, 8 * n, err));
  CLOTH_TRY(be->write(p->device, d->toi, z->toi, 4 * n, err));
  CLOTH_TRY(be->write(p->device, d->fresh, z->fresh, i * (size_t)z->found_count, err));
  CLOTH_TRY(be->write(p->device, d->member, z->member, i * n, err));
  CLOTH_TRY(be->write(p->device, d->colour, z->colour, n, err));
  CLOTH_TRY(be->write(p->device, d->local, z->local, 4 * i * n, err));
  CLOTH_TRY(be->write(p->device, d->first, z->first, i * zones, err));
  CLOTH_TRY(be->write(p->device, d->moving_first, z->moving_first, i * zones, err));
  CLOTH_TRY(be->write(p->device, d->moving, z->moving, i * (size_t)z->moving_count, err));
  return be->write(p->device, d->deal, z->deal, i * (size_t)dealt, err);
}

static cloth_status project_part(cloth_sim *sim, cloth_part *p, double gap, cloth_error *err)
{
  cloth_zones *z = &sim->zones;
  cloth_zone_part *d = &p->zone;
  CLOTH_TRY(grow_part(sim, p, err));
  int dealt = deal(z, p);
  CLOTH_TRY(send(sim, p, dealt, err));
  cloth_zone_build_args build = {.scene = cloth_contact_scene_of(sim, p),
                                 .gap = (cloth_real)gap,
                                 .fresh = d->fresh,
                                 .key = d->key,
                                 .toi = d->toi,
                                 .vertex = d->vertex,
                                 .weight = d->weight,
                                 .normal = d->normal,
                                 .apart = d->apart};
  CLOTH_LAUNCH(sim, p, zone_build, z->found_count, &build, err);
  cloth_zone_mark_args mark = {d->moving, d->moved};
  CLOTH_LAUNCH(sim, p, zone_mark, z->moving_count, &mark, err);
  cloth_zone_solve_args solve = {.zone = d->deal,
                                 .first = d->first,
                                 .member = d->member,
                                 .local = d->local,
                                 .colour = d->colour,
                                 .moving_first = d->moving_first,
                                 .moving = d->moving,
                                 .vertex = d->vertex,
                                 .weight = d->weight,
                                 .normal = d->normal,
                                 .apart = d->apart,
                                 .mass = p->mass,
                                 .x_solved = d->x_solved,
                                 .cloth_vertices = sim->vertex_count,
                                 .multiplier = d->multiplier,
                                 .need = d->need,
                                 .move = d->move,
                                 .x = p->x};
  CLOTH_LAUNCH(sim, p, zone_solve, dealt, &solve, err);
  return CLOTH_OK;
}

cloth_status cloth_zones_project(cloth_sim *sim, double gap, cloth_error *err)
{
  for (int i = 0; i < sim->part_count; i++) CLOTH_TRY(project_part(sim, &sim->part[i], gap, err));
  return cloth_exchange(sim, offsetof(cloth_part, x), CLOTH_PER_VERTEX, 3 * sizeof(cloth_real),
                        err);
}
