// The mass-spring cloth: a second model beside the implicit one, with the same scenes, bodies,
// holds, reports and state files (doc/mass_spring.md). State lives in x_t0 and v of the parts;
// x and v_next are the second buffers, and the two pairs swap at every sub-step.
#pragma once

#include "spring_block.h"
#include "status.h"

#include <stdbool.h>

enum {
  CLOTH_MASS_SPRING = 1 // a choice of the parameter `integrator`
};

typedef enum cloth_spring_kind {
  CLOTH_SPRING_STRETCH, // neighbours: sides of a lattice's cells, edges of a mesh
  CLOTH_SPRING_SHEAR,   // diagonals of a lattice's cells
  CLOTH_SPRING_BEND,    // two away on a lattice, corners across an edge of a mesh
  CLOTH_SPRING_KINDS
} cloth_spring_kind;

typedef struct cloth_spring {
  int a, b; // internal vertices
  cloth_spring_kind kind;
  double rest, stiffness, damping; // m, N/m, N s/m
} cloth_spring;

/// On the host.
typedef struct cloth_springs {
  int count, capacity, of_kind[CLOTH_SPRING_KINDS];
  cloth_spring *list;
  double *stiffness, *damping; // [n] N/m, N s/m: sums over the springs of a particle
  double radius;               // m, of a particle
  double step, limit;          // s, of a sub-step; and the largest that is stable
  int limited_by;              // vertex whose row sets the limit
  bool holds_known;            // the parts' slots are those of the present holds
  // between two searches: none of this shows in the result
  int block;                                   // sub-steps that may go well
  double mean[3], mean_change[3];              // m/s, m/s^2: how all particles moved on average
  cloth_real wind[3 * CLOTH_SPRING_BLOCK_MAX]; // m/s, of the sub-steps of a block
  cloth_real *rest_pose;                       // poses of bodies that rest, as the parts have them
  size_t rest_pose_count;
} cloth_springs;

/// On the device of a part.
typedef struct cloth_spring_part {
  uint32_t *first; // springs of the part's rows, see spring.h
  int *to;
  cloth_real *law;
  uint32_t *air_first; // triangles around the part's rows, see spring_step.h
  int *air_triangle;
  cloth_real *air_drag;
  int *shape_kind; // bodies, see shape_contact.h
  cloth_real *shape_size, *shape_friction, *shape_pose;
  int *slot; // holds
  cloth_real *aim, *impulse, *wind;
  uint64_t *bin, *bin_spare; // bins and candidates
  uint32_t *binned, *binned_spare, *bin_first;
  uint32_t *listed, *candidate, candidate_room; // see particle.h
  uint32_t *sums;                               // [CLOTH_SPRING_HEAD] see spring_block.h
  cloth_real *x_ref, *v_ref;                    // [n x 3] m, m/s at the last search
  uint32_t *touch;                              // [n x 2] contacts
  cloth_real *chunk; // [chunks x CLOTH_SPRING_FIELDS], behind the sums: one read
} cloth_spring_part;

struct cloth_sim;
struct cloth_part;

/// The springs of the scene, the radius of its particles and its step limit, before any part is
/// built. CLOTH_UNSUPPORTED: a body that is a mesh; CLOTH_BAD_ARGUMENT: spring_step above the
/// limit, or a time_step of too many sub-steps.
cloth_status cloth_springs_make(struct cloth_sim *sim, cloth_error *err);
void cloth_springs_free(cloth_springs *s);

/// How many sub-steps a step of h [s] takes. CLOTH_BAD_ARGUMENT: too many to wait for.
cloth_status cloth_spring_sub_steps(const struct cloth_sim *sim, double h, int *count,
                                    cloth_error *err);

/// Largest stable sub-step [s] for a row of the system with `held` [N/m] more stiffness.
double cloth_spring_limit(const struct cloth_sim *sim, int vertex, double held);

/// What a part holds of it.
cloth_status cloth_springs_upload(struct cloth_sim *sim, struct cloth_part *part, cloth_error *err);

/// Does a block of sub-steps that begins a step keep the state that the step began with?
bool cloth_springs_save(const struct cloth_sim *sim);

/// One step of h seconds in sub-steps. *good: all is finite and within bounds at its end.
cloth_status cloth_springs_advance(struct cloth_sim *sim, double h, bool *good, cloth_error *err);

// ---- within src/spring/ -------------------------------------------------------------------------

/// Add a spring; stiffness 0 adds none.
cloth_status cloth_spring_add(cloth_springs *s, const cloth_spring *spring, cloth_error *err);

/// Springs of all cloths (net.c).
cloth_status cloth_springs_net(struct cloth_sim *sim, cloth_error *err);

/// How far a particle may stray from the average way before candidates are searched again [m].
double cloth_spring_stray(const struct cloth_sim *sim);

typedef struct cloth_spring_verdict {
  bool room;            // all candidates found room
  bool strayed, nearly; // a particle strayed too far since the search; half as far
} cloth_spring_verdict;

/// What the counts of a search say: adds to the verdict, and makes room if there was none.
cloth_status cloth_spring_found(struct cloth_sim *sim, struct cloth_part *part,
                                const uint32_t sum[CLOTH_SPRING_HEAD],
                                cloth_spring_verdict *verdict, cloth_error *err);

/// Does the backend take whole blocks of sub-steps?
bool cloth_springs_at_once(const struct cloth_sim *sim);

/// Where a part keeps its candidates, and what makes one.
cloth_bin_search_args cloth_spring_find(const struct cloth_sim *sim, const struct cloth_part *part);

/// Candidates of a part from its present state (search.c). Queued; the number of candidates is
/// known afterwards, see cloth_spring_searched().
cloth_status cloth_spring_search(struct cloth_sim *sim, struct cloth_part *part, cloth_error *err);

/// What became of a search, read from the part.
cloth_status cloth_spring_searched(struct cloth_sim *sim, struct cloth_part *part,
                                   cloth_spring_verdict *verdict, cloth_error *err);

/// One step while it runs.
typedef struct cloth_spring_frame {
  double h, step; // s, of the whole and of a sub-step; the last one may be shorter
  int count;      // sub-steps
  int body_rows;  // bodies in each row of shape_pose; 0: they rest, and one row is for all
  int held_rows;  // held vertices in each row of aim, likewise
} cloth_spring_frame;

/// Seconds from the start of the step to that of a sub-step.
static inline double cloth_spring_time(const cloth_spring_frame *f, int sub_step)
{
  return sub_step < f->count ? sub_step * f->step : f->h;
}

/// Tell the parts which vertices are held. CLOTH_BAD_ARGUMENT: a hold is too stiff for the
/// sub-step.
cloth_status cloth_spring_holds_write(struct cloth_sim *sim, cloth_error *err);

/// Where held vertices are to be at the end of each sub-step in [begin, end); impulses become 0.
cloth_status cloth_spring_aims_write(struct cloth_sim *sim, cloth_spring_frame *f, int begin,
                                     int end, cloth_error *err);

/// Poses of all bodies at the start of the sub-steps in [begin, end], one more than there are.
cloth_status cloth_spring_poses_write(struct cloth_sim *sim, cloth_spring_frame *f, int begin,
                                      int end, cloth_error *err);

/// Add what the holds gave in a block [N s, N m s] to their wrenches, which are multiplied by the
/// second call.
cloth_status cloth_spring_impulses_add(struct cloth_sim *sim, cloth_error *err);
void cloth_spring_wrenches_scale(struct cloth_sim *sim, double factor);
