#include "ccd_file.h"

#include "ccd_fraction.h"
#include "scene/file.h"
#include "scene/list.h"
#include "scene/number.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LINE_FAIL(f, err, ...)                                                                     \
  do {                                                                                             \
    char text_[256];                                                                               \
    snprintf(text_, sizeof text_, __VA_ARGS__);                                                    \
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s:%" PRId64 ": %s", (f)->path, (f)->line, text_);           \
  } while (0)

cloth_status ccd_file_open(const char *path, ccd_file *out, cloth_error *err)
{
  struct stat info;
  *out = (ccd_file){.path = path};
  out->stream = fopen(path, "r");
  if (!out->stream) CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: %s", path, strerror(errno));
  if (fstat(fileno(out->stream), &info) == 0 && S_ISDIR(info.st_mode)) {
    ccd_file_close(out);
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: it is a directory; name the files in it", path);
  }
  return CLOTH_OK;
}

void ccd_file_close(ccd_file *file)
{
  if (file->stream) fclose(file->stream);
  free(file->text);
  *file = (ccd_file){0};
}

// ---- rows --------------------------------------------------------------------------------------

static const char *skip_blanks(const char *at)
{
  while (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n') at++;
  return at;
}

// Seven columns of the present line; false at column *bad, counted from 1.
static bool read_columns(const char *at, ccd_whole column[7], int *bad)
{
  for (int k = 0; k < 7; k++) {
    *bad = k + 1;
    at = ccd_whole_read(skip_blanks(at), &column[k]);
    if (!at) return false;
    at = skip_blanks(at);
    if (*at != (k < 6 ? ',' : '\0')) return false;
    at += k < 6;
  }
  return true;
}

static int count_columns(const char *text)
{
  int n = 1;
  for (; *text; text++) n += *text == ',';
  return n;
}

// The next line that is not blank; *there is false at the end.
static cloth_status next_line(ccd_file *f, bool *there, cloth_error *err)
{
  *there = false;
  errno = 0;
  for (;;) {
    ssize_t length = getline(&f->text, &f->room, f->stream);
    if (length < 0) break;
    f->line++;
    if ((size_t)length != strlen(f->text)) LINE_FAIL(f, err, "a NUL byte; this is no text");
    if (f->line == 1 && strncmp(f->text, "\xef\xbb\xbf", 3) == 0) // byte order mark
      memcpy(f->text, "   ", 3);
    if (*skip_blanks(f->text) == '\0') continue;
    *there = true;
    return CLOTH_OK;
  }
  if (ferror(f->stream) || errno == ENOMEM)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: %s", f->path, strerror(errno));
  return CLOTH_OK;
}

// "column K is 'TEXT'", the text cut short where it is long.
static cloth_status bad_column(ccd_file *f, int column, cloth_error *err)
{
  const char *at = f->text;
  for (int k = 1; k < column; k++) at = strchr(at, ',') + 1;
  at = skip_blanks(at);
  int length = (int)strcspn(at, ",\r\n"), shown;
  while (length > 0 && (at[length - 1] == ' ' || at[length - 1] == '\t')) length--;
  shown = length < 40 ? length : 40;
  LINE_FAIL(f, err, "column %d is '%.*s%s', no whole number of at most %d digits", column, shown,
            at, shown < length ? "..." : "", CCD_DIGITS_MAX);
}

static cloth_status read_row(ccd_file *f, int row, ccd_query *q, cloth_error *err)
{
  ccd_whole column[7];
  int bad;
  if (!read_columns(f->text, column, &bad)) {
    int columns = count_columns(f->text);
    if (columns != 7)
      LINE_FAIL(f, err, "%d columns; there must be 7: xn,xd,yn,yd,zn,zd,truth", columns);
    return bad_column(f, bad, err);
  }
  if (row == 0) q->rounded = false;
  for (int k = 0; k < 3; k++) {
    if (column[2 * k + 1].value == 0) LINE_FAIL(f, err, "column %d: a denominator of 0", 2 * k + 2);
    if (!ccd_fraction(&column[2 * k], &column[2 * k + 1], &q->x[row][k])) q->rounded = true;
    if (!isfinite(q->x[row][k])) LINE_FAIL(f, err, "%c is too large for a double", "xyz"[k]);
  }
  double given = column[6].value;
  if (given != 0 && given != 1) LINE_FAIL(f, err, "the truth %g is neither 0 nor 1", given);
  bool truth = given != 0;
  if (row > 0 && truth != q->truth)
    LINE_FAIL(f, err, "the truth %d differs from the one in row 1 of query %" PRId64, truth,
              f->queries + 1);
  q->truth = truth;
  return CLOTH_OK;
}

cloth_status ccd_file_read(ccd_file *f, int most, ccd_query *out, int *count, cloth_error *err)
{
  for (*count = 0; *count < most; ++*count, f->queries++) {
    for (int row = 0; row < 8; row++) {
      bool there;
      CLOTH_TRY(next_line(f, &there, err));
      if (!there && row == 0) return CLOTH_OK;
      if (!there)
        CLOTH_FAIL(err, CLOTH_BAD_SCENE,
                   "%s:%" PRId64 ": the file ends after row %d of query %" PRId64 "; it has 8 rows",
                   f->path, f->line, row, f->queries + 1);
      CLOTH_TRY(read_row(f, row, &out[*count], err));
    }
  }
  return CLOTH_OK;
}

// ---- exact times -------------------------------------------------------------------------------

// One entry: null, "word", [lo, hi]. Returns what follows, or NULL.
static const char *read_entry(const char *at, double *hi)
{
  double lo;
  *hi = INFINITY;
  if (strncmp(at, "null", 4) == 0) return at + 4;
  if (*at == '"') {
    at = strchr(at + 1, '"');
    return at ? at + 1 : NULL;
  }
  if (*at != '[') return NULL;
  at = cloth_number_read(skip_blanks(at + 1), &lo);
  if (!at || *(at = skip_blanks(at)) != ',') return NULL;
  at = cloth_number_read(skip_blanks(at + 1), hi);
  if (!at || *(at = skip_blanks(at)) != ']' || !(lo <= *hi)) return NULL;
  return at + 1;
}

static cloth_status parse_times(const char *path, const char *at, cloth_doubles *out,
                                cloth_error *err)
{
  double hi;
  at = skip_blanks(at);
  if (*at++ != '[') CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: no list of times begins here", path);
  at = skip_blanks(at);
  if (*at == ']') return CLOTH_OK;
  for (;;) {
    at = read_entry(skip_blanks(at), &hi);
    if (at) at = skip_blanks(at);
    if (!at || (*at != ',' && *at != ']'))
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: entry %zu is not null, a word in quotes, or [lo, hi]",
                 path, out->count + 1);
    if (!cloth_doubles_push(out, hi)) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: no memory", path);
    if (*at++ == ']') return CLOTH_OK;
  }
}

// DIR/data_NAME.csv -> DIR/toi_NAME.json; NULL if it is not called like that, or no memory
static char *times_path(const char *csv)
{
  const char *slash = strrchr(csv, '/'), *name = slash ? slash + 1 : csv;
  size_t length = strlen(name);
  if (length < 9 || strncmp(name, "data_", 5) != 0 || strcmp(name + length - 4, ".csv") != 0)
    return NULL;
  char *path = malloc(strlen(csv) + 8);
  if (path) sprintf(path, "%.*stoi_%.*s.json", (int)(name - csv), csv, (int)(length - 9), name + 5);
  return path;
}

cloth_status ccd_times_read(const char *csv, double **hi, int64_t *count, cloth_error *err)
{
  *hi = NULL, *count = 0;
  cloth_text text = {0};
  cloth_doubles list = {0};
  char *path = times_path(csv);
  if (!path || access(path, F_OK) != 0) {
    free(path);
    return CLOTH_OK;
  }
  cloth_status status = cloth_text_read(path, &text, err);
  if (status == CLOTH_OK) status = parse_times(path, text.data, &list, err);
  free(text.data);
  free(path);
  if (status != CLOTH_OK) {
    free(list.data);
    return status;
  }
  *hi = list.data, *count = (int64_t)list.count;
  return CLOTH_OK;
}
