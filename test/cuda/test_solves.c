// The CUDA sources of the large solves, on a CPU (cuda_runtime_api.h): in any number of blocks, on
// one device and on several, they give the bits of the CPU's own solve.
#define SHEET_SIDE_MAX 257
#include "pcg_part.h"
#include "solve/sim.h"

void emulated_solve(const cloth_pcg_solve_args *args, int blocks, int sparse);
void emulated_solve_small(const cloth_pcg_solve_args *args, int blocks);
void emulated_sums(const cloth_real *partial, int chunks, int more, cloth_real *out);
void emulated_solve_parts(int parts, const cloth_pcg_part_args *args, const int *blocks);

enum { N = 21, WIDE = SHEET_SIDE_MAX };

static sheet cloth;
static solid table;

// how a sim is solved; 0 blocks: by the CPU
typedef struct how {
  const char *preconditioner, *devices;
  int blocks;
  enum { DENSE, SPARSE, SMALL } kernel;
} how;

static struct {
  how how;
  int solves, contacts;
} now;

static cloth_status solve(cloth_device *device, const cloth_pcg_solve_args *args, bool *finished,
                          cloth_error *err)
{
  (void)device, (void)err;
  now.solves++, now.contacts += cloth_pcg_contacts(args);
  *finished = now.how.kernel == SMALL;
  if (now.how.kernel == SMALL)
    emulated_solve_small(args, now.how.blocks);
  else
    emulated_solve(args, now.how.blocks, now.how.kernel == SPARSE);
  return CLOTH_OK;
}

static cloth_status solve_parts(int parts, cloth_device *const *device,
                                const cloth_pcg_part_args *args, cloth_error *err)
{
  (void)device, (void)err;
  int blocks[CLOTH_PARTS_MAX];
  for (int i = 0; i < parts; i++) blocks[i] = 1 + (now.how.blocks + i) % 3;
  now.solves++, now.contacts += args->solve.contacts;
  emulated_solve_parts(parts, args, blocks);
  return args->solve.v.scalar[CLOTH_PCG_LOST] > 0 ? CLOTH_DEVICE_LOST : CLOTH_OK;
}

static cloth_def *def_new_of(const how *h)
{
  cloth_def *def = def_new(PRECISION);
  def_set(def, "devices", h->devices);
  def_set(def, "threads", "1");
  def_set(def, "preconditioner", h->preconditioner);
  def_set(def, "pcg_iterations_max", "25"); // bits are the same long before
  return def;
}

// two layers on a table, turned against each other
static cloth_def *layers(const how *h)
{
  sheet_make(&cloth, 0.2, 0.2, N, N);
  solid_box(&table, 1, 1, 0.1);
  cloth_def *def = def_new_of(h);
  def_cloth(def, "lower", &cloth, cloth_material_default(), pose_at(0, 0, 0.003));
  def_cloth(def, "upper", &cloth, cloth_material_default(),
            pose_turned(0.01, 0.02, 0.0055, 2, 1.2));
  def_body(def, "table", &table, 0.4, pose_at(0, 0, -0.05));
  return def;
}

static uint64_t run(cloth_def *def, const how *h, int steps)
{
  static cloth_backend emulated;
  cloth_error err = {0};
  cloth_sim *sim = sim_new(def);
  uint64_t hash = 0;
  memset(&now, 0, sizeof now);
  now.how = *h;
  emulated = *sim->backend, emulated.solve = solve, emulated.solve_parts = solve_parts;
  if (h->blocks > 0) sim->backend = &emulated;
  sim_step(sim, steps);
  must(cloth_sim_hash(sim, &hash, &err), &err);
  cloth_sim_free(sim);
  cloth_def_free(def);
  return hash;
}

// ---- sentences ----------------------------------------------------------------------------------

static const char *const preconditioners[] = {"multilevel", "two_level", "block_jacobi"};

// the same hash as the CPU's with each preconditioner
static int same(const char *devices, int blocks, int kernel)
{
  for (int i = 0; i < 3; i++) {
    how cpu = {preconditioners[i], "cpu", 0, DENSE};
    how gpu = {preconditioners[i], devices, blocks, kernel};
    uint64_t hash = run(layers(&cpu), &cpu, 1);
    CHECK(run(layers(&gpu), &gpu, 1) == hash);
    CHECK(now.solves >= 1 && now.contacts > 0);
  }
  return 0;
}

static int one_device(void) { return same("cpu", 1, DENSE) + same("cpu", 3, SPARSE); }

static int a_cluster(void) { return same("cpu", 4, SMALL); }

static int several_devices(void)
{
  return same("cpu, cpu", 1, DENSE) + same("cpu, cpu, cpu", 2, DENSE);
}

// a sheet of so many vertices that chunks are added up in groups, the last of which is not whole
static cloth_def *wide(const how *h)
{
  cloth_def *def = def_new_of(h);
  sheet_make(&cloth, 2, 2, WIDE, WIDE);
  def_set(def, "pcg_iterations_max", "2");
  def_set(def, "newton_iterations_max", "1");
  def_set(def, "wind", "0.5 1 0");
  def_set(def, "air_density", "1.2");
  def_cloth(def, "sheet", &cloth, cloth_material_default(), pose_at(0, 0, 1));
  return def;
}

static int groups_of_chunks(void)
{
  static const char *const devices[] = {"cpu", "cpu, cpu"};
  int chunks = (WIDE * WIDE + CLOTH_CHUNK - 1) / CLOTH_CHUNK;
  CHECK(cloth_chunk_group(chunks) > 1 && chunks % cloth_chunk_group(chunks) > 0);
  for (int i = 0; i < 2; i++) {
    how cpu = {preconditioners[i], "cpu", 0, DENSE};
    uint64_t hash = run(wide(&cpu), &cpu, 1);
    for (int k = i; k < 2; k++) {
      how gpu = {preconditioners[i], devices[k], 2, DENSE};
      CHECK(run(wide(&gpu), &gpu, 1) == hash);
      CHECK(now.solves == 1);
    }
  }
  return 0;
}

// few, as many as are a group each, one more, some behind them
static int sums_of_launches(void)
{
  static cloth_real partial[CLOTH_PCG_PARTIALS * 3000];
  const int chunks[] = {1, 255, 300, CLOTH_FEW_CHUNKS, CLOTH_FEW_CHUNKS + 1, 2999};
  uint32_t seed = 1;
  for (int k = 0; k < CLOTH_PCG_PARTIALS * 3000; k++) partial[k] = (cloth_real)roll_real(&seed);
  for (int i = 0; i < 6; i++) {
    int more = i % 2 && chunks[i] < 2000 ? 700 : 0;
    cloth_real sum[2];
    emulated_sums(partial, chunks[i], more, sum);
    for (int f = 0; f < 2; f++) CHECK(sum[f] == cloth_partial_sum(partial, chunks[i], more, f));
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(sums_of_launches);
  RUN(one_device);
  RUN(a_cluster);
  RUN(several_devices);
  RUN(groups_of_chunks);
  return failures > 0;
}
