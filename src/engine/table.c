// The one symbol that an engine library exports.
#include "engine/engine.h"
#include "state/build.h"
#include "state/state.h"

#ifdef CLOTH_SINGLE_PRECISION
#define CLOTH_ENGINE cloth_engine_f32
#define PRECISION    "float"
#else
#define CLOTH_ENGINE cloth_engine_f64
#define PRECISION    "double"
#endif

__attribute__((visibility("default"))) const cloth_engine CLOTH_ENGINE = {
    .precision = PRECISION,
    .create = cloth_sim_new,
    .destroy = cloth_sim_free,
    .backend = cloth_sim_backend,
    .backend_why = cloth_sim_backend_why,
    .step = cloth_sim_step,
    .tune = cloth_sim_tune,
    .hash = cloth_sim_hash,
    .time = cloth_sim_time,
    .positions = cloth_sim_positions,
    .velocities = cloth_sim_velocities,
    .held = cloth_sim_held,
    .state_set = cloth_sim_state_set,
    .reset = cloth_sim_reset,
    .save = cloth_sim_save,
    .load = cloth_sim_load,
    .body_pose = cloth_sim_body_pose,
    .body_move = cloth_sim_body_move,
    .body_place = cloth_sim_body_place,
    .grasp = cloth_sim_grasp,
    .grasp_move = cloth_sim_grasp_move,
    .grasp_release = cloth_sim_grasp_release,
    .grasp_alive = cloth_sim_grasp_alive,
    .grasp_wrench = cloth_sim_grasp_wrench,
    .body_pairs = cloth_sim_body_pairs,
    .contacts = cloth_sim_contacts,
    .tangles = cloth_sim_tangles,
    .blocking_bodies = cloth_sim_blocking_bodies,
    .blocking_holds = cloth_sim_blocking_holds,
    .effect_count = cloth_sim_effect_count,
    .effect_describe = cloth_sim_effect_describe,
};
