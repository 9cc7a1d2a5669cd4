// What stray.c and contour.c share.
#pragma once

#include "contact/tangle.h"
#include "contact_geometry.h"
#include "state/sim.h"

/// A pair of triangles that intersect, seen from one of them.
typedef struct cloth_role {
  int triangle, face; // the triangle of cloth, and what it intersects
  int body;           // of the face; -1: cloth
  int side[3];        // of its corners at the face: 1 in front, 2 behind, 0 on it
  int pierces;        // bit k: its edge k pierces the face
} cloth_role;

/// The two roles of a pair, or the one if a body is in it; returns how many.
int cloth_roles_of(const cloth_sim *sim, const cloth_tangle *tangle, cloth_role out[2]);

/// A vertex is to go through a face to its front or back: CLOTH_PULL_FRONT, CLOTH_PULL_BACK.
cloth_status cloth_pull_add(cloth_sim *sim, int type, int vertex, int face, cloth_error *err);

/// The first vertex of the group that a vertex is in.
int cloth_group_of(const cloth_sim *sim, int vertex);

/// Pulls of the groups beyond a cut of a convex body; tangles.exit tells which these are.
cloth_status cloth_exits_pull(cloth_sim *sim, cloth_error *err);

/// Marks and pulls of the pairs of cloth with cloth that no cut tells. untold: [tangles]; the cuts
/// are those of cloth; let: pull.
cloth_status cloth_contours_pull(cloth_sim *sim, const unsigned char *untold, bool let,
                                 cloth_error *err);
