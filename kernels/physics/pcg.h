// Preconditioned conjugate gradients, 3x3 block Jacobi alone or with coarser levels, in a form
// that needs no scalar on the host: every number that steers the iteration lives in device memory,
// and once the solve is done the remaining kernels change nothing. (Hestenes and Stiefel 1952;
// masked rows: Baraff and Witkin 1998.)
#pragma once

#include "block_rows.h"
#include "chunk.h"
#include "hat.h"

// scalars of one solve, cloth_real [CLOTH_PCG_SCALARS]
enum {
  CLOTH_PCG_ALPHA,
  CLOTH_PCG_BETA,
  CLOTH_PCG_RZ,       // r' z
  CLOTH_PCG_RZ_FIRST, // r' z at the start of the solve that this one is measured against
  CLOTH_PCG_RR,       // r' r
  CLOTH_PCG_BB,       // b' b of that, over the free rows
  CLOTH_PCG_DONE,     // 1: converged or broken down
  CLOTH_PCG_ITERATIONS,
  CLOTH_PCG_RESIDUAL, // r'r of the true residual at the end
  CLOTH_PCG_LARGEST,  // m, largest correction of a vertex
  CLOTH_PCG_LOST,     // 1: another part did not answer (pcg_part.h)
  CLOTH_PCG_SCALARS
};

// sums of a chunk, fields of `partial`: r'z of the block Jacobi part (or p'q), r'r, r in x y z
enum { CLOTH_PCG_PARTIALS = 5 };

// rows of a part: solve vectors are padded to whole chunks, and the padding stays zero
typedef struct cloth_pcg_vectors {
  int first, count;                   // owned vertices; first is a multiple of CLOTH_CHUNK
  const cloth_real *free;             // [vertices] 1: row is solved, 0: held
  const cloth_real *inverse_diagonal; // [vertices x 6]
  const cloth_real *b;                // [vertices x 3]
  cloth_real *dx, *r, *z, *p, *q;     // [vertices x 3]
  cloth_real *partial;                // [chunks x CLOTH_PCG_PARTIALS] sums of chunks; behind them
                                      // those of hat_rest.h
  const cloth_real *coarse;           // [aggregates x 3] correction of each aggregate; NULL: none
  int aggregates, chunks;             // of all parts
  cloth_hats hats;                    // no nodes: none
  cloth_real *scalar;                 // [CLOTH_PCG_SCALARS]
} cloth_pcg_vectors;

/// z of vertex k by block Jacobi.
CLOTH_FN cloth_v3 cloth_pcg_z(int k, const cloth_pcg_vectors *v, cloth_v3 r)
{
  return cloth_v3_scale(v->free[k], cloth_sym3_mul(cloth_sym3_load(v->inverse_diagonal, k), r));
}

/// r of a chunk, x y z.
typedef struct cloth_pcg_chunk {
  cloth_real r[3][CLOTH_CHUNK];
} cloth_pcg_chunk;

/// z of a chunk and its partial sums, from r. Vertices [begin, end); what lies behind is zero.
CLOTH_FN void cloth_pcg_chunk_finish(const cloth_pcg_vectors *v, cloth_pcg_chunk *c, int begin,
                                     int end)
{
  cloth_real rz[CLOTH_CHUNK], rr[CLOTH_CHUNK];
  for (int lane = end - begin; lane < CLOTH_CHUNK; lane++)
    c->r[0][lane] = c->r[1][lane] = c->r[2][lane] = rz[lane] = rr[lane] = 0;
  for (int lane = 0; lane < end - begin; lane++) {
    cloth_v3 r = cloth_v3_make(c->r[0][lane], c->r[1][lane], c->r[2][lane]);
    cloth_v3 z = cloth_pcg_z(begin + lane, v, r);
    cloth_v3_store(v->z, begin + lane, z);
    rz[lane] = cloth_v3_dot(r, z), rr[lane] = cloth_v3_dot(r, r);
  }
  cloth_real *partial = v->partial + CLOTH_PCG_PARTIALS * (begin / CLOTH_CHUNK);
  partial[0] = cloth_chunk_sum(rz), partial[1] = cloth_chunk_sum(rr);
  for (int k = 0; k < 3 && v->coarse; k++) partial[2 + k] = cloth_chunk_sum(c->r[k]);
}

CLOTH_FN void cloth_pcg_chunk_set(cloth_pcg_chunk *c, int lane, cloth_v3 r)
{
  c->r[0][lane] = r.x, c->r[1][lane] = r.y, c->r[2][lane] = r.z;
}

// Sum over all chunks: lane l adds chunks l, l + LANES, ... and the lanes are added pairwise. One
// order, that a loop and a block of threads follow alike.
enum { CLOTH_PCG_LANES = 256, CLOTH_COARSE_LANES = 32 };

/// The numbers of all chunks, `stride` apart.
CLOTH_FN cloth_real cloth_chunks_sum(const cloth_real *number, int chunks, int stride)
{
  cloth_real lane[CLOTH_PCG_LANES];
  int used = chunks < CLOTH_PCG_LANES ? chunks : CLOTH_PCG_LANES;
  for (int l = 0; l < used; l++) lane[l] = 0 + number[stride * l];
  for (int c = CLOTH_PCG_LANES; c < chunks; c++)
    lane[c % CLOTH_PCG_LANES] += number[stride * c];
  return cloth_lanes_sum_of(lane, used, CLOTH_PCG_LANES);
}

CLOTH_FN cloth_real cloth_partial_sum(const cloth_real *partial, int chunks, int field)
{
  return cloth_chunks_sum(partial + field, chunks, CLOTH_PCG_PARTIALS);
}

// The coarse level: vertices of an aggregate (a run of chunks) move together (Nicolaides 1987).
// What is stiff over long distances, a pull along the whole cloth, is solved there directly; block
// Jacobi does the rest. Additive, so symmetric and positive definite.
enum { CLOTH_AGGREGATES_MAX = 96 }; // a dense factor of 288 rows

CLOTH_FN int cloth_aggregate_of(int vertex, int chunks, int aggregates)
{
  return (int)((int64_t)(vertex / CLOTH_CHUNK) * aggregates / chunks);
}

/// First chunk of an aggregate.
CLOTH_FN int cloth_aggregate_begin(int aggregate, int chunks, int aggregates)
{
  return (int)(((int64_t)aggregate * chunks + aggregates - 1) / aggregates);
}

/// The coarse level's share of r'z: P' r times the correction, lanes as in coarse_solve.h.
CLOTH_FN cloth_real cloth_coarse_rz(const cloth_real *rest, const cloth_real *coarse,
                                    int aggregates)
{
  cloth_real lane[CLOTH_COARSE_LANES];
  for (int l = 0; l < CLOTH_COARSE_LANES; l++) lane[l] = 0;
  for (int k = 0; k < 3 * aggregates; k++) lane[k % CLOTH_COARSE_LANES] += rest[k] * coarse[k];
  return cloth_lanes_sum(lane, CLOTH_COARSE_LANES);
}
