// cloth: cloth for robots. This is the whole public interface of libcloth.
//
// A scene is described on the host (cloth_def: meshes, materials, bodies, parameters), then built
// (cloth_scene) and stepped. A description comes from a YAML file, from calls, or from both.
//
// Conventions. SI units; angles in radians; right-handed frames, z up in the scene frame. Arrays are
// row-major and their shape is written [rows x columns]. Vertices, triangles and groups keep the
// order of the file or call that made them. A cloth_scene may be used by one thread at a time;
// different scenes are independent. No function keeps a pointer that it was given, unless its
// comment says "borrows". Nothing prints, exits or aborts.
#pragma once

#include "params.h"
#include "report.h"
#include "status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cloth_def cloth_def;     // a description of a scene, on the host
typedef struct cloth_scene cloth_scene; // a scene that can be stepped

/// A rigid pose: position [3] m and unit quaternion (x, y, z, w).
typedef struct cloth_pose {
  double position[3];
  double rotation[4];
} cloth_pose;

/// The pose that changes nothing.
static inline cloth_pose cloth_pose_identity(void)
{
  cloth_pose p = {{0, 0, 0}, {0, 0, 0, 1}};
  return p;
}

// ---- description --------------------------------------------------------------------------------

/// A triangle mesh that a caller owns.
typedef struct cloth_mesh_view {
  int vertex_count, triangle_count;
  const double *position; // [vertex_count x 3] m, in the frame of the cloth or body
  const int *triangle;    // [triangle_count x 3] vertex indices, counter-clockwise seen from outside
  const double *material; // [triangle_count x 3 x 2] m, (warp, weft) of each corner at rest; or NULL:
                          // the flattened triangle, warp along the mesh's x axis projected onto it
} cloth_mesh_view;

/// A named set of vertices.
typedef struct cloth_group_view {
  const char *name;
  int count;
  const int *vertex; // [count]
} cloth_group_view;

/// One cloth.
typedef struct cloth_cloth_view {
  const char *name;
  cloth_mesh_view mesh;
  cloth_material material;
  cloth_pose pose;     // of the mesh in the scene frame at the start
  double velocity[3];  // m/s, scene frame, at the start
  int group_count;
  const cloth_group_view *group; // [group_count]
} cloth_cloth_view;

/// What a body's mesh stands for. The integrator mass_spring collides with these shapes and refuses
/// CLOTH_SHAPE_MESH; the others collide with the mesh (a plane's reaches 50 m).
typedef enum cloth_shape {
  CLOTH_SHAPE_MESH,     // nothing but itself
  CLOTH_SHAPE_BOX,      // size: edge lengths x, y, z
  CLOTH_SHAPE_SPHERE,   // size: radius
  CLOTH_SHAPE_CYLINDER, // size: radius, length along z
  CLOTH_SHAPE_PLANE,    // z <= 0 is solid
} cloth_shape;

/// One rigid body: it goes where it is moved to, and is never moved by cloth. A robot link, a table.
typedef struct cloth_body_view {
  const char *name;
  cloth_mesh_view mesh; // material is ignored
  cloth_pose pose;      // at the start
  double friction;      // Coulomb coefficient against cloth, in [0, 10]
  cloth_shape shape;    // centred at the origin of the body frame
  double size[3];       // m, of the shape
} cloth_body_view;

/// An empty description with default parameters. CLOTH_NO_MEMORY.
cloth_status cloth_def_new(cloth_def **out, cloth_error *err);

/// Read a scene file (YAML; doc/scene_file.md). Relative paths in it are relative to the file.
/// CLOTH_BAD_SCENE with file, line, key, value, unit and range; nothing is left behind.
cloth_status cloth_def_load(const char *path, cloth_def **out, cloth_error *err);

/// How a scene file is read, beside what stands in it.
typedef struct cloth_load_options {
  const char *variant; // nullable: names of the file's `variants:` and VARIABLE=VALUE, with commas
                       // between, applied in this order: "small,speed=4"
  const char *preset; // nullable: a name (fast, balanced, accurate, reference) or a YAML file; takes
                      // the place of the file's own `preset:`. What the scene says itself wins
  double resolution;  // factor on the cells along each side of every `grid` and `tube`; 0 or 1: as
                      // in the file. Refused where such a cloth has groups by vertex number
} cloth_load_options;

/// cloth_def_load() with options; NULL: none.
cloth_status cloth_def_load_with(const char *path, const cloth_load_options *options,
                                 cloth_def **out, cloth_error *err);

/// How long the scene file says that it runs [s]; 0: it does not.
double cloth_def_duration(const cloth_def *def);

/// "float" or "double"; borrowed.
const char *cloth_def_precision(const cloth_def *def);

/// NULL is allowed.
void cloth_def_free(cloth_def *def);

/// The parameters, to read or edit in place; cloth_scene_new() checks them.
cloth_params *cloth_def_params(cloth_def *def);

/// Set one setting from text, as a command line or a ROS parameter would: any name of params.inl, or
/// "backend" (auto, cpu, cuda, shuffle), "precision" (float, double), "devices" ("cpu,cpu,cpu": one
/// part each; "mpi": one for each process of `cloth run`), "effects.NAME" (auto, on, off). A vector
/// is "0 0 -9.81". CLOTH_BAD_ARGUMENT with the range, or with the nearest name where there is no
/// such; nothing changed on failure.
cloth_status cloth_def_set(cloth_def *def, const char *name, const char *value, cloth_error *err);

/// Add a cloth, a body; `index` (nullable) receives its index. Copies everything. Refuses meshes with
/// indices out of range, non-finite vertices, or (parameter mesh_defects) zero-area, duplicate or
/// non-manifold parts: CLOTH_BAD_SCENE with the first offender.
cloth_status cloth_def_add_cloth(cloth_def *def, const cloth_cloth_view *cloth, int *index,
                                 cloth_error *err);
cloth_status cloth_def_add_body(cloth_def *def, const cloth_body_view *body, int *index,
                                cloth_error *err);

// ---- scene --------------------------------------------------------------------------------------

/// Build a scene. Reads `def` and keeps no reference to it.
/// CLOTH_BAD_ARGUMENT: a parameter out of range; CLOTH_BAD_SCENE: nothing to simulate;
/// CLOTH_UNSUPPORTED: backend or device not there; CLOTH_NO_MEMORY.
cloth_status cloth_scene_new(const cloth_def *def, cloth_scene **out, cloth_error *err);

/// NULL is allowed.
void cloth_scene_free(cloth_scene *scene);

/// The backend that runs the scene ("cpu", "cuda", "shuffle") and why, e.g. "asked for", or what kept
/// `auto` from the GPU. Borrowed.
const char *cloth_backend_of(const cloth_scene *scene);
const char *cloth_backend_why(const cloth_scene *scene);

/// Advance by one step.
///
/// Bodies and grasps arrive at the poses given by cloth_body_move() and cloth_grasp_move() since the
/// last step; those with a motion in the scene file follow it. Blocks until the step is done.
///
/// h       length of the step [s] in [1e-5, 0.1]; 0 takes the parameter time_step
/// report  nullable; filled also when a solve did not converge or contacts remain: those are results
///
/// Positive status (CLOTH_UNSTABLE: not finite, or out of bounds, after step_halvings_max halvings;
/// CLOTH_BAD_ARGUMENT): the state is that of before the call. Negative: the scene can only be freed,
/// after cloth_positions(), cloth_velocities() and cloth_state_save() have given its last state,
/// that before the call. Where a device is lost, another's is given: of the last whole substep,
/// without what friction remembered on the lost one; with none left they fail with
/// CLOTH_DEVICE_LOST.
cloth_status cloth_step(cloth_scene *scene, double h, cloth_step_report *report, cloth_error *err);

/// What a time budget chooses (parameter time_budget, doc/budget.md), for one step.
typedef struct cloth_tuning {
  double pcg_tolerance;
  int newton_iterations; // most linear systems, in [1, 100]
  int contact_rounds;    // most, in [0, 100]
  int pcg_iterations;    // most of one system, in [1, 100000]; 0: the parameter's
  double pair_slack;     // m, in (0, 0.1]; 0: the parameter's. Changes costs, not what is held apart
} cloth_tuning;

/// Use this for the next step instead of the parameters, or of what the budget would choose. Recorded.
/// CLOTH_BAD_ARGUMENT: out of the range of the parameter; nothing changed.
cloth_status cloth_tune(cloth_scene *scene, const cloth_tuning *tuning, cloth_error *err);

/// Ask for cloth_step_report.state_hash at every step (default: off, it reads the state back).
void cloth_scene_hash_steps(cloth_scene *scene, bool on);

/// 64-bit hash of time, positions and velocities, bit for bit. Equal input gives equal hashes on
/// every run, for any number of threads and parts.
cloth_status cloth_state_hash(cloth_scene *scene, uint64_t *out, cloth_error *err);

/// Simulated time [s].
double cloth_time(const cloth_scene *scene);

// ---- what is in it ------------------------------------------------------------------------------

// Cloths and bodies are numbered from 0 in the order in which they were added. Of an index that is
// out of range names and arrays are NULL, counts 0 and poses the identity.

int cloth_count(const cloth_scene *scene);
int cloth_find(const cloth_scene *scene, const char *name); // index, or -1
const char *cloth_name(const cloth_scene *scene, int cloth);
int cloth_vertex_count(const cloth_scene *scene, int cloth);
int cloth_triangle_count(const cloth_scene *scene, int cloth);
const int *cloth_triangles(const cloth_scene *scene, int cloth);       // [triangles x 3]; borrowed
const double *cloth_rest_positions(const cloth_scene *scene, int cloth); // [vertices x 3] m; borrowed
int cloth_group_count(const cloth_scene *scene, int cloth);
cloth_group_view cloth_group(const cloth_scene *scene, int cloth, int group); // borrowed

int cloth_body_count(const cloth_scene *scene);
int cloth_body_find(const cloth_scene *scene, const char *name); // index, or -1
const char *cloth_body_name(const cloth_scene *scene, int body);
cloth_mesh_view cloth_body_mesh(const cloth_scene *scene, int body); // body frame; borrowed
cloth_pose cloth_body_pose(const cloth_scene *scene, int body);      // after the last step

/// Is an effect active, why, and what does it cost?
typedef struct cloth_effect_info {
  const char *name;
  const char *source; // publication
  bool active;
  char why[160];         // e.g. "material towel: bend_warp = 5e-05 N m"
  uint64_t memory_bytes; // device memory it holds; 0 when not active
  int64_t launches;      // kernels launched since the scene began; 0 when not active
  double ms;             // wall time of those kernels; on a GPU 0, unless `profile` is 2
} cloth_effect_info;

int cloth_effect_count(void);

/// Effect `effect` in [0, cloth_effect_count()) of a scene. CLOTH_BAD_ARGUMENT: there is no such.
cloth_status cloth_effect_describe(const cloth_scene *scene, int effect, cloth_effect_info *out,
                                   cloth_error *err);

// ---- state --------------------------------------------------------------------------------------

/// Positions [m] or velocities [m/s] of one cloth's vertices after the last step, in the scene frame.
/// out [count x 3]; count must equal cloth_vertex_count(). CLOTH_BAD_ARGUMENT, CLOTH_DEVICE_LOST.
cloth_status cloth_positions(cloth_scene *scene, int cloth, double *out, int count, cloth_error *err);
cloth_status cloth_velocities(cloth_scene *scene, int cloth, double *out, int count, cloth_error *err);

/// Which vertices are held: out [count], 0 free, 1 pinned or grasped.
cloth_status cloth_held(const cloth_scene *scene, int cloth, uint8_t *out, int count, cloth_error *err);

/// Overwrite the state of one cloth. Either pointer may be NULL to leave that part as it is; every
/// number must be finite and within the parameter bounds. CLOTH_BAD_ARGUMENT, nothing changed.
cloth_status cloth_state_set(cloth_scene *scene, int cloth, const double *position,
                             const double *velocity, int count, cloth_error *err);

/// Back to the start: time 0, initial positions, velocities and body poses; no grasps but the pins
/// of the scene file.
cloth_status cloth_reset(cloth_scene *scene, cloth_error *err);

/// Write, read the state (time, positions, velocities, bodies, grasps). The file is written beside
/// and renamed; a file that is truncated, damaged, of another mesh or of another precision is refused
/// (CLOTH_BAD_STATE) and the running state stays. A run continued from a file gives the same hashes.
/// path NULL: reads and writes nothing; the part that all processes of `devices: mpi` but the first
/// have in saving.
cloth_status cloth_state_save(cloth_scene *scene, const char *path, cloth_error *err);
cloth_status cloth_state_load(cloth_scene *scene, const char *path, cloth_error *err);

// ---- bodies and grasps --------------------------------------------------------------------------

/// Where the body is to be at the end of the next step; it gets there on a straight line and the
/// shorter rotation. Farther than the parameter teleport_distance, or more than a quarter turn, is
/// no motion: then the body is placed there when the step begins. The quaternion is normalised; its
/// length must be in (1e-3, 1e3), coordinates in [-1e6, 1e6] m. CLOTH_BAD_ARGUMENT otherwise, or if
/// there is no such body; nothing changed then.
cloth_status cloth_body_move(cloth_scene *scene, int body, const cloth_pose *pose, cloth_error *err);

/// Put the body there at once, with no sweep in between. Cloth that it lands in is worked out of it
/// over the next steps, whatever the parameter `untangle` says. Refused as cloth_body_move() is.
cloth_status cloth_body_place(cloth_scene *scene, int body, const cloth_pose *pose, cloth_error *err);

/// A hold on some vertices of a cloth. Zero is no grasp. A handle outlives what it names: using one
/// after its release fails with CLOTH_BAD_ARGUMENT instead of touching a new grasp.
typedef struct cloth_grasp_id {
  int index1;
  unsigned generation;
} cloth_grasp_id;

/// What to hold and how.
typedef struct cloth_grasp_view {
  int cloth;
  int count;
  const int *vertex;     // [count]
  int body;              // the vertices follow this body; -1: they follow `frame`
  cloth_pose frame;      // used when body is -1; moved by cloth_grasp_move()
  double stiffness;      // N/m per vertex, in [0, 1e9]; 0: rigid (exact)
  double break_force;    // N; 0: never lets go by itself
  int ignore_count;
  const int *ignore_body; // [ignore_count] bodies (finger links) whose contacts with held vertices are off
} cloth_grasp_view;

/// Hold vertices. They move rigidly with the body or frame from the next cloth_step() on.
/// out receives the grasp; {0} on failure. CLOTH_BAD_ARGUMENT: an index is out of range, a vertex is
/// held already (named), no vertices. Nothing changed on failure.
cloth_status cloth_grasp(cloth_scene *scene, const cloth_grasp_view *grasp, cloth_grasp_id *out,
                         cloth_error *err);

/// Where the frame is to be at the end of the next step (grasps with body -1). CLOTH_BAD_ARGUMENT: it
/// does not hold any more, it follows a body, or the pose is refused as in cloth_body_move().
cloth_status cloth_grasp_move(cloth_scene *scene, cloth_grasp_id id, const cloth_pose *frame,
                              cloth_error *err);

/// Let go. The vertices keep their velocity. CLOTH_BAD_ARGUMENT: it does not hold any more.
cloth_status cloth_grasp_release(cloth_scene *scene, cloth_grasp_id id, cloth_error *err);

/// Does it still hold? false after release, break or reset.
bool cloth_grasp_alive(const cloth_scene *scene, cloth_grasp_id id);

/// What the gripper exerted on the cloth in the last step: force [3] N and torque [3] N m about the
/// origin of the body or frame, in the scene frame. CLOTH_BAD_ARGUMENT: it does not hold any more.
cloth_status cloth_grasp_wrench(const cloth_scene *scene, cloth_grasp_id id, double force[3],
                                double torque[3], cloth_error *err);

// ---- looking at contact -------------------------------------------------------------------------

/// A cloth triangle and a body triangle that the broad phase holds for close.
typedef struct cloth_body_pair {
  int body, body_triangle;
  int cloth, cloth_triangle;
} cloth_body_pair;

/// The broad phase on the present state: every (body, cloth) triangle pair closer than `margin` [m],
/// in [0, 0.1], is in the answer; farther ones may be. Writes at most `capacity` pairs in ascending
/// order; *count is how many there are. Changes nothing in the simulation. Blocks.
/// CLOTH_BAD_ARGUMENT: margin out of range; CLOTH_UNSUPPORTED: integrator mass_spring.
cloth_status cloth_body_pairs(cloth_scene *scene, double margin, cloth_body_pair *out, int capacity,
                              int *count, cloth_error *err);

/// A contact of the last linear system that carries a force.
typedef struct cloth_contact_view {
  int cloth;           // of the first feature
  int body;            // of the second feature; -1: cloth
  double position[3];  // m, scene frame, the closest point of the first feature
  double normal[3];    // unit, from the second feature to the first
  double distance;     // m, when the last substep began
  double force;        // N, normal
} cloth_contact_view;

/// Contacts of the last step: writes at most `capacity`; *count is how many there are. Blocks.
/// CLOTH_NO_MEMORY, CLOTH_DEVICE_LOST.
cloth_status cloth_contacts(cloth_scene *scene, cloth_contact_view *out, int capacity, int *count,
                            cloth_error *err);

/// Two triangles that intersect, or touch.
typedef struct cloth_tangle_view {
  int cloth, triangle;
  int other_cloth; // -1: a body
  int other_body;  // -1: a cloth
  int other_triangle;
} cloth_tangle_view;

/// Every pair of triangles, cloth with cloth (also of one) and cloth with body, that intersect in the
/// present state, each once and in ascending order; what a grasp lets its fingers reach into is left
/// out. Of two triangles of one mesh that share a corner only the rest counts; neighbours across an
/// edge are not looked at. Writes at most `capacity`; *count is how many there are. Changes nothing
/// in the simulation. Blocks.
cloth_status cloth_tangles(cloth_scene *scene, cloth_tangle_view *out, int capacity, int *count,
                           cloth_error *err);

/// The bodies that left the cloth no room in the last step (report: bodies_blocking), ascending: pairs
/// still passed through at its end, and these bodies took part, or a triangle with a held corner
/// intersects them. Writes at most `capacity`; *count is how many there are.
cloth_status cloth_blocking_bodies(cloth_scene *scene, int *out, int capacity, int *count,
                                   cloth_error *err);

/// A hold: a pin of the scene, or a grasp.
typedef struct cloth_hold_view {
  int cloth;
  const char *group;    // of the pinned vertices, lives as long as the scene; NULL: a grasp
  cloth_grasp_id grasp; // zero: a pin
} cloth_hold_view;

/// The rigid holds that left the cloth no room in the last step (report: holds_blocking): as
/// cloth_blocking_bodies(), of the holds that drove vertices through bodies or through other cloth, or keep
/// them there. Of the holds there are now: ask before the next one is taken or let go.
cloth_status cloth_blocking_holds(cloth_scene *scene, cloth_hold_view *out, int capacity, int *count,
                                  cloth_error *err);

// ---- recorder -----------------------------------------------------------------------------------

/// Write every call that changes this scene, and the state hash after each step, to a text file
/// (doc/recording.md), until it is stopped. CLOTH_BAD_ARGUMENT: one is running already; CLOTH_IO.
cloth_status cloth_record_start(cloth_scene *scene, const char *path, cloth_error *err);
/// CLOTH_IO: something of it could not be written.
cloth_status cloth_record_stop(cloth_scene *scene, cloth_error *err);

/// Run a recording against a fresh scene of the same description; *steps (nullable) is how many
/// matched. CLOTH_BAD_STATE at the first step whose hash differs, naming the step; CLOTH_IO: it cannot
/// be read, or is none of this version.
cloth_status cloth_replay(cloth_scene *scene, const char *path, int64_t *steps, cloth_error *err);

#ifdef __cplusplus
}
#endif
