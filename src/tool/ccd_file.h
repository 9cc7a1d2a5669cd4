// Query files of Wang et al. 2021 (A Large Scale Benchmark and an Inclusion-Based Algorithm for
// Continuous Collision Detection): 8 rows a query, each x, y, z as numerator, denominator, and the
// truth. And the exact times of first contact beside some of them (toi_*.json).
#pragma once

#include "cloth.h"

#include <stdbool.h>
#include <stdio.h>

/// One query: four points at the start of the step, then at its end.
typedef struct ccd_query {
  double x[8][3]; // m
  bool truth;     // they meet
  bool rounded;   // some coordinate is no double, such as 1/3: x is within two of its last digits
} ccd_query;

/// A file that is being read.
typedef struct ccd_file {
  const char *path;
  FILE *stream;
  char *text; // the line, of `room` bytes
  size_t room;
  int64_t line, queries; // so far
} ccd_file;

/// CLOTH_BAD_SCENE: cannot be read.
cloth_status ccd_file_open(const char *path, ccd_file *out, cloth_error *err);

/// Read up to `most` queries; *count is 0 at the end. CLOTH_BAD_SCENE with path and line.
cloth_status ccd_file_read(ccd_file *file, int most, ccd_query *out, int *count, cloth_error *err);

/// A zeroed file is allowed.
void ccd_file_close(ccd_file *file);

/// Upper ends of the exact first contacts of the queries of data_NAME.csv, from toi_NAME.json
/// beside it: *hi [*count], infinite where there is none or it is not known; free it. No such file:
/// NULL, 0. CLOTH_BAD_SCENE: it is not a list of null, [lo, hi] and words; CLOTH_NO_MEMORY.
cloth_status ccd_times_read(const char *csv, double **hi, int64_t *count, cloth_error *err);
