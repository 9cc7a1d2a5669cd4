#include "output.h"

#include "scene/mesh.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NAME_SIZE = 96, PATH_SIZE = 4096, ROW_SIZE = 4096 };

struct tool_output {
  char dir[PATH_SIZE - 256];
  FILE *csv;
  int cloth_count, body_count;
  char (*name)[NAME_SIZE]; // [cloth_count + body_count] file names without the step
  double *position;        // [most vertices x 3] m
  bool silent;             // another process writes; here positions are read, as all must
  bool made;               // the directory was not there before
};

// ---- files -------------------------------------------------------------------------------------

static void path_of(const tool_output *o, const char *file, const char *suffix, char out[PATH_SIZE])
{
  snprintf(out, PATH_SIZE, "%s/%s%s", o->dir, file, suffix);
}

static cloth_status file_open(const tool_output *o, const char *file, FILE **out, cloth_error *err)
{
  char part[PATH_SIZE];
  path_of(o, file, ".part", part);
  *out = fopen(part, "w");
  if (!*out) CLOTH_FAIL(err, CLOTH_IO, "cannot write %s: %s", part, strerror(errno));
  return CLOTH_OK;
}

static cloth_status file_close(const tool_output *o, const char *file, FILE *f, cloth_error *err)
{
  char part[PATH_SIZE], whole[PATH_SIZE];
  path_of(o, file, ".part", part);
  path_of(o, file, "", whole);
  int failed = ferror(f);
  errno = failed ? EIO : 0;
  if ((fclose(f) != 0 || failed) || rename(part, whole) != 0) {
    int cause = errno;
    remove(part);
    CLOTH_FAIL(err, CLOTH_IO, "cannot write %s: %s", whole, strerror(cause));
  }
  return CLOTH_OK;
}

// ---- directory ---------------------------------------------------------------------------------

static cloth_status directory_make(const char *dir, cloth_error *err)
{
  char path[PATH_SIZE];
  snprintf(path, sizeof path, "%s", dir);
  for (char *p = path + 1;; p++) {
    if (*p != '/' && *p != '\0') continue;
    char end = *p;
    *p = '\0';
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
      CLOTH_FAIL(err, CLOTH_IO, "--out %s: cannot make %s: %s", dir, path, strerror(errno));
    *p = end;
    if (end == '\0') break;
  }
  struct stat s;
  if (stat(dir, &s) != 0 || !S_ISDIR(s.st_mode))
    CLOTH_FAIL(err, CLOTH_IO, "--out %s is not a directory", dir);
  if (access(dir, W_OK | X_OK) != 0)
    CLOTH_FAIL(err, CLOTH_IO, "--out %s: cannot write there: %s", dir, strerror(errno));
  return CLOTH_OK;
}

// is it a file that an earlier run of this scene wrote?
static bool written_before(const tool_output *o, const char *file)
{
  if (strcmp(file, "report.csv") == 0 || strcmp(file, "report.csv.part") == 0 ||
      strcmp(file, "meshes.csv") == 0)
    return true;
  for (int i = 0; i < o->cloth_count + o->body_count; i++) {
    size_t n = strlen(o->name[i]);
    if (strncmp(file, o->name[i], n) != 0 || file[n] != '_') continue;
    const char *p = file + n + 1;
    while (isdigit((unsigned char)*p)) p++;
    if (p > file + n + 1 && (strcmp(p, ".obj") == 0 || strcmp(p, ".obj.part") == 0)) return true;
  }
  return false;
}

// refuse a directory with something in it; with force remove what an earlier run left there, so
// that its steps do not mix with the new ones
static cloth_status directory_clear(const tool_output *o, bool force, cloth_error *err)
{
  cloth_status status = CLOTH_OK;
  DIR *dir = opendir(o->dir);
  if (!dir) CLOTH_FAIL(err, CLOTH_IO, "cannot read %s: %s", o->dir, strerror(errno));
  for (struct dirent *e; status == CLOTH_OK && (e = readdir(dir)) != NULL;) {
    if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0) continue;
    if (!force) {
      status = cloth_fail(err, CLOTH_BAD_ARGUMENT, __FILE__, __LINE__,
                          "--out %s is not empty ('%s' is in it); name another directory, or add "
                          "--force to replace an earlier run",
                          o->dir, e->d_name);
    } else if (written_before(o, e->d_name)) {
      char path[PATH_SIZE];
      path_of(o, e->d_name, "", path);
      if (remove(path) != 0)
        status = cloth_fail(err, CLOTH_IO, __FILE__, __LINE__, "cannot remove %s: %s", path,
                            strerror(errno));
    }
  }
  closedir(dir);
  return status;
}

// ---- names -------------------------------------------------------------------------------------

// A name of a scene as a file name: links are called "left/finger". Equal ones get their index.
static void names_make(tool_output *o, const cloth_scene *scene)
{
  for (int i = 0; i < o->cloth_count + o->body_count; i++) {
    const char *name =
        i < o->cloth_count ? cloth_name(scene, i) : cloth_body_name(scene, i - o->cloth_count);
    char *out = o->name[i];
    snprintf(out, NAME_SIZE - 16, "%s", name);
    for (char *p = out; *p; p++)
      if (!isalnum((unsigned char)*p) && !strchr("_-.", *p)) *p = '_';
    if (out[0] == '.') out[0] = '_'; // not a hidden file
    for (int k = 0; k < i; k++)
      if (strcmp(o->name[k], out) == 0) {
        snprintf(out + strlen(out), 16, "-%d", i);
        break;
      }
  }
}

// meshes.csv: what each NAME of NAME_STEP.obj is
static cloth_status index_write(const tool_output *o, const cloth_scene *scene, cloth_error *err)
{
  FILE *f;
  CLOTH_TRY(file_open(o, "meshes.csv", &f, err));
  fprintf(f, "kind,file,name\n");
  for (int i = 0; i < o->cloth_count; i++)
    fprintf(f, "cloth,%s,%s\n", o->name[i], cloth_name(scene, i));
  for (int i = 0; i < o->body_count; i++)
    fprintf(f, "body,%s,%s\n", o->name[o->cloth_count + i], cloth_body_name(scene, i));
  return file_close(o, "meshes.csv", f, err);
}

// ---- public ------------------------------------------------------------------------------------

static void output_free(tool_output *o)
{
  free(o->name);
  free(o->position);
  free(o);
}

cloth_status tool_output_new(const char *dir, bool force, const cloth_scene *scene,
                             tool_output **out, cloth_error *err)
{
  cloth_status status;
  tool_output *o = calloc(1, sizeof *o);
  if (!o) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for the output");
  o->cloth_count = cloth_count(scene);
  o->body_count = cloth_body_count(scene);
  size_t vertex_count = 1;
  for (int i = 0; i < o->cloth_count; i++)
    if ((size_t)cloth_vertex_count(scene, i) > vertex_count)
      vertex_count = (size_t)cloth_vertex_count(scene, i);
  o->name = calloc((size_t)(o->cloth_count + o->body_count) + 1, sizeof *o->name);
  o->position = calloc(vertex_count, 3 * sizeof *o->position);
  if (!o->name || !o->position) {
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for the output");
    goto fail;
  }
  o->silent = dir == NULL;
  if (o->silent) {
    status = tool_processes_agree(CLOTH_OK, err);
    if (status == CLOTH_OK)
      *out = o;
    else
      output_free(o);
    return status;
  }
  if (snprintf(o->dir, sizeof o->dir, "%s", dir) >= (int)sizeof o->dir || dir[0] == '\0') {
    status = cloth_fail(err, CLOTH_BAD_ARGUMENT, __FILE__, __LINE__,
                        "--out: the path is empty or too long");
    goto fail;
  }
  names_make(o, scene);
  o->made = access(dir, F_OK) != 0;
  CLOTH_TRY_GOTO(directory_make(dir, err), status, fail);
  CLOTH_TRY_GOTO(directory_clear(o, force, err), status, fail);
  CLOTH_TRY_GOTO(index_write(o, scene, err), status, fail);
  CLOTH_TRY_GOTO(file_open(o, "report.csv", &o->csv, err), status, fail);
  char row[ROW_SIZE];
  cloth_report_csv(NULL, row, sizeof row);
  fprintf(o->csv, "%s\n", row);
  *out = o;
  return tool_processes_agree(CLOTH_OK, err);

fail:
  output_free(o);
  return tool_processes_agree(status, err);
}

// how it went for process 0, which has the files
static cloth_status report_write(tool_output *o, const cloth_step_report *report, cloth_error *err)
{
  if (o->silent) return CLOTH_OK;
  char row[ROW_SIZE];
  cloth_report_csv(report, row, sizeof row);
  // flushed, so that a long run can be watched and a full disk is met at the step it happens
  if (fprintf(o->csv, "%s\n", row) < 0 || fflush(o->csv) != 0)
    CLOTH_FAIL(err, CLOTH_IO, "cannot write %s/report.csv: %s", o->dir, strerror(errno));
  return CLOTH_OK;
}

cloth_status tool_output_report(tool_output *o, const cloth_step_report *report, cloth_error *err)
{
  return tool_processes_agree(report_write(o, report, err), err);
}

static cloth_status mesh_write(const tool_output *o, int i, int64_t step, const double *position,
                               int vertex_count, const int *triangle, int triangle_count,
                               cloth_error *err)
{
  if (o->silent) return CLOTH_OK;
  char file[NAME_SIZE + 32], path[PATH_SIZE];
  snprintf(file, sizeof file, "%s_%06lld.obj", o->name[i], (long long)step);
  path_of(o, file, "", path);
  return cloth_obj_write(path, vertex_count, position, triangle_count, triangle, err);
}

// p + q x q*, q unit
static void pose_apply(const cloth_pose *pose, const double x[3], double out[3])
{
  const double *q = pose->rotation;
  double t[3] = {2 * (q[1] * x[2] - q[2] * x[1]), 2 * (q[2] * x[0] - q[0] * x[2]),
                 2 * (q[0] * x[1] - q[1] * x[0])};
  out[0] = pose->position[0] + x[0] + q[3] * t[0] + q[1] * t[2] - q[2] * t[1];
  out[1] = pose->position[1] + x[1] + q[3] * t[1] + q[2] * t[0] - q[0] * t[2];
  out[2] = pose->position[2] + x[2] + q[3] * t[2] + q[0] * t[1] - q[1] * t[0];
}

static cloth_status body_write(const tool_output *o, const cloth_scene *scene, int body,
                               int64_t step, cloth_error *err)
{
  cloth_mesh_view mesh = cloth_body_mesh(scene, body);
  cloth_pose pose = cloth_body_pose(scene, body);
  double *position = calloc((size_t)mesh.vertex_count + 1, 3 * sizeof *position);
  if (!position) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d vertices", mesh.vertex_count);
  for (int i = 0; i < mesh.vertex_count; i++)
    pose_apply(&pose, mesh.position + 3 * i, position + 3 * i);
  cloth_status status = mesh_write(o, o->cloth_count + body, step, position, mesh.vertex_count,
                                   mesh.triangle, mesh.triangle_count, err);
  free(position);
  return status;
}

cloth_status tool_output_meshes(tool_output *o, cloth_scene *scene, int64_t step, cloth_error *err)
{
  for (int i = 0; i < o->cloth_count; i++) {
    int vertex_count = cloth_vertex_count(scene, i);
    CLOTH_TRY(cloth_positions(scene, i, o->position, vertex_count, err));
    CLOTH_TRY(tool_processes_agree(mesh_write(o, i, step, o->position, vertex_count,
                                              cloth_triangles(scene, i),
                                              cloth_triangle_count(scene, i), err),
                                   err));
  }
  cloth_status status = CLOTH_OK;
  for (int i = 0; i < o->body_count && status == CLOTH_OK; i++)
    status = body_write(o, scene, i, step, err);
  return tool_processes_agree(status, err);
}

cloth_status tool_output_close(tool_output *o, cloth_error *err)
{
  if (!o) return CLOTH_OK;
  cloth_status status = o->silent ? CLOTH_OK : file_close(o, "report.csv", o->csv, err);
  output_free(o);
  return status;
}

void tool_output_abandon(tool_output *o)
{
  if (!o) return;
  char part[PATH_SIZE];
  path_of(o, "report.csv", ".part", part);
  if (!o->silent) {
    fclose(o->csv);
    remove(part);
    path_of(o, "meshes.csv", "", part);
    remove(part);
    if (o->made) rmdir(o->dir);
  }
  output_free(o);
}
