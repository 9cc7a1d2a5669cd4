#ifndef _GNU_SOURCE
#define _GNU_SOURCE // newlocale
#endif
#include "report.h"

#include <inttypes.h>
#include <locale.h>
#include <stdbool.h>
#include <stdio.h>

const char *cloth_stage_name(int stage)
{
  static const char *const name[] = {
#define CLOTH_STAGE(name, file, meaning) #name,
#include "stages.inl"
  };
  return stage >= 0 && stage < CLOTH_STAGE_COUNT ? name[stage] : "";
}

const char *cloth_stage_file(int stage)
{
  static const char *const file_of[] = {
#define CLOTH_STAGE(name, file, meaning) file,
#include "stages.inl"
  };
  return stage >= 0 && stage < CLOTH_STAGE_COUNT ? file_of[stage] : "";
}

typedef enum field_kind { FIELD_double, FIELD_int, FIELD_int64_t, FIELD_uint64_t } field_kind;

typedef struct field {
  const char *name, *unit;
  field_kind kind;
  size_t offset; // in cloth_step_report
} field;

static const field fields[] = {
#define CLOTH_REPORT(type, name, unit, meaning)                                                    \
  {#name, unit, FIELD_##type, offsetof(cloth_step_report, name)},
#include "report.inl"
#define CLOTH_STAGE(name, file, meaning)                                                           \
  {"ms_" #name, "ms", FIELD_double,                                                                \
   offsetof(cloth_step_report, ms) + sizeof(double) * CLOTH_STAGE_##name},
#include "stages.inl"
};

enum { FIELD_COUNT = sizeof fields / sizeof fields[0] };

int cloth_report_field_count(void) { return FIELD_COUNT; }

static bool in_range(int i) { return i >= 0 && i < FIELD_COUNT; }

const char *cloth_report_field_name(int i) { return in_range(i) ? fields[i].name : ""; }

const char *cloth_report_field_unit(int i) { return in_range(i) ? fields[i].unit : ""; }

double cloth_report_field(const cloth_step_report *report, int i)
{
  if (!in_range(i)) return 0;
  const void *at = (const char *)report + fields[i].offset;
  switch (fields[i].kind) {
  case FIELD_double:
    return *(const double *)at;
  case FIELD_int:
    return *(const int *)at;
  case FIELD_int64_t:
    return (double)*(const int64_t *)at;
  case FIELD_uint64_t:
    return (double)*(const uint64_t *)at;
  }
  return 0;
}

static int print_field(const cloth_step_report *report, const field *f, char *out, size_t size)
{
  const void *at = (const char *)report + f->offset;
  switch (f->kind) {
  case FIELD_double:
    return snprintf(out, size, "%.12g", *(const double *)at);
  case FIELD_int:
    return snprintf(out, size, "%d", *(const int *)at);
  case FIELD_int64_t:
    return snprintf(out, size, "%" PRId64, *(const int64_t *)at);
  case FIELD_uint64_t:
    // a hash is a bit pattern; the other unsigned fields are numbers
    if (f->offset == offsetof(cloth_step_report, state_hash))
      return snprintf(out, size, "%016" PRIx64, *(const uint64_t *)at);
    return snprintf(out, size, "%" PRIu64, *(const uint64_t *)at);
  }
  return 0;
}

int cloth_report_csv(const cloth_step_report *report, char *out, size_t size)
{
  // a decimal comma would make two columns of one number
  locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  locale_t before = c == (locale_t)0 ? (locale_t)0 : uselocale(c);
  size_t used = 0;
  if (size > 0) out[0] = '\0';
  for (int i = 0; i < FIELD_COUNT; i++) {
    for (int comma = i > 0; comma >= 0; comma--) {
      char *at = used < size ? out + used : NULL;
      size_t left = used < size ? size - used : 0;
      int n = comma    ? snprintf(at, left, ",")
              : report ? print_field(report, &fields[i], at, left)
                       : snprintf(at, left, "%s", fields[i].name);
      used += n > 0 ? (size_t)n : 0;
    }
  }
  if (before != (locale_t)0) uselocale(before);
  if (c != (locale_t)0) freelocale(c);
  return (int)used;
}
