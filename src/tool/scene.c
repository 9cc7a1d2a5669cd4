// What every subcommand that runs a scene needs: the scene itself, a clock, sizes as text.
#include "tool.h"

#include <string.h>
#include <time.h>

// --set NAME=VALUE
static cloth_status set_pair(cloth_def *def, const char *pair, cloth_error *err)
{
  const char *equals = strchr(pair, '=');
  char name[64];
  if (!equals || equals == pair || (size_t)(equals - pair) >= sizeof name)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--set '%s' is not NAME=VALUE", pair);
  snprintf(name, sizeof name, "%.*s", (int)(equals - pair), pair);
  if (strcmp(name, "mesh_defects") == 0) // the meshes have been read by now
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
               "--set %s comes too late, meshes are judged when the file is read; write it under "
               "'params:' of the scene file",
               pair);
  return cloth_def_set(def, name, equals + 1, err);
}

cloth_status tool_scene_load(const tool_arguments *args, const char *path, cloth_def **out,
                             cloth_error *err)
{
  cloth_load_options options = {.variant = tool_text(args, "variant"),
                                .preset = tool_text(args, "preset")};
  CLOTH_TRY(tool_number(args, "resolution", "1", 0.01, 100, &options.resolution, err));
  return tool_scene_load_with(args, path, &options, out, err);
}

// options that are spent when the file is read
static bool is_for_loading(const char *option)
{
  return strcmp(option, "variant") == 0 || strcmp(option, "preset") == 0 ||
         strcmp(option, "resolution") == 0;
}

cloth_status tool_scene_load_with(const tool_arguments *args, const char *path,
                                  const cloth_load_options *options, cloth_def **out,
                                  cloth_error *err)
{
  cloth_status status;
  *out = NULL;
  status = tool_processes_agree(cloth_def_load_with(path, options, out, err), err);
  if (status != CLOTH_OK) goto fail;
  for (int i = 0; i < args->given_count; i++) {
    const tool_given *given = &args->given[i];
    for (const tool_option *option = tool_scene_options; option->name; option++) {
      if (given->option != option || is_for_loading(option->name)) continue;
      status = strcmp(option->name, "set") == 0
                   ? set_pair(*out, given->value, err)
                   : cloth_def_set(*out, option->name, given->value, err);
      if (status != CLOTH_OK) goto fail;
    }
  }
  CLOTH_TRY_GOTO(tool_processes_join(args, *out, err), status, fail);
  return CLOTH_OK;

fail:
  cloth_def_free(*out);
  *out = NULL;
  return status;
}

double tool_clock(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

const char *tool_bytes(uint64_t bytes, char out[32])
{
  static const char *const unit[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double size = (double)bytes;
  int i = 0;
  while (size >= 1024 && i < 4) size /= 1024, i++;
  snprintf(out, 32, i ? "%.1f %s" : "%.0f %s", size, unit[i]);
  return out;
}
