#include "geometry/box_tree.h"

#include <stdint.h>
#include <stdlib.h>

enum { LEAF_SIZE = 4, TASK_SIZE = 8192 };

cloth_box cloth_box_join(const cloth_box *a, const cloth_box *b)
{
  cloth_box j = *a;
  for (int k = 0; k < 3; k++) {
    if (b->min[k] < j.min[k]) j.min[k] = b->min[k];
    if (b->max[k] > j.max[k]) j.max[k] = b->max[k];
  }
  return j;
}

// first box, in the tree's order, of node i of a level; i + 1 gives the end
static int range_start(const cloth_box_tree *t, int level, int64_t i)
{
  return (int)(i * t->count >> level);
}

// ---- building ----------------------------------------------------------------------------------

// halves are added, not the sum halved: it might overflow
static double centre(const cloth_box *box, int axis)
{
  return box->min[axis] / 2 + box->max[axis] / 2;
}

static int widest_axis(const cloth_box *box, const int *order, int count)
{
  cloth_box range = {{0}, {0}};
  for (int i = 0; i < count; i++) {
    cloth_box point;
    for (int k = 0; k < 3; k++) point.min[k] = point.max[k] = centre(&box[order[i]], k);
    range = i == 0 ? point : cloth_box_join(&range, &point);
  }
  int axis = 0;
  for (int k = 1; k < 3; k++)
    if (range.max[k] / 2 - range.min[k] / 2 > range.max[axis] / 2 - range.min[axis] / 2) axis = k;
  return axis;
}

// Reorder so that no centre before `middle` is above one from it on (Hoare's selection). The pivots
// are drawn at random, from a fixed start, so that no arrangement of a mesh makes it slow.
static void select_middle(const cloth_box *box, int *order, int count, int middle, int axis)
{
  int first = 0, last = count - 1;
  uint32_t random = 2463534242u;
  while (first < last) {
    random ^= random << 13, random ^= random >> 17, random ^= random << 5; // Marsaglia 2003
    double pivot = centre(&box[order[first + (int)(random % (uint32_t)(last - first + 1))]], axis);
    int i = first, j = last;
    while (i <= j) {
      while (centre(&box[order[i]], axis) < pivot) i++;
      while (centre(&box[order[j]], axis) > pivot) j--;
      if (i > j) break;
      int swap = order[i];
      order[i++] = order[j], order[j--] = swap;
    }
    if (middle <= j)
      last = j;
    else if (middle >= i)
      first = i;
    else
      return;
  }
}

static void build(cloth_box_tree *t, const cloth_box *box, int level, int64_t i)
{
  int first = range_start(t, level, i), last = range_start(t, level, i + 1);
  cloth_box *node = &t->node[((int64_t)1 << level) - 1 + i];
  if (level == t->depth) {
    for (int k = first; k < last; k++) {
      t->leaf[k] = box[t->order[k]];
      *node = k == first ? t->leaf[k] : cloth_box_join(node, &t->leaf[k]);
    }
    return;
  }
  int middle = range_start(t, level + 1, 2 * i + 1);
  int axis = widest_axis(box, t->order + first, last - first);
  select_middle(box, t->order + first, last - first, middle - first, axis);
#pragma omp task if (last - first > TASK_SIZE)
  build(t, box, level + 1, 2 * i);
  build(t, box, level + 1, 2 * i + 1);
#pragma omp taskwait
  const cloth_box *child = &t->node[((int64_t)2 << level) - 1 + 2 * i];
  *node = cloth_box_join(&child[0], &child[1]);
}

cloth_status cloth_box_tree_make(const cloth_box *box, int count, cloth_box_tree *out,
                                 cloth_error *err)
{
  *out = (cloth_box_tree){.count = count};
  while (((int64_t)LEAF_SIZE << out->depth) < count) out->depth++;
  out->order = malloc(sizeof *out->order * ((size_t)count + 1));
  out->leaf = malloc(sizeof *out->leaf * ((size_t)count + 1));
  out->node = malloc(sizeof *out->node * ((size_t)2 << out->depth));
  if (!out->order || !out->leaf || !out->node) {
    cloth_box_tree_free(out);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for a tree of %d boxes", count);
  }
  for (int i = 0; i < count; i++) out->order[i] = i;
  if (count == 0) return CLOTH_OK;
#pragma omp parallel
#pragma omp single
  build(out, box, 0, 0);
  return CLOTH_OK;
}

void cloth_box_tree_free(cloth_box_tree *tree)
{
  free(tree->order);
  free(tree->leaf);
  free(tree->node);
  *tree = (cloth_box_tree){0};
}

// ---- walking -----------------------------------------------------------------------------------

cloth_box_walk cloth_box_walk_start(const cloth_box_tree *tree, const cloth_box *box)
{
  cloth_box_walk w;
  w.tree = tree, w.box = *box, w.at = w.end = 0;
  w.waiting = tree->count > 0;
  w.stack[0] = w.level[0] = 0;
  return w;
}

int cloth_box_walk_next(cloth_box_walk *w)
{
  const cloth_box_tree *t = w->tree;
  for (;;) {
    for (; w->at < w->end; w->at++)
      if (cloth_box_overlap(&w->box, &t->leaf[w->at])) return t->order[w->at++];
    if (w->waiting == 0) return -1;
    int i = w->stack[--w->waiting], level = w->level[w->waiting];
    if (!cloth_box_overlap(&w->box, &t->node[((int64_t)1 << level) - 1 + i])) continue;
    if (level == t->depth) {
      w->at = range_start(t, level, i), w->end = range_start(t, level, i + (int64_t)1);
      continue;
    }
    for (int child = 1; child >= 0; child--) {
      w->stack[w->waiting] = 2 * i + child;
      w->level[w->waiting++] = level + 1;
    }
  }
}
