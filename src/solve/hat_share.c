// Which nodes of the hats' first level belong to which of several parts that solve together, and
// what they need of each other for that: kernels/physics/pcg_part.h. Nodes are numbered in the
// order of the first vertex that shares in them, so a part's run of vertices has a run of nodes.
#include "halo_contact.h"
#include "solve/hats.h"

#include <stdlib.h>

typedef struct readers {
  uint32_t *row, *node; // [rows of the part], [fine] bits of parts
  int *others;          // [cloth vertices]
} readers;

// own nodes of each part: [cut[j], cut[j + 1])
static void cut_nodes(const cloth_sim *sim, const cloth_hats *h, const int *corner,
                      const cloth_real *weight, int cut[CLOTH_HALO_PARTS + 1])
{
  int seen = 0, v = 0;
  for (int j = 0; j < sim->part_count; j++) {
    for (; v < sim->part[j].v0; v++)
      for (int k = CLOTH_HAT_CORNERS * v; k < CLOTH_HAT_CORNERS * (v + 1); k++)
        if (weight[k] > 0 && corner[k] >= seen) seen = corner[k] + 1;
    int group = (seen + CLOTH_HAT_FINE_GROUP / 2) / CLOTH_HAT_FINE_GROUP;
    cut[j] = group * CLOTH_HAT_FINE_GROUP;
    if (cut[j] > h->fine) cut[j] = h->fine;
  }
  cut[sim->part_count] = h->fine;
}

// vertex v of part `at`, and who has its nodes
static void find_readers(const cloth_sim *sim, cloth_part *p, int v, int at, const int *node_cut,
                         const int *corner, const cloth_real *weight, readers *r)
{
  bool listed = false;
  for (int k = CLOTH_HAT_CORNERS * v; k < CLOTH_HAT_CORNERS * (v + 1); k++) {
    r->node[corner[k]] |= 1u << at;
    int owner = cloth_part_of(node_cut, sim->part_count, corner[k]);
    if (owner == at || !(weight[k] > 0)) continue;
    if (at == p->index) r->row[v - p->v0] |= 1u << owner;
    if (owner == p->index && !listed) r->others[p->hat_share.other_count++] = v, listed = true;
  }
}

static cloth_status share_upload(cloth_sim *sim, cloth_part *p, const readers *r, cloth_error *err)
{
  cloth_hat_share *s = &p->hat_share;
  size_t rows = (size_t)(p->v1 - p->v0), fine = (size_t)p->hats.fine;
  CLOTH_TRY(
      cloth_upload(sim, p, "hat_row_reader", r->row, sizeof(uint32_t) * rows, &s->row_reader, err));
  CLOTH_TRY(cloth_upload(sim, p, "hat_node_reader", r->node, sizeof(uint32_t) * fine,
                         &s->node_reader, err));
  return cloth_upload(sim, p, "hat_others", r->others, sizeof(int) * (size_t)s->other_count,
                      &s->others, err);
}

cloth_status cloth_hat_share_build(cloth_sim *sim, cloth_part *p, const int *corner,
                                   const cloth_real *weight, cloth_error *err)
{
  p->hat_share = (cloth_hat_share){.begin = 0, .end = p->hats.fine};
  if (!sim->joined) return CLOTH_OK;
  int vertex_cut[CLOTH_HALO_PARTS + 1], node_cut[CLOTH_HALO_PARTS + 1];
  readers r = {.row = calloc((size_t)(p->v1 - p->v0) + 1, sizeof(uint32_t)),
               .node = calloc((size_t)p->hats.fine + 1, sizeof(uint32_t)),
               .others = malloc(sizeof(int) * (size_t)sim->vertex_count + 8)};
  cloth_status status = CLOTH_OK;
  if (!r.row || !r.node || !r.others)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "levels of the solver");
  if (status == CLOTH_OK) {
    cloth_cuts(sim, vertex_cut);
    cut_nodes(sim, &p->hats, corner, weight, node_cut);
    p->hat_share.begin = node_cut[p->index], p->hat_share.end = node_cut[p->index + 1];
    for (int v = 0; v < sim->vertex_count; v++)
      find_readers(sim, p, v, cloth_part_of(vertex_cut, sim->part_count, v), node_cut, corner,
                   weight, &r);
    status = share_upload(sim, p, &r, err);
  }
  free(r.row), free(r.node), free(r.others);
  return status;
}
