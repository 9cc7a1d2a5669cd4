// What one of several parts does of the hats' first level, and what it needs of others for that.
// All of it lies in the mesh at rest and does not change.
#pragma once

#include <stdint.h>

typedef struct cloth_hat_share {
  int begin, end;             // own nodes: whole groups, so that a group's sum has one author
  int other_count;            // vertices of others that own nodes sum over:
  const int *others;          // [other_count]
  const uint32_t *row_reader; // [rows of the part] bit j: a node of part j sums over it; NULL: none
  const uint32_t *node_reader; // [fine nodes] bit j: vertices of part j share in it
} cloth_hat_share;
