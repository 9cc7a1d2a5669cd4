// cloth run: step a scene, write meshes and reports, say how it went.
#include "output.h"
#include "scene/def.h"
#include "tangles.h"
#include "tool.h"

#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const tool_option options[] = {
    {"steps", "N", "how many steps"},
    {"seconds", "T",
     "how long to simulate, if --steps is not given; default: the scene's duration"},
    {"out", "DIR", "write report.csv (and meshes) there; it must be empty or not exist"},
    {"mesh-every", "K", "write OBJ files of cloths and bodies every K steps, and the last"},
    {"force", NULL, "replace an earlier run in --out, an earlier file of --record"},
    {"record", "FILE", "record the run (cloth replay plays it)"},
    {"hash", NULL, "state hash after every step in report.csv"},
    {"quiet", NULL, "no progress line"},
    {NULL, NULL, NULL},
};

// What the summary says about all steps together.
typedef struct totals {
  int64_t steps;
  double wall;        // s, of cloth_step() alone
  double stretch_max; // 1
  int64_t stretch_step;
  int contacts_self_max, contacts_body_max, impacts_left_max;
  int zone_largest;
  int tangles_max, tangles_last;
  tool_blocking blocking;
  int64_t teleports;
  int64_t impacts, zones, held_back, impacts_left_steps, unconverged, substeps, halvings;
} totals;

static volatile sig_atomic_t stop_signal;

static void on_signal(int signal) { stop_signal = signal; }

// the first one asks for the end of the step, the second one ends the process
static void catch_signals(void)
{
  struct sigaction action = {.sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

// ---- how long ----------------------------------------------------------------------------------

static cloth_status steps_wanted(const tool_arguments *args, cloth_def *def, int64_t *out,
                                 cloth_error *err)
{
  *out = 0;
  double seconds = def->duration;
  CLOTH_TRY(tool_integer(args, "steps", 1, INT64_C(1000000000000), out, err));
  CLOTH_TRY(tool_number(args, "seconds", "s", 1e-5, 1e7, &seconds, err));
  if (*out > 0) return CLOTH_OK;
  if (!(seconds > 0))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
               "how long? give --steps N or --seconds T; the scene has no duration");
  // a duration that is a whole number of steps up to rounding takes that number
  *out = (int64_t)ceil(seconds / cloth_def_params(def)->time_step - 1e-6);
  if (*out < 1) *out = 1;
  return CLOTH_OK;
}

// ---- progress ----------------------------------------------------------------------------------

typedef struct progress {
  bool on;
  double start, last; // s, tool_clock()
  int64_t steps;      // to do
} progress;

static void progress_show(progress *p, const totals *t, const cloth_step_report *r)
{
  double now = tool_clock();
  if (!p->on || (now - p->last < 0.1 && t->steps < p->steps)) return;
  p->last = now;
  double per_step = (now - p->start) / (double)t->steps;
  fprintf(stderr,
          "\rstep %" PRId64 "/%" PRId64 "  t %.3f s  %.1f steps/s  contacts %d  eta %.0f s\033[K",
          t->steps, p->steps, r->time, 1 / per_step, r->contacts_self + r->contacts_body,
          per_step * (double)(p->steps - t->steps));
  fflush(stderr);
}

static void progress_end(const progress *p)
{
  if (p->on) fprintf(stderr, "\r\033[K");
}

// ---- the run -----------------------------------------------------------------------------------

static void totals_add(totals *t, const cloth_step_report *r, double wall)
{
  t->steps++;
  t->wall += wall;
  if (r->stretch_max > t->stretch_max || t->steps == 1)
    t->stretch_max = r->stretch_max, t->stretch_step = r->step;
  if (r->contacts_self > t->contacts_self_max) t->contacts_self_max = r->contacts_self;
  if (r->contacts_body > t->contacts_body_max) t->contacts_body_max = r->contacts_body;
  if (r->impacts_left > t->impacts_left_max) t->impacts_left_max = r->impacts_left;
  if (r->tangles > t->tangles_max) t->tangles_max = r->tangles;
  t->tangles_last = r->tangles;
  t->teleports += r->teleports;
  t->impacts += r->impacts;
  t->zones += r->zones;
  t->held_back += r->held_back;
  if (r->zone_largest > t->zone_largest) t->zone_largest = r->zone_largest;
  t->impacts_left_steps += r->impacts_left > 0;
  t->unconverged += r->pcg_unconverged;
  t->substeps += r->substeps;
  t->halvings += r->step_halvings;
}

typedef struct run {
  cloth_scene *scene;
  tool_output *output; // NULL: nothing is written
  int64_t steps, mesh_every;
  totals totals;
  cloth_step_report last;
  progress progress;
} run;

static cloth_status run_steps(run *r, cloth_error *err)
{
  if (r->mesh_every > 0) CLOTH_TRY(tool_output_meshes(r->output, r->scene, 0, err));
  CLOTH_TRY(tool_tangles_print(r->scene, &r->totals.tangles_max, err));
  r->progress.start = tool_clock();
  for (int64_t i = 1; i <= r->steps && !stop_signal; i++) {
    cloth_step_report report = {0};
    double before = tool_clock();
    CLOTH_TRY(cloth_step(r->scene, 0, &report, err));
    totals_add(&r->totals, &report, tool_clock() - before);
    CLOTH_TRY(tool_blocking_add(&r->totals.blocking, r->scene, &report, err));
    r->last = report;
    if (r->output) CLOTH_TRY(tool_output_report(r->output, &report, err));
    bool last = i == r->steps || stop_signal;
    if (r->mesh_every > 0 && (i % r->mesh_every == 0 || last))
      CLOTH_TRY(tool_output_meshes(r->output, r->scene, i, err));
    progress_show(&r->progress, &r->totals, &report);
  }
  return CLOTH_OK;
}

static void print_budget(const cloth_step_report *r)
{
  if (!(r->budget_ms > 0)) return;
  printf("budget            %.4g ms a step: missed in %" PRId64 "; of the last steps half took at "
         "most %.3g ms, 99 %% at most %.3g ms, the longest %.3g ms\n",
         r->budget_ms, r->deadlines_missed, r->wall_p50, r->wall_p99, r->wall_worst);
  printf(
      "                  last chosen: pcg_tolerance %.2g, %d Newton iterations, %d contact rounds; "
      "not deterministic\n",
      r->chosen_pcg_tolerance, r->chosen_newton_iterations, r->chosen_contact_rounds);
}

static void print_summary(const run *r, uint64_t hash)
{
  const totals *t = &r->totals;
  double simulated = cloth_time(r->scene);
  printf("steps             %" PRId64 " (%" PRId64 " substeps, %" PRId64 " halvings)\n", t->steps,
         t->substeps, t->halvings);
  printf("simulated         %.6g s\n", simulated);
  printf("wall              %.3f s, %.3f ms a step\n", t->wall,
         t->steps ? 1e3 * t->wall / (double)t->steps : 0);
  printf("real-time factor  %.2f\n", t->wall > 0 ? simulated / t->wall : 0);
  printf("worst stretch     %.2f %% in step %" PRId64 "\n", 100 * t->stretch_max, t->stretch_step);
  printf("contacts          at most %d cloth-cloth, %d cloth-body in a step\n",
         t->contacts_self_max, t->contacts_body_max);
  printf("impacts           %" PRId64 ": in %" PRId64 " zones of at most %d vertices; %" PRId64
         " held back\n",
         t->impacts, t->zones, t->zone_largest, t->held_back);
  printf("impacts left      %d", t->impacts_left_max);
  if (t->impacts_left_steps) printf(" at most, in %" PRId64 " steps", t->impacts_left_steps);
  printf("\n");
  printf("intersecting      %d pairs of triangles at the end", t->tangles_last);
  if (t->tangles_max) printf(", %d at most", t->tangles_max);
  printf("\n");
  if (t->teleports)
    printf("teleports         %" PRId64 " bodies placed, not swept\n", t->teleports);
  tool_blocking_print(&t->blocking, r->scene);
  print_budget(&r->last);
  if (t->unconverged) printf("unconverged       %" PRId64 " linear solves\n", t->unconverged);
  printf("state hash        %016" PRIx64 "\n", hash);
}

// everything that was written is given its name, whatever happened before
static int run_end(run *r, cloth_status status)
{
  progress_end(&r->progress);
  if (r->totals.steps == 0 && status == CLOTH_OK && stop_signal) return 128 + (int)stop_signal;

  uint64_t hash = 0;
  if (status >= 0) { // a lost scene has no state to hash
    cloth_error ignored = {0};
    cloth_state_hash(r->scene, &hash, &ignored);
    print_summary(r, hash);
  }
  if (status != CLOTH_OK) return TOOL_FAILED;
  if (stop_signal) {
    fprintf(stderr, "cloth run: stopped by a signal after step %" PRId64 " of %" PRId64 "\n",
            r->totals.steps, r->steps);
    return 128 + (int)stop_signal;
  }
  return TOOL_DONE;
}

// ---- set-up ------------------------------------------------------------------------------------

static cloth_status check_usage(const tool_arguments *args, run *r, cloth_error *err)
{
  CLOTH_TRY(tool_integer(args, "mesh-every", 1, INT64_C(1000000000), &r->mesh_every, err));
  if (r->mesh_every > 0 && !tool_text(args, "out"))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--mesh-every needs --out DIR to write to");
  const char *record = tool_text(args, "record");
  if (record && !tool_has(args, "force") && access(record, F_OK) == 0)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--record %s exists; name another file, or add --force",
               record);
  return CLOTH_OK;
}

// Nothing is written before everything that can be refused has been checked.
static cloth_status run_prepare(const tool_arguments *args, run *r, cloth_error *err)
{
  cloth_status status;
  cloth_def *def = NULL;
  CLOTH_TRY(check_usage(args, r, err));
  CLOTH_TRY(tool_scene_load(args, args->operand[0], &def, err));
  CLOTH_TRY_GOTO(steps_wanted(args, def, &r->steps, err), status, done);
  CLOTH_TRY_GOTO(cloth_scene_new(def, &r->scene, err), status, done);
  cloth_scene_hash_steps(r->scene, tool_has(args, "hash"));
  const char *dir = tool_text(args, "out"), *record = tool_text(args, "record");
  if (dir)
    CLOTH_TRY_GOTO(tool_output_new(dir, tool_has(args, "force"), r->scene, &r->output, err), status,
                   done);
  if (record) CLOTH_TRY_GOTO(cloth_record_start(r->scene, record, err), status, done);
  r->progress.steps = r->steps;
  r->progress.on = isatty(STDERR_FILENO) && !tool_has(args, "quiet");
done:
  if (status != CLOTH_OK) tool_output_abandon(r->output), r->output = NULL;
  cloth_def_free(def);
  return status;
}

static int run_main(const tool_arguments *args, cloth_error *err)
{
  run r = {0};
  cloth_status status = run_prepare(args, &r, err);
  int code;
  if (status != CLOTH_OK) {
    code = tool_exit_code(status);
  } else {
    catch_signals();
    status = run_steps(&r, err);
    code = run_end(&r, status);
    if (tool_has(args, "record") && status >= 0 && cloth_record_stop(r.scene, err) != CLOTH_OK)
      code = TOOL_FAILED;
  }
  if (tool_output_close(r.output, err) != CLOTH_OK) code = TOOL_FAILED;
  cloth_scene_free(r.scene);
  tool_blocking_free(&r.totals.blocking);
  return code;
}

const tool_command tool_run = {
    "run", "SCENE.yaml", 1, 1, true, options, "step a scene; write meshes and reports", run_main};
