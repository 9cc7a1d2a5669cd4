// cloth bench: how long a step takes. Warm up, save the state, time N steps from it, go back,
// repeat: every repeat does the same work, so what differs between repeats is the machine.
#include "scene/def.h"
#include "tool.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const tool_option options[] = {
    {"warmup", "N", "steps before the timing (default 60)"},
    {"steps", "N", "steps to time in each repeat (default 120)"},
    {"repeat", "R", "repeats (default 5)"},
    {"csv", "FILE", "write the figures there too, one row per stage"},
    {NULL, NULL, NULL},
};

// rows of the table: the whole step, the worst single step, then the stages
enum { ROW_STEP, ROW_WORST, ROW_STAGE, ROW_COUNT = ROW_STAGE + CLOTH_STAGE_COUNT, REPEATS = 100 };

typedef struct bench {
  int64_t warmup, steps, repeats;
  FILE *csv; // or NULL
} bench;

// What one scene gave. Counts are of the timed steps of one repeat; all repeats have the same.
typedef struct figures {
  double ms[ROW_COUNT][REPEATS]; // a step; mean over the steps of a repeat (ROW_WORST: the largest)
  cloth_step_report last;
  double pairs, contacts_self, contacts_body, pcg_iterations, substeps; // mean
  double pcg_residual, stretch_max;                                     // largest
  int impacts_left, unconverged, allocations;                           // sum
  uint64_t hash;                                                        // after the last step
  int differing;                                                        // repeats with another hash
  double time_step;                                                     // s
  const char *backend;                                                  // that ran it
} figures;

// ---- timing ------------------------------------------------------------------------------------

static void count(figures *f, const cloth_step_report *r, double share)
{
  f->pairs += share * r->pairs;
  f->contacts_self += share * r->contacts_self;
  f->contacts_body += share * r->contacts_body;
  f->pcg_iterations += share * r->pcg_iterations;
  f->substeps += share * r->substeps;
  f->pcg_residual = fmax(f->pcg_residual, r->pcg_residual);
  f->stretch_max = fmax(f->stretch_max, r->stretch_max);
  f->impacts_left += r->impacts_left;
  f->unconverged += r->pcg_unconverged;
  f->allocations += r->allocations;
  f->last = *r;
}

static cloth_status time_repeat(const bench *b, cloth_scene *scene, int repeat, figures *f,
                                cloth_error *err)
{
  double share = 1.0 / (double)b->steps;
  for (int64_t i = 0; i < b->steps; i++) {
    cloth_step_report r = {0};
    double before = tool_clock();
    CLOTH_TRY(cloth_step(scene, 0, &r, err));
    double ms = 1e3 * (tool_clock() - before);
    f->ms[ROW_STEP][repeat] += share * ms;
    f->ms[ROW_WORST][repeat] = fmax(f->ms[ROW_WORST][repeat], ms);
    for (int s = 0; s < CLOTH_STAGE_COUNT; s++) f->ms[ROW_STAGE + s][repeat] += share * r.ms[s];
    if (repeat == 0) count(f, &r, share);
  }
  uint64_t hash;
  CLOTH_TRY(cloth_state_hash(scene, &hash, err));
  if (repeat == 0) f->hash = hash;
  f->differing += hash != f->hash;
  return CLOTH_OK;
}

static cloth_status time_scene(const bench *b, cloth_scene *scene, figures *f, cloth_error *err)
{
  cloth_status status;
  const char *tmp = getenv("TMPDIR");
  char dir[1024], path[1040];
  snprintf(dir, sizeof dir, "%s/cloth-bench-XXXXXX", tmp && tmp[0] ? tmp : P_tmpdir);
  for (int64_t i = 0; i < b->warmup; i++) CLOTH_TRY(cloth_step(scene, 0, NULL, err));
  if (!mkdtemp(dir)) CLOTH_FAIL(err, CLOTH_IO, "cannot make %s: %s", dir, strerror(errno));
  snprintf(path, sizeof path, "%s/state", dir);
  CLOTH_TRY_GOTO(cloth_state_save(scene, path, err), status, done);
  for (int i = 0; i < b->repeats; i++) {
    CLOTH_TRY_GOTO(cloth_state_load(scene, path, err), status, done);
    CLOTH_TRY_GOTO(time_repeat(b, scene, i, f, err), status, done);
  }
done:
  remove(path);
  rmdir(dir);
  return status;
}

// ---- tables ------------------------------------------------------------------------------------

static int compare_numbers(const void *a, const void *b)
{
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

// sorts ms
static double median(double *ms, int64_t n)
{
  qsort(ms, (size_t)n, sizeof *ms, compare_numbers);
  return (ms[(n - 1) / 2] + ms[n / 2]) / 2;
}

static const char *row_name(int row)
{
  return row == ROW_STEP    ? "step"
         : row == ROW_WORST ? "step_worst"
                            : cloth_stage_name(row - ROW_STAGE);
}

static void print_csv_heading(FILE *out)
{
  fprintf(out,
          "scene,backend,precision,parts,threads,time_step_s,warmup,steps,repeats,row,median_ms,"
          "min_ms,max_ms,vertices,triangles,pairs,contacts_self,contacts_body,substeps,"
          "pcg_iterations,pcg_residual,pcg_unconverged,stretch_max,impacts_left\n");
}

static void print_csv_row(const bench *b, const cloth_def *def, const char *name, int row,
                          double middle, double least, double most, const figures *f)
{
  fprintf(b->csv, "%s,%s,%s,%d,%d,%.9g,%" PRId64 ",%" PRId64 ",%" PRId64 ",%s,%.4f,%.4f,%.4f,",
          name, f->backend, def->precision, def->device_count, def->params.threads, f->time_step,
          b->warmup, b->steps, b->repeats, row_name(row), middle, least, most);
  fprintf(b->csv, "%d,%d,%.1f,%.1f,%.1f,%.3f,%.2f,%.3g,%d,%.5f,%d\n", f->last.vertices,
          f->last.triangles, f->pairs, f->contacts_self, f->contacts_body, f->substeps,
          f->pcg_iterations, f->pcg_residual, f->unconverged, f->stretch_max, f->impacts_left);
}

static void print_figures(const bench *b, const cloth_def *def, const char *name, figures *f)
{
  printf("%s: %d vertices, %d triangles, %s, %s, parts %d, %" PRId64 " steps of %.4g s x %" PRId64
         " after %" PRId64 "\n",
         name, f->last.vertices, f->last.triangles, f->backend, def->precision, def->device_count,
         b->steps, f->time_step, b->repeats, b->warmup);
  printf("  mean of a step: %.0f pairs, %.0f + %.0f contacts (cloth + body), %.1f iterations, %.2f "
         "substeps\n",
         f->pairs, f->contacts_self, f->contacts_body, f->pcg_iterations, f->substeps);
  printf(
      "  residual %.2g, unconverged %d, worst stretch %.2f %%, impacts left %d, allocations %d\n",
      f->pcg_residual, f->unconverged, 100 * f->stretch_max, f->impacts_left, f->allocations);
  printf("  %-12s %10s %10s %10s %9s\n", "", "median ms", "min ms", "max ms", "spread");
  double step = 0;
  for (int row = 0; row < ROW_COUNT; row++) {
    double *ms = f->ms[row], middle = median(ms, b->repeats);
    double least = ms[0], most = ms[b->repeats - 1];
    if (row == ROW_STEP) step = middle;
    printf("  %-12s %10.3f %10.3f %10.3f %7.1f %%\n", row_name(row), middle, least, most,
           middle > 0 ? 100 * (most - least) / middle : 0);
    if (b->csv) print_csv_row(b, def, name, row, middle, least, most, f);
  }
  printf("  real-time factor %.2f\n", step > 0 ? 1e3 * f->time_step / step : 0);
  if (f->differing)
    printf("  NOT DETERMINISTIC: %d of %" PRId64 " repeats ended with another state hash\n",
           f->differing, b->repeats);
  printf("\n");
}

// ---- the command -------------------------------------------------------------------------------

// the scene's file name without directory and ending, as tables show it
static void name_of(const char *path, char *out, size_t size)
{
  const char *slash = strrchr(path, '/');
  snprintf(out, size, "%s", slash ? slash + 1 : path);
  char *dot = strrchr(out, '.');
  if (dot && dot != out) *dot = '\0';
}

static int bench_scene(const bench *b, const tool_arguments *args, const char *path,
                       cloth_error *err)
{
  cloth_def *def = NULL;
  cloth_scene *scene = NULL;
  int code;
  cloth_status status = tool_scene_load(args, path, &def, err);
  if (status == CLOTH_OK) status = cloth_scene_new(def, &scene, err);
  code = tool_exit_code(status);
  if (status == CLOTH_OK) {
    figures *f = calloc(1, sizeof *f);
    if (!f)
      status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for the figures");
    else
      status = time_scene(b, scene, f, err);
    code = status == CLOTH_OK && f->differing == 0 ? TOOL_DONE : TOOL_FAILED;
    if (status == CLOTH_OK) {
      char name[128];
      name_of(path, name, sizeof name);
      f->time_step = cloth_def_params(def)->time_step;
      f->backend = cloth_backend_of(scene);
      print_figures(b, def, name, f);
    }
    free(f);
  }
  cloth_scene_free(scene);
  cloth_def_free(def);
  return code;
}

static int bench_main(const tool_arguments *args, cloth_error *err)
{
  bench b = {.warmup = 60, .steps = 120, .repeats = 5};
  cloth_status status;
  char part[1024] = "";
  const char *path = tool_text(args, "csv");
  int code = TOOL_DONE;
  CLOTH_TRY_GOTO(tool_integer(args, "warmup", 0, 1000000, &b.warmup, err), status, refused);
  CLOTH_TRY_GOTO(tool_integer(args, "steps", 1, 1000000, &b.steps, err), status, refused);
  CLOTH_TRY_GOTO(tool_integer(args, "repeat", 1, REPEATS, &b.repeats, err), status, refused);
  if (path) {
    snprintf(part, sizeof part, "%s.part", path);
    b.csv = fopen(part, "w");
    if (!b.csv) {
      status = cloth_fail(err, CLOTH_IO, __FILE__, __LINE__, "--csv: cannot write %s: %s", part,
                          strerror(errno));
      goto refused;
    }
    print_csv_heading(b.csv);
  }
  for (int i = 0; i < args->operand_count && err->status == CLOTH_OK; i++) {
    int scene_code = bench_scene(&b, args, args->operand[i], err);
    if (scene_code > code) code = scene_code;
  }
  if (b.csv) {
    bool written = !ferror(b.csv);
    written = fclose(b.csv) == 0 && written;
    if (err->status != CLOTH_OK) {
      remove(part);
    } else if (!written || rename(part, path) != 0) {
      cloth_fail(err, CLOTH_IO, __FILE__, __LINE__, "cannot write %s: %s", path, strerror(errno));
      remove(part);
      code = TOOL_FAILED;
    }
  }
  return code;

refused:
  return tool_exit_code(status);
}

const tool_command tool_bench = {
    "bench",   "SCENE.yaml...", 1, 1000, true, options, "time the steps of scenes, stage by stage",
    bench_main};
