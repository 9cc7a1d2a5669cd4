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
  CLOTH_PCG_RESIDUAL,        // r'r of the true residual at the end
  CLOTH_PCG_LARGEST,         // m, largest correction of a vertex
  CLOTH_PCG_RESIDUAL_LENGTH, // m, how far the solve leaves a vertex from its place: pcg_residual.h
  CLOTH_PCG_LOST,            // 1: another part did not answer (pcg_part.h)
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

// Sum over all chunks. Where they are many, GROUP neighbours are added pairwise first: a block of a
// GPU that has them anyway does it (kernels/cuda/group_sums.cuh). Then lane l adds groups l,
// l + LANES, ... and the lanes are added pairwise. One order, of the number of chunks alone, that a
// loop and blocks of threads follow alike. Parts are cut at groups.
enum {
  CLOTH_PCG_LANES = 256,
  CLOTH_COARSE_LANES = 32,
  CLOTH_CHUNK_GROUP = 4,
  CLOTH_FEW_CHUNKS = 1024 // each is a group
};

/// Chunks of a group, but for the last one; groups.
CLOTH_FN int cloth_chunk_group(int chunks)
{
  return chunks > CLOTH_FEW_CHUNKS ? CLOTH_CHUNK_GROUP : 1;
}

CLOTH_FN int cloth_chunk_groups(int chunks)
{
  int group = cloth_chunk_group(chunks);
  return (chunks + group - 1) / group;
}

/// The sum of group i; numbers are `stride` apart.
CLOTH_FN cloth_real cloth_group_sum(const cloth_real *number, int chunks, int stride, int i)
{
  if (cloth_chunk_group(chunks) == 1) return number[(int64_t)stride * i];
  cloth_real v[CLOTH_CHUNK_GROUP];
  for (int k = 0, c = i * CLOTH_CHUNK_GROUP; k < CLOTH_CHUNK_GROUP; k++, c++)
    v[k] = c < chunks ? number[(int64_t)stride * c] : 0;
  return cloth_lanes_sum(v, CLOTH_CHUNK_GROUP);
}

/// Term e of the sum over all chunks: a group, or behind the groups one of the numbers that lie
/// behind the chunks.
CLOTH_FN cloth_real cloth_sum_term(const cloth_real *number, int chunks, int stride, int e)
{
  int groups = cloth_chunk_groups(chunks);
  if (e < groups) return cloth_group_sum(number, chunks, stride, e);
  return number[(int64_t)stride * (chunks + e - groups)];
}

/// The sum of all terms; `more` of them are no chunks'.
CLOTH_FN cloth_real cloth_chunks_sum(const cloth_real *number, int chunks, int more, int stride)
{
  cloth_real lane[CLOTH_PCG_LANES];
  int terms = cloth_chunk_groups(chunks) + more;
  int used = terms < CLOTH_PCG_LANES ? terms : CLOTH_PCG_LANES;
  for (int l = 0; l < used; l++) lane[l] = 0 + cloth_sum_term(number, chunks, stride, l);
  for (int e = CLOTH_PCG_LANES; e < terms; e++)
    lane[e % CLOTH_PCG_LANES] += cloth_sum_term(number, chunks, stride, e);
  return cloth_lanes_sum_of(lane, used, CLOTH_PCG_LANES);
}

CLOTH_FN cloth_real cloth_partial_sum(const cloth_real *partial, int chunks, int more, int field)
{
  return cloth_chunks_sum(partial + field, chunks, more, CLOTH_PCG_PARTIALS);
}

/// The same where the terms lie side by side.
CLOTH_FN cloth_real cloth_terms_sum(const cloth_real *term, int terms)
{
  cloth_real lane[CLOTH_PCG_LANES];
  int used = terms < CLOTH_PCG_LANES ? terms : CLOTH_PCG_LANES;
  for (int l = 0; l < used; l++) lane[l] = 0 + term[l];
  for (int e = CLOTH_PCG_LANES; e < terms; e++) lane[e % CLOTH_PCG_LANES] += term[e];
  return cloth_lanes_sum_of(lane, used, CLOTH_PCG_LANES);
}

/// Terms side by side, of a solve in one kernel: p'q, r'r [groups], r'z [groups, then those of
/// hat_rest.h]; room for the sums of lanes of two of them.
typedef struct cloth_pcg_terms {
  cloth_real *lanes, *pq, *rr, *rz;
} cloth_pcg_terms;

/// Where they are in an array of 2 x CLOTH_PCG_LANES + 3 groups + hat groups.
CLOTH_FN cloth_pcg_terms cloth_pcg_terms_at(cloth_real *terms, int chunks)
{
  int groups = cloth_chunk_groups(chunks);
  cloth_pcg_terms t;
  t.lanes = terms, t.pq = terms + 2 * CLOTH_PCG_LANES;
  t.rr = t.pq + groups, t.rz = t.rr + groups;
  return t;
}

/// Groups of the part's own chunks: [begin, end).
CLOTH_FN int cloth_own_groups_begin(const cloth_pcg_vectors *v)
{
  return v->first / CLOTH_CHUNK / cloth_chunk_group(v->chunks);
}

CLOTH_FN int cloth_own_groups_end(const cloth_pcg_vectors *v)
{
  int rows = CLOTH_CHUNK * cloth_chunk_group(v->chunks);
  return (v->first + v->count + rows - 1) / rows;
}

// The coarse level: vertices of an aggregate (a run of groups of chunks) move together (Nicolaides
// 1987). What is stiff over long distances, a pull along the whole cloth, is solved there directly;
// block Jacobi does the rest. Additive, so symmetric and positive definite.
enum { CLOTH_AGGREGATES_MAX = 96 }; // a dense factor of 288 rows

CLOTH_FN int cloth_aggregate_of(int vertex, int chunks, int aggregates)
{
  int group = vertex / CLOTH_CHUNK / cloth_chunk_group(chunks);
  return (int)((int64_t)group * aggregates / cloth_chunk_groups(chunks));
}

/// First chunk of an aggregate: it begins with a group, since parts are cut at both.
CLOTH_FN int cloth_aggregate_begin(int aggregate, int chunks, int aggregates)
{
  int groups = cloth_chunk_groups(chunks);
  int group = (int)(((int64_t)aggregate * groups + aggregates - 1) / aggregates);
  int chunk = group * cloth_chunk_group(chunks);
  return chunk < chunks ? chunk : chunks;
}

/// The aggregate that begins with this chunk, where a part does; `chunks`: their number.
CLOTH_FN int cloth_aggregate_from(int chunk, int chunks, int aggregates)
{
  int size = cloth_chunk_group(chunks), group = (chunk + size - 1) / size;
  return (int)((int64_t)group * aggregates / cloth_chunk_groups(chunks));
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
