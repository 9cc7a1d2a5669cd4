// The `cloth` command: a table of subcommands (main.c), one file each. A subcommand fills a
// cloth_error and returns an exit code; main() prints the error. This is the only place of the
// engine that prints.
#pragma once

#include "cloth.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/// Exit codes. A run that a signal ended exits with 128 + its number.
enum {
  TOOL_DONE = 0,
  TOOL_FAILED = 1,    // the simulation failed, a replay differs, or a check found something
  TOOL_BAD_INPUT = 2, // usage, a file, a key, a value
};

/// An option of a subcommand; lists end with name == NULL.
typedef struct tool_option {
  const char *name;    // without the dashes
  const char *value;   // what it takes, as the help shows it; NULL: it takes nothing
  const char *meaning; // for the help
} tool_option;

typedef struct tool_arguments tool_arguments;

/// A subcommand.
typedef struct tool_command {
  const char *name;
  const char *operands; // as the help shows them
  int operand_least, operand_most;
  bool takes_scene;                                         // it also takes tool_scene_options
  const tool_option *option;                                // its own options
  const char *meaning;                                      // for the help
  int (*run)(const tool_arguments *args, cloth_error *err); // returns an exit code
} tool_command;

/// An option on the command line.
typedef struct tool_given {
  const tool_option *option;
  const char *value; // NULL for a switch
} tool_given;

/// A command line after parsing; strings belong to argv.
struct tool_arguments {
  const tool_command *command;
  int operand_count, given_count;
  const char **operand; // [operand_count]
  tool_given *given;    // [given_count] in the order they were written
  bool help;            // --help was among them
};

// ---- options.c ---------------------------------------------------------------------------------

/// Options of every subcommand that loads a scene: --backend, --devices, --precision, ...
extern const tool_option tool_scene_options[];

/// Parse what follows the subcommand's name. CLOTH_BAD_ARGUMENT names the option, and the nearest
/// one if it is unknown; CLOTH_NO_MEMORY.
cloth_status tool_parse(const tool_command *command, int argc, char **argv, tool_arguments *out,
                        cloth_error *err);
void tool_arguments_free(tool_arguments *args);

bool tool_has(const tool_arguments *args, const char *option);
/// The last value given, or NULL.
const char *tool_text(const tool_arguments *args, const char *option);
/// Leave *out alone if the option was not given. CLOTH_BAD_ARGUMENT: not a number, out of range.
cloth_status tool_integer(const tool_arguments *args, const char *option, int64_t least,
                          int64_t most, int64_t *out, cloth_error *err);
cloth_status tool_number(const tool_arguments *args, const char *option, const char *unit,
                         double least, double most, double *out, cloth_error *err);

/// Is `name` (nullable) close enough to `wrong` to ask whether it was meant?
bool tool_is_near(const char *wrong, const char *name);

/// The exit code of a refused or failed set-up.
int tool_exit_code(cloth_status status);

// ---- scene.c -----------------------------------------------------------------------------------

/// Load a scene file and apply the scene options of the command line to it.
cloth_status tool_scene_load(const tool_arguments *args, const char *path, cloth_def **out,
                             cloth_error *err);

/// The same with load options of the caller's in place of --preset and --resolution.
cloth_status tool_scene_load_with(const tool_arguments *args, const char *path,
                                  const cloth_load_options *options, cloth_def **out,
                                  cloth_error *err);

// ---- processes.c -------------------------------------------------------------------------------

/// Joins the other processes of `devices: mpi`, where the description says so or --devices does
/// (def NULL: only the latter); every process but the first is silent from then on. Only `cloth
/// run` goes with it.
cloth_status tool_processes_join(const tool_arguments *args, const cloth_def *def,
                                 cloth_error *err);

/// Is it this process that writes and prints?
bool tool_processes_first(void);

/// The first process that failed is how it went for all. `mine` where there is one process.
cloth_status tool_processes_agree(cloth_status mine, cloth_error *err);

/// What the first process says.
cloth_status tool_processes_share(int *value, cloth_error *err);

/// A line of the summary: how many, and how rows travel between them. Nothing for one process.
void tool_processes_print(void);

/// The end, with the exit code of all; `message` for those who could not say it.
int tool_processes_leave(int code, const char *message);

/// Seconds on a clock that only goes forward.
double tool_clock(void);

/// A size in bytes as text, e.g. "1.5 MiB".
const char *tool_bytes(uint64_t bytes, char out[32]);

// ---- the subcommands ---------------------------------------------------------------------------

extern const tool_command tool_links, tool_run, tool_info, tool_replay, tool_bench, tool_params,
    tool_check, tool_ccd, tool_ccd_mesh, tool_accuracy;
