// Vertex i of one rigid body: where it starts and ends the substep.
#pragma once

#include "real.h"

typedef struct cloth_body_vertex_args {
  const cloth_real *local; // [n x 3] m, body frame
  cloth_real pose_t0[12];  // rotation matrix, row-major, then translation [m]; start of the substep
  cloth_real pose_t1[12];  // end of the substep
  int first;               // row of the body's first vertex
  cloth_real *x_t0;        // [vertices x 3] m, written
  cloth_real *x;           // [vertices x 3] m, written
} cloth_body_vertex_args;

CLOTH_FN cloth_v3 cloth_pose_apply(const cloth_real pose[12], cloth_v3 p)
{
  return cloth_v3_make(pose[0] * p.x + pose[1] * p.y + pose[2] * p.z + pose[9],
                       pose[3] * p.x + pose[4] * p.y + pose[5] * p.z + pose[10],
                       pose[6] * p.x + pose[7] * p.y + pose[8] * p.z + pose[11]);
}

CLOTH_FN void cloth_body_vertex(int i, const cloth_body_vertex_args *a)
{
  cloth_v3 p = cloth_v3_load(a->local, i);
  cloth_v3_store(a->x_t0, a->first + i, cloth_pose_apply(a->pose_t0, p));
  cloth_v3_store(a->x, a->first + i, cloth_pose_apply(a->pose_t1, p));
}
