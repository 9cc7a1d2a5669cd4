// `cloth accuracy`: what accuracy costs. accuracy.c is the command, accuracy_sweep.c the table of
// what is varied, accuracy_run.c one run and its error, accuracy_points.c where material points
// are, accuracy_table.c the CSV file, accuracy_front.c what is read off it.
#pragma once

#include "tool.h"

// ---- accuracy_sweep.c: what is varied ----------------------------------------------------------

enum { SWEEP_SETS = 8 };

/// One run of a scene.
typedef struct sweep_setting {
  const char *varied, *setting;
  double step, resolution;     // factors on the scene's; 0: 1
  const char *set[SWEEP_SETS]; // NAME=VALUE
  const char *preset;
  bool quick; // also with --quick
} sweep_setting;

extern const sweep_setting accuracy_sweep[]; // ends with varied == NULL

/// What errors are measured against, in double with small tolerances: on a finer mesh, and on the
/// mesh of the file; then what shows how far they are from their limit.
typedef struct sweep_references {
  sweep_setting fine, same_mesh;
  const sweep_setting *convergence; // ends with varied == NULL
} sweep_references;

const sweep_references *accuracy_references(bool quick);

// ---- accuracy_table.c: DIR/accuracy.csv --------------------------------------------------------

typedef struct accuracy_row {
#define ACCURACY_TEXT(name, size) char name[size];
#define ACCURACY_NUMBER(name)     double name;
#include "accuracy_columns.inl"
} accuracy_row;

typedef struct accuracy_table {
  int count;
  accuracy_row *row; // [count]
  FILE *file;        // NULL: only read
} accuracy_table;

/// Read a CSV file; a last line without its end does not count. CLOTH_IO: cannot be read, or is not
/// such a file, with its line.
cloth_status accuracy_table_read(const char *path, accuracy_table *out, cloth_error *err);

/// Go on with the rows that are in the file, if there is one, and append to it. CLOTH_IO.
cloth_status accuracy_table_open(const char *path, accuracy_table *out, cloth_error *err);

/// Append, to the file too. CLOTH_IO, CLOTH_NO_MEMORY.
cloth_status accuracy_table_add(accuracy_table *t, const accuracy_row *row, cloth_error *err);

/// The row of a run, or NULL.
const accuracy_row *accuracy_table_find(const accuracy_table *t, const char *scene,
                                        const char *varied, const char *setting);
void accuracy_table_close(accuracy_table *t);

// ---- accuracy_front.c --------------------------------------------------------------------------

/// Print, for every scene of a table, the references' convergence, the Pareto front, and the
/// cheapest setting for 10 %, 1 % and 0.1 %.
typedef enum accuracy_cost { ACCURACY_WALL, ACCURACY_CPU, ACCURACY_WORK } accuracy_cost;
cloth_status accuracy_print(const accuracy_table *t, accuracy_cost cost, cloth_error *err);

// ---- accuracy_points.c -------------------------------------------------------------------------

/// A material point in a mesh.
typedef struct material_point {
  int cloth;
  int vertex[3];
  double weight[3]; // barycentric
} material_point;

/// At most `most` vertices of each cloth, evenly spread over their numbers; *place [*count x 3] m
/// and *cloth [*count] are the caller's to free. CLOTH_NO_MEMORY.
cloth_status accuracy_points_choose(const cloth_scene *scene, int most, int *count, double **place,
                                    int **cloth, cloth_error *err);

/// Where those places lie in the mesh of a scene at t = 0: the closest point of a triangle of the
/// cloth of that number. out [count].
void accuracy_points_locate(const cloth_scene *scene, int count, const double *place,
                            const int *cloth, material_point *out);

/// Diagonal of the largest cloth's box at t = 0 [m].
double accuracy_size(const cloth_scene *scene);

// ---- accuracy_run.c ----------------------------------------------------------------------------

enum { ACCURACY_SAMPLES = 4 }; // times at which errors are measured

/// A scene under study.
typedef struct accuracy_study {
  const tool_arguments *args;
  const char *path, *name;
  char digest[24];
  double time_step, seconds, size; // of the file [s]; simulated [s]; of the cloth [m]
  int vertices;
  int point_count;
  double *place;            // [point_count x 3] m
  int *cloth;               // [point_count]
  double *fine, *same_mesh; // [ACCURACY_SAMPLES x point_count x 3] m, references
} accuracy_study;

/// Load the scene, choose points and times. quick: simulate less. CLOTH_BAD_SCENE, ...
cloth_status accuracy_study_begin(const tool_arguments *args, const char *path, bool quick,
                                  accuracy_study *out, cloth_error *err);
void accuracy_study_end(accuracy_study *s);

/// Is there anything to run? false where it asks for another resolution but the scene has no grid,
/// or for a step longer than the engine takes.
cloth_status accuracy_applies(const accuracy_study *s, const sweep_setting *setting, bool *out,
                              cloth_error *err);

/// Run a setting. positions [ACCURACY_SAMPLES x point_count x 3] m receives the material points.
/// row: all but its errors. *stopped: a signal came, nothing else is filled.
cloth_status accuracy_run(const accuracy_study *s, const sweep_setting *setting, double *positions,
                          accuracy_row *row, bool *stopped, cloth_error *err);

/// Fill the errors of a row.
void accuracy_measure(const accuracy_study *s, const double *positions, accuracy_row *row);

/// The signal that asked to stop, or 0.
int accuracy_stop_signal(void);
void accuracy_catch_signals(void);
