// Does candidate i touch in this substep? It does if it is closer than its thickness now, or would
// be after the predicted motion.
#pragma once

#include "atomic.h"
#include "contact_geometry.h"
#include "pair_close.h"

typedef struct cloth_contact_find_args {
  cloth_contact_scene scene;
  const uint64_t *pair; // [n]
  uint64_t *contact;    // [capacity], appended
  uint32_t capacity;
  uint64_t *close; // [close_capacity], appended: all that may come to an impact, see pair_close.h;
  uint32_t close_capacity; // NULL: not asked
  cloth_real close_reach;  // m
  uint32_t *count;         // [2] contacts, close pairs; count up, also past the capacities
} cloth_contact_find_args;

// do the features' swept boxes come within the thickness?
CLOTH_FN int cloth_pair_near(const cloth_contact_scene *s, const cloth_contact_geometry *g,
                             cloth_real gap)
{
  int split = g->type == CLOTH_VERTEX_FACE ? 1 : 2;
  cloth_box box[2];
  for (int k = 0; k < 4; k++) {
    int v = g->vertex[k];
    cloth_box b = cloth_box_swept(cloth_v3_load(s->x_t0, v), cloth_v3_load(s->x, v), 0);
    int side = k >= split;
    box[side] = k == 0 || k == split ? b : cloth_box_union(box[side], b);
  }
  return cloth_box_near(box[0], box[1], gap);
}

// Within which distance [m] swept features are looked at: free cloth falls side by side, but on
// bodies.
CLOTH_FN cloth_real cloth_contact_asked(const cloth_contact_scene *s,
                                        const cloth_contact_geometry *g)
{
  int cloth = g->vertex[0] < s->cloth_vertices && g->vertex[3] < s->cloth_vertices;
  return s->thickness + (cloth ? 0 : s->reach);
}

// as cloth_contact_motion(), to where inertia and gravity alone take the cloth
CLOTH_FN cloth_v3 cloth_contact_flight(const cloth_contact_scene *s,
                                       const cloth_contact_geometry *g)
{
  cloth_v3 u = cloth_v3_make(0, 0, 0);
  for (int k = 0; k < 4; k++) {
    int v = g->vertex[k];
    cloth_v3 end = cloth_v3_load(v < s->cloth_vertices ? s->x_pred : s->x, v);
    u = cloth_v3_add_scaled(u, g->weight[k], cloth_v3_sub(end, cloth_v3_load(s->x_t0, v)));
  }
  return u;
}

// Is it a vertex of cloth just behind the face of a body that it may leave? Then it goes out there;
// deeper inside the way is not known.
CLOTH_FN int cloth_contact_comes_out(const cloth_contact_scene *s, const cloth_contact_geometry *g)
{
  if (g->type != CLOTH_VERTEX_FACE || !s->let_body) return 0;
  if (g->vertex[0] >= s->cloth_vertices || g->vertex[1] < s->cloth_vertices) return 0;
  cloth_v3 o = cloth_v3_load(s->x_t0, g->vertex[1]);
  cloth_v3 front = cloth_v3_cross(cloth_v3_sub(cloth_v3_load(s->x_t0, g->vertex[2]), o),
                                  cloth_v3_sub(cloth_v3_load(s->x_t0, g->vertex[3]), o));
  return cloth_v3_dot(front, g->normal) < 0;
}

CLOTH_FN void cloth_contact_find(int i, const cloth_contact_find_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_contact_geometry g;
  cloth_pair pair = cloth_pair_unpack(s->format, a->pair[i]);
  if (cloth_contact_on_seam(s, pair)) return;
  int on_flat = cloth_contact_on_flat(s, pair); // no contact, but it may come to an impact
  if (on_flat && !a->close) return;
  cloth_pair_vertices(s, a->pair[i], &g);
  if (!cloth_pair_near(s, &g, cloth_contact_asked(s, &g))) return;
  cloth_contact_measure(s->x_t0, &g);
  if (a->close && cloth_pair_close(s, &g, a->close_reach)) {
    uint32_t at = cloth_atomic_next(a->count + 1);
    if (at < a->close_capacity) a->close[at] = a->pair[i];
  }
  if (on_flat || !g.proper) return;
  cloth_real ahead = g.distance + cloth_v3_dot(g.normal, cloth_contact_motion(&g, s->x_t0, s->x));
  cloth_real nearest = ahead < g.distance ? ahead : g.distance;
  // the solve may end anywhere between its first guess and free flight
  ahead = g.distance + cloth_v3_dot(g.normal, cloth_contact_flight(s, &g));
  nearest = ahead < nearest ? ahead : nearest;
  if (!(nearest < s->thickness) || cloth_contact_driven(s, &g)) return;
  if (cloth_contact_grasped(s, &g)) return;
  if (!(nearest < cloth_contact_thickness(s, &g))) return;
  if (g.type == CLOTH_VERTEX_FACE && cloth_contact_told_across(s, &g, pair.b)) return;
  uint64_t key = a->pair[i];
  if (cloth_contact_strayed(s, &g)) {
    if (!cloth_contact_comes_out(s, &g)) return;
    key = cloth_pair_pack(s->format, CLOTH_PULL_FRONT, pair.a, pair.b);
  }
  uint32_t at = cloth_atomic_next(a->count);
  if (at < a->capacity) a->contact[at] = key;
}
