// The elastic slip that contact i starts the substep with: its own of the last substep, turned with
// its features and laid into the new tangent plane; for a cloth vertex that went on to another face
// of the same body, that of the face it left. (Other pairs that are new start with none: every part
// must find the same, and a part knows the contacts of its own vertices alone.)
#pragma once

#include "friction_law.h"

typedef struct cloth_friction_recall_args {
  cloth_contact_scene scene;
  int count;                  // contacts
  const uint64_t *contact;    // [count] sorted
  const cloth_real *normal;   // [count x 3]
  const cloth_real *distance; // [count] m
  int kept_count;
  const uint64_t *kept;        // [kept_count] sorted: contacts of the last substep
  const cloth_real *kept_slip; // [kept_count x 3] m, in the frame of the pair
  cloth_real *elastic;         // [count x 3] m, written
  unsigned char *state;        // [count] cleared
} cloth_friction_recall_args;

CLOTH_FN cloth_v3 cloth_friction_kept(const cloth_friction_recall_args *a, int at, cloth_v3 normal)
{
  cloth_pair p = cloth_pair_unpack(a->scene.format, a->kept[at]);
  cloth_friction_frame f = cloth_friction_frame_of(&a->scene, p, normal);
  cloth_v3 s = cloth_v3_make(0, 0, 0);
  for (int k = 0; k < 3; k++) s = cloth_v3_add_scaled(s, a->kept_slip[3 * at + k], f.axis[k]);
  return cloth_friction_tangential(s, normal);
}

/// The face of the same body that the vertex touched before and touches no longer, of several the
/// first; or -1. The first new face inherits it alone.
CLOTH_FN int cloth_friction_left(const cloth_friction_recall_args *a, int i, cloth_pair p)
{
  const cloth_contact_scene *s = &a->scene;
  int body = s->body_of[s->triangle[3 * p.b] - s->cloth_vertices];
  uint64_t first = cloth_pair_pack(s->format, p.type, p.a, 0),
           last = cloth_pair_pack(s->format, p.type, p.a + 1, 0);
  for (int k = i - 1; k >= 0 && a->contact[k] >= first; k--) {
    int face = cloth_pair_unpack(s->format, a->contact[k]).b, v = s->triangle[3 * face];
    if (a->contact[k] != a->contact[i] && v >= s->cloth_vertices &&
        s->body_of[v - s->cloth_vertices] == body &&
        !cloth_friction_has(a->kept, a->kept_count, a->contact[k]))
      return -1;
  }
  for (int k = cloth_friction_lower(a->kept, a->kept_count, first);
       k < a->kept_count && a->kept[k] < last; k++) {
    int face = cloth_pair_unpack(s->format, a->kept[k]).b, v = s->triangle[3 * face];
    int latest = k + 1 == a->kept_count || a->kept[k + 1] != a->kept[k];
    if (latest && v >= s->cloth_vertices && s->body_of[v - s->cloth_vertices] == body &&
        !cloth_friction_has(a->contact, a->count, a->kept[k]))
      return k;
  }
  return -1;
}

// Two layers that turn together do not slip, though the points between which slip is measured, a
// distance apart, move: how far they do when the face of a body tilts.
CLOTH_FN cloth_v3 cloth_friction_tilt(const cloth_friction_recall_args *a, int i, int face,
                                      cloth_v3 normal)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_v3 m0 = cloth_friction_face_normal(s, s->x_t0, face),
           m1 = cloth_friction_face_normal(s, s->x, face);
  cloth_real way = cloth_v3_dot(m0, normal) > 0 ? a->distance[i] : -a->distance[i];
  return cloth_friction_tangential(cloth_v3_scale(way, cloth_v3_sub(m1, m0)), normal);
}

CLOTH_FN void cloth_friction_recall(int i, const cloth_friction_recall_args *a)
{
  const cloth_contact_scene *s = &a->scene;
  cloth_pair p = cloth_pair_unpack(s->format, a->contact[i]);
  cloth_v3 n = cloth_v3_load(a->normal, i), elastic = cloth_v3_make(0, 0, 0);
  int on_body = p.type == CLOTH_VERTEX_FACE && p.a < s->cloth_vertices &&
                s->triangle[3 * p.b] >= s->cloth_vertices;
  int at = cloth_friction_lower(a->kept, a->kept_count, a->contact[i]);
  while (at + 1 < a->kept_count && a->kept[at + 1] == a->contact[i]) at++; // its latest plane
  if (!(at < a->kept_count && a->kept[at] == a->contact[i]))
    at = on_body && a->kept_count > 0 ? cloth_friction_left(a, i, p) : -1;
  if (at >= 0) elastic = cloth_friction_kept(a, at, n);
  if (on_body) elastic = cloth_v3_sub(elastic, cloth_friction_tilt(a, i, p.b, n));
  cloth_v3_store(a->elastic, i, elastic);
  a->state[i] = CLOTH_FRICTION_NONE;
}
