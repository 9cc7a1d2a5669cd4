// Preconditioned conjugate gradients, 3x3 block Jacobi with or without a coarse level, in a form
// that needs no scalar on the host: every number that steers the iteration lives in device memory,
// and once the solve is done the remaining kernels change nothing. (Hestenes and Stiefel 1952;
// masked rows: Baraff and Witkin 1998.)
#pragma once

#include "block_rows.h"
#include "chunk.h"

// scalars of one solve, cloth_real [CLOTH_PCG_SCALARS]
enum {
  CLOTH_PCG_ALPHA,
  CLOTH_PCG_BETA,
  CLOTH_PCG_RZ,        // r' z
  CLOTH_PCG_RZ_COARSE, // the part of it that the coarse level adds
  CLOTH_PCG_RZ_FIRST,  // r' z of the substep's first solve at its start
  CLOTH_PCG_RR,        // r' r
  CLOTH_PCG_BB,        // b' b of the substep's first solve, over the free rows
  CLOTH_PCG_DONE,      // 1: converged or broken down
  CLOTH_PCG_ITERATIONS,
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
  cloth_real *partial;                // [chunks x CLOTH_PCG_PARTIALS] sums of chunks
  const cloth_real *coarse;           // [aggregates x 3] correction of each aggregate; NULL: none
  int aggregates, chunks;             // of all parts
  cloth_real *scalar;                 // [CLOTH_PCG_SCALARS]
} cloth_pcg_vectors;

// partial sums of all chunks, in order
CLOTH_FN cloth_real cloth_partial_sum(const cloth_real *partial, int chunks, int field)
{
  cloth_real sum = 0;
  for (int c = 0; c < chunks; c++) sum += partial[CLOTH_PCG_PARTIALS * c + field];
  return sum;
}

// The coarse level: vertices of an aggregate (a run of chunks) move together (Nicolaides 1987).
// What is stiff over long distances, a pull along the whole cloth, is solved there directly; block
// Jacobi does the rest. Additive, so symmetric and positive definite.
CLOTH_FN int cloth_aggregate_of(int vertex, int chunks, int aggregates)
{
  return (int)((int64_t)(vertex / CLOTH_CHUNK) * aggregates / chunks);
}
