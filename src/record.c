#define _GNU_SOURCE // newlocale
#include "record.h"

#include "record_digest.h"

#include <errno.h>
#include <inttypes.h>
#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_SIZE = 4096 };

struct cloth_recorder {
  FILE *file; // NULL once the recording broke off
  locale_t c; // numbers look the same in every program
  int cause;  // errno of the write that failed; 0: none did
  int64_t steps;
  int state_files;
  char path[PATH_SIZE];
};

// ---- writing -----------------------------------------------------------------------------------

static void break_off(cloth_recorder *r)
{
  r->cause = errno ? errno : EIO;
  fclose(r->file);
  r->file = NULL;
}

__attribute__((format(printf, 2, 3))) static void put(cloth_recorder *r, const char *format, ...)
{
  if (!r->file) return;
  va_list args;
  va_start(args, format);
  locale_t before = uselocale(r->c);
  int n = vfprintf(r->file, format, args);
  uselocale(before);
  va_end(args);
  if (n < 0) break_off(r);
}

static void put_pose(cloth_recorder *r, const cloth_pose *p)
{
  put(r, " %a %a %a %a %a %a %a", p->position[0], p->position[1], p->position[2], p->rotation[0],
      p->rotation[1], p->rotation[2], p->rotation[3]);
}

// ---- hooks -------------------------------------------------------------------------------------

void cloth_record_step_begin(cloth_recorder *r, double h)
{
  if (!r) return;
  put(r, "step %a\n", h);
  // to the file before the step: it may be the one that crashes
  if (r->file && fflush(r->file) != 0) break_off(r);
}

void cloth_record_step_end(cloth_recorder *r, cloth_status status, uint64_t hash)
{
  if (!r) return;
  if (status == CLOTH_OK)
    put(r, "hash %016" PRIx64 "\n", hash);
  else
    put(r, "fail %d\n", (int)status);
  if (r->file) r->steps++;
}

void cloth_record_tune(cloth_recorder *r, const cloth_tuning *t)
{
  if (r)
    put(r, "tune %a %d %d %d %a\n", t->pcg_tolerance, t->newton_iterations, t->contact_rounds,
        t->pcg_iterations, t->pair_slack);
}

void cloth_record_body_move(cloth_recorder *r, int body, const cloth_pose *pose)
{
  if (!r) return;
  put(r, "move %d", body);
  put_pose(r, pose);
  put(r, "\n");
}

void cloth_record_body_place(cloth_recorder *r, int body, const cloth_pose *pose)
{
  if (!r) return;
  put(r, "place %d", body);
  put_pose(r, pose);
  put(r, "\n");
}

void cloth_record_grasp(cloth_recorder *r, const cloth_grasp_view *g, cloth_grasp_id id)
{
  if (!r) return;
  put(r, "grasp %d %u %d %d %a %a", id.index1, id.generation, g->cloth, g->body, g->stiffness,
      g->break_force);
  put_pose(r, &g->frame);
  put(r, " %d", g->count);
  for (int i = 0; i < g->count; i++) put(r, " %d", g->vertex[i]);
  put(r, " %d", g->ignore_count);
  for (int i = 0; i < g->ignore_count; i++) put(r, " %d", g->ignore_body[i]);
  put(r, "\n");
}

void cloth_record_grasp_move(cloth_recorder *r, cloth_grasp_id id, const cloth_pose *frame)
{
  if (!r) return;
  put(r, "carry %d %u", id.index1, id.generation);
  put_pose(r, frame);
  put(r, "\n");
}

void cloth_record_grasp_release(cloth_recorder *r, cloth_grasp_id id)
{
  if (!r) return;
  put(r, "release %d %u\n", id.index1, id.generation);
}

void cloth_record_state_set(cloth_recorder *r, int cloth, const double *position,
                            const double *velocity, int count)
{
  if (!r) return;
  const double *given[2] = {position, velocity};
  static const char *const word[2] = {"positions", "velocities"};
  for (int k = 0; k < 2; k++) {
    if (!given[k]) continue;
    put(r, "%s %d %d\n", word[k], cloth, count);
    for (const double *x = given[k]; x < given[k] + 3 * (ptrdiff_t)count; x += 3)
      put(r, "%a %a %a\n", x[0], x[1], x[2]);
  }
}

// the name without directories: a recording and its state files are moved together
static const char *file_name(const char *path)
{
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

void cloth_record_state_load(cloth_recorder *r, cloth_scene *scene)
{
  if (!r || !r->file) return;
  char path[PATH_SIZE + 16];
  cloth_error err = {0};
  snprintf(path, sizeof path, "%s.state.%d", r->path, ++r->state_files);
  if (cloth_state_save(scene, path, &err) != CLOTH_OK) {
    errno = EIO;
    break_off(r);
    return;
  }
  put(r, "load %s\n", file_name(path));
}

void cloth_record_reset(cloth_recorder *r)
{
  if (r) put(r, "reset\n");
}

// ---- open, close -------------------------------------------------------------------------------

static cloth_status put_heading(cloth_recorder *r, const cloth_record_subject *s, cloth_error *err)
{
  uint64_t hash;
  put(r, "%s\n", CLOTH_RECORD_VERSION);
  put(r, "precision %s\n", s->precision);
  for (int i = 0; i < cloth_record_line_count(s); i++) {
    char line[CLOTH_RECORD_LINE_SIZE];
    cloth_record_line(s, i, line);
    put(r, "%s\n", line);
  }
  for (const cloth_param_info *p = cloth_param_table(); p->name; p++) {
    if (!cloth_record_param_counts(p)) continue;
    double value[3];
    int n = cloth_record_param(s->params, p, value);
    put(r, "param %s", p->name);
    for (int k = 0; k < n; k++) put(r, " %a", value[k]);
    put(r, "\n");
  }
  if (!s->fresh) {
    char path[PATH_SIZE + 16];
    snprintf(path, sizeof path, "%s.state", r->path);
    CLOTH_TRY(cloth_state_save(s->scene, path, err));
    put(r, "load %s\n", file_name(path));
  }
  CLOTH_TRY(cloth_state_hash(s->scene, &hash, err));
  put(r, "start %016" PRIx64 "\n", hash);
  return CLOTH_OK;
}

static void recorder_free(cloth_recorder *r)
{
  if (r->file) fclose(r->file);
  if (r->c != (locale_t)0) freelocale(r->c);
  free(r);
}

cloth_status cloth_recorder_open(const cloth_record_subject *subject, const char *path,
                                 cloth_recorder **out, cloth_error *err)
{
  cloth_status status = CLOTH_OK;
  bool existed = access(path, F_OK) == 0;
  *out = NULL;
  cloth_recorder *r = calloc(1, sizeof *r);
  if (!r) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for a recorder");
  if (snprintf(r->path, sizeof r->path, "%s", path) >= (int)sizeof r->path)
    status = cloth_fail(err, CLOTH_IO, __FILE__, __LINE__, "the path of the recording is too long");
  if (status == CLOTH_OK && (r->c = newlocale(LC_ALL_MASK, "C", (locale_t)0)) == (locale_t)0)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for a locale");
  if (status == CLOTH_OK && (r->file = fopen(path, "w")) == NULL)
    status = cloth_fail(err, CLOTH_IO, __FILE__, __LINE__, "cannot write the recording %s: %s",
                        path, strerror(errno));
  if (status != CLOTH_OK) {
    recorder_free(r);
    return status;
  }
  status = put_heading(r, subject, err);
  if (status == CLOTH_OK && (!r->file || fflush(r->file) != 0))
    status = cloth_fail(err, CLOTH_IO, __FILE__, __LINE__, "cannot write the recording %s: %s",
                        path, strerror(r->file ? errno : r->cause));
  if (status != CLOTH_OK) {
    recorder_free(r);
    if (!existed) remove(path); // what was there may be a device
    return status;
  }
  *out = r;
  return CLOTH_OK;
}

cloth_status cloth_recorder_close(cloth_recorder *r, cloth_error *err)
{
  if (!r) return CLOTH_OK;
  cloth_status status = CLOTH_OK;
  put(r, "end\n");
  if (r->file && fflush(r->file) != 0) break_off(r);
  if (!r->file)
    status = cloth_fail(err, CLOTH_IO, __FILE__, __LINE__,
                        "the recording %s broke off after %" PRId64 " steps: %s", r->path, r->steps,
                        strerror(r->cause));
  recorder_free(r);
  return status;
}
