// accuracy.csv: read, go on, append. The list of columns is accuracy_columns.inl.
#include "accuracy.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct column {
  const char *name;
  size_t offset, size; // size 0: a number
} column;

static const column columns[] = {
#define ACCURACY_TEXT(name, size) {#name, offsetof(accuracy_row, name), size},
#define ACCURACY_NUMBER(name)     {#name, offsetof(accuracy_row, name), 0},
#include "accuracy_columns.inl"
};
enum { COLUMNS = sizeof columns / sizeof columns[0], LINE_SIZE = 4096 };

// ---- writing -----------------------------------------------------------------------------------

static void print_heading(FILE *out)
{
  for (int i = 0; i < COLUMNS; i++) fprintf(out, i ? ",%s" : "%s", columns[i].name);
  fputc('\n', out);
}

static void print_row(FILE *out, const accuracy_row *row)
{
  for (int i = 0; i < COLUMNS; i++) {
    const char *at = (const char *)row + columns[i].offset;
    double number = 0;
    if (i) fputc(',', out);
    if (columns[i].size == 0) memcpy(&number, at, sizeof number);
    if (columns[i].size > 0)
      fputs(at, out);
    else
      fprintf(out, "%.9g", number);
  }
  fputc('\n', out);
}

// ---- reading -----------------------------------------------------------------------------------

static bool read_row(char *line, accuracy_row *row)
{
  *row = (accuracy_row){0};
  for (int i = 0; i < COLUMNS; i++) {
    char *word = strsep(&line, ","), *end;
    if (!word) return false;
    char *at = (char *)row + columns[i].offset;
    if (columns[i].size > 0) {
      if (strlen(word) >= columns[i].size) return false;
      memcpy(at, word, strlen(word) + 1);
      continue;
    }
    double number = strtod(word, &end);
    if (end == word || *end != '\0') return false;
    memcpy(at, &number, sizeof number);
  }
  return line == NULL;
}

static cloth_status keep(accuracy_table *t, const accuracy_row *row, cloth_error *err)
{
  if ((t->count & (t->count - 1)) == 0) { // grows at powers of two
    void *grown = realloc(t->row, sizeof *t->row * (t->count ? 2 * (size_t)t->count : 1));
    if (!grown) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d rows", t->count + 1);
    t->row = grown;
  }
  t->row[t->count++] = *row;
  return CLOTH_OK;
}

static cloth_status read_lines(FILE *in, const char *path, accuracy_table *t, cloth_error *err)
{
  char line[LINE_SIZE], heading[LINE_SIZE] = "";
  for (int i = 0; i < COLUMNS; i++) {
    size_t used = strlen(heading);
    snprintf(heading + used, sizeof heading - used, i ? ",%s" : "%s", columns[i].name);
  }
  for (int number = 1; fgets(line, sizeof line, in); number++) {
    size_t n = strlen(line);
    accuracy_row row;
    if (line[n - 1] != '\n') return CLOTH_OK; // cut off while it was written
    line[n - 1] = '\0';
    if (number == 1 && strcmp(line, heading) != 0)
      CLOTH_FAIL(err, CLOTH_IO, "%s:1: not the heading of an accuracy.csv of this version", path);
    if (number == 1) continue;
    if (!read_row(line, &row))
      CLOTH_FAIL(err, CLOTH_IO, "%s:%d: not a row of %d columns as in the heading", path, number,
                 (int)COLUMNS);
    CLOTH_TRY(keep(t, &row, err));
  }
  if (ferror(in)) CLOTH_FAIL(err, CLOTH_IO, "cannot read %s: %s", path, strerror(errno));
  return CLOTH_OK;
}

cloth_status accuracy_table_read(const char *path, accuracy_table *out, cloth_error *err)
{
  *out = (accuracy_table){0};
  FILE *in = fopen(path, "r");
  if (!in) CLOTH_FAIL(err, CLOTH_IO, "cannot read %s: %s", path, strerror(errno));
  cloth_status status = read_lines(in, path, out, err);
  fclose(in);
  return status;
}

cloth_status accuracy_table_open(const char *path, accuracy_table *out, cloth_error *err)
{
  char part[1100];
  *out = (accuracy_table){0};
  if (access(path, F_OK) == 0) CLOTH_TRY(accuracy_table_read(path, out, err));
  // written anew, so that half a line is gone
  snprintf(part, sizeof part, "%s.part", path);
  out->file = fopen(part, "w");
  if (!out->file) CLOTH_FAIL(err, CLOTH_IO, "cannot write %s: %s", part, strerror(errno));
  print_heading(out->file);
  for (int i = 0; i < out->count; i++) print_row(out->file, &out->row[i]);
  if (fflush(out->file) != 0 || rename(part, path) != 0)
    CLOTH_FAIL(err, CLOTH_IO, "cannot write %s: %s", path, strerror(errno));
  return CLOTH_OK;
}

cloth_status accuracy_table_add(accuracy_table *t, const accuracy_row *row, cloth_error *err)
{
  CLOTH_TRY(keep(t, row, err));
  print_row(t->file, row);
  if (fflush(t->file) != 0)
    CLOTH_FAIL(err, CLOTH_IO, "cannot write accuracy.csv: %s", strerror(errno));
  return CLOTH_OK;
}

const accuracy_row *accuracy_table_find(const accuracy_table *t, const char *scene,
                                        const char *varied, const char *setting)
{
  for (int i = 0; i < t->count; i++)
    if (strcmp(t->row[i].scene, scene) == 0 && strcmp(t->row[i].varied, varied) == 0 &&
        strcmp(t->row[i].setting, setting) == 0)
      return &t->row[i];
  return NULL;
}

void accuracy_table_close(accuracy_table *t)
{
  if (t->file) fclose(t->file);
  free(t->row);
  *t = (accuracy_table){0};
}
