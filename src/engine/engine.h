// The two faces of the engine: one table per precision. libcloth_f32 and libcloth_f64 export their
// table and nothing else; the front (src/cloth.c) calls through it. The functions mean what cloth.h
// says.
#pragma once

#include "scene/def.h"
#include "transport.h"

typedef struct cloth_engine {
  const char *precision; // "float", "double"
  // Borrows def; transport NULL: all devices are this process's.
  cloth_status (*create)(const cloth_def *def, cloth_transport *transport, void **out,
                         cloth_error *err);
  void (*destroy)(void *sim);
  const char *(*backend)(const void *sim);
  const char *(*backend_why)(const void *sim);
  cloth_status (*step)(void *sim, double h, cloth_step_report *report, cloth_error *err);
  void (*tune)(void *sim, const cloth_tuning *tuning);
  cloth_status (*hash)(void *sim, uint64_t *out, cloth_error *err);
  double (*time)(const void *sim);
  cloth_status (*positions)(void *sim, int cloth, double *out, cloth_error *err);
  cloth_status (*velocities)(void *sim, int cloth, double *out, cloth_error *err);
  cloth_status (*held)(const void *sim, int cloth, uint8_t *out, cloth_error *err);
  cloth_status (*state_set)(void *sim, int cloth, const double *position, const double *velocity,
                            cloth_error *err);
  cloth_status (*reset)(void *sim, cloth_error *err);
  cloth_status (*save)(void *sim, const char *path, cloth_error *err);
  cloth_status (*load)(void *sim, const char *path, cloth_error *err);
  cloth_pose (*body_pose)(const void *sim, int body);
  cloth_status (*body_move)(void *sim, int body, const cloth_pose *pose, cloth_error *err);
  cloth_status (*body_place)(void *sim, int body, const cloth_pose *pose, cloth_error *err);
  cloth_status (*grasp)(void *sim, const cloth_grasp_view *grasp, cloth_grasp_id *out,
                        cloth_error *err);
  cloth_status (*grasp_move)(void *sim, cloth_grasp_id id, const cloth_pose *frame,
                             cloth_error *err);
  cloth_status (*grasp_release)(void *sim, cloth_grasp_id id, cloth_error *err);
  bool (*grasp_alive)(const void *sim, cloth_grasp_id id);
  cloth_status (*grasp_wrench)(const void *sim, cloth_grasp_id id, double force[3],
                               double torque[3], cloth_error *err);
  cloth_status (*body_pairs)(void *sim, double margin, cloth_body_pair *out, int capacity,
                             int *count, cloth_error *err);
  cloth_status (*contacts)(void *sim, cloth_contact_view *out, int capacity, int *count,
                           cloth_error *err);
  cloth_status (*tangles)(void *sim, cloth_tangle_view *out, int capacity, int *count,
                          cloth_error *err);
  cloth_status (*blocking_bodies)(void *sim, int *out, int capacity, int *count, cloth_error *err);
  cloth_status (*blocking_holds)(void *sim, cloth_hold_view *out, int capacity, int *count,
                                 cloth_error *err);
  int (*effect_count)(void);
  cloth_status (*effect_describe)(const void *sim, int effect, cloth_effect_info *out,
                                  cloth_error *err);
} cloth_engine;

extern const cloth_engine cloth_engine_f32, cloth_engine_f64;
