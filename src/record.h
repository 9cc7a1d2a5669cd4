// The recorder: every call that changes a scene, and the state hash after each step, as text
// (doc/recording.md). The front (cloth.c) calls the hooks; a recorder of NULL records nothing.
// Hooks never fail: a recording that cannot be written breaks off, and cloth_record_stop() says so.
#pragma once

#include "cloth.h"

typedef struct cloth_recorder cloth_recorder;

/// What a recording needs to know of a scene that the public interface does not tell.
typedef struct cloth_record_subject {
  cloth_scene *scene;
  const cloth_params *params;
  const char *precision; // "float", "double"
  bool fresh;            // no call has changed the scene since it was built or reset
} cloth_record_subject;

/// Start a recording. A scene that is not fresh is saved beside it, as PATH.state. CLOTH_IO,
/// CLOTH_NO_MEMORY; no file is left behind on failure.
cloth_status cloth_recorder_open(const cloth_record_subject *subject, const char *path,
                                 cloth_recorder **out, cloth_error *err);

/// End a recording and free the recorder. NULL is allowed. CLOTH_IO: it had broken off.
cloth_status cloth_recorder_close(cloth_recorder *r, cloth_error *err);

// ---- hooks Call --------------------------------------------------------------------------------
// each after the call it records has succeeded, but step_begin before the step: a recording of a
// step that crashes must hold that step.

void cloth_record_step_begin(cloth_recorder *r, double h);
void cloth_record_step_end(cloth_recorder *r, cloth_status status, uint64_t hash);
void cloth_record_tune(cloth_recorder *r, const cloth_tuning *tuning);
void cloth_record_body_move(cloth_recorder *r, int body, const cloth_pose *pose);
void cloth_record_body_place(cloth_recorder *r, int body, const cloth_pose *pose);
void cloth_record_grasp(cloth_recorder *r, const cloth_grasp_view *grasp, cloth_grasp_id id);
void cloth_record_grasp_move(cloth_recorder *r, cloth_grasp_id id, const cloth_pose *frame);
void cloth_record_grasp_release(cloth_recorder *r, cloth_grasp_id id);
void cloth_record_state_set(cloth_recorder *r, int cloth, const double *position,
                            const double *velocity, int count);
/// After cloth_state_load(): saves the loaded state as PATH.state.N beside the recording.
void cloth_record_state_load(cloth_recorder *r, cloth_scene *scene);
void cloth_record_reset(cloth_recorder *r);

// ---- replay ------------------------------------------------------------------------------------

/// cloth_replay() for a scene of which the subject is known.
/// CLOTH_BAD_STATE: the recording is of another scene, or a step differs; CLOTH_IO: it cannot be
/// read or is damaged, with file and line.
cloth_status cloth_record_replay(const cloth_record_subject *subject, const char *path,
                                 int64_t *steps, cloth_error *err);
