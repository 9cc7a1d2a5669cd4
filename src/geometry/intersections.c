#include "geometry/intersections.h"

#include "geometry/box_tree.h"
#include "geometry/triangle_test.h"
#include "scene/list.h"

#include <limits.h>
#include <string.h>

typedef struct face {
  int mesh, triangle;
} face;

typedef struct search {
  const cloth_mesh_view *mesh;
  int count;      // triangles of all meshes
  face *face;     // [count]
  cloth_box *box; // [count]
  cloth_box_tree tree;
} search;

typedef struct pairs {
  cloth_triangle_pair *data;
  size_t count, room;
} pairs;

static cloth_corners corners_of(const search *s, int i)
{
  const cloth_mesh_view *m = &s->mesh[s->face[i].mesh];
  cloth_corners c;
  for (int k = 0; k < 3; k++) {
    c.vertex[k] = m->triangle[3 * (size_t)s->face[i].triangle + (size_t)k];
    c.x[k] = m->position + 3 * (size_t)c.vertex[k];
  }
  return c;
}

static cloth_box box_of(const cloth_corners *c)
{
  cloth_box box;
  memcpy(box.min, c->x[0], sizeof box.min);
  memcpy(box.max, c->x[0], sizeof box.max);
  for (int i = 1; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      if (c->x[i][k] < box.min[k]) box.min[k] = c->x[i][k];
      if (c->x[i][k] > box.max[k]) box.max[k] = c->x[i][k];
    }
  return box;
}

static cloth_status list_faces(search *s, int mesh_count, cloth_error *err)
{
  int64_t count = 0;
  for (int m = 0; m < mesh_count; m++) count += s->mesh[m].triangle_count;
  if (count > INT_MAX / 4)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "the meshes have %lld triangles; %d is the limit",
               (long long)count, INT_MAX / 4);
  s->face = malloc(sizeof *s->face * ((size_t)count + 1));
  s->box = malloc(sizeof *s->box * ((size_t)count + 1));
  if (!s->face || !s->box)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %lld triangles", (long long)count);
  for (int m = 0; m < mesh_count; m++)
    for (int t = 0; t < s->mesh[m].triangle_count; t++, s->count++) {
      s->face[s->count] = (face){m, t};
      cloth_corners c = corners_of(s, s->count);
      s->box[s->count] = box_of(&c);
    }
  return CLOTH_OK;
}

// pairs of triangle i with later ones; false without memory
static bool search_one(const search *s, int i, pairs *found)
{
  cloth_corners a = corners_of(s, i);
  cloth_box_walk walk = cloth_box_walk_start(&s->tree, &s->box[i]);
  for (int j; (j = cloth_box_walk_next(&walk)) >= 0;) {
    if (j <= i) continue;
    cloth_corners b = corners_of(s, j);
    face fa = s->face[i], fb = s->face[j];
    if (!cloth_triangles_intersect(&a, &b, fa.mesh == fb.mesh)) continue;
    cloth_triangle_pair *grown =
        cloth_list_grow(found->data, found->count, &found->room, sizeof *grown);
    if (!grown) return false;
    found->data = grown;
    grown[found->count++] = (cloth_triangle_pair){{fa.mesh, fb.mesh}, {fa.triangle, fb.triangle}};
  }
  return true;
}

// move what one thread found to the end of what all did
static bool append(pairs *all, pairs *one)
{
  if (one->count == 0) return true;
  cloth_triangle_pair *grown = realloc(all->data, (all->count + one->count) * sizeof *grown);
  if (!grown) return false;
  memcpy(grown + all->count, one->data, one->count * sizeof *grown);
  all->data = grown;
  all->count += one->count;
  return true;
}

static int compare_pairs(const void *a_, const void *b_)
{
  const cloth_triangle_pair *a = a_, *b = b_;
  for (int k = 0; k < 2; k++) {
    if (a->mesh[k] != b->mesh[k]) return a->mesh[k] < b->mesh[k] ? -1 : 1;
    if (a->triangle[k] != b->triangle[k]) return a->triangle[k] < b->triangle[k] ? -1 : 1;
  }
  return 0;
}

static cloth_status search_all(const search *s, pairs *all, cloth_error *err)
{
  bool memory = true;
#pragma omp parallel
  {
    pairs found = {0};
    bool mine = true;
#pragma omp for schedule(dynamic, 64)
    for (int i = 0; i < s->count; i++)
      if (mine) mine = search_one(s, i, &found);
#pragma omp critical
    memory = append(all, &found) && mine && memory;
    free(found.data);
  }
  if (!memory) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for more than %zu pairs", all->count);
  if (all->count) qsort(all->data, all->count, sizeof *all->data, compare_pairs);
  return CLOTH_OK;
}

cloth_status cloth_intersections_find(int mesh_count, const cloth_mesh_view *mesh,
                                      cloth_triangle_pair **out, int64_t *count, cloth_error *err)
{
  search s = {.mesh = mesh};
  pairs all = {0};
  *out = NULL, *count = 0;
  cloth_status status = list_faces(&s, mesh_count, err);
  if (status == CLOTH_OK) status = cloth_box_tree_make(s.box, s.count, &s.tree, err);
  if (status == CLOTH_OK) status = search_all(&s, &all, err);
  if (status == CLOTH_OK)
    *out = all.data, *count = (int64_t)all.count;
  else
    free(all.data);
  cloth_box_tree_free(&s.tree);
  free(s.face);
  free(s.box);
  return status;
}
