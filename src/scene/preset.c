// Presets: settings that were measured to go together. Those of config/presets are compiled in, so
// that a name means the same wherever the package is installed; a file works too.
#include "nearest.h"
#include "scene/scene_file.h"

#include <stdlib.h>
#include <string.h>

static const struct {
  const char *name, *text;
} presets[] = {
#include "presets.inl" // made by src/engine.cmake from config/presets/*.yaml
};
enum { PRESET_COUNT = sizeof presets / sizeof presets[0] };

static cloth_status read_preset(cloth_value root, cloth_def *def, cloth_error *err)
{
  static const char *const known[] = {"name", "source", "precision", "params", NULL};
  cloth_value at;
  const char *text;
  CLOTH_TRY(cloth_yaml_mapping(root, known, err));
  if (cloth_yaml_find(root, "precision", &at)) {
    cloth_error cause = {0};
    CLOTH_TRY(cloth_yaml_text(at, &text, err));
    CLOTH_TRY(cloth_yaml_blame(err, at, cloth_def_set(def, "precision", text, &cause), &cause));
  }
  return cloth_yaml_find(root, "params", &at) ? cloth_read_params(at, def, err) : CLOTH_OK;
}

static bool is_file(const char *name)
{
  size_t n = strlen(name);
  return n > 5 && strcmp(name + n - 5, ".yaml") == 0;
}

// a preset that is compiled in, or a file
static cloth_status open_preset(const char *name, const char *beside, cloth_yaml *file,
                                cloth_error *err)
{
  if (is_file(name)) {
    char *path = NULL;
    CLOTH_TRY(cloth_path_beside(beside, name, &path, err));
    cloth_status status = cloth_yaml_open(path, file, err);
    free(path);
    return status;
  }
  const char *best = NULL;
  for (int i = 0; i < PRESET_COUNT; i++) {
    if (strcmp(presets[i].name, name) == 0)
      return cloth_yaml_open_text(name, presets[i].text, file, err);
    cloth_nearest(name, presets[i].name, &best);
  }
  CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
             "no preset '%s'; the nearest is '%s' (or name a file that ends in .yaml)", name, best);
}

cloth_status cloth_preset_apply(const char *name, const char *beside, cloth_def *def,
                                cloth_error *err)
{
  cloth_yaml file = {0};
  cloth_status status = open_preset(name, beside, &file, err);
  if (status == CLOTH_OK) status = read_preset(cloth_yaml_root(&file), def, err);
  cloth_yaml_close(&file);
  return status;
}
