// What the front may ask of a sim: the functions behind engine.h's table; they mean what cloth.h
// says.
#pragma once

#include "state/sim.h"

cloth_status cloth_sim_step(void *sim, double h, cloth_step_report *report, cloth_error *err);
void cloth_sim_tune(void *sim, const cloth_tuning *tuning);
cloth_status cloth_sim_hash(void *sim, uint64_t *out, cloth_error *err);
double cloth_sim_time(const void *sim);
cloth_status cloth_sim_positions(void *sim, int cloth, double *out, cloth_error *err);
cloth_status cloth_sim_velocities(void *sim, int cloth, double *out, cloth_error *err);
cloth_status cloth_sim_held(const void *sim, int cloth, uint8_t *out, cloth_error *err);
cloth_status cloth_sim_state_set(void *sim, int cloth, const double *position,
                                 const double *velocity, cloth_error *err);
cloth_status cloth_sim_reset(void *sim, cloth_error *err);
cloth_status cloth_sim_save(void *sim, const char *path, cloth_error *err);
cloth_status cloth_sim_load(void *sim, const char *path, cloth_error *err);
cloth_pose cloth_sim_body_pose(const void *sim, int body);
cloth_status cloth_sim_body_move(void *sim, int body, const cloth_pose *pose, cloth_error *err);
cloth_status cloth_sim_body_place(void *sim, int body, const cloth_pose *pose, cloth_error *err);
cloth_status cloth_sim_grasp(void *sim, const cloth_grasp_view *grasp, cloth_grasp_id *out,
                             cloth_error *err);
cloth_status cloth_sim_grasp_move(void *sim, cloth_grasp_id id, const cloth_pose *frame,
                                  cloth_error *err);
cloth_status cloth_sim_grasp_release(void *sim, cloth_grasp_id id, cloth_error *err);
bool cloth_sim_grasp_alive(const void *sim, cloth_grasp_id id);
cloth_status cloth_sim_grasp_wrench(const void *sim, cloth_grasp_id id, double force[3],
                                    double torque[3], cloth_error *err);
cloth_status cloth_sim_body_pairs(void *sim, double margin, cloth_body_pair *out, int capacity,
                                  int *count, cloth_error *err);
cloth_status cloth_sim_contacts(void *sim, cloth_contact_view *out, int capacity, int *count,
                                cloth_error *err);
cloth_status cloth_sim_tangles(void *sim, cloth_tangle_view *out, int capacity, int *count,
                               cloth_error *err);
cloth_status cloth_sim_blocking_bodies(void *sim, int *out, int capacity, int *count,
                                       cloth_error *err);
cloth_status cloth_sim_blocking_holds(void *sim, cloth_hold_view *out, int capacity, int *count,
                                      cloth_error *err);
int cloth_sim_effect_count(void);
cloth_status cloth_sim_effect_describe(const void *sim, int effect, cloth_effect_info *out,
                                       cloth_error *err);
