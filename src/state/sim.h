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

#include "box.h"
#include "ccd/blocking.h"
#include "contact/tangle.h"
#include "pair_key.h"
#include "scene/def.h"
#include "state/memory.h"
#include "transport.h"

typedef struct cloth_bend_rest cloth_bend_rest; // effect/bend_rest.h

enum { CLOTH_EXCHANGE_HALO, CLOTH_EXCHANGE_WHOLE, CLOTH_EXCHANGE_LAUNCHES }; // parameter `exchange`

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
  bool commanded;           // moved by call: the motion of the scene file no longer acts
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

enum { CLOTH_STRETCH_READ = 256 }; // more numbers are reduced on the device before they are read

/// Numbers that come with a read that the host waits for anyway (cloth_read_along()): a small scene
/// waits ten times a step, longer than some of its kernels run.
typedef struct cloth_along {
  bool friction; // `unsettled` is of the last solve
  bool stretch;  // `stretched` is of the end of the step
  int stretched_count;
  uint32_t unsettled;  // contacts, friction_check.h
  uint32_t impacts[2]; // ccd/ccd.c
  uint32_t totals[2];  // contacts of cloth with cloth, with bodies
  cloth_real stretched[CLOTH_STRETCH_READ];
} cloth_along;

/// What a linear solve is asked for.
typedef struct cloth_asked {
  double tolerance; // relative residual
  int iterations_max;
  bool first; // later ones are measured against this one
  bool last;  // no other follows, whatever it leaves
} cloth_asked;

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
  int iteration_last;  // the last one as far as is known
  int iteration_first; // the one against whose right-hand side this one is measured
  cloth_asked asked;   // of the linear solve that runs
  cloth_along along;
  bool solve_failed; // the last linear solve said that it had converged, and had not; or ran away
  double *mean_velocity,
      *acceleration;       // [cloths x 3] of the last substep, m/s and m/s^2: predict.h
  bool mean_known;         // mean_velocity is that of the state
  double speed_last;       // m/s, fastest vertex of the last substep
  double damping_h;        // s, step for which the damping numbers are set
  bool pairs_valid;        // the candidates still cover every path from x_t0 to x
  bool pairs_for_contacts; // and were searched up to the thickness, not for impacts alone
  double pairs_reach;      // m, cloth_contact_reach() when they were searched
  int region_lost;         // cloth_region_lost (vertex_box.h), of the search that is due
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

// ---- building (state/build.c, state/topology.c, solve/pattern.c) --------------------------------

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
/// Before the host reads of the step's end, with the first part's positions then: so that it comes
/// with that.
cloth_status cloth_stretch_look(cloth_sim *sim, const cloth_real *x, cloth_error *err);
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
// It holds no more; refresh then. Fingers that held cloth was allowed to reach into are bodies like
// others again, and it is worked out of them: else it would hang on an open gripper for ever.
void cloth_hold_end(cloth_sim *sim, cloth_hold_state *hold);
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
