// One whole solve by several parts that reach each other's memory (backend.h, solve_parts). No part
// asks the host anything: it writes what the others need into their memory, and tells them by a
// count of signals (on a GPU each of its blocks does). In this order, iteration after iteration:
//
//   signal 1        start, with hats only: r of the rows that others' nodes sum over lies in their
//                   `r`
//   signal 3 k + 2  residuals: sums of r'z and r'r of its groups of chunks lie in everybody's
//                   `terms`, with aggregates sums of r of its chunks in everybody's `partial`; of
//                   its nodes of hats, the residuals in everybody's `hat_rest`, sums of r'z in
//                   everybody's `terms`, the corrections in their `hat_correction` who interpolate
//                   them
//   signal 3 k + 3  directions: p of the rows that others read lies in their `p`
//   signal 3 k + 4  products: sums of p'q of its groups of chunks lie in everybody's `terms`, q of
//                   the rows that others' nodes sum over in their `q`
//
// A node of the first level of hats belongs to one part, which sums over all its vertices in one
// order. Of vertices that are others' it keeps r itself, from the q it is sent: r' = r - alpha q is
// the same bits everywhere, so r need not travel, which would take a signal of its own. The
// other levels are small, and every part does them all.
//
// Who has everybody's signal of residuals or products adds all terms in one order, so that the
// scalars, and with them what each part does next, are the same bits everywhere. Nothing that is
// still read is overwritten: between two writings of a number lies a signal that its readers give
// after they have read it. (Terms of p'q have a place of their own for this reason: between a sum
// of p'q and the next r'z there is none.)
//
// Rows that read only what is their part's own ("inner") are multiplied before the others'
// directions have come (pipelined product: P-Cloth section 3.1.1, cut by rows instead of columns,
// so that each row is summed in one piece and in one order).
#pragma once

#include "hat_share.h"
#include "pcg_solve.h"

enum {
  CLOTH_PARTS_MAX = 16,   // of such a solve
  CLOTH_FLAG_STRIDE = 32, // numbers between two flags, so that each has a cache line to itself
  CLOTH_FLAG_WORDS = CLOTH_PARTS_MAX * CLOTH_FLAG_STRIDE
};

// memory of one part that the others write
typedef struct cloth_pcg_peer {
  cloth_real *p;       // [vertices x 3]
  cloth_real *partial; // [chunks x CLOTH_PCG_PARTIALS] fields 2 to 4 written
  cloth_pcg_terms terms;
  cloth_real *r, *q;                     // [vertices x 3], written with hats only
  cloth_real *hat_rest, *hat_correction; // [nodes x 3]
  int *flag; // [CLOTH_FLAG_WORDS] signals so far, zero before: how a backend counts them is its own
} cloth_pcg_peer;

typedef struct cloth_pcg_part_args {
  cloth_pcg_solve_args solve;
  int parts, me;
  int whole;                    // 1: every row of p goes to every part, 0: what a part reads
  int overlap;                  // 1: inner rows first, 0: all rows when everything has come
  const uint32_t *reader;       // [rows] bit j: part j reads this row's p (halo_contact.h)
  const uint32_t *chunk_reader; // [chunks of the part] all bits of its rows; 0: inner
  const uint32_t *order;        // [chunks of the part] inner ones first (halo_order.h)
  const uint32_t *outer;        // [2] chunks of the part that are not inner, contacts that are not
  cloth_hat_share share;        // of this part in the hats; no nodes without them
  cloth_pcg_peer peer[CLOTH_PARTS_MAX]; // [parts] the part's own too
} cloth_pcg_part_args;

/// Signals after which the residuals, directions, products of iteration k are there.
enum { CLOTH_START_SIGNAL = 1 };
CLOTH_FN int cloth_residuals_signal(int k) { return 3 * k + 2; }
CLOTH_FN int cloth_directions_signal(int k) { return 3 * k + 3; }
CLOTH_FN int cloth_products_signal(int k) { return 3 * k + 4; }

/// Bits of the parts that get p of a chunk's rows, of a row.
CLOTH_FN uint32_t cloth_all_others(const cloth_pcg_part_args *a)
{
  return ((1u << a->parts) - 1) & ~(1u << a->me);
}

CLOTH_FN uint32_t cloth_chunk_readers(const cloth_pcg_part_args *a, int chunk)
{
  return a->whole ? cloth_all_others(a) : a->chunk_reader[chunk];
}

CLOTH_FN uint32_t cloth_row_readers(const cloth_pcg_part_args *a, int row)
{
  return a->whole ? cloth_all_others(a) : a->reader[row];
}

/// p of row `row` of the part to those who read it.
CLOTH_FN void cloth_direction_send(const cloth_pcg_part_args *a, int row)
{
  int k = a->solve.v.first + row;
  uint32_t readers = cloth_row_readers(a, row);
  cloth_v3 p = cloth_v3_load(a->solve.v.p, k);
  for (int j = 0; j < a->parts; j++)
    if (readers >> j & 1) cloth_v3_store(a->peer[j].p, k, p);
}

/// q of row `row` of the part, or r at the start, to those whose nodes sum over it.
CLOTH_FN void cloth_hat_row_send(const cloth_pcg_part_args *a, int row, int start)
{
  uint32_t readers = a->share.row_reader ? a->share.row_reader[row] : 0;
  if (!readers) return;
  int k = a->solve.v.first + row;
  cloth_v3 value = cloth_v3_load(start ? a->solve.v.r : a->solve.v.q, k);
  for (int j = 0; j < a->parts; j++)
    if (readers >> j & 1) cloth_v3_store(start ? a->peer[j].r : a->peer[j].q, k, value);
}

/// r of vertex i of the list of others' vertices, from their q.
CLOTH_FN void cloth_hat_row_update(const cloth_pcg_part_args *a, int i, cloth_real alpha)
{
  const cloth_pcg_vectors *v = &a->solve.v;
  int k = a->share.others[i];
  cloth_v3_store(v->r, k, cloth_pcg_residual_step(k, v, alpha));
}

/// Own node c of the first level to the others, after it is set.
CLOTH_FN void cloth_hat_node_send(const cloth_pcg_part_args *a, int c)
{
  const cloth_hats *h = &a->solve.v.hats;
  cloth_v3 rest = cloth_v3_load(h->rest, c), y = cloth_v3_load(h->correction, c);
  uint32_t readers = a->share.node_reader[c];
  for (int j = 0; j < a->parts; j++) {
    if (j == a->me) continue;
    cloth_v3_store(a->peer[j].hat_rest, c, rest);
    if (readers >> j & 1) cloth_v3_store(a->peer[j].hat_correction, c, y);
  }
}

/// Share of r'z of group i of the first level, for everybody.
CLOTH_FN void cloth_hat_group_send(const cloth_pcg_part_args *a, int i, cloth_real rz)
{
  int at = cloth_chunk_groups(a->solve.v.chunks) + i;
  for (int j = 0; j < a->parts; j++) a->peer[j].terms.rz[at] = rz;
}

/// r'z and r'r of group i of the chunks of all, and p'q of it, likewise.
CLOTH_FN void cloth_residual_terms_send(const cloth_pcg_part_args *a, int i, cloth_real rz,
                                        cloth_real rr)
{
  for (int j = 0; j < a->parts; j++) a->peer[j].terms.rz[i] = rz, a->peer[j].terms.rr[i] = rr;
}

CLOTH_FN void cloth_product_term_send(const cloth_pcg_part_args *a, int i, cloth_real pq)
{
  for (int j = 0; j < a->parts; j++) a->peer[j].terms.pq[i] = pq;
}

/// Groups of the first level's nodes that are the part's own: [begin, end).
CLOTH_FN int cloth_hat_share_begin(const cloth_hat_share *s)
{
  return s->begin / CLOTH_HAT_FINE_GROUP;
}

CLOTH_FN int cloth_hat_share_end(const cloth_hat_share *s)
{
  return (s->end + CLOTH_HAT_FINE_GROUP - 1) / CLOTH_HAT_FINE_GROUP;
}

/// Are the levels' corrections at node c of the first level wanted on this part?
CLOTH_FN int cloth_hat_is_mine(const cloth_pcg_part_args *a, int c)
{
  return a->share.node_reader[c] >> a->me & 1;
}

/// Does contact i read p of another part?
CLOTH_FN int cloth_contact_is_outer(const cloth_pcg_part_args *a, int i)
{
  const cloth_contact_product_args *c = &a->solve.contact;
  int begin = a->solve.v.first, end = begin + a->solve.v.count;
  for (int k = 0; k < 4; k++) {
    int v = c->vertex[4 * i + k];
    if (v < c->cloth_vertices && (v < begin || v >= end)) return 1;
  }
  return 0;
}
