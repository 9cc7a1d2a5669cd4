// cloth accuracy: what accuracy costs in time. Sweeps what buys accuracy, one thing at a time and
// some of them together, measures the error against a much finer solution, and writes a row for
// each run. Interrupted, it goes on where it was.
#include "accuracy.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const tool_option options[] = {
    {"out", "DIR", "write accuracy.csv and the references there; rows that are in it are kept"},
    {"seconds", "T", "how long to simulate; default: the scene's duration, or 2 s"},
    {"cost", "WHAT",
     "wall, cpu (of all threads) or work: what the lists count as cost (default wall)"},
    {"only", "LIST",
     "of the sweep only what varies these, e.g. standard,time_step,preset; references as always"},
    {"quick", NULL, "a few settings over 16 steps, against coarser references: for a first look"},
    {"from", "FILE", "print the lists of an accuracy.csv and run nothing"},
    {NULL, NULL, NULL},
};

typedef struct command {
  const tool_arguments *args;
  const char *dir;
  bool quick;
  accuracy_cost cost;
  accuracy_table table;
} command;

// ---- references on disk ------------------------------------------------------------------------

static void reference_path(const command *c, const accuracy_study *s, const sweep_setting *which,
                           char out[1200])
{
  bool fine = which->resolution > 0;
  snprintf(out, 1200, "%.800s/%s_%s.txt", c->dir, s->name, fine ? "fine" : "same_mesh");
}

static size_t reference_numbers(const accuracy_study *s)
{
  return 3 * (size_t)ACCURACY_SAMPLES * (size_t)s->point_count;
}

static bool reference_read(const char *path, const accuracy_study *s, const sweep_setting *which,
                           double *out)
{
  char wanted[256], line[256];
  FILE *in = fopen(path, "r");
  if (!in) return false;
  snprintf(wanted, sizeof wanted, "%s %s %d\n", s->digest, which->setting, s->point_count);
  bool good = fgets(line, sizeof line, in) && strcmp(line, wanted) == 0;
  for (size_t i = 0; i < reference_numbers(s) && good; i++) good = fscanf(in, "%lf", &out[i]) == 1;
  fclose(in);
  return good;
}

static cloth_status reference_write(const char *path, const accuracy_study *s,
                                    const sweep_setting *which, const double *x, cloth_error *err)
{
  char part[1210];
  snprintf(part, sizeof part, "%s.part", path);
  FILE *out = fopen(part, "w");
  if (!out) CLOTH_FAIL(err, CLOTH_IO, "cannot write %s: %s", part, strerror(errno));
  fprintf(out, "%s %s %d\n", s->digest, which->setting, s->point_count);
  for (size_t i = 0; i < reference_numbers(s); i++)
    fprintf(out, "%.17g%c", x[i], i % 3 == 2 ? '\n' : ' ');
  bool written = !ferror(out);
  written = fclose(out) == 0 && written;
  if (!written || rename(part, path) != 0)
    CLOTH_FAIL(err, CLOTH_IO, "cannot write %s: %s", path, strerror(errno));
  return CLOTH_OK;
}

// ---- a scene -----------------------------------------------------------------------------------

static void say(const accuracy_row *row)
{
  printf("%-18s %-14s %-28s error %8.3g %%  %8.3g s / s  %s\n", row->scene, row->varied,
         row->setting, 100 * row->error_rms, row->wall_per_second,
         strcmp(row->status, "ok") == 0 ? "" : row->status);
  fflush(stdout);
}

static cloth_status run_setting(command *c, const accuracy_study *s, const sweep_setting *setting,
                                bool *stopped, cloth_error *err)
{
  bool applies;
  accuracy_row row;
  if (accuracy_table_find(&c->table, s->name, setting->varied, setting->setting)) return CLOTH_OK;
  CLOTH_TRY(accuracy_applies(s, setting, &applies, err));
  if (!applies) return CLOTH_OK;
  double *x = calloc(reference_numbers(s) + 1, sizeof *x);
  if (!x) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for positions");
  cloth_status status = accuracy_run(s, setting, x, &row, stopped, err);
  if (status == CLOTH_OK && !*stopped) {
    accuracy_measure(s, x, &row);
    status = accuracy_table_add(&c->table, &row, err);
    say(&row);
  }
  free(x);
  return status;
}

// computed once; its row is added when both references are there
static cloth_status make_reference(const command *c, const accuracy_study *s,
                                   const sweep_setting *which, double *x, accuracy_row *row,
                                   bool *stopped, cloth_error *err)
{
  char path[1200];
  reference_path(c, s, which, path);
  if (accuracy_table_find(&c->table, s->name, which->varied, which->setting) &&
      reference_read(path, s, which, x))
    return CLOTH_OK;
  CLOTH_TRY(accuracy_run(s, which, x, row, stopped, err));
  if (*stopped) return CLOTH_OK;
  if (strcmp(row->status, "ok") != 0)
    CLOTH_FAIL(err, CLOTH_UNSTABLE,
               "%s: the reference (%s) is unstable: nothing to measure against", s->name,
               which->setting);
  return reference_write(path, s, which, x, err);
}

static cloth_status add_reference(command *c, const accuracy_study *s, const double *x,
                                  accuracy_row *row, cloth_error *err)
{
  if (row->scene[0] == '\0' ||
      accuracy_table_find(&c->table, row->scene, row->varied, row->setting))
    return CLOTH_OK;
  accuracy_measure(s, x, row);
  say(row);
  return accuracy_table_add(&c->table, row, err);
}

static cloth_status make_references(command *c, accuracy_study *s, bool *stopped, cloth_error *err)
{
  const sweep_references *r = accuracy_references(c->quick);
  accuracy_row same = {0}, fine = {0};
  // without a grid there is no finer mesh: then both are the same
  sweep_setting finer = {.resolution = r->fine.resolution};
  bool has_grid;
  CLOTH_TRY(accuracy_applies(s, &finer, &has_grid, err));
  CLOTH_TRY(make_reference(c, s, &r->same_mesh, s->same_mesh, &same, stopped, err));
  if (*stopped) return CLOTH_OK;
  if (has_grid)
    CLOTH_TRY(make_reference(c, s, &r->fine, s->fine, &fine, stopped, err));
  else
    memcpy(s->fine, s->same_mesh, sizeof *s->fine * reference_numbers(s));
  if (*stopped) return CLOTH_OK;
  CLOTH_TRY(add_reference(c, s, s->same_mesh, &same, err));
  CLOTH_TRY(add_reference(c, s, s->fine, &fine, err));
  for (const sweep_setting *v = r->convergence; v->varied && !*stopped; v++)
    if (has_grid || !(v->resolution > 0)) CLOTH_TRY(run_setting(c, s, v, stopped, err));
  return CLOTH_OK;
}

static cloth_status check_rows(const command *c, const accuracy_study *s, cloth_error *err)
{
  for (int i = 0; i < c->table.count; i++)
    if (strcmp(c->table.row[i].scene, s->name) == 0 &&
        strcmp(c->table.row[i].digest, s->digest) != 0)
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
                 "%s/accuracy.csv has rows of another version of scene %s, or with other options; "
                 "name another --out, or remove them",
                 c->dir, s->name);
  return CLOTH_OK;
}

// is the word in a list with commas?
static bool is_listed(const char *list, const char *word)
{
  size_t n = strlen(word);
  for (const char *at = list; (at = strstr(at, word)); at += n)
    if ((at == list || at[-1] == ',') && (at[n] == ',' || at[n] == '\0')) return true;
  return false;
}

static bool is_wanted(const command *c, const char *varied)
{
  const char *only = tool_text(c->args, "only");
  return !only || is_listed(only, varied);
}

static cloth_status check_only(const char *only, cloth_error *err)
{
  char word[64];
  for (const char *at = only; at && *at; at += *at == ',') {
    int n = (int)strcspn(at, ",");
    snprintf(word, sizeof word, "%.*s", n < 63 ? n : 63, at);
    const sweep_setting *v = accuracy_sweep;
    while (v->varied && strcmp(v->varied, word) != 0) v++;
    if (!v->varied) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--only: the sweep varies no '%s'", word);
    at += n;
  }
  return CLOTH_OK;
}

static cloth_status sweep_scene(command *c, accuracy_study *s, bool *stopped, cloth_error *err)
{
  CLOTH_TRY(check_rows(c, s, err));
  CLOTH_TRY(make_references(c, s, stopped, err));
  for (const sweep_setting *v = accuracy_sweep; v->varied && !*stopped; v++)
    if ((v->quick || !c->quick) && is_wanted(c, v->varied))
      CLOTH_TRY(run_setting(c, s, v, stopped, err));
  return CLOTH_OK;
}

// the scene's file name without directory and ending
static void name_of(const char *path, char *out, size_t size)
{
  const char *slash = strrchr(path, '/');
  snprintf(out, size, "%s", slash ? slash + 1 : path);
  char *dot = strrchr(out, '.');
  if (dot && dot != out) *dot = '\0';
  for (char *p = out; *p; p++)
    if (*p == ',' || *p == '\n') *p = '_'; // it becomes a column
}

// ---- the command -------------------------------------------------------------------------------

static cloth_status check_usage(command *c, cloth_error *err)
{
  static const char *const costs[] = {"wall", "cpu", "work"};
  const char *cost = tool_text(c->args, "cost");
  int word = 0;
  while (cost && word < 3 && strcmp(cost, costs[word]) != 0) word++;
  if (word == 3) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--cost '%s' is not wall, cpu or work", cost);
  c->cost = (accuracy_cost)word;
  CLOTH_TRY(check_only(tool_text(c->args, "only"), err));
  if (tool_text(c->args, "from")) {
    if (c->args->operand_count > 0)
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--from runs nothing; leave out the scenes");
    return CLOTH_OK;
  }
  if (c->args->operand_count == 0)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "too few arguments; name scenes, or --from FILE");
  if (!c->dir) CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--out DIR is missing: where rows are written");
  for (int i = 0; i < c->args->operand_count; i++)
    for (int j = 0; j < i; j++) {
      char a[64], b[64];
      name_of(c->args->operand[i], a, sizeof a);
      name_of(c->args->operand[j], b, sizeof b);
      if (strcmp(a, b) == 0)
        CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s and %s have the same name, which tells rows apart",
                   c->args->operand[j], c->args->operand[i]);
    }
  return CLOTH_OK;
}

// every scene is read before anything is written
static cloth_status check_scenes(const command *c, cloth_error *err)
{
  for (int i = 0; i < c->args->operand_count; i++) {
    cloth_def *def = NULL;
    CLOTH_TRY(tool_scene_load(c->args, c->args->operand[i], &def, err));
    cloth_def_free(def);
  }
  return CLOTH_OK;
}

static cloth_status open_output(command *c, cloth_error *err)
{
  char path[1024];
  if (mkdir(c->dir, 0777) != 0 && errno != EEXIST)
    CLOTH_FAIL(err, CLOTH_IO, "--out: cannot make %s: %s", c->dir, strerror(errno));
  snprintf(path, sizeof path, "%.1000s/accuracy.csv", c->dir);
  return accuracy_table_open(path, &c->table, err);
}

static cloth_status sweep_all(command *c, bool *stopped, cloth_error *err)
{
  for (int i = 0; i < c->args->operand_count && !*stopped; i++) {
    char name[64];
    accuracy_study s = {.name = name};
    name_of(c->args->operand[i], name, sizeof name);
    cloth_status status = accuracy_study_begin(c->args, c->args->operand[i], c->quick, &s, err);
    if (status == CLOTH_OK) status = sweep_scene(c, &s, stopped, err);
    accuracy_study_end(&s);
    CLOTH_TRY(status);
  }
  return CLOTH_OK;
}

static int accuracy_main(const tool_arguments *args, cloth_error *err)
{
  command c = {.args = args, .dir = tool_text(args, "out"), .quick = tool_has(args, "quick")};
  bool stopped = false;
  const char *from = tool_text(args, "from");
  cloth_status status = check_usage(&c, err);
  if (status == CLOTH_OK && from) status = accuracy_table_read(from, &c.table, err);
  if (status == CLOTH_OK && !from) {
    status = check_scenes(&c, err);
    if (status == CLOTH_OK) status = open_output(&c, err);
    accuracy_catch_signals();
    if (status == CLOTH_OK) status = sweep_all(&c, &stopped, err);
  }
  int code = tool_exit_code(status);
  if (stopped) {
    code = 128 + accuracy_stop_signal();
    fprintf(stderr, "cloth accuracy: stopped by a signal; the same command goes on from %d rows\n",
            c.table.count);
  } else if (status == CLOTH_OK) {
    code = tool_exit_code(accuracy_print(&c.table, c.cost, err));
  }
  accuracy_table_close(&c.table);
  return code;
}

const tool_command tool_accuracy = {
    "accuracy",
    "SCENE.yaml...",
    0,
    1000,
    true,
    options,
    "what accuracy costs: errors and times over a sweep of settings",
    accuracy_main};
