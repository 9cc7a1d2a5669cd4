// Impact zones: impacts that share a moving vertex, directly or through others, are solved
// together. Grouping is done here on the host from lists of pairs (a few hundred where cloth is
// crumpled; none in most steps); what has arithmetic in it runs on the parts.
#pragma once

#include "real.h"
#include "status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cloth_sim;

/// A pair that would pass through in this substep.
typedef struct cloth_impact_pair {
  uint64_t key; // pair_key.h
  uint32_t toi; // of CLOTH_WHOLE
} cloth_impact_pair;

/// On the host. Constraints stay until the substep ends, or until their pair is found again and is
/// measured anew; zones are made anew in every round.
typedef struct cloth_zones {
  int found_count, found_capacity;
  cloth_impact_pair *found; // of the last detection, sorted by key, each pair once
  uint64_t *read_key;       // [found_capacity] staging
  uint32_t *read_toi;

  int driven_count, driven_capacity;
  uint64_t
      *driven; // pairs that pass through in this substep and in which nothing gives way, sorted

  int count, capacity;
  uint64_t *key;         // [count]
  uint32_t *toi;         // [count]
  int *vertex;           // [count x 4]
  int *by_key;           // [count] constraints in the order of their keys
  int *spare;            // [count]
  int *fresh;            // [found_count] constraints of the last detection
  int *parent;           // [count] union-find over constraints
  int *member;           // [count] constraint, zone by zone, in a zone by colour
  unsigned char *colour; // [count] by member: see zone_solve.h
  uint64_t *taken;       // [moving] colours at a vertex, scratch
  int *local;            // [count x 4] by member
  int *zone_rank;        // [count] zone of a root
  int *first;            // [zones + 1] in member

  int zones, moving_count;
  int *moving_first;    // [zones + 1] in moving
  int *moving;          // [4 count] vertices, zone by zone
  int *deal;            // [zones] zones of one part
  int *owner;           // [vertices] a constraint that moves it, or -1; later its place in `moving`
  int held_back;        // pairs that the last resolution left to the failsafe
  bool searched;        // pairs were searched anew when impacts were last looked for
  bool carried;         // the failsafe is at work: what rides on one carrier has no impact
  unsigned char *fixed; // [vertices] 1: held rigidly; all 0 outside cloth_zones_add()
} cloth_zones;

/// What a part holds of them.
typedef struct cloth_zone_part {
  uint64_t *found_key;
  uint32_t *found_toi;
  uint32_t found_capacity;
  int found_count; // of the last detection
  uint64_t *driven;
  uint32_t driven_capacity;
  uint64_t *key;
  uint32_t *toi;
  int *vertex, *fresh, *member, *local, *first, *moving_first, *moving, *deal;
  cloth_real *weight, *normal, *apart, *multiplier, *need, *move;
  cloth_real *x_solved; // [vertices x 3] m
  cloth_real *x_held;   // [vertices x 3] m, after impacts, before the solve around what they moved
  cloth_real *free;     // [vertices] part->free and what impacts have moved held; in turn with it
  unsigned char *moved; // [vertices] 1: in a zone
  unsigned char *colour;
  int capacity; // constraints
} cloth_zone_part;

/// Take zones.found in as further constraints and group all of them.
cloth_status cloth_zones_add(struct cloth_sim *sim, cloth_error *err);

/// Project every zone from the solver's end of the substep; x of every part is set.
cloth_status cloth_zones_project(struct cloth_sim *sim, double gap, cloth_error *err);

/// The four vertices of a pair of features.
void cloth_pair_corners(const struct cloth_sim *sim, uint64_t key, int v[4]);

/// Vertices of the largest zone.
int cloth_zones_largest(const cloth_zones *zones);

void cloth_zones_free(cloth_zones *zones);
