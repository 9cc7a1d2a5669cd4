// What one part of the cloth holds: memory on its device, and how much there is of it. Compiled
// once for float and once for double.
#pragma once

#include "backend.h"
#include "ccd/zones.h"
#include "chunk.h"
#include "contact/count_place.h"
#include "flat_patch.h"
#include "hat.h"
#include "hat_share.h"
#include "real.h"
#include "spring/springs.h"

enum { CLOTH_CORE = -1 }; // owner of memory and launches that belong to no effect

/// Which flat patches a part judges (contact/flat_part.h), and the triangles whose gradients that
/// takes. A list that is NULL stands for all, in order.
typedef struct cloth_flat_part {
  int triangles, squares, nodes[CLOTH_FLAT_LEVELS];
  int *triangle;                // [triangles]
  int *node[CLOTH_FLAT_LEVELS]; // [nodes[level]] whose ranges are made
  int *square;                  // [squares] nodes whose squares are judged
} cloth_flat_part;

/// Memory on a device that is owned by the sim and freed with it.
typedef struct cloth_block {
  void *data;
  size_t bytes;
  int owner; // effect, or CLOTH_CORE
  const char *name;
} cloth_block;

/// Elements of one kind that a part computes, and where they enter its rows.
typedef struct cloth_elements {
  int count, corners;
  int owner;                  // effect
  bool coupled;               // has off-diagonal blocks
  int *host_vertex;           // [count x corners] on the host, until the rows are built
  int *which;                 // [count] on the host, likewise: index in the list of the whole scene
  int *vertex;                // [count x corners]
  int *first, *corner, *slot; // incidence of rows, see assemble_row.h
} cloth_elements;

/// What a part had to do in a step, in products of a 3x3 block with a vector (state/recut.h).
typedef struct cloth_work {
  double rows, contacts, pairs;
} cloth_work;

/// What one part holds. Device memory, except the counts.
typedef struct cloth_part {
  cloth_device *device;
  int index;
  bool lost;          // its device answers no more (state/rescue.c)
  int v0, v1;         // owned vertices
  cloth_work load;    // of this step so far, or of the last one
  cloth_block *block; // every allocation, for freeing and accounting
  int block_count, block_capacity;

  // vertices: cloth [n], or cloth and bodies [all]
  cloth_real *x_t0, *x;      // [all x 3] m, start and end of the substep
  cloth_real *v, *v_next;    // [n x 3] m/s
  cloth_real *x_pred;        // [n x 3] m
  cloth_real *x_rest;        // [n x 3] m
  cloth_real *mass;          // [n] kg
  cloth_real *mass_drag;     // [n] 1/s, or NULL
  cloth_real *free;          // [n] 1: moves, 0: held rigidly
  int *cloth_of;             // [n]
  cloth_real *body_local;    // [all - n x 3] m, body frame
  int *body_of;              // [all - n]
  cloth_real *body_friction; // [bodies]

  // integrator bdf2: the substep before, the same at the start of the step; where a substep starts
  cloth_real *x_last, *v_last, *x_last_saved, *v_last_saved; // [n x 3] m, m/s
  cloth_real *x_from, *v_from;                               // [n x 3] m, m/s

  // holds: pins and grasps; allocated when there is one
  cloth_real *target;         // [n x 3] m
  cloth_real *hold_stiffness; // [n] N/m, or NULL while no hold is compliant
  int *held;                  // [hold_capacity] vertices
  cloth_real *aim;            // [hold_capacity x 3] m
  int *grasp_of;              // [n] 0, or 1 + grasp
  unsigned char *ignore;      // [grasp_capacity x bodies]

  // elements
  cloth_elements membrane, drag, bend;
  int *membrane_material, *drag_material;            // [count]
  cloth_real *membrane_rest;                         // [count x 5]
  cloth_real *membrane_stiffness, *membrane_damping; // [cloths x 4] N/m, [cloths] beta / h
  cloth_real *membrane_force, *membrane_tangent;     // [count x 9], [count x 45]
  cloth_real *drag_coefficient, *drag_force, *drag_tangent;
  cloth_real *bend_stiffness, *bend_rest, *bend_damping, *bend_force, *bend_gradient, *bend_weight;
  cloth_real *membrane_measured;              // [cloths x 24] N/m, or NULL: no measured fabric
  cloth_real *membrane_limit;                 // [cloths x 2] 1, N/m, or NULL: no strain limit
  cloth_real *bend_direction, *bend_measured; // [bend.count x 6], [cloths x 15] N m, or NULL
  int *bend_material;                         // [bend.count], or NULL
  cloth_real *bend_constant;                  // [bend.count x 4] of quadratic bending, else NULL
  cloth_real *stretch, *stretch_largest;      // [membrane.count], [chunks, and chunks of them]

  // pairs
  int *triangle, *triangle_edge, *owns, *edge, *edge_side;
  unsigned char *edge_flat;              // of all cloth and bodies
  unsigned char *vertex_flat;            // of bodies
  cloth_real *vertex_box, *triangle_box; // [all x 6] m
  unsigned char *vertex_level;           // [all] vertex_box.h
  int *body_triangle, *body_listed;      // triangles of near bodies; on the host, as last written
  int body_listed_count;
  uint32_t *cells; // [active + 1]
  uint64_t *cell_key, *cell_key_spare;
  uint32_t *cell_triangle, *cell_triangle_spare, *work, *large;
  // ghosts, with several parts: contact/ghosts.h
  uint32_t *cell_mark; // [2^cell_mark_bits / 32] cell_mark.h; NULL with one part
  int cell_mark_bits;
  int *ghost_first, *ghost_list; // chunk_near.h
  unsigned char *ghost_near;     // [chunks of triangles]
  cloth_real *ghost_box;         // [chunks x 6] m
  uint64_t *pair;
  uint32_t *counter; // [CLOTH_COUNTS x CLOTH_COUNT_ROUNDS] what kernels count: contact/count.h
  int counter_round[CLOTH_COUNTS]; // of each place, the word in use; later ones are zero
  uint32_t cell_capacity, pair_capacity, active_capacity;
  int pair_count;
  uint64_t *close;     // of the pairs, those that may come to an impact: contact/close.h
  cloth_real *x_guess; // [n x 3] m, x when they were listed
  uint32_t close_capacity;
  int close_count;
  uint64_t *watch;                 // of the pairs, those that are watched: contact/watch.h
  cloth_real *watch_x0, *watch_x1; // [all x 3] m, x_t0 and x when they were chosen
  uint32_t watch_capacity;
  int watch_count;

  // flat patches, see flat_patch.h; allocated when a cloth is flat at rest. flat_first, flat_list:
  // of the share's nodes of level 0; flat_rest, flat_gradient: of the share's triangles
  cloth_flat_part flat_part;
  int *flat_first, *flat_list, *flat_source, *flat_extent, *flat_place, *flat_level;
  unsigned char *flat;
  cloth_real *flat_rest, *flat_height, *flat_gradient, *flat_range;

  // triangles that intersect
  uint64_t *tangle_key;
  uint32_t *tangle_how, tangle_capacity;
  int *stray; // [n] see contact_geometry.h

  // contacts
  uint64_t *contact, *contact_spare;
  uint32_t *contact_toi, *contact_toi_spare; // 0, or time of an impact
  int *contact_vertex;
  cloth_real *contact_weight, *contact_normal, *contact_distance, *contact_thickness, *contact_k,
      *contact_inertia, *contact_relief, *contact_mu, *contact_force, *contact_tangent,
      *contact_pressure, *contact_q;
  uint64_t *contact_row, *contact_row_spare;
  uint32_t *contact_entry, *contact_entry_spare, *contact_place, *contact_first;
  int *contact_slot;
  uint32_t contact_capacity;
  int contact_count;

  // friction: of the contacts, and what is kept from substep to substep (contact/friction.c)
  cloth_real *friction_elastic, *friction_trial; // [contacts x 3] m
  cloth_real *friction_bound;                    // [contacts] N
  cloth_real *friction_secant;                   // [contacts] N/m
  unsigned char *friction_state;                 // [contacts]
  uint64_t *kept, *kept_saved;                   // [kept_count] keys, now and before the step
  cloth_real *kept_slip, *kept_slip_saved;       // [kept_count x 3] m
  uint32_t friction_capacity, kept_capacity;
  int kept_count, kept_count_saved;

  uint32_t *allowed, *claim;  // [n] failsafe, see impact_limit.h
  uint32_t *carrier;          // [all vertices] see carrier.h
  uint32_t *carrier_of;       // [bodies + holds] carrier of each
  cloth_real *carrier_motion; // [carriers x 15]
  cloth_zone_part zone;
  cloth_spring_part spring; // integrator mass_spring

  // solve
  int row_slots, row_widest; // slots of all groups, of the longest row
  int *row_first, *row_col;
  cloth_real *row_val;
  cloth_real *dx, *p;           // [n x 3]
  cloth_real *b, *z;            // [n x 3], of which only the part's own are there
  cloth_real *r;                // [n x 3], of which the part's own count, and with hats its nodes'
  cloth_real *q;                // [n x 3], the part's own, with hats all
  cloth_real *inverse_diagonal; // [n x 6], likewise
  cloth_real *partial, *scalar;
  cloth_real
      *terms; // [2 x CLOTH_PCG_LANES + 3 groups + hat groups] sums of a solve in one kernel: pcg.h
  uint64_t *product_ns; // [1] time of the products, with the parameter profile
  cloth_real *slice, *factor, *inverse, *usable, *coarse_rest, *coarse; // coarse level, see pcg.h
  cloth_hats hats;                              // levels of the solver, see hat.h
  cloth_real *hat_place, *hat_block, *hat_part; // [n x 3], [n x 5 x 6], [fine x 12]
  cloth_hat_share hat_share;      // joined parts: whose nodes are whose; hat_block: own rows alone
  uint32_t *reader_mesh, *reader; // [rows of the part] of the mesh, of all: halo_contact.h; NULL
                                  // where parts are not joined
  uint32_t *chunk_reader, *halo_place, *halo_order; // [chunks of the part (+ 1)] halo_order.h
  uint32_t *halo_outer;                             // [2]
  int *flag;                                        // [CLOTH_FLAG_WORDS]
  cloth_real *commit, *largest;                     // [chunks x CLOTH_COMMIT_FIELDS], [chunks]
  cloth_real *x_saved, *v_saved; // [n x 3] own rows at the start of the whole step, for going back
  cloth_real *balance;           // [3] m, solve/balance.c
  cloth_real *box_of_chunk;      // [chunks x 6] m, and those of chunks of chunks

  cloth_event *ready, *sent;
  cloth_event *stage_begin, *stage_end;   // with the parameter `profile`
  cloth_event *launch_begin, *launch_end; // with `profile` 2
} cloth_part;

/// Rows of chunks that a part owns.
static inline int cloth_part_chunks(const cloth_part *p)
{
  return (p->v1 - p->v0 + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
}
