// Triangles that intersect: found where the state may not be free of them, and what follows for the
// step. A state that is known to be free costs nothing: from one the step leads to another.
#pragma once

#include "status.h"

#include <stdbool.h>
#include <stdint.h>

struct cloth_sim;
struct cloth_part;

/// A pair of triangles that intersect.
typedef struct cloth_tangle {
  uint64_t
      key; // pair_key.h: a the cloth triangle, b the other one, of cloth (then b > a) or a body
  uint32_t how; // triangle_cross.h
} cloth_tangle;

/// On the host.
typedef struct cloth_tangle_list {
  bool known_free; // nothing intersects; belongs to the state, as does:
  bool settling;   // a body was placed: what it intersects is worked out, whatever `untangle` says
  bool found;      // what follows is of the present state
  bool held;       // some of the triangles have a held corner
  int count, capacity;
  cloth_tangle *list; // [count] sorted by key
  uint64_t *read_key; // [capacity] staging
  uint32_t *read_how;

  int pull_count, pull_capacity;
  uint64_t *pull; // [pull_count] sorted, see tangle_pull.h
  int *mark;      // [vertices] contact_geometry.h: CLOTH_TANGLED and its like
  int *group;     // [vertices] scratch of stray.c
  int *depth;     // [vertices], by the first vertex of a group
  int *size;      // [vertices], likewise
  int *inside;    // [vertices], likewise
  int *body;      // [vertices], likewise
  int *exit;      // [vertices], likewise: 1: leaves its body as exit.c says
  int *cut;       // [edges] 1 + body, or -1 for cloth, of what pierces it; 0: nothing
} cloth_tangle_list;

/// List the intersecting triangles of the state, with the bodies at `share` of the step.
cloth_status cloth_tangles_find(struct cloth_sim *sim, double share, cloth_error *err);

/// If the state is not known to be free: find, and make ready what the step needs to know of it.
cloth_status cloth_tangles_update(struct cloth_sim *sim, double share, cloth_error *err);

/// Which vertices have strayed, as last found, to a part.
cloth_status cloth_tangles_mark(struct cloth_sim *sim, struct cloth_part *part, cloth_error *err);

/// The state was changed other than by a step that left no impacts: it may intersect.
void cloth_tangles_suspect(struct cloth_sim *sim);

/// A body was put somewhere without a sweep: what it intersects now is worked out.
void cloth_body_settle(struct cloth_sim *sim);

/// Have holds driven cloth into what it intersects, and may they keep it there? (Not so where a
/// scene begins with a pin inside a body.)
bool cloth_tangles_forced(const struct cloth_sim *sim);

/// Is what has strayed through cloth (bodies: 0), through bodies (1), worked out?
bool cloth_untangles(const struct cloth_sim *sim, int bodies);

/// From the list: which vertices have strayed and what pulls them back (stray.c).
cloth_status cloth_stray_find(struct cloth_sim *sim, cloth_error *err);

void cloth_tangles_free(cloth_tangle_list *tangles);
