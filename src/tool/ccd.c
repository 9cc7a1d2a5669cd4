// cloth ccd: the engine's time of impact against query files with exact answers. It may be early or
// report a contact that is not there; it may not miss one.
#include "ccd_file.h"
#include "precision.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const tool_option options[] = {
    {"precision", "NAME", "float or double (default double)"},
    {"float-only", NULL, "with --precision float: no second look in double at close calls"},
    {"type", "NAME", "ee or vf; default: by edge-edge or vertex-face in the path of a file"},
    {NULL, NULL, NULL},
};

enum { BATCH = 32768 };

typedef struct ccd {
  cloth_impact_precision precision;
  const char *type; // of all files; NULL: by their paths
  ccd_query query[BATCH];
  cloth_impact_result result[BATCH];
} ccd;

typedef struct tally {
  int64_t queries, contacts, missed, extra, asked_again, rounded;
  int64_t timed;   // contacts whose exact time is known
  double lateness; // largest, in shares of the step
  double seconds;  // in the search
} tally;

// ---- what is in a file -------------------------------------------------------------------------

static const char *last_of(const char *path, const char *word)
{
  const char *found = NULL;
  for (const char *at = path; (at = strstr(at, word)) != NULL; at++) found = at;
  return found;
}

static cloth_status kind_of(const char *type, const char *path, cloth_impact_kind *out,
                            cloth_error *err)
{
  char whole[PATH_MAX];
  const char *at = !type && realpath(path, whole) ? whole : path;
  const char *edges = type ? NULL : last_of(at, "edge-edge");
  const char *face = type ? NULL : last_of(at, "vertex-face");
  if (type ? strcmp(type, "ee") == 0 : edges && (!face || edges > face))
    *out = CLOTH_IMPACT_EDGE_EDGE;
  else if (type ? strcmp(type, "vf") == 0 : face != NULL)
    *out = CLOTH_IMPACT_VERTEX_FACE;
  else if (type)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--type '%s' is neither ee nor vf", type);
  else
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
               "%s: are these edge-edge or vertex-face queries? The path has neither word; say "
               "--type ee or --type vf",
               path);
  return CLOTH_OK;
}

// ---- counting ----------------------------------------------------------------------------------

static void search(ccd *c, cloth_impact_kind kind, int count, tally *t)
{
  double before = tool_clock();
#pragma omp parallel for schedule(dynamic, 64)
  for (int i = 0; i < count; i++) {
    const ccd_query *q = &c->query[i];
    c->result[i] = (q->rounded ? cloth_impact_test_rounded
                               : cloth_impact_test)(kind, c->precision, (const double(*)[3])q->x);
  }
  t->seconds += tool_clock() - before;
}

static void count_results(const ccd *c, int count, const double *hi, tally *t)
{
  for (int i = 0; i < count; i++, t->queries++) {
    const cloth_impact_result *r = &c->result[i];
    bool truth = c->query[i].truth;
    t->contacts += truth;
    t->missed += truth && !r->hit;
    t->extra += !truth && r->hit;
    t->asked_again += r->asked_again;
    t->rounded += c->query[i].rounded;
    if (!hi || !isfinite(hi[t->queries]) || !r->hit) continue;
    t->timed++;
    t->lateness = fmax(t->lateness, r->toi - hi[t->queries]);
  }
}

static cloth_status count_queries(ccd *c, cloth_impact_kind kind, ccd_file *file, const double *hi,
                                  int64_t times, tally *t, cloth_error *err)
{
  for (;;) {
    int count;
    CLOTH_TRY(ccd_file_read(file, BATCH, c->query, &count, err));
    if (hi && (t->queries + count > times || (count == 0 && t->queries < times)))
      CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                 "%s has %s than %" PRId64 " queries, but the toi_*.json beside it %" PRId64
                 " times",
                 file->path, count ? "more" : "fewer", times, times);
    if (count == 0) return CLOTH_OK;
    search(c, kind, count, t);
    count_results(c, count, hi, t);
  }
}

static cloth_status count_file(ccd *c, const char *path, tally *t, cloth_error *err)
{
  cloth_status status;
  cloth_impact_kind kind;
  ccd_file file = {0};
  double *hi = NULL;
  int64_t times = 0;
  CLOTH_TRY(kind_of(c->type, path, &kind, err));
  CLOTH_TRY(ccd_file_open(path, &file, err));
  CLOTH_TRY_GOTO(ccd_times_read(path, &hi, &times, err), status, done);
  CLOTH_TRY_GOTO(count_queries(c, kind, &file, hi, times, t, err), status, done);
  if (t->queries == 0)
    status = cloth_fail(err, CLOTH_BAD_SCENE, __FILE__, __LINE__, "%s: no queries in it", path);
done:
  ccd_file_close(&file);
  free(hi);
  return status;
}

static void add(tally *sum, const tally *t)
{
  sum->queries += t->queries, sum->contacts += t->contacts;
  sum->missed += t->missed, sum->extra += t->extra;
  sum->asked_again += t->asked_again, sum->timed += t->timed, sum->rounded += t->rounded;
  sum->lateness = fmax(sum->lateness, t->lateness);
  sum->seconds += t->seconds;
}

static void print_tally(const ccd *c, const char *name, const tally *t)
{
  printf("%s: queries %" PRId64 ", contacts %" PRId64 ", missed %" PRId64 ", extra %" PRId64
         ", worst lateness %.3g, %.0f ns per query",
         name, t->queries, t->contacts, t->missed, t->extra, t->lateness,
         1e9 * t->seconds / (double)t->queries);
  printf(" (%" PRId64 " with exact times", t->timed);
  if (c->precision == CLOTH_IMPACT_FLOAT)
    printf(", %" PRId64 " asked again in double", t->asked_again);
  if (t->rounded) printf(", %" PRId64 " with coordinates that no double is", t->rounded);
  printf(")\n");
}

// ---- the command -------------------------------------------------------------------------------

cloth_status tool_precision(const tool_arguments *args, cloth_impact_precision *out,
                            cloth_error *err)
{
  const char *name = tool_text(args, "precision");
  bool single = name && strcmp(name, "float") == 0;
  if (name && !single && strcmp(name, "double") != 0)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--precision '%s' is neither float nor double", name);
  if (tool_has(args, "float-only") && !single)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--float-only goes with --precision float");
  *out = !single                        ? CLOTH_IMPACT_DOUBLE
         : tool_has(args, "float-only") ? CLOTH_IMPACT_FLOAT_ALONE
                                        : CLOTH_IMPACT_FLOAT;
  return CLOTH_OK;
}

static int ccd_main(const tool_arguments *args, cloth_error *err)
{
  cloth_status status = CLOTH_OK;
  tally sum = {0};
  ccd *c = calloc(1, sizeof *c);
  if (!c) return tool_exit_code(cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory"));
  c->type = tool_text(args, "type");
  CLOTH_TRY_GOTO(tool_precision(args, &c->precision, err), status, done);
  for (int i = 0; i < args->operand_count; i++) {
    tally t = {0};
    CLOTH_TRY_GOTO(count_file(c, args->operand[i], &t, err), status, done);
    print_tally(c, args->operand[i], &t);
    add(&sum, &t);
  }
  print_tally(c, "total", &sum);
done:
  free(c);
  if (status != CLOTH_OK) return tool_exit_code(status);
  return sum.missed > 0 ? TOOL_FAILED : TOOL_DONE;
}

const tool_command tool_ccd = {"ccd",
                               "FILE.csv...",
                               1,
                               INT_MAX,
                               false,
                               options,
                               "the time of impact against queries with exact answers",
                               ccd_main};
