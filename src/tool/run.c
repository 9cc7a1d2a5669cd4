// cloth run: step a scene, write meshes and reports, say how it went.
#include "output.h"
#include "scene/def.h"
#include "tangles.h"
#include "tool.h"

#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

static const tool_option options[] = {
    {"steps", "N", "how many steps"},
    {"seconds", "T",
     "how long to simulate, if --steps is not given; default: the scene's duration"},
    {"out", "DIR", "write report.csv (and meshes) there; it must be empty or not exist"},
    {"mesh-every", "K", "write OBJ files of cloths and bodies every K steps, and the last"},
    {"load-state", "FILE", "go on from a state that a run of the same meshes saved"},
    {"save-state", "FILE", "write the state after the last step, also of an interrupted run"},
    {"force", NULL, "replace an earlier run in --out, earlier files of --record, --save-state"},
    {"record", "FILE", "record the run (cloth replay plays it)"},
    {"hash", NULL, "state hash after every step in report.csv"},
    {"quiet", NULL, "no progress line"},
    {NULL, NULL, NULL},
};

// What the summary says about all steps together.
typedef struct totals {
  int64_t steps;
  double wall;        // s, of cloth_step() alone
  double error;       // 1, estimates of all steps added
  double stretch_max; // 1
  int64_t stretch_step;
  int contacts_self_max, contacts_body_max, impacts_left_max;
  int zone_largest;
  int tangles_max, tangles_last;
  tool_blocking blocking;
  int64_t teleports;
  int64_t impacts, zones, held_back, impacts_left_steps, unconverged, substeps, halvings;
  int substeps_max;
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
  t->error += r->accuracy_estimate * r->step_size;
  if (r->substeps > t->substeps_max) t->substeps_max = r->substeps;
}

typedef struct run {
  cloth_scene *scene;
  tool_output *output; // NULL: nothing is written
  int stop;            // signal that ends the run, or 0
  int64_t steps, mesh_every;
  double begin;    // s, scene time of the first step
  double accuracy; // asked for, 1/s
  totals totals;
  cloth_step_report last;
  progress progress;
} run;

// several processes stop together, whoever got the signal
static cloth_status look_for_signal(run *r, cloth_error *err)
{
  r->stop = (int)stop_signal;
  return tool_processes_share(&r->stop, err);
}

static cloth_status run_steps(run *r, cloth_error *err)
{
  CLOTH_TRY(look_for_signal(r, err));
  if (r->mesh_every > 0) CLOTH_TRY(tool_output_meshes(r->output, r->scene, 0, err));
  CLOTH_TRY(tool_tangles_print(r->scene, &r->totals.tangles_max, err));
  r->progress.start = tool_clock();
  r->begin = cloth_time(r->scene);
  for (int64_t i = 1; i <= r->steps && !r->stop; i++) {
    cloth_step_report report = {0};
    double before = tool_clock();
    CLOTH_TRY(cloth_step(r->scene, 0, &report, err));
    totals_add(&r->totals, &report, tool_clock() - before);
    CLOTH_TRY(tool_blocking_add(&r->totals.blocking, r->scene, &report, err));
    r->last = report;
    if (r->output) CLOTH_TRY(tool_output_report(r->output, &report, err));
    CLOTH_TRY(look_for_signal(r, err));
    bool last = i == r->steps || r->stop;
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
      "                  last chosen: pcg_tolerance %.2g, %d Newton iterations, %d contact rounds, "
      "%d solver iterations; not deterministic\n",
      r->chosen_pcg_tolerance, r->chosen_newton_iterations, r->chosen_contact_rounds,
      r->chosen_pcg_iterations);
}

static void print_accuracy(const run *r, double simulated)
{
  const totals *t = &r->totals;
  if (!(r->accuracy > 0) || !(simulated > 0)) return;
  printf(
      "accuracy          %.3g %% a second asked for: estimated %.3g %% a second, %.3g %% in all; "
      "more in %" PRId64 " steps\n",
      100 * r->accuracy, 100 * t->error / simulated, 100 * t->error, r->last.accuracy_missed);
  printf("                  chosen: at most %d substeps a step, pcg_tolerance %.2g\n",
         t->substeps_max, r->last.chosen_pcg_tolerance);
}

static void print_summary(const run *r, uint64_t hash)
{
  const totals *t = &r->totals;
  double simulated = cloth_time(r->scene) - r->begin;
  printf("steps             %" PRId64 " (%" PRId64 " substeps, %" PRId64 " halvings)\n", t->steps,
         t->substeps, t->halvings);
  printf("simulated         %.6g s\n", simulated);
  tool_processes_print();
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
  print_accuracy(r, simulated);
  if (t->unconverged) printf("unconverged       %" PRId64 " linear solves\n", t->unconverged);
  printf("state hash        %016" PRIx64 "\n", hash);
}

// everything that was written is given its name, whatever happened before
static int run_end(run *r, cloth_status status)
{
  progress_end(&r->progress);
  if (r->totals.steps == 0 && status == CLOTH_OK && r->stop) return 128 + r->stop;

  uint64_t hash = 0;
  if (status >= 0) { // a lost scene has no state to hash
    cloth_error ignored = {0};
    cloth_state_hash(r->scene, &hash, &ignored);
    print_summary(r, hash);
  }
  if (status != CLOTH_OK) return TOOL_FAILED;
  if (r->stop) {
    fprintf(stderr, "cloth run: stopped by a signal after step %" PRId64 " of %" PRId64 "\n",
            r->totals.steps, r->steps);
    return 128 + r->stop;
  }
  return TOOL_DONE;
}

// ---- set-up ------------------------------------------------------------------------------------

static cloth_status check_usage(const tool_arguments *args, run *r, cloth_error *err)
{
  CLOTH_TRY(tool_integer(args, "mesh-every", 1, INT64_C(1000000000), &r->mesh_every, err));
  if (r->mesh_every > 0 && !tool_text(args, "out"))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--mesh-every needs --out DIR to write to");
  const char *written[] = {"record", "save-state"};
  for (int i = 0; i < 2 && tool_processes_first(); i++) {
    const char *file = tool_text(args, written[i]);
    if (file && !tool_has(args, "force") && access(file, F_OK) == 0)
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--%s %s exists; name another file, or add --force",
                 written[i], file);
  }
  return CLOTH_OK;
}

// Nothing is written before everything that can be refused has been checked.
static cloth_status run_prepare(const tool_arguments *args, run *r, cloth_error *err)
{
  cloth_status status;
  cloth_def *def = NULL;
  const char *dir = tool_text(args, "out"), *record = tool_text(args, "record");
  CLOTH_TRY(tool_processes_agree(check_usage(args, r, err), err));
  CLOTH_TRY(tool_scene_load(args, args->operand[0], &def, err));
  CLOTH_TRY_GOTO(steps_wanted(args, def, &r->steps, err), status, done);
  CLOTH_TRY_GOTO(cloth_scene_new(def, &r->scene, err), status, done);
  bool first = tool_processes_first();
  r->accuracy = cloth_def_params(def)->accuracy;
  cloth_scene_hash_steps(r->scene, tool_has(args, "hash"));
  const char *from = tool_text(args, "load-state");
  if (from) CLOTH_TRY_GOTO(cloth_state_load(r->scene, from, err), status, done);
  if (dir)
    CLOTH_TRY_GOTO(
        tool_output_new(first ? dir : NULL, tool_has(args, "force"), r->scene, &r->output, err),
        status, done);
  if (record) status = cloth_record_start(r->scene, first ? record : "/dev/null", err);
  CLOTH_TRY_GOTO(tool_processes_agree(status, err), status, done);
  r->progress.steps = r->steps;
  r->progress.on = isatty(STDERR_FILENO) && !tool_has(args, "quiet");
done:
  if (status != CLOTH_OK) tool_output_abandon(r->output), r->output = NULL;
  cloth_def_free(def);
  return status;
}

// a device was lost or full: what another still holds goes into the output folder
static void save_last(const tool_arguments *args, const run *r)
{
  const char *dir = tool_text(args, "out");
  cloth_error why = {0};
  char path[4096];
  if (dir == NULL || (size_t)snprintf(path, sizeof path, "%s/last.state", dir) >= sizeof path)
    return;
  if (cloth_state_save(r->scene, path, &why) == CLOTH_OK)
    fprintf(stderr, "cloth run: the last state, at %g s, is in %s\n", cloth_time(r->scene), path);
  else
    fprintf(stderr, "cloth run: the last state cannot be saved: %s\n", why.text);
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
    if (status < 0 && tool_processes_count() == 1) save_last(args, &r);
    code = run_end(&r, status);
    if (tool_has(args, "record") && status >= 0 && cloth_record_stop(r.scene, err) != CLOTH_OK)
      code = TOOL_FAILED;
    const char *to = tool_text(args, "save-state");
    if (to && status >= 0 &&
        cloth_state_save(r.scene, tool_processes_first() ? to : NULL, err) != CLOTH_OK)
      code = TOOL_FAILED;
  }
  if (tool_output_close(r.output, err) != CLOTH_OK) code = TOOL_FAILED;
  cloth_scene_free(r.scene);
  tool_blocking_free(&r.totals.blocking);
  return code;
}

const tool_command tool_run = {
    "run", "SCENE.yaml", 1, 1, true, options, "step a scene; write meshes and reports", run_main};
