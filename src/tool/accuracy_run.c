// One run of a scene with a setting, and how far its material points are from a reference.
#include "accuracy.h"

#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { POINTS_MOST = 200, COARSEST = 4 }; // of a cloth; the largest step factor of the sweep

static volatile sig_atomic_t stop_signal;

static void on_signal(int signal) { stop_signal = signal; }

int accuracy_stop_signal(void) { return (int)stop_signal; }

// the first one asks for the end of the step, the second one ends the process
void accuracy_catch_signals(void)
{
  struct sigaction action = {.sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

// ---- the scene ---------------------------------------------------------------------------------

static cloth_status load(const accuracy_study *s, const sweep_setting *setting, cloth_def **out,
                         cloth_error *err)
{
  cloth_load_options options = {.variant = tool_text(s->args, "variant"),
                                .preset = setting->preset ? setting->preset
                                                          : tool_text(s->args, "preset")};
  CLOTH_TRY(tool_number(s->args, "resolution", "1", 0.01, 100, &options.resolution, err));
  if (setting->resolution > 0)
    options.resolution = setting->resolution * (options.resolution > 0 ? options.resolution : 1);
  CLOTH_TRY(tool_scene_load_with(s->args, s->path, &options, out, err));
  cloth_status status = CLOTH_OK;
  for (int i = 0; i < SWEEP_SETS && setting->set[i] && status == CLOTH_OK; i++) {
    char name[64];
    const char *equals = strchr(setting->set[i], '=');
    snprintf(name, sizeof name, "%.*s", (int)(equals - setting->set[i]), setting->set[i]);
    status = cloth_def_set(*out, name, equals + 1, err);
  }
  cloth_params *p = cloth_def_params(*out);
  if (setting->step > 0) p->time_step *= setting->step;
  if (status != CLOTH_OK) cloth_def_free(*out);
  return status;
}

static uint64_t hash_text(uint64_t hash, const char *text) // FNV-1a (Fowler, Noll, Vo)
{
  for (; *text; text++) hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
  return (hash ^ 0xff) * UINT64_C(0x100000001b3);
}

// what changes times, not results beyond rounding: rows of a GPU compare with references of a CPU
static bool is_of_machine(const char *option)
{
  return strcmp(option, "backend") == 0 || strcmp(option, "devices") == 0 ||
         strcmp(option, "threads") == 0;
}

// of all that makes rows incomparable: the file, what the command line changes, how long
static cloth_status make_digest(accuracy_study *s, cloth_error *err)
{
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  char text[64];
  FILE *in = fopen(s->path, "r");
  if (!in) CLOTH_FAIL(err, CLOTH_IO, "cannot read %s", s->path);
  for (int c; (c = fgetc(in)) != EOF;) hash = (hash ^ (unsigned char)c) * UINT64_C(0x100000001b3);
  fclose(in);
  for (int i = 0; i < s->args->given_count; i++) {
    const tool_given *given = &s->args->given[i];
    bool of_scene = false;
    for (const tool_option *o = tool_scene_options; o->name; o++) of_scene |= given->option == o;
    if (!of_scene || is_of_machine(given->option->name)) continue;
    hash = hash_text(hash_text(hash, given->option->name), given->value ? given->value : "");
  }
  snprintf(text, sizeof text, "%a", s->seconds);
  snprintf(s->digest, sizeof s->digest, "%016" PRIx64, hash_text(hash, text));
  return CLOTH_OK;
}

cloth_status accuracy_study_begin(const tool_arguments *args, const char *path, bool quick,
                                  accuracy_study *s, cloth_error *err)
{
  const sweep_setting standard = {.varied = "standard"};
  cloth_def *def = NULL;
  cloth_scene *scene = NULL;
  *s = (accuracy_study){.args = args, .path = path, .name = s->name};
  CLOTH_TRY(load(s, &standard, &def, err));
  double seconds = cloth_def_duration(def) > 0 ? cloth_def_duration(def) : 2;
  cloth_status status = tool_number(args, "seconds", "s", 1e-3, 1e4, &seconds, err);
  // every step of the sweep must meet the sample times
  s->time_step = cloth_def_params(def)->time_step;
  double unit = ACCURACY_SAMPLES * COARSEST * s->time_step;
  s->seconds = unit * (quick ? 1 : fmax(1, round(seconds / unit)));
  if (status == CLOTH_OK) status = make_digest(s, err);
  if (status == CLOTH_OK) status = cloth_scene_new(def, &scene, err);
  if (status == CLOTH_OK) {
    for (int c = 0; c < cloth_count(scene); c++) s->vertices += cloth_vertex_count(scene, c);
    s->size = accuracy_size(scene);
    status = accuracy_points_choose(scene, POINTS_MOST, &s->point_count, &s->place, &s->cloth, err);
  }
  cloth_scene_free(scene);
  cloth_def_free(def);
  size_t numbers = 3 * ACCURACY_SAMPLES * (size_t)s->point_count + 1;
  s->fine = calloc(numbers, sizeof *s->fine);
  s->same_mesh = calloc(numbers, sizeof *s->same_mesh);
  if (status == CLOTH_OK && (!s->fine || !s->same_mesh))
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for references");
  return status;
}

void accuracy_study_end(accuracy_study *s)
{
  free(s->place);
  free(s->cloth);
  free(s->fine);
  free(s->same_mesh);
  *s = (accuracy_study){0};
}

cloth_status accuracy_applies(const accuracy_study *s, const sweep_setting *setting, bool *out,
                              cloth_error *err)
{
  *out = !(setting->step > 0) || s->time_step * setting->step <= 0.1;
  if (!*out || !(setting->resolution > 0)) return CLOTH_OK;
  // does the resolution change anything?
  cloth_def *def = NULL;
  cloth_scene *scene = NULL;
  CLOTH_TRY(load(s, setting, &def, err));
  cloth_status status = cloth_scene_new(def, &scene, err);
  int vertices = 0;
  for (int c = 0; status == CLOTH_OK && c < cloth_count(scene); c++)
    vertices += cloth_vertex_count(scene, c);
  *out = vertices != s->vertices;
  cloth_scene_free(scene);
  cloth_def_free(def);
  return status;
}

// ---- the run -----------------------------------------------------------------------------------

static const char *contact_of(const cloth_scene *scene, const cloth_params *p)
{
  bool self = false, body = false;
  for (int i = 0; i < cloth_effect_count(); i++) {
    cloth_effect_info info;
    cloth_error ignored = {0};
    if (cloth_effect_describe(scene, i, &info, &ignored) != CLOTH_OK) continue;
    self |= info.active && strcmp(info.name, "self_contact") == 0;
    body |= info.active && strcmp(info.name, "body_contact") == 0;
  }
  if (!self && !body) return "off";
  if (!self) return "bodies only";
  return p->contact_detection ? "discrete" : "continuous";
}

static void choice_word(const cloth_params *p, const char *name, char *out, size_t size)
{
  const cloth_param_info *info = cloth_param_table();
  int index, length;
  while (info->name && strcmp(info->name, name) != 0) info++;
  if (!info->name || info->kind != CLOTH_IS_CHOICE) return;
  memcpy(&index, (const char *)p + info->offset, sizeof index);
  const char *word = cloth_param_choice(info, index, &length);
  snprintf(out, size, "%.*s", length, word);
}

static void fill_settings(const accuracy_study *s, const sweep_setting *setting, cloth_def *def,
                          accuracy_row *row)
{
  const cloth_params *p = cloth_def_params(def);
  *row = (accuracy_row){.time_step = p->time_step, .substeps = p->substeps};
  snprintf(row->scene, sizeof row->scene, "%s", s->name);
  snprintf(row->digest, sizeof row->digest, "%s", s->digest);
  snprintf(row->varied, sizeof row->varied, "%s", setting->varied);
  snprintf(row->setting, sizeof row->setting, "%s", setting->setting);
  snprintf(row->status, sizeof row->status, "ok");
  row->resolution = setting->resolution > 0 ? setting->resolution : 1;
  row->pcg_tolerance = p->pcg_tolerance;
  row->newton_iterations_max = p->newton_iterations_max;
  row->newton_tolerance = p->newton_tolerance;
  snprintf(row->precision, sizeof row->precision, "%s", cloth_def_precision(def));
  choice_word(p, "preconditioner", row->preconditioner, sizeof row->preconditioner);
  choice_word(p, "integrator", row->integrator, sizeof row->integrator);
  choice_word(p, "bending_model", row->bending_model, sizeof row->bending_model);
}

static double cpu_clock(void)
{
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fill_scene(const cloth_scene *scene, const cloth_params *p, accuracy_row *row)
{
  for (int c = 0; c < cloth_count(scene); c++) row->vertices += cloth_vertex_count(scene, c);
  snprintf(row->contact, sizeof row->contact, "%s", contact_of(scene, p));
}

static void count(accuracy_row *row, const cloth_step_report *r, double wall, double cpu)
{
  row->steps++;
  row->simulated = r->time;
  row->stretch_max = fmax(row->stretch_max, r->stretch_max);
  row->energy_kinetic = r->energy_kinetic;
  row->impacts_left += r->impacts_left;
  row->unconverged += r->pcg_unconverged;
  row->substeps_done += r->substeps;
  row->linear_systems += r->newton_iterations;
  row->pcg_iterations += r->pcg_iterations;
  row->pairs += r->pairs;
  row->contacts += r->contacts_self + r->contacts_body;
  row->launches += r->launches;
  row->ms_per_step += 1e3 * wall; // sums, so far
  row->cpu_per_second += cpu;
}

static void finish(accuracy_row *row)
{
  double seconds = row->simulated > 0 ? row->simulated : 1, steps = row->steps > 0 ? row->steps : 1;
  row->wall_per_second = 1e-3 * row->ms_per_step / seconds;
  row->cpu_per_second /= seconds;
  row->work = row->pcg_iterations * row->vertices / seconds;
  row->ms_per_step /= steps;
  row->pairs /= steps;
  row->contacts /= steps;
}

// out [point_count x 3] m
static cloth_status sample(cloth_scene *scene, const material_point *point, int points, double *out,
                           cloth_error *err)
{
  double *x = NULL;
  for (int i = 0, have = -1; i < points; i++) {
    int c = point[i].cloth, n = cloth_vertex_count(scene, c);
    if (c != have) { // points come cloth by cloth
      free(x);
      x = malloc(sizeof *x * 3 * (size_t)n);
      if (!x) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d positions", n);
      cloth_status status = cloth_positions(scene, c, x, n, err);
      if (status != CLOTH_OK) {
        free(x);
        return status;
      }
      have = c;
    }
    for (int k = 0; k < 3; k++) {
      double *at = &out[3 * (size_t)i + (size_t)k];
      *at = 0;
      for (int j = 0; j < 3; j++)
        *at += point[i].weight[j] * x[3 * (size_t)point[i].vertex[j] + (size_t)k];
    }
  }
  free(x);
  return CLOTH_OK;
}

static void show(const accuracy_study *s, const sweep_setting *setting, int64_t i, int64_t n)
{
  static double last;
  double now = tool_clock();
  if (!isatty(STDERR_FILENO) || now - last < 0.2) return;
  last = now;
  fprintf(stderr, "\r%s: %s %s  step %" PRId64 "/%" PRId64 "\033[K\r", s->name, setting->varied,
          setting->setting, i, n);
  fflush(stderr);
}

static cloth_status run_steps(const accuracy_study *s, const sweep_setting *setting, double h,
                              cloth_scene *scene, const material_point *point, double *positions,
                              accuracy_row *row, bool *stopped, cloth_error *err)
{
  int64_t n = (int64_t)llround(s->seconds / h);
  for (int64_t i = 1; i <= n; i++) {
    cloth_step_report r = {0};
    double start = tool_clock(), cpu = cpu_clock();
    CLOTH_TRY(cloth_step(scene, 0, &r, err));
    count(row, &r, tool_clock() - start, cpu_clock() - cpu);
    if (i * ACCURACY_SAMPLES % n == 0)
      CLOTH_TRY(sample(
          scene, point, s->point_count,
          positions + 3 * (size_t)s->point_count * (size_t)(i * ACCURACY_SAMPLES / n - 1), err));
    show(s, setting, i, n);
    *stopped = stop_signal != 0;
    if (*stopped) return CLOTH_OK;
  }
  return CLOTH_OK;
}

cloth_status accuracy_run(const accuracy_study *s, const sweep_setting *setting, double *positions,
                          accuracy_row *row, bool *stopped, cloth_error *err)
{
  cloth_def *def = NULL;
  cloth_scene *scene = NULL;
  *stopped = false;
  CLOTH_TRY(load(s, setting, &def, err));
  material_point *point = calloc((size_t)s->point_count + 1, sizeof *point);
  cloth_status status = CLOTH_OK;
  if (!point)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for material points");
  fill_settings(s, setting, def, row);
  if (status == CLOTH_OK) status = cloth_scene_new(def, &scene, err);
  // what an integrator does not do is a finding too
  bool refused = scene == NULL && (status == CLOTH_UNSUPPORTED || status == CLOTH_BAD_SCENE ||
                                   status == CLOTH_BAD_ARGUMENT);
  if (status == CLOTH_OK) {
    fill_scene(scene, cloth_def_params(def), row);
    accuracy_points_locate(scene, s->point_count, s->place, s->cloth, point);
    status = run_steps(s, setting, row->time_step, scene, point, positions, row, stopped, err);
    finish(row);
  }
  if (refused || status == CLOTH_UNSTABLE) {
    snprintf(row->status, sizeof row->status, refused ? "refused" : "unstable");
    for (size_t i = 0; i < 3 * ACCURACY_SAMPLES * (size_t)s->point_count; i++) positions[i] = NAN;
    *err = (cloth_error){0};
    status = CLOTH_OK;
  }
  cloth_scene_free(scene);
  cloth_def_free(def);
  free(point);
  return status;
}

// ---- errors ------------------------------------------------------------------------------------

static void compare(const accuracy_study *s, const double *a, const double *b, double *rms,
                    double *most)
{
  int n = ACCURACY_SAMPLES * s->point_count;
  double sum = 0, largest = 0;
  for (int i = 0; i < n; i++) {
    double d_sq = 0;
    for (int k = 0; k < 3; k++) {
      double d = a[3 * (size_t)i + (size_t)k] - b[3 * (size_t)i + (size_t)k];
      d_sq += d * d;
    }
    sum += d_sq;
    if (!(d_sq <= largest)) largest = d_sq;
  }
  *rms = sqrt(sum / n) / s->size;
  *most = sqrt(largest) / s->size;
}

void accuracy_measure(const accuracy_study *s, const double *positions, accuracy_row *row)
{
  compare(s, positions, s->fine, &row->error_rms, &row->error_max);
  compare(s, positions, s->same_mesh, &row->error_rms_same_mesh, &row->error_max_same_mesh);
}
