// The region that vertex i may visit before pairs must be searched again: from its start to where
// inertia with and without gravity takes it (cloth that rests does not fall), and a little more.
//
// A vertex that left its region has all pairs searched again. Where few did (a swinging corner of a
// towel that lies), theirs are made larger: wider by the slack for each level, and on along their
// way by it times two to the level; so are those of vertices that would leave soon, if they are few
// as well. Levels fall where a vertex has become slow, and after a crowd left.
#pragma once

#include "box.h"

enum {
  CLOTH_REGION_LEVELS = 3,
  CLOTH_REGION_STEPS = 8 // a level suits who takes so many substeps to go as far as it reaches ahead
};

/// Who asked for the search: nobody that left a region, few vertices (and few more hurry), few
/// while many hurry, or a crowd.
typedef enum cloth_region_lost {
  CLOTH_REGION_LOST_NONE,
  CLOTH_REGION_LOST_FEW,
  CLOTH_REGION_LOST_FEW_OF_MANY,
  CLOTH_REGION_LOST_MANY
} cloth_region_lost;

/// How far ahead a region of a level > 0 reaches [m].
CLOTH_FN cloth_real cloth_vertex_ahead(int level, cloth_real slack)
{
  return slack * (cloth_real)(1 << level);
}

/// Does a vertex that goes on like this, in m a substep, need a level?
CLOTH_FN int cloth_vertex_hurries(cloth_v3 way, cloth_real slack)
{
  cloth_real ahead = cloth_vertex_ahead(1, slack) / CLOTH_REGION_STEPS;
  return cloth_v3_dot(way, way) > ahead * ahead;
}

typedef struct cloth_vertex_box_args {
  int first;              // vertex of element 0
  const cloth_real *x_t0; // [vertices x 3] m, start of the substep
  const cloth_real *x;    // [vertices x 3] m, predicted end
  const cloth_real *v;    // [vertices x 3] m/s; NULL: a body's vertices, which arrive at x exactly
  cloth_real h;           // s
  cloth_real slack;       // m
  unsigned char *level;   // [vertices] in [0, CLOTH_REGION_LEVELS]; NULL: no region is larger
  int lost;               // cloth_region_lost, of those in box
  cloth_real *box;        // [vertices x 6] m, rewritten
} cloth_vertex_box_args;

CLOTH_FN int cloth_vertex_box_level(const cloth_vertex_box_args *a, int k, cloth_v3 x_t0,
                                    cloth_v3 x, cloth_real length)
{
  if (!a->level) return 0;
  int level = a->level[k];
  int few = a->lost == CLOTH_REGION_LOST_FEW || a->lost == CLOTH_REGION_LOST_FEW_OF_MANY;
  cloth_box b = cloth_box_load(a->box, k);
  if (few && !(cloth_box_holds(b, x_t0) && cloth_box_holds(b, x)))
    level = CLOTH_REGION_LEVELS;
  else if (level > 0 && (a->lost == CLOTH_REGION_LOST_MANY ||
                         cloth_vertex_ahead(level, a->slack) > CLOTH_REGION_STEPS * length))
    level--;
  if (a->lost == CLOTH_REGION_LOST_FEW && a->v)
    while (level < CLOTH_REGION_LEVELS &&
           cloth_vertex_ahead(level + 1, a->slack) <= CLOTH_REGION_STEPS * length)
      level++;
  a->level[k] = (unsigned char)level;
  return level;
}

CLOTH_FN void cloth_vertex_box(int i, const cloth_vertex_box_args *a)
{
  int k = a->first + i;
  cloth_v3 x_t0 = cloth_v3_load(a->x_t0, k), x = cloth_v3_load(a->x, k), coast = x;
  if (a->v) coast = cloth_v3_add_scaled(x_t0, a->h, cloth_v3_load(a->v, k));
  cloth_v3 way = cloth_v3_sub(coast, x_t0);
  cloth_real length = cloth_sqrt(cloth_v3_dot(way, way));
  int level = cloth_vertex_box_level(a, k, x_t0, x, length);
  cloth_real wide = a->slack * (cloth_real)(1 + level);
  if (level > 0 && length > 0)
    coast = cloth_v3_add_scaled(coast, cloth_vertex_ahead(level, a->slack) / length, way);
  cloth_box_store(
      a->box, k,
      cloth_box_union(cloth_box_swept(x_t0, x, wide), cloth_box_swept(coast, coast, wide)));
}
