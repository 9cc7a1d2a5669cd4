// The description of a scene, on the host, in double. Filled by src/scene/*.c (YAML, OBJ, PLY,
// calls), read by the engine. Everything here is owned by the cloth_def and freed with it.
#pragma once

#include "cloth.h"

enum { CLOTH_DEVICES_MAX = 64, CLOTH_EFFECTS_MAX = 32 };

/// A mesh in the order of its file.
typedef struct cloth_mesh {
  int vertex_count, triangle_count;
  double *position; // [vertex_count x 3] m
  int *triangle;    // [triangle_count x 3]
  double *material; // [triangle_count x 3 x 2] m, or NULL
} cloth_mesh;

/// What was wrong with a mesh and was put right when it was added (parameter mesh_defects).
typedef struct cloth_mesh_repairs {
  int zero_area;    // triangles without area or with a vertex twice: dropped
  int duplicate;    // triangles that were there already: dropped
  int non_manifold; // third and further triangles on an edge: dropped
  int flipped;      // triangles wound against their neighbours: turned over
  int flattened;    // triangles without area in material space: flattened from their rest shape
  int unreferenced; // vertices that no triangle uses: dropped, so later vertices moved up
} cloth_mesh_repairs;

typedef struct cloth_group_def {
  char *name;
  int count;
  int *vertex; // [count] ascending, each once
} cloth_group_def;

/// Where something is at a time: positions interpolated linearly, rotations on the shorter arc;
/// before the first and after the last key the pose stays. Or constant velocity and spin, with an
/// oscillation sin(2 pi t / period) on top, between two times.
typedef struct cloth_motion {
  int key_count;
  double *time;     // [key_count] s, strictly ascending
  cloth_pose *pose; // [key_count]
  // used when key_count is 0
  double velocity[3], spin[3];   // m/s; rad/s about the start pose's origin
  double amplitude[3], swing[3]; // m; rad about the start pose's origin
  double period;                 // s; 0: no oscillation
  double start, end;             // s; they act in [start, end]
} cloth_motion;

/// Vertices held from the scene file: from `start` to `end`, following a body or a motion of their
/// own.
typedef struct cloth_pin_def {
  int cloth, group;
  int body;            // index, or -1
  cloth_motion motion; // used when body is -1; relative to the frame at the vertices' centroid
  double start, end;   // s; end may be INFINITY
  double stiffness, break_force;
} cloth_pin_def;

typedef struct cloth_cloth_def {
  char *name;
  cloth_mesh mesh;
  cloth_material material;
  char *material_name;
  cloth_pose pose;
  double velocity[3];
  int group_count;
  cloth_group_def *group;
  cloth_mesh_repairs repairs;
} cloth_cloth_def;

typedef struct cloth_body_def {
  char *name;
  cloth_mesh mesh; // primitives are triangulated when they are read
  bool plane; // an unbounded half-space: z <= 0 of the body frame is solid. mesh is a square of it
  cloth_shape shape; // what the mesh stands for
  double size[3];    // m, see cloth_shape
  cloth_pose pose;
  double friction;
  cloth_motion motion; // key_count 0 and velocity, spin 0: stays where it is told
  cloth_mesh_repairs repairs;
} cloth_body_def;

typedef enum cloth_effect_wish {
  CLOTH_EFFECT_AUTO,
  CLOTH_EFFECT_ON,
  CLOTH_EFFECT_OFF
} cloth_effect_wish;

struct cloth_def {
  char name[64];
  char *path; // of the scene file, for messages; NULL: made by calls
  cloth_params params;
  char backend[16];              // "auto", "cpu", "cuda", "shuffle"
  char precision[8];             // "float", "double"
  int device_count;              // parts; at least 1
  bool devices_are_cpu;          // one was named "cpu"
  bool devices_are_processes;    // "mpi": one part for each process that mpirun started
  int device[CLOTH_DEVICES_MAX]; // backend's index of each part's device
  struct {
    char name[32];
    cloth_effect_wish wish;
  } effect[CLOTH_EFFECTS_MAX]; // wishes of the file; an effect that is not listed is auto
  int effect_count;
  double duration; // s, for `cloth run`; 0: not given
  int cloth_count, body_count, pin_count;
  cloth_cloth_def *cloth;
  cloth_body_def *body;
  cloth_pin_def *pin;
};

/// Pose of a motion at a time, starting from `start` (the pose of the description).
cloth_pose cloth_motion_at(const cloth_motion *m, cloth_pose start, double time);

/// Does it move at all?
bool cloth_motion_moves(const cloth_motion *m);

// ---- for the readers in src/scene ---------------------------------------------------------------

/// Index of the cloth or body of that name, or -1.
int cloth_def_find_cloth(const cloth_def *def, const char *name);
int cloth_def_find_body(const cloth_def *def, const char *name);

/// Give the quaternion length 1. CLOTH_BAD_SCENE: not finite, or its length is not within 10 %
/// of 1.
cloth_status cloth_pose_normalise(cloth_pose *pose, cloth_error *err);

/// The arrays of a motion, not the struct; an array of groups with all that is in it.
void cloth_motion_free(cloth_motion *motion);
void cloth_groups_free(cloth_group_def *group, int count);
