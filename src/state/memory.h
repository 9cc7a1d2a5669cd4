// Memory of a sim's parts and launches on them, charged to who asked for them, and the clock of its
// stages (state/memory.c).
#pragma once

#include "state/part_memory.h"

typedef struct cloth_sim cloth_sim;

/// Allocate zeroed device memory for a part, charged to sim->owner.
cloth_status cloth_take(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes, void *out,
                        cloth_error *err);

/// Make *data hold at least `bytes`; grows by half again. Contents are lost. Counted in the report.
cloth_status cloth_grow(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes,
                        void *data, cloth_error *err);

/// As cloth_grow(), by an eighth: for what is large and hardly changes.
cloth_status cloth_grow_little(cloth_sim *sim, cloth_part *part, const char *name, size_t bytes,
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

/// *out becomes the largest of n numbers of a part where that is more; NaN if any is.
cloth_status cloth_read_largest(cloth_sim *sim, cloth_part *part, const cloth_real *from, int n,
                                double *out, cloth_error *err);

/// Can numbers come with a read that the host waits for anyway? Of one part alone, and where a read
/// costs time.
bool cloth_reads_along(const cloth_sim *sim);

/// Read these with the next read of the first part, where cloth_reads_along(); until then *host
/// must live: it is in sim->along.
cloth_status cloth_read_along(cloth_sim *sim, void *host, const void *src, size_t bytes,
                              cloth_error *err);

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

/// Launch arguments are plain structs on the stack; this fills what every range kernel needs.
#define CLOTH_LAUNCH(sim, part, kernel, n, args, err)                                              \
  CLOTH_TRY(cloth_launch(sim, part, CLOTH_KERNEL_##kernel, n, args, err))
