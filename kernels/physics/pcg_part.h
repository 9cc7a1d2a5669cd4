// One whole solve by several parts that reach each other's memory (backend.h, solve_parts). No part
// asks the host anything: it writes what the others need into their memory, and tells them by a
// count of signals. In this order, iteration after iteration:
//
//   signal 3 k + 1  residuals: sums of r'z, r'r and r of its chunks lie in everybody's `partial`
//   signal 3 k + 2  directions: p of the rows that others read lies in their `p`
//   signal 3 k + 3  products: sums of p'q of its chunks lie in everybody's `pq`
//
// Who has everybody's signal of residuals or products adds all chunk sums in one order, so that the
// scalars, and with them what each part does next, are the same bits everywhere. Nothing that is
// still read is overwritten: between two writings of a number lies a signal that its readers give
// after they have read it. (`pq` is not a field of `partial` for this reason: between a sum of p'q
// and the next r'z there is none.)
//
// Rows that read only what is their part's own ("inner") are multiplied before the others'
// directions have come (pipelined product: P-Cloth section 3.1.1, cut by rows instead of columns,
// so that each row is summed in one piece and in one order).
#pragma once

#include "pcg_solve.h"

enum {
  CLOTH_PARTS_MAX = 16,   // of such a solve
  CLOTH_FLAG_STRIDE = 32, // numbers between two flags, so that each has a cache line to itself
  CLOTH_FLAG_WORDS = (CLOTH_PARTS_MAX + 1) * CLOTH_FLAG_STRIDE, // the last line: the part's own
  CLOTH_FLAG_LOST = -1 // instead of a count: do not wait any more
};

// memory of one part that the others write
typedef struct cloth_pcg_peer {
  cloth_real *p;       // [vertices x 3]
  cloth_real *partial; // [chunks x CLOTH_PCG_PARTIALS]
  cloth_real *pq;      // [chunks]
  int *flag;           // [CLOTH_FLAG_WORDS] signals of each part so far
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
  cloth_pcg_peer peer[CLOTH_PARTS_MAX]; // [parts] the part's own too
} cloth_pcg_part_args;

/// Signals after which the residuals, directions, products of iteration k are there.
CLOTH_FN int cloth_residuals_signal(int k) { return 3 * k + 1; }
CLOTH_FN int cloth_directions_signal(int k) { return 3 * k + 2; }
CLOTH_FN int cloth_products_signal(int k) { return 3 * k + 3; }

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
