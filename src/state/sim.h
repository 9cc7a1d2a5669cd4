// What the engine holds of a scene. Compiled once for float and once for double.
//
// Numbering. "Internal" vertex and triangle order is chosen at load for locality; cloths follow
// each other, then bodies follow the cloths, in one numbering, so that contact treats them alike:
// vertices [0, vertex_count) are cloth, [vertex_count, all_vertices) are bodies; edges and
// triangles likewise. Everything public keeps the order of the file (`order`).
//
// Parts. Each part owns a run of cloth vertices, cut at whole chunks (kernels/physics/chunk.h),
// holds full-length vertex vectors, and the elements and rows that its vertices need. It computes
// those itself; only vertex vectors and the chunk sums of dot products travel (solve/exchange.c).
#pragma once

#include "backend.h"
#include "box.h"
#include "ccd/blocking.h"
#include "ccd/zones.h"
#include "contact/tangle.h"
#include "flat_patch.h"
#include "hat.h"
#include "hat_share.h"
#include "pair_key.h"
#include "real.h"
#include "scene/def.h"
#include "spring/springs.h"
#include "transport.h"

typedef struct cloth_sim cloth_sim;
typedef struct cloth_bend_rest cloth_bend_rest; // effect/bend_rest.h

enum { CLOTH_EXCHANGE_HALO, CLOTH_EXCHANGE_WHOLE, CLOTH_EXCHANGE_LAUNCHES }; // parameter `exchange`

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
  uint32_t *counter; // [14] small counts that the host reads
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
  cloth_real *terms;    // [3 groups + hat groups] sums of a solve in one kernel: pcg.h
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

/// Tables of contact/flat.c: how many tiles and nodes, and where each level's nodes begin.
typedef struct cloth_flat {
  int tiles, nodes; // 0: nothing is culled
  int level_first[CLOTH_FLAT_LEVELS + 1];
  double margin; // what a search asks of a square that it calls flat
} cloth_flat;

/// When parts are cut anew (state/recut.h).
typedef struct cloth_recut {
  double waited; // steps' worth of work that parts have waited for the one with most
  double worst;  // work of that one in the last step
  bool refused;  // another cut did not fit into a device's memory: no more of it
} cloth_recut;

/// Integrator bdf2 (state/bdf2.h).
enum { CLOTH_BACKWARD_EULER = 0, CLOTH_BDF2 = 2 }; // a choice of the parameter `integrator`
typedef struct cloth_bdf2 {
  bool known, known_saved; // x_last, v_last are those of a substep that this one may build on
  bool used;               // this substep is of order 2
  double h_last, h_saved;  // s
} cloth_bdf2;

/// Of the parameter accuracy (state/control.h).
typedef struct cloth_control {
  double size;       // m, diagonal of the largest cloth's box as it lies at the start
  int parts;         // of the next step; 0: not known; belongs to the state
  double spent;      // m, estimated error of this step so far
  bool second_order; // all substeps of this step were
  int64_t missed;    // steps that were above what was asked for
} cloth_control;

/// Pairs that are watched over several substeps (contact/watch.h).
typedef struct cloth_watch {
  bool known;   // they are chosen, for ends near the straight ways from watch_x0 through watch_x1
  bool covers;  // and this substep is: no other pair touches
  double begin; // s, when they were chosen
  double h;     // s, length of that substep
  double slack; // m, how far a vertex may be from its way
  bool lasted;  // the candidates were those of an earlier substep
  int used;     // substeps
  int rest;     // substeps in which it is not tried again
} cloth_watch;

/// A rigid body, on the host.
typedef struct cloth_body {
  cloth_pose now, target;   // after the last step; at the end of this one
  cloth_pose t0, t1;        // of this substep
  bool told;                // moved by call: the motion of the scene file no longer acts
  bool near;                // its swept box meets the cloth's
  double center[3], radius; // m, bounding sphere in the body frame
  double half[3];           // m, half edges of the box around it, in the body frame
  double spread;            // factor on the mesh: above 1 for planes
  int vertex_first, vertex_count, triangle_first, triangle_count;
} cloth_body;

/// A hold on vertices, on the host.
typedef struct cloth_hold_state {
  bool alive, rigid;
  unsigned generation;
  int cloth, count, body;
  int *vertex;            // [count] internal
  double *local;          // [count x 3] m, in the frame
  cloth_pose now, target; // of the frame, when body is -1
  cloth_pose t0, t1;      // of the frame in this substep
  double stiffness, break_force;
  unsigned char *ignore; // [bodies]
  double force[3], torque[3];
  int pin;   // index of the scene file's pin, or -1
  int first; // in the held list
} cloth_hold_state;

struct cloth_sim {
  const cloth_def *def; // borrowed from the front
  cloth_params params;
  const cloth_backend *backend;
  cloth_transport *transport; // what joins the parts
  char backend_why[200];
  int part_count;
  bool joined; // the parts solve together, in each other's memory: pcg_part.h
  cloth_part part[CLOTH_DEVICES_MAX];
  cloth_recut recut;

  // numbering
  int vertex_count, all_vertices;
  int triangle_count, all_triangles;
  int edge_count, all_edges;
  int hinge_count;
  int chunks;
  int aggregates;             // of the coarse level; 0: none
  int hat_groups;             // of the levels between, entries of `partial` behind the chunks
  int *cloth_first;           // [cloths + 1] first internal vertex
  int *triangle_first;        // [cloths + 1]
  int *order;                 // [vertex_count] file order within the cloth, by internal vertex
  int *internal;              // [vertex_count] internal vertex, by cloth_first + file order
  int *triangle_order;        // [triangle_count] file order within the cloth, by internal triangle
  int *triangle;              // [all_triangles x 3]
  int *edge;                  // [all_edges x 2]
  int *edge_side;             // [all_edges x 2] triangles on it, lowest first; -1: none
  unsigned char *edge_flat;   // [all_edges] 1: between two faces of a body that lie in one plane
  unsigned char *vertex_flat; // [body vertices] 1: all edges at it are flat
  int *triangle_edge;         // [all_triangles x 3]
  int *owns;                  // [all_triangles]
  int *hinge;                 // [hinge_count x 4] the shared edge, then the corners across from it
  int *hinge_triangle;        // [hinge_count] one of its two triangles
  double *rest;               // [vertex_count x 3] m, scene frame at the start
  double *mass;               // [vertex_count] kg
  double mass_total;          // kg
  double mean_edge;           // m
  cloth_bend_rest *bend_rest; // all bending elements, while bending is active

  cloth_body *body;
  unsigned char *pin_broken; // [pins] 1: pulled off, does not come back before a reset
  int *held_index;           // [held_capacity] internal vertices held now, hold by hold
  cloth_hold_state *hold;
  int hold_count, hold_capacity, held_count, held_capacity, compliant_count;
  cloth_key_format format;
  cloth_flat flat;

  // effects: index into cloth_effects
  bool active[CLOTH_EFFECTS_MAX];
  char why[CLOTH_EFFECTS_MAX][160];
  uint64_t effect_bytes[CLOTH_EFFECTS_MAX];
  int64_t effect_launches[CLOTH_EFFECTS_MAX];
  double effect_ms[CLOTH_EFFECTS_MAX];
  int64_t launches, allocations, growths;
  int ranges; // open
  uint64_t bytes;
  int owner; // of launches and allocations that happen now

  // time
  double time, time_t0;
  int64_t step;
  double h;         // s, of this substep
  double h_whole;   // s, that it is made from in a step that is not cut
  double h_contact; // s, that the stiffness of contacts is made from
  double gamma;     // s, length of the backward Euler step that it is: h, but for bdf2
  cloth_bdf2 bdf2;
  int iteration;       // Newton iteration of this substep
  int iteration_first; // the one against whose right-hand side this one is measured
  bool astray;         // the last linear solve thought that it was done, and was not; or ran away
  double *mean_velocity,
      *acceleration;       // [cloths x 3] of the last substep, m/s and m/s^2: predict.h
  bool mean_known;         // mean_velocity is that of the state
  double speed_last;       // m/s, fastest vertex of the last substep
  double damping_h;        // s, step for which the damping numbers are set
  bool pairs_valid;        // the candidates still cover every path from x_t0 to x
  bool pairs_for_contacts; // and were searched up to the thickness, not for impacts alone
  cloth_watch watch;
  bool close_known;  // close pairs are listed, for ends of the substep near x_guess
  bool close_covers; // and x is: no other pair comes to an impact on the way to it
  cloth_real *host;  // staging, as large as any vertex vector
  size_t host_bytes;
  cloth_box cloth_box; // of all swept cloth at the last search
  cloth_zones zones;
  int impacts_left;      // of this substep
  double span;           // m, the most that all cloth spans and sweeps in this substep
  bool smooth;           // nothing touched in this substep
  double correction;     // m, largest correction of the last Newton iteration of this substep
  double error_estimate; // m, of this substep, of the worst vertex
  double error_mean;     // m, of this substep, root mean square over the cloth
  cloth_control control; // of the parameter accuracy
  double crowd;          // 1, impacts of this substep before zones, by what is crowded (substep.c)
  bool helpless; // stiffer contacts did not even halve the impacts: by the looks of it no room
  int substeps_crowded; // least substeps of the next step; belongs to the state
  cloth_tangle_list tangles;
  cloth_blocking blocking;
  cloth_springs springs; // integrator mass_spring
  cloth_step_report *report;
};

// ---- memory (state/memory.c) --------------------------------------------------------------------

/// Allocate zeroed device memory for a part, charged to sim->owner.
cloth_status cloth_take(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes, void *out,
                        cloth_error *err);

/// Make *data hold at least `bytes`; grows by half again. Contents are lost. Counted in the report.
cloth_status cloth_grow(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes,
                        void *data, cloth_error *err);

/// As cloth_grow(), but the first `kept` bytes stay.
cloth_status cloth_extend(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes,
                          size_t kept, void *data, cloth_error *err);

/// Take and fill from the host.
cloth_status cloth_upload(cloth_sim *sim, cloth_part *part, const char *name, const void *host,
                          size_t bytes, void *out, cloth_error *err);

/// cloth_real from double, staged. n numbers.
cloth_status cloth_upload_real(cloth_sim *sim, cloth_part *part, const char *name,
                               const double *host, int n, void *out, cloth_error *err);

/// Free everything that an owner holds on a part.
void cloth_drop(cloth_sim *sim, cloth_part *part, int owner);
void cloth_drop_all(cloth_sim *sim, cloth_part *part); // whoever holds it

/// Launch on a part, counted for sim->owner. n == 0 launches nothing.
cloth_status cloth_launch(cloth_sim *sim, cloth_part *part, cloth_kernel k, int n, const void *args,
                          cloth_error *err);

/// The same for a block of sub-steps, where the backend takes them at once.
cloth_status cloth_launch_spring_block(cloth_sim *sim, cloth_part *part,
                                       const cloth_spring_block_args *block, cloth_error *err);

/// Particles and springs instead of a solve (src/spring/)?
static inline bool cloth_is_mass_spring(const cloth_sim *sim)
{
  return sim->params.integrator == CLOTH_MASS_SPRING;
}

/// Positions and velocities [n x 3] that the implicit step of this substep starts from.
static inline const cloth_real *cloth_step_from(const cloth_sim *sim, const cloth_part *p)
{
  return sim->bdf2.used ? p->x_from : p->x_t0;
}
static inline const cloth_real *cloth_step_velocity(const cloth_sim *sim, const cloth_part *p)
{
  return sim->bdf2.used ? p->v_from : p->v;
}

/// Host staging of at least this many cloth_real.
cloth_status cloth_staging(cloth_sim *sim, size_t reals, cloth_error *err);

/// The host's clock [ms].
double cloth_now_ms(void);

/// A stage ran, for so many ms: into the report.
void cloth_stage_charge(cloth_sim *sim, cloth_stage stage, double ms);

/// A stage begins: the clock, and a range for profilers. cloth_stage_close() charges the time
/// since.
double cloth_stage_open(cloth_sim *sim, cloth_stage stage);
void cloth_stage_close(cloth_sim *sim, cloth_stage stage, double start);

/// Ranges for profilers, where the backend has them; all that are open end with the step.
void cloth_range_begin(cloth_sim *sim, const char *name);
void cloth_range_end(cloth_sim *sim, int left_open);

/// Rows of chunks that a part owns.
static inline int cloth_part_chunks(const cloth_part *p) { return (p->v1 - p->v0 + 63) / 64; }

/// Launch arguments are plain structs on the stack; this fills what every range kernel needs.
#define CLOTH_LAUNCH(sim, part, kernel, n, args, err)                                              \
  CLOTH_TRY(cloth_launch(sim, part, CLOTH_KERNEL_##kernel, n, args, err))

// ---- building (state/build.c, state/topology.c, solve/pattern.c)
// ---------------------------------

/// Edges of all triangles, who owns vertices and edges, hinges of the cloth. Host arrays of the
/// sim.
cloth_status cloth_topology_build(cloth_sim *sim, cloth_error *err);

/// Inverse material edge matrix and area of a cloth triangle: [5], see membrane.h.
void cloth_rest_triangle(const cloth_sim *sim, int triangle, double rest[5]);

/// Unit warp direction in the rest shape, at a cloth triangle.
void cloth_warp_direction(const cloth_sim *sim, int triangle, double warp[3]);

/// Rigidity [N m] for bending over a hinge (effect/bending.c).
double cloth_hinge_rigidity(const cloth_sim *sim, int hinge, const cloth_material *m);

/// The cloth that an internal vertex, an internal triangle belongs to.
int cloth_of_vertex(const cloth_sim *sim, int vertex);
int cloth_of_triangle(const cloth_sim *sim, int triangle);

/// The body that a triangle or a vertex of a body belongs to.
int cloth_body_of_triangle(const cloth_sim *sim, int triangle);
int cloth_body_of_vertex(const cloth_sim *sim, int vertex);

/// beta / h of this substep for the damping effect.
cloth_status cloth_damping_set(cloth_sim *sim, double h, cloth_error *err);

/// The elements of `vertex` [count x corners] that touch a part's rows, in order.
cloth_status cloth_elements_select(const cloth_part *part, int count, int corners,
                                   const int *vertex, bool coupled, cloth_elements *out,
                                   cloth_error *err);

/// Block rows of a part from its elements, and where each element goes in them.
cloth_status cloth_pattern_build(cloth_sim *sim, cloth_part *part, cloth_error *err);

// ---- stages -------------------------------------------------------------------------------------

void cloth_guess_free_fall(cloth_sim *sim); // after anything but a step changed the state
/// Parts that a step of h seconds is cut into, because of bodies (state/substeps.c).
cloth_status cloth_substeps_count(cloth_sim *sim, double h, int *out, cloth_error *err);
cloth_status cloth_predict_stage(cloth_sim *sim, double from, double to, cloth_error *err);
/// sim->cloth_box: of all cloth on its way from x_t0 to x and to x_t0 + h v.
cloth_status cloth_box_update(cloth_sim *sim, double h, cloth_error *err);
/// After a step that failed for good: which devices still answer? true: all.
bool cloth_rescue_probe(cloth_sim *sim);
/// A part whose device answers; it holds the whole cloth.
cloth_part *cloth_rescue_part(cloth_sim *sim);
/// Into the report: the largest stretch of any triangle at x_t0 (state/stretch.c).
cloth_status cloth_stretch_measure(cloth_sim *sim, cloth_error *err);
/// After x went elsewhere than predicted: the box anew, and bodies that it now meets become near.
cloth_status cloth_bodies_join(cloth_sim *sim, cloth_error *err);
cloth_status cloth_freeze_bodies(cloth_sim *sim, cloth_error *err); // all at rest where they are
cloth_status cloth_freeze_bodies_at(cloth_sim *sim, double share,
                                    cloth_error *err); // at a share of the step
cloth_status cloth_pairs_find(cloth_sim *sim, cloth_error *err);
cloth_status cloth_pairs_search(cloth_sim *sim, cloth_error *err); // now, whatever is known already
// after the solve: only pairs that come closer than `gap`, less than the thickness
cloth_status cloth_pairs_search_impacts(cloth_sim *sim, double gap, cloth_error *err);
cloth_status cloth_pairs_escaped(cloth_sim *sim, bool *escaped, cloth_error *err);
cloth_status cloth_contact_build_stage(cloth_sim *sim, cloth_error *err);
cloth_status cloth_contact_apply(cloth_sim *sim, int iteration, cloth_error *err);
cloth_status cloth_contact_totals(cloth_sim *sim, cloth_error *err);
cloth_status cloth_effects_apply(cloth_sim *sim, int iteration, cloth_error *err);
cloth_status cloth_assemble(cloth_sim *sim, cloth_error *err);
cloth_status cloth_pcg(cloth_sim *sim, double *correction, cloth_error *err);

/// After a solve: cloth that nothing holds or touches keeps its momentum, whatever residual is
/// left.
cloth_status cloth_balance(cloth_sim *sim, cloth_error *err);
cloth_status cloth_ccd_detect(cloth_sim *sim, int *impacts, cloth_error *err);
/// What was solved for is put aside, or fetched `back`.
cloth_status cloth_ccd_keep(cloth_sim *sim, bool back, cloth_error *err);
int cloth_impacts_of_cloth(const cloth_sim *sim); // of cloth with cloth, of those last found
/// What impacts have moved from where the solve put it is held where it is, until unpinned; `more`:
/// and all that was held the last time. Positions are put aside.
cloth_status cloth_ccd_pin(cloth_sim *sim, bool more, cloth_error *err);
void cloth_ccd_unpin(cloth_sim *sim);
cloth_status cloth_ccd_back_to_held(cloth_sim *sim, cloth_error *err);
cloth_status cloth_ccd_resolve(cloth_sim *sim, int *left, cloth_error *err);

// ---- parts (solve/exchange.c, solve/halo.c) -----------------------------------------------------

/// What a row of an array stands for. Parts own whole chunks, and with a coarse level whole
/// aggregates; nodes of hats they own as hat_share.h says.
typedef enum cloth_rows_of {
  CLOTH_PER_VERTEX,
  CLOTH_PER_CHUNK,
  CLOTH_PER_AGGREGATE,
  CLOTH_PER_NODE // of the hats' first level, joined parts only
} cloth_rows_of;

/// Each part sends its own rows of a vector to all others. `field` is the vector's offset in
/// cloth_part; `row` bytes each. Queued, not finished.
cloth_status cloth_exchange(cloth_sim *sim, size_t field, cloth_rows_of rows, size_t row,
                            cloth_error *err);

/// What is queued next on COMPUTE of any part starts when all parts have done what was queued
/// before.
cloth_status cloth_meet(cloth_sim *sim, cloth_error *err);

/// Vertices [cut[j], cut[j + 1]) are part j's. cut [parts + 1], written.
void cloth_cuts(const cloth_sim *sim, int *cut);

/// Who reads which rows of a part: the mesh's share, from the columns of its rows [rows + 1], and
/// what a solve by joined parts needs. Nothing where they are not joined.
cloth_status cloth_halo_build(cloth_sim *sim, cloth_part *part, const int *first, const int *col,
                              cloth_error *err);

/// The same with the contacts of this system, on all parts.
cloth_status cloth_halo_update(cloth_sim *sim, cloth_error *err);

/// Copy on one device, in order with its COMPUTE queue.
cloth_status cloth_copy_local(cloth_sim *sim, cloth_part *part, void *dst, const void *src,
                              size_t bytes, cloth_error *err);

// ---- bodies and holds (state/predict.c, state/hold.c) -------------------------------------------

cloth_pose cloth_pose_between(cloth_pose a, cloth_pose b, double share);
void cloth_pose_point(const cloth_pose *pose, const double p[3], double out[3]);
void cloth_pose_matrix(const cloth_pose *pose, cloth_real out[12]);
cloth_status cloth_pins_update(cloth_sim *sim, double time, cloth_error *err);
cloth_status cloth_holds_refresh(cloth_sim *sim, cloth_error *err); // after any hold came or went
cloth_status cloth_holds_take(cloth_sim *sim, cloth_part *part, cloth_error *err); // of a new part
cloth_status cloth_holds_aim(cloth_sim *sim, double share, cloth_error *err);
cloth_status cloth_holds_measure(cloth_sim *sim, cloth_error *err); // wrenches from the residual
/// Clears the hold's wrench; false if nothing is held. *frame: where the hold is at the substep's
/// end.
bool cloth_hold_clear_force(const cloth_sim *sim, cloth_hold_state *hold, cloth_pose *frame);
/// f [N] that the hold exerts at x [m] adds to its wrench about its frame.
void cloth_hold_add_force(cloth_hold_state *hold, const cloth_pose *frame, const double x[3],
                          const double f[3]);
cloth_pose cloth_hold_frame(const cloth_sim *sim, const cloth_hold_state *h, double share);
void cloth_holds_place(const cloth_sim *sim, double share, cloth_real *aim); // [held_count x 3] m
cloth_status cloth_holds_reserve(cloth_sim *sim, int holds, int vertices, cloth_error *err);
