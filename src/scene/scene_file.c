// The top of a scene file: settings, effects, materials, then bodies and cloths.
#include "scene/scene_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// a scalar, or a list of scalars with `separator` between, as one text
static cloth_status join(cloth_value at, const char *separator, char *out, size_t size,
                         cloth_error *err)
{
  const char *text;
  out[0] = '\0';
  if (!cloth_yaml_is_list(at)) {
    CLOTH_TRY(cloth_yaml_text(at, &text, err));
    if (strlen(text) >= size) CLOTH_YAML_FAIL(err, at, "the text is too long");
    snprintf(out, size, "%s", text);
    return CLOTH_OK;
  }
  CLOTH_TRY(cloth_yaml_list(at, 1, -1, err));
  for (int i = 0; i < cloth_yaml_count(at); i++) {
    size_t used = strlen(out);
    CLOTH_TRY(cloth_yaml_text(cloth_yaml_item(at, i), &text, err));
    if (used + strlen(text) + 2 > size) CLOTH_YAML_FAIL(err, at, "the list is too long");
    snprintf(out + used, size - used, "%s%s", i ? separator : "", text);
  }
  return CLOTH_OK;
}

cloth_status cloth_read_setting(cloth_value at, const cloth_param_info *table, void *base,
                                cloth_error *err)
{
  const cloth_param_info *p = table;
  while (p->name && strcmp(p->name, at.key) != 0) p++;
  char *field = (char *)base + p->offset;
  double number[3];
  int whole;
  if (p->name && p->kind == CLOTH_IS_DOUBLE && !cloth_yaml_is_word(at, "real_time")) {
    CLOTH_TRY(cloth_yaml_number(at, p->unit, p->least, p->most, number, err));
    memcpy(field, number, sizeof *number);
    return CLOTH_OK;
  }
  if (p->name && p->kind == CLOTH_IS_INT) {
    CLOTH_TRY(cloth_yaml_int(at, p->unit, (int)p->least, (int)p->most, &whole, err));
    memcpy(field, &whole, sizeof whole);
    return CLOTH_OK;
  }
  if (p->name && p->kind == CLOTH_IS_VECTOR && cloth_yaml_is_list(at)) {
    CLOTH_TRY(cloth_yaml_numbers(at, 3, p->unit, p->most, number, err));
    memcpy(field, number, sizeof number);
    return CLOTH_OK;
  }
  const char *text;
  CLOTH_TRY(cloth_yaml_text(at, &text, err));
  cloth_error cause = {0};
  return cloth_yaml_blame(err, at, cloth_param_set(table, base, at.key, text, &cause), &cause);
}

// Known keys: the names of a table and up to three more words.
static cloth_status check_table_keys(cloth_value at, const cloth_param_info *table,
                                     const char *const *more, cloth_error *err)
{
  const char *known[128];
  int n = 0;
  for (; table->name && n < 120; table++) known[n++] = table->name;
  for (; *more; more++) known[n++] = *more;
  known[n] = NULL;
  return cloth_yaml_mapping(at, known, err);
}

cloth_status cloth_read_params(cloth_value at, cloth_def *def, cloth_error *err)
{
  static const char *const none[] = {NULL};
  CLOTH_TRY(check_table_keys(at, cloth_param_table(), none, err));
  for (int i = 0; i < cloth_yaml_count(at); i++)
    CLOTH_TRY(cloth_read_setting(cloth_yaml_pair(at, i), cloth_param_table(), &def->params, err));
  return CLOTH_OK;
}

static cloth_status read_effects(cloth_value at, cloth_def *def, cloth_error *err)
{
  CLOTH_TRY(cloth_yaml_mapping(at, NULL, err));
  for (int i = 0; i < cloth_yaml_count(at); i++) {
    cloth_value wish = cloth_yaml_pair(at, i);
    const char *text;
    char name[64];
    CLOTH_TRY(cloth_yaml_text(wish, &text, err));
    snprintf(name, sizeof name, "effects.%s", wish.key);
    cloth_error cause = {0};
    CLOTH_TRY(cloth_yaml_blame(err, wish, cloth_def_set(def, name, text, &cause), &cause));
  }
  return CLOTH_OK;
}

// ---- materials ----------------------------------------------------------------------------------

// prose, and what is no single number: scene_material.c
static bool is_other(const char *key)
{
  static const char *const other[] = {"source", "name", "file", "isotropic", "stretching", "bending"};
  for (size_t i = 0; i < sizeof other / sizeof *other; i++)
    if (strcmp(key, other[i]) == 0) return true;
  return false;
}

static cloth_status read_properties(cloth_value at, cloth_material *out, cloth_error *err)
{
  CLOTH_TRY(cloth_read_material_tables(at, out, err));
  for (int i = 0; i < cloth_yaml_count(at); i++) {
    cloth_value property = cloth_yaml_pair(at, i);
    if (is_other(property.key)) continue;
    CLOTH_TRY(cloth_read_setting(property, cloth_material_table(), out, err));
  }
  return CLOTH_OK;
}

static cloth_status read_material_file(cloth_value at, cloth_material *out, cloth_error *err)
{
  static const char *const more[] = {"name", "source", "isotropic", "stretching", "bending", NULL};
  const char *name;
  char *path = NULL;
  CLOTH_TRY(cloth_yaml_text(at, &name, err));
  CLOTH_TRY(cloth_path_beside(at.file->path, name, &path, err));
  cloth_yaml file;
  cloth_error cause = {0};
  cloth_status status = cloth_yaml_open(path, &file, &cause);
  free(path);
  if (status != CLOTH_OK) {
    cloth_yaml_close(&file);
    return cloth_yaml_blame(err, at, status, &cause);
  }
  status = check_table_keys(cloth_yaml_root(&file), cloth_material_table(), more, err);
  if (status == CLOTH_OK) status = read_properties(cloth_yaml_root(&file), out, err);
  cloth_yaml_close(&file);
  return status;
}

cloth_status cloth_read_materials(cloth_value at, cloth_materials *out, cloth_error *err)
{
  static const char *const more[] = {"file", "name", "source", "isotropic", "stretching", "bending", NULL};
  *out = (cloth_materials){0};
  CLOTH_TRY(cloth_yaml_mapping(at, NULL, err));
  int n = cloth_yaml_count(at);
  out->item = calloc((size_t)n + 1, sizeof *out->item);
  if (out->item == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for materials");
  for (int i = 0; i < n; i++) {
    cloth_value entry = cloth_yaml_pair(at, i), file;
    cloth_material m = cloth_material_default();
    CLOTH_TRY(check_table_keys(entry, cloth_material_table(), more, err));
    if (cloth_yaml_find(entry, "file", &file)) CLOTH_TRY(read_material_file(file, &m, err));
    CLOTH_TRY(read_properties(entry, &m, err));
    cloth_error cause = {0};
    CLOTH_TRY(cloth_yaml_blame(err, entry, cloth_material_check(&m, &cause), &cause));
    out->item[out->count++] = (cloth_named_material){entry.key, m};
  }
  return CLOTH_OK;
}

// ---- file ---------------------------------------------------------------------------------------

static cloth_status read_name(cloth_value root, cloth_def *def, cloth_error *err)
{
  cloth_value at;
  const char *text;
  if (!cloth_yaml_find(root, "name", &at)) {
    // the file's name without folder and ending
    const char *slash = strrchr(root.file->path, '/'), *stem = slash ? slash + 1 : root.file->path;
    snprintf(def->name, sizeof def->name, "%.*s", (int)strcspn(stem, "."), stem);
    return CLOTH_OK;
  }
  CLOTH_TRY(cloth_yaml_text(at, &text, err));
  if (strlen(text) >= sizeof def->name)
    CLOTH_YAML_FAIL(err, at, "longer than %zu characters", sizeof def->name - 1);
  snprintf(def->name, sizeof def->name, "%s", text);
  return CLOTH_OK;
}

// before everything that may say otherwise
static cloth_status read_preset(cloth_value root, const char *wanted, cloth_def *def,
                                cloth_error *err)
{
  cloth_value at;
  const char *name;
  if (cloth_yaml_find(root, "preset", &at)) {
    CLOTH_TRY(cloth_yaml_text(at, &name, err));
    if (wanted == NULL) {
      cloth_error cause = {0};
      cloth_status status = cloth_preset_apply(name, root.file->path, def, &cause);
      return cloth_yaml_blame(err, at, status, &cause);
    }
  }
  return wanted ? cloth_preset_apply(wanted, "", def, err) : CLOTH_OK;
}

static cloth_status read_settings(cloth_value root, const char *preset, cloth_def *def,
                                  cloth_error *err)
{
  static const char *const names[] = {"backend", "precision", "devices", "duration"};
  cloth_value at;
  CLOTH_TRY(read_name(root, def, err));
  CLOTH_TRY(read_preset(root, preset, def, err));
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    char text[512];
    if (!cloth_yaml_find(root, names[i], &at)) continue;
    CLOTH_TRY(join(at, ",", text, sizeof text, err));
    cloth_error cause = {0};
    CLOTH_TRY(cloth_yaml_blame(err, at, cloth_def_set(def, names[i], text, &cause), &cause));
  }
  if (cloth_yaml_find(root, "params", &at)) CLOTH_TRY(cloth_read_params(at, def, err));
  if (cloth_yaml_find(root, "effects", &at)) CLOTH_TRY(read_effects(at, def, err));
  return CLOTH_OK;
}

static cloth_status read_things(cloth_value root, const cloth_materials *materials, cloth_def *def,
                                cloth_error *err)
{
  cloth_value at;
  if (cloth_yaml_find(root, "bodies", &at)) {
    CLOTH_TRY(cloth_yaml_list(at, 0, -1, err));
    for (int i = 0; i < cloth_yaml_count(at); i++)
      CLOTH_TRY(cloth_read_body(cloth_yaml_item(at, i), def, err));
  }
  if (cloth_yaml_find(root, "cloths", &at)) {
    CLOTH_TRY(cloth_yaml_list(at, 0, -1, err));
    for (int i = 0; i < cloth_yaml_count(at); i++)
      CLOTH_TRY(cloth_read_cloth(cloth_yaml_item(at, i), materials, def, err));
  }
  return CLOTH_OK;
}

static cloth_status read_scene(cloth_value root, const char *preset, cloth_def *def,
                               cloth_error *err)
{
  static const char *const known[] = {"name",      "preset",  "variables", "variants", "backend",
                                      "precision", "devices", "duration",  "params",   "effects",
                                      "materials", "cloths",  "bodies",    NULL};
  CLOTH_TRY(cloth_yaml_mapping(root, known, err));
  CLOTH_TRY(read_settings(root, preset, def, err));
  cloth_materials materials = {0};
  cloth_value at;
  cloth_status status = CLOTH_OK;
  if (cloth_yaml_find(root, "materials", &at)) status = cloth_read_materials(at, &materials, err);
  if (status == CLOTH_OK) status = read_things(root, &materials, def, err);
  free(materials.item);
  return status;
}

cloth_status cloth_def_load(const char *path, cloth_def **out, cloth_error *err)
{
  return cloth_def_load_with(path, NULL, out, err);
}

cloth_status cloth_def_load_with(const char *path, const cloth_load_options *options,
                                 cloth_def **out, cloth_error *err)
{
  const cloth_load_options none = {0}, *o = options ? options : &none;
  *out = NULL;
  if (o->resolution != 0 && !(o->resolution >= 0.01 && o->resolution <= 100))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "resolution = %g [1] is not in [0.01, 100]", o->resolution);
  cloth_yaml file = {0};
  cloth_def *def;
  CLOTH_TRY(cloth_def_new(&def, err));
  cloth_status status = cloth_yaml_open(path, &file, err);
  if (status == CLOTH_OK) status = cloth_resolve_variables(&file, o->variant, err);
  file.resolution = o->resolution;
  def->path = cloth_string_copy(path);
  if (status == CLOTH_OK && def->path == NULL)
    status = cloth_fail(err, CLOTH_NO_MEMORY, __FILE__, __LINE__, "no memory for '%s'", path);
  if (status == CLOTH_OK) status = read_scene(cloth_yaml_root(&file), o->preset, def, err);
  cloth_yaml_close(&file);
  if (status != CLOTH_OK) {
    cloth_def_free(def);
    return status;
  }
  *out = def;
  return CLOTH_OK;
}
