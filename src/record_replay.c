// Reading a recording: each line is one call (doc/recording.md), played against a scene.
#define _GNU_SOURCE // getline, strtod_l
#include "record_digest.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct replay {
  const cloth_record_subject *subject;
  cloth_scene *scene;
  const char *path;
  FILE *file;
  locale_t c;
  char *line; // getline's, without the line end
  size_t line_size;
  long number; // of the line
  char *at;    // what is still to read of it
  int digest_lines;
  int64_t steps;    // that matched
  bool started;     // the heading is over
  bool ended;       // nothing follows
  uint64_t hash;    // of the state after the last step played
  cloth_status was; // its status
  bool stepped;     // its line with hash or failure has not come yet
  cloth_error step_error;
  int grasp_count, grasp_room;
  struct replay_grasp {
    cloth_grasp_id recorded, mine;
  } * grasp; // [grasp_count] handles may differ: those of a scene that was reset count on
} replay;

// ---- reading -----------------------------------------------------------------------------------

static bool next_line(replay *r)
{
  ssize_t n = getline(&r->line, &r->line_size, r->file);
  if (n < 0) return false;
  r->number++;
  // a last line without its end was cut off while it was written: it does not count
  if (r->line[n - 1] != '\n') return false;
  r->line[n - 1] = '\0';
  r->at = r->line;
  return true;
}

static cloth_status damaged(replay *r, const char *what, cloth_error *err)
{
  CLOTH_FAIL(err, CLOTH_IO, "%s:%ld: the recording is damaged: expected %s in '%.60s'", r->path,
             r->number, what, r->line ? r->line : "");
}

static cloth_status read_number(replay *r, double *out, cloth_error *err)
{
  char *end;
  *out = strtod_l(r->at, &end, r->c);
  if (end == r->at) return damaged(r, "a number", err);
  r->at = end;
  return CLOTH_OK;
}

static cloth_status read_int(replay *r, int *out, cloth_error *err)
{
  char *end;
  errno = 0;
  long value = strtol(r->at, &end, 10);
  if (end == r->at || errno || value < INT_MIN || value > INT_MAX)
    return damaged(r, "a whole number", err);
  r->at = end;
  *out = (int)value;
  return CLOTH_OK;
}

static cloth_status read_unsigned(replay *r, int base, uint64_t *out, cloth_error *err)
{
  char *end;
  errno = 0;
  *out = strtoull(r->at, &end, base);
  if (end == r->at || errno) return damaged(r, base == 16 ? "a hash" : "a number", err);
  r->at = end;
  return CLOTH_OK;
}

static cloth_status read_hash(replay *r, uint64_t *out, cloth_error *err)
{
  return read_unsigned(r, 16, out, err);
}

static cloth_status read_pose(replay *r, cloth_pose *out, cloth_error *err)
{
  for (int i = 0; i < 3; i++) CLOTH_TRY(read_number(r, &out->position[i], err));
  for (int i = 0; i < 4; i++) CLOTH_TRY(read_number(r, &out->rotation[i], err));
  return CLOTH_OK;
}

// *out [*count] is the caller's to free; a count that the line cannot hold is damage, not memory
static cloth_status read_list(replay *r, int *count, int **out, cloth_error *err)
{
  CLOTH_TRY(read_int(r, count, err));
  if (*count < 0 || (size_t)*count > strlen(r->at)) return damaged(r, "a count", err);
  *out = calloc((size_t)*count + 1, sizeof **out);
  if (!*out) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d indices", *count);
  for (int i = 0; i < *count; i++) CLOTH_TRY(read_int(r, &(*out)[i], err));
  return CLOTH_OK;
}

static cloth_status read_handle(replay *r, cloth_grasp_id *out, cloth_error *err)
{
  uint64_t generation;
  CLOTH_TRY(read_int(r, &out->index1, err));
  CLOTH_TRY(read_unsigned(r, 10, &generation, err));
  out->generation = (unsigned)generation;
  return CLOTH_OK;
}

// The grasp of this scene that a recorded handle means; one that came with a state file keeps its
// own.
static cloth_status read_grasp_id(replay *r, cloth_grasp_id *out, cloth_error *err)
{
  CLOTH_TRY(read_handle(r, out, err));
  for (int i = r->grasp_count - 1; i >= 0; i--)
    if (r->grasp[i].recorded.index1 == out->index1 &&
        r->grasp[i].recorded.generation == out->generation) {
      *out = r->grasp[i].mine;
      break;
    }
  return CLOTH_OK;
}

static cloth_status remember_grasp(replay *r, cloth_grasp_id recorded, cloth_grasp_id mine,
                                   cloth_error *err)
{
  if (r->grasp_count == r->grasp_room) {
    int room = 2 * r->grasp_room + 16;
    void *more = realloc(r->grasp, (size_t)room * sizeof *r->grasp);
    if (!more) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d grasps", room);
    r->grasp = more;
    r->grasp_room = room;
  }
  r->grasp[r->grasp_count++] = (struct replay_grasp){recorded, mine};
  return CLOTH_OK;
}

// a call that succeeded when it was recorded
static cloth_status played(replay *r, cloth_status status, const cloth_error *cause,
                           cloth_error *err)
{
  if (status == CLOTH_OK) return CLOTH_OK;
  CLOTH_FAIL(err, status < 0 ? status : CLOTH_BAD_STATE, "%s:%ld: '%.40s' is refused here: %s",
             r->path, r->number, r->line, cause->text);
}

// ---- heading -----------------------------------------------------------------------------------

static cloth_status on_precision(replay *r, cloth_error *err)
{
  const char *word = r->at + strspn(r->at, " ");
  if (strcmp(word, r->subject->precision) != 0)
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "%s was recorded with precision %.20s, this scene has %s",
               r->path, word, r->subject->precision);
  return CLOTH_OK;
}

static cloth_status on_digest(replay *r, cloth_error *err)
{
  int i = r->digest_lines++;
  char mine[CLOTH_RECORD_LINE_SIZE] = "nothing there";
  if (i < cloth_record_line_count(r->subject)) cloth_record_line(r->subject, i, mine);
  if (strcmp(mine, r->line) != 0)
    CLOTH_FAIL(err, CLOTH_BAD_STATE,
               "%s:%ld: recorded with another scene: '%.120s', this one has '%.120s'", r->path,
               r->number, r->line, mine);
  return CLOTH_OK;
}

static cloth_status on_param(replay *r, cloth_error *err)
{
  const char *name = strtok_r(r->at, " ", &r->at);
  if (!name) return damaged(r, "the name of a parameter", err);
  const cloth_param_info *p = cloth_param_table();
  while (p->name && strcmp(p->name, name) != 0) p++;
  if (!p->name)
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "%s:%ld: this version has no parameter '%.60s'", r->path,
               r->number, name);
  double mine[3], recorded;
  int n = cloth_record_param(r->subject->params, p, mine);
  for (int k = 0; k < n; k++) {
    CLOTH_TRY(read_number(r, &recorded, err));
    if (recorded != mine[k])
      CLOTH_FAIL(err, CLOTH_BAD_STATE, "%s:%ld: recorded with %s = %.9g %s, this scene has %.9g %s",
                 r->path, r->number, name, recorded, p->unit, mine[k], p->unit);
  }
  return CLOTH_OK;
}

static cloth_status on_start(replay *r, cloth_error *err)
{
  uint64_t recorded, mine;
  CLOTH_TRY(read_hash(r, &recorded, err));
  if (r->digest_lines != cloth_record_line_count(r->subject))
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "%s was recorded with %d cloths and bodies, this scene has %d",
               r->path, r->digest_lines, cloth_record_line_count(r->subject));
  CLOTH_TRY(cloth_state_hash(r->scene, &mine, err));
  if (recorded != mine)
    CLOTH_FAIL(err, CLOTH_BAD_STATE,
               "%s starts from another state (hash %016" PRIx64 ", this scene has %016" PRIx64
               "); is the scene fresh?",
               r->path, recorded, mine);
  r->started = true;
  return CLOTH_OK;
}

// ---- calls -------------------------------------------------------------------------------------

static cloth_status on_load(replay *r, cloth_error *err)
{
  char path[4096];
  cloth_error cause = {0};
  const char *name = r->at + strspn(r->at, " ");
  const char *slash = strrchr(r->path, '/');
  int length = slash ? (int)(slash + 1 - r->path) : 0;
  snprintf(path, sizeof path, "%.*s%s", length, r->path, name);
  return played(r, cloth_state_load(r->scene, path, &cause), &cause, err);
}

static cloth_status on_body(replay *r, cloth_error *err)
{
  int body;
  cloth_pose pose;
  cloth_error cause = {0};
  CLOTH_TRY(read_int(r, &body, err));
  CLOTH_TRY(read_pose(r, &pose, err));
  cloth_status status = r->line[0] == 'm' ? cloth_body_move(r->scene, body, &pose, &cause)
                                          : cloth_body_place(r->scene, body, &pose, &cause);
  return played(r, status, &cause, err);
}

static cloth_status on_grasp(replay *r, cloth_error *err)
{
  cloth_status status;
  cloth_grasp_id recorded, mine = {0, 0};
  cloth_grasp_view g = {0};
  cloth_error cause = {0};
  int *vertex = NULL, *ignore = NULL;
  CLOTH_TRY(read_handle(r, &recorded, err));
  CLOTH_TRY(read_int(r, &g.cloth, err));
  CLOTH_TRY(read_int(r, &g.body, err));
  CLOTH_TRY(read_number(r, &g.stiffness, err));
  CLOTH_TRY(read_number(r, &g.break_force, err));
  CLOTH_TRY(read_pose(r, &g.frame, err));
  CLOTH_TRY_GOTO(read_list(r, &g.count, &vertex, err), status, done);
  CLOTH_TRY_GOTO(read_list(r, &g.ignore_count, &ignore, err), status, done);
  g.vertex = vertex;
  g.ignore_body = ignore;
  CLOTH_TRY_GOTO(played(r, cloth_grasp(r->scene, &g, &mine, &cause), &cause, err), status, done);
  status = remember_grasp(r, recorded, mine, err); // later lines name it by its handle
done:
  free(vertex);
  free(ignore);
  return status;
}

static cloth_status on_carry(replay *r, cloth_error *err)
{
  cloth_grasp_id id;
  cloth_pose frame;
  cloth_error cause = {0};
  CLOTH_TRY(read_grasp_id(r, &id, err));
  CLOTH_TRY(read_pose(r, &frame, err));
  return played(r, cloth_grasp_move(r->scene, id, &frame, &cause), &cause, err);
}

static cloth_status on_release(replay *r, cloth_error *err)
{
  cloth_grasp_id id;
  cloth_error cause = {0};
  CLOTH_TRY(read_grasp_id(r, &id, err));
  return played(r, cloth_grasp_release(r->scene, id, &cause), &cause, err);
}

static cloth_status on_state(replay *r, cloth_error *err)
{
  int cloth, count;
  cloth_status status = CLOTH_OK;
  cloth_error cause = {0};
  bool positions = r->line[0] == 'p';
  CLOTH_TRY(read_int(r, &cloth, err));
  CLOTH_TRY(read_int(r, &count, err));
  if (cloth < 0 || cloth >= cloth_count(r->scene) || count != cloth_vertex_count(r->scene, cloth))
    return damaged(r, "a cloth and its number of vertices", err);
  double *x = calloc((size_t)count + 1, 3 * sizeof *x);
  if (!x) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d vertices", count);
  for (int i = 0; i < count && status == CLOTH_OK; i++) {
    if (!next_line(r)) status = damaged(r, "three numbers", err);
    for (int k = 0; k < 3 && status == CLOTH_OK; k++)
      status = read_number(r, &x[3 * (ptrdiff_t)i + k], err);
  }
  if (status == CLOTH_OK)
    status = played(
        r,
        cloth_state_set(r->scene, cloth, positions ? x : NULL, positions ? NULL : x, count, &cause),
        &cause, err);
  free(x);
  return status;
}

static cloth_status on_reset(replay *r, cloth_error *err)
{
  cloth_error cause = {0};
  return played(r, cloth_reset(r->scene, &cause), &cause, err);
}

static cloth_status on_tune(replay *r, cloth_error *err)
{
  cloth_tuning t;
  cloth_error cause = {0};
  CLOTH_TRY(read_number(r, &t.pcg_tolerance, err));
  CLOTH_TRY(read_int(r, &t.newton_iterations, err));
  CLOTH_TRY(read_int(r, &t.contact_rounds, err));
  CLOTH_TRY(read_int(r, &t.pcg_iterations, err));
  CLOTH_TRY(read_number(r, &t.pair_slack, err));
  return played(r, cloth_tune(r->scene, &t, &cause), &cause, err);
}

static cloth_status on_step(replay *r, cloth_error *err)
{
  double h;
  CLOTH_TRY(read_number(r, &h, err));
  r->step_error = (cloth_error){0};
  r->was = cloth_step(r->scene, h, NULL, &r->step_error);
  r->stepped = true;
  return CLOTH_OK;
}

static cloth_status on_hash(replay *r, cloth_error *err)
{
  uint64_t recorded;
  CLOTH_TRY(read_hash(r, &recorded, err));
  if (!r->stepped) return damaged(r, "a step before it", err);
  r->stepped = false;
  if (r->was != CLOTH_OK)
    CLOTH_FAIL(err, r->was < 0 ? r->was : CLOTH_BAD_STATE,
               "%s:%ld: step %" PRId64 " succeeded when it was recorded and fails here: %s",
               r->path, r->number, r->steps + 1, r->step_error.text);
  CLOTH_TRY(cloth_state_hash(r->scene, &r->hash, err));
  if (r->hash != recorded)
    CLOTH_FAIL(err, CLOTH_BAD_STATE,
               "%s:%ld: step %" PRId64 " differs: hash %016" PRIx64 " was recorded, %016" PRIx64
               " is computed",
               r->path, r->number, r->steps + 1, recorded, r->hash);
  r->steps++;
  return CLOTH_OK;
}

static cloth_status on_fail(replay *r, cloth_error *err)
{
  int recorded;
  CLOTH_TRY(read_int(r, &recorded, err));
  if (!r->stepped) return damaged(r, "a step before it", err);
  r->stepped = false;
  if ((int)r->was != recorded)
    CLOTH_FAIL(err, CLOTH_BAD_STATE,
               "%s:%ld: step %" PRId64 " failed with status %d when it was recorded, here it is %d",
               r->path, r->number, r->steps + 1, recorded, (int)r->was);
  r->steps++;
  r->ended = r->was < 0; // the scene is lost, as it was then
  return CLOTH_OK;
}

static cloth_status on_end(replay *r, cloth_error *err)
{
  (void)err;
  r->ended = true;
  return CLOTH_OK;
}

// ---- the file ----------------------------------------------------------------------------------

static const struct {
  const char *word;
  bool heading; // may come before `start`; all but load only then
  cloth_status (*play)(replay *r, cloth_error *err);
} calls[] = {
    {"precision", true, on_precision},
    {"cloth", true, on_digest},
    {"body", true, on_digest},
    {"param", true, on_param},
    {"start", true, on_start},
    {"load", true, on_load},
    {"move", false, on_body},
    {"place", false, on_body},
    {"grasp", false, on_grasp},
    {"carry", false, on_carry},
    {"release", false, on_release},
    {"positions", false, on_state},
    {"velocities", false, on_state},
    {"reset", false, on_reset},
    {"tune", false, on_tune},
    {"step", false, on_step},
    {"hash", false, on_hash},
    {"fail", false, on_fail},
    {"end", false, on_end},
};

static cloth_status play_line(replay *r, cloth_error *err)
{
  if (r->line[0] == '#' || r->line[0] == '\0') return CLOTH_OK;
  size_t length = strcspn(r->line, " ");
  for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
    if (strlen(calls[i].word) != length || strncmp(calls[i].word, r->line, length) != 0) continue;
    if (calls[i].heading == r->started && calls[i].play != on_load)
      return damaged(r, r->started ? "a call" : "the heading", err);
    r->at = r->line + length;
    return calls[i].play(r, err);
  }
  return damaged(r, "a known call", err);
}

cloth_status cloth_record_replay(const cloth_record_subject *subject, const char *path,
                                 int64_t *steps, cloth_error *err)
{
  cloth_status status = CLOTH_OK;
  replay r = {.subject = subject, .scene = subject->scene, .path = path};
  if (steps) *steps = 0;
  r.file = fopen(path, "r");
  if (!r.file) CLOTH_FAIL(err, CLOTH_IO, "cannot read the recording %s: %s", path, strerror(errno));
  r.c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  if (r.c == (locale_t)0)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for a locale");
  else if (!next_line(&r) || strcmp(r.line, CLOTH_RECORD_VERSION) != 0)
    status = cloth_fail(err, CLOTH_IO, __FILE__, __LINE__,
                        "%s is not a recording of this version: its first line is not '%s'", path,
                        CLOTH_RECORD_VERSION);
  // a recording may end anywhere: what it was made of may have crashed
  while (status == CLOTH_OK && !r.ended && next_line(&r)) status = play_line(&r, err);
  if (status == CLOTH_OK && ferror(r.file))
    status =
        cloth_fail(err, CLOTH_IO, __FILE__, __LINE__, "cannot read %s: %s", path, strerror(errno));
  if (status == CLOTH_OK && !r.started)
    status = cloth_fail(err, CLOTH_IO, __FILE__, __LINE__, "%s ends within its heading", path);
  if (status == CLOTH_OK && r.stepped && r.was != CLOTH_OK) // the crash of then is an error of now
    status =
        cloth_fail(err, r.was, __FILE__, __LINE__, "%s:%ld: %s", path, r.number, r.step_error.text);
  if (steps) *steps = r.steps;
  free(r.line);
  free(r.grasp);
  if (r.c != (locale_t)0) freelocale(r.c);
  fclose(r.file);
  return status;
}
