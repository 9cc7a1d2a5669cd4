// Tests of src/report.c.
#include "check.h"
#include "report.h"

#include <locale.h>
#include <stdbool.h>

static cloth_step_report sample(void)
{
  cloth_step_report r;
  memset(&r, 0, sizeof r);
  r.step = 12345678901;
  r.time = 0.25;
  r.pcg_iterations = 77;
  r.memory_bytes = 1u << 30;
  r.state_hash = 0x0123456789abcdefu;
  r.ms[CLOTH_STAGE_solve] = 1.5;
  return r;
}

static int field_named(const char *name)
{
  for (int i = 0; i < cloth_report_field_count(); i++)
    if (strcmp(cloth_report_field_name(i), name) == 0) return i;
  return -1;
}

static int fields_are_found_by_name(void)
{
  cloth_step_report r = sample();
  CHECK(cloth_report_field(&r, field_named("step")) == 12345678901.0);
  CHECK(cloth_report_field(&r, field_named("time")) == 0.25);
  CHECK(cloth_report_field(&r, field_named("pcg_iterations")) == 77);
  CHECK(cloth_report_field(&r, field_named("memory_bytes")) == 1073741824.0);
  CHECK(cloth_report_field(&r, field_named("ms_solve")) == 1.5);
  CHECK(cloth_report_field(&r, field_named("ms_pairs")) == 0);
  CHECK(strcmp(cloth_report_field_unit(field_named("time")), "s") == 0);
  CHECK(strcmp(cloth_report_field_unit(field_named("ms_ccd")), "ms") == 0);
  CHECK(field_named("ms_predict") == cloth_report_field_count() - CLOTH_STAGE_COUNT);
  return 0;
}

static int wrong_indices_are_empty_not_a_crash(void)
{
  cloth_step_report r = sample();
  const int wrong[] = {-1, cloth_report_field_count(), 1 << 30};
  for (int i = 0; i < 3; i++) {
    CHECK(cloth_report_field(&r, wrong[i]) == 0);
    CHECK(strcmp(cloth_report_field_name(wrong[i]), "") == 0);
    CHECK(strcmp(cloth_report_field_unit(wrong[i]), "") == 0);
    CHECK(strcmp(cloth_stage_name(wrong[i]), "") == 0);
    CHECK(strcmp(cloth_stage_file(wrong[i]), "") == 0);
  }
  return 0;
}

static int every_stage_has_a_name_and_a_file(void)
{
  CHECK(strcmp(cloth_stage_name(CLOTH_STAGE_assemble), "assemble") == 0);
  for (int i = 0; i < CLOTH_STAGE_COUNT; i++) {
    CHECK(strlen(cloth_stage_name(i)) > 0);
    CHECK(strncmp(cloth_stage_file(i), "src/", 4) == 0);
  }
  return 0;
}

// the n-th cell of a row, or -1
static int cell(const char *row, int n, char *out, size_t size)
{
  for (; n > 0 && row; n--) row = strchr(row, ',') ? strchr(row, ',') + 1 : NULL;
  if (row == NULL) return -1;
  size_t length = strcspn(row, ",");
  snprintf(out, size, "%.*s", (int)length, row);
  return 0;
}

static int csv_has_one_cell_for_each_heading(void)
{
  cloth_step_report r = sample();
  char head[4096], row[4096], name[64], value[64];
  CHECK(cloth_report_csv(NULL, head, sizeof head) == (int)strlen(head));
  CHECK(cloth_report_csv(&r, row, sizeof row) == (int)strlen(row));
  for (int i = 0; i < cloth_report_field_count(); i++) {
    CHECK(cell(head, i, name, sizeof name) == 0 && cell(row, i, value, sizeof value) == 0);
    CHECK(strcmp(name, cloth_report_field_name(i)) == 0);
    if (strcmp(name, "state_hash") == 0)
      CHECK(strcmp(value, "0123456789abcdef") == 0);
    else
      CHECK(strtod(value, NULL) == cloth_report_field(&r, i));
  }
  CHECK(cell(row, cloth_report_field_count(), value, sizeof value) == -1);
  CHECK(strchr(row, '\n') == NULL);
  return 0;
}

static int csv_tells_the_room_it_needs(void)
{
  cloth_step_report r = sample();
  char whole[4096], part[4096];
  int n = cloth_report_csv(&r, whole, sizeof whole);
  CHECK(cloth_report_csv(&r, NULL, 0) == n);
  for (int size = 1; size <= n + 1; size += 7) {
    memset(part, '#', sizeof part);
    CHECK(cloth_report_csv(&r, part, (size_t)size) == n);
    CHECK((int)strlen(part) == size - 1);
    CHECK(strncmp(part, whole, (size_t)size - 1) == 0);
    CHECK(part[size] == '#'); // nothing behind the room
  }
  return 0;
}

// a locale with a decimal comma must not make two columns of one number
static int csv_does_not_follow_the_locale(void)
{
  static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE",
                                      "nl_NL.UTF-8"};
  char c[4096], local[4096];
  cloth_step_report r = sample();
  cloth_report_csv(&r, c, sizeof c);
  bool found = false;
  for (int i = 0; i < 5 && !found; i++) found = setlocale(LC_ALL, names[i]) != NULL;
  if (!found) {
    printf("skip: no locale with a decimal comma is installed\n");
    return 0;
  }
  cloth_report_csv(&r, local, sizeof local);
  setlocale(LC_ALL, "C");
  CHECK(strcmp(c, local) == 0);
  return 0;
}

// doc/report.md has a row for each field, with its unit
static int every_field_is_documented(void)
{
  char path[1024], line[2048];
  snprintf(path, sizeof path, "%s", __FILE__);
  char *end = strstr(path, "test/test_report.c");
  CHECK(end != NULL);
  snprintf(end, sizeof path - (size_t)(end - path), "doc/report.md");
  FILE *f = fopen(path, "r");
  CHECK(f != NULL);
  bool found[256] = {false};
  while (fgets(line, sizeof line, f))
    for (int i = 0; i < cloth_report_field_count(); i++) {
      char start[200];
      snprintf(start, sizeof start, "| `%s` | %s |", cloth_report_field_name(i),
               cloth_report_field_unit(i));
      if (strncmp(line, start, strlen(start)) == 0) found[i] = true;
    }
  fclose(f);
  for (int i = 0; i < cloth_report_field_count(); i++) {
    if (!found[i]) printf("doc/report.md has no row for %s\n", cloth_report_field_name(i));
    CHECK(found[i]);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(fields_are_found_by_name);
  RUN(wrong_indices_are_empty_not_a_crash);
  RUN(every_stage_has_a_name_and_a_file);
  RUN(csv_has_one_cell_for_each_heading);
  RUN(csv_tells_the_room_it_needs);
  RUN(csv_does_not_follow_the_locale);
  RUN(every_field_is_documented);
  return failures != 0;
}
