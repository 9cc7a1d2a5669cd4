// Which of many boxes overlap a box? A balanced tree of boxes on the host. Every comparison is of
// coordinates as given, so the answer is that of testing all of them: nothing is missed, nothing is
// added, boxes that only touch overlap.
#pragma once

#include "status.h"

/// A closed box. min <= max, finite.
typedef struct cloth_box {
  double min[3], max[3]; // m
} cloth_box;

static inline int cloth_box_overlap(const cloth_box *a, const cloth_box *b)
{
  return a->min[0] <= b->max[0] && b->min[0] <= a->max[0] && a->min[1] <= b->max[1] &&
         b->min[1] <= a->max[1] && a->min[2] <= b->max[2] && b->min[2] <= a->max[2];
}

/// The smallest box around both.
cloth_box cloth_box_join(const cloth_box *a, const cloth_box *b);

/// Boxes in a complete binary tree: node k has the children 2 k + 1 and 2 k + 2, and node i of
/// level d holds boxes [i n / 2^d, (i + 1) n / 2^d) of the tree's order.
typedef struct cloth_box_tree {
  int count, depth;
  int *order;      // [count] which box is where in the tree's order
  cloth_box *leaf; // [count] boxes in that order
  cloth_box *node; // [2^(depth + 1) - 1]
} cloth_box_tree;

/// Build over `box` [count], which is copied; count may be 0. CLOTH_NO_MEMORY.
cloth_status cloth_box_tree_make(const cloth_box *box, int count, cloth_box_tree *out,
                                 cloth_error *err);

/// What is inside, not the struct. A zeroed tree is allowed.
void cloth_box_tree_free(cloth_box_tree *tree);

/// A walk over the boxes that overlap one box. Several threads may walk over one tree.
typedef struct cloth_box_walk {
  const cloth_box_tree *tree;
  cloth_box box;
  int stack[72], level[72], waiting; // nodes still to be opened; at most two a level
  int at, end;                       // of the leaf that is open
} cloth_box_walk;

cloth_box_walk cloth_box_walk_start(const cloth_box_tree *tree, const cloth_box *box);

/// The index of the next box that overlaps, as given to cloth_box_tree_make(); -1 when there is no
/// more. The order depends on the boxes alone.
int cloth_box_walk_next(cloth_box_walk *walk);
