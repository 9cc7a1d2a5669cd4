// What a step says about itself; the list is report.inl, the stages are stages.inl.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum cloth_stage {
#define CLOTH_STAGE(name, file, meaning) CLOTH_STAGE_##name,
#include "stages.inl"
  CLOTH_STAGE_COUNT
} cloth_stage;

typedef struct cloth_step_report {
#define CLOTH_REPORT(type, name, unit, meaning) type name;
#include "report.inl"
  double ms[CLOTH_STAGE_COUNT]; // wall time of each stage
} cloth_step_report;

/// Name of a stage, and the file that holds it.
const char *cloth_stage_name(int stage);
const char *cloth_stage_file(int stage);

/// One field of the report as a number, for CSV and ROS: 0 <= field < cloth_report_field_count(); the
/// stage times come last as ms_<stage>. 64-bit integers above 2^53 do not fit: use the struct.
int cloth_report_field_count(void);
const char *cloth_report_field_name(int field);
const char *cloth_report_field_unit(int field);
double cloth_report_field(const cloth_step_report *report, int field);

/// Write one CSV row (or the heading when report is NULL) without line end. Hashes are hexadecimal.
/// Returns the length that was needed, like snprintf.
int cloth_report_csv(const cloth_step_report *report, char *out, size_t size);

#ifdef __cplusplus
}
#endif
