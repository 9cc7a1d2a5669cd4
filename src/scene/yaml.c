#include "scene/yaml.h"

#include "nearest.h"
#include "scene/number.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- file ---------------------------------------------------------------------------------------

static cloth_status parse_failed(const cloth_yaml *file, const yaml_parser_t *p, cloth_error *err)
{
  if (p->error == YAML_MEMORY_ERROR)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: no memory to read it", file->path);
  size_t line = p->problem_mark.line + 1;
  if (p->error == YAML_READER_ERROR) { // knows the byte only
    line = 1;
    for (size_t i = 0; i < p->problem_offset && i < file->text.size; i++)
      line += file->text.data[i] == '\n';
  }
  CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s:%zu: not YAML: %s%s%s", file->path, line,
             p->problem ? p->problem : "cannot be read", p->context ? ", " : "",
             p->context ? p->context : "");
}

static cloth_status load_only_document(cloth_yaml *file, yaml_parser_t *p, cloth_error *err)
{
  if (!yaml_parser_load(p, &file->document)) {
    file->document = (yaml_document_t){0};
    return parse_failed(file, p, err);
  }
  if (yaml_document_get_root_node(&file->document) == NULL)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s:1: the file is empty", file->path);

  yaml_document_t second;
  if (!yaml_parser_load(p, &second)) return parse_failed(file, p, err);
  const yaml_node_t *root = yaml_document_get_root_node(&second);
  size_t line = root ? root->start_mark.line + 1 : 0;
  yaml_document_delete(&second);
  if (line > 0)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s:%zu: a second document begins; one file is one document",
               file->path, line);
  return CLOTH_OK;
}

// JSON is YAML, but for the comments that some programs write into it: lines that begin with //
static void blank_comments(const char *path, char *text, size_t size)
{
  size_t length = strlen(path);
  if (length < 5 || strcmp(path + length - 5, ".json") != 0) return;
  for (size_t i = 0, start = 1; i < size; i++) {
    if (start && text[i] == '/' && i + 1 < size && text[i + 1] == '/')
      for (; i < size && text[i] != '\n'; i++) text[i] = ' ';
    if (i < size) start = text[i] == '\n' || (start && (text[i] == ' ' || text[i] == '\t'));
  }
}

static cloth_status parse_text(cloth_yaml *out, cloth_error *err)
{
  yaml_parser_t parser;
  if (!yaml_parser_initialize(&parser))
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: no memory to read it", out->path);
  yaml_parser_set_input_string(&parser, (const unsigned char *)out->text.data, out->text.size);
  cloth_status status = load_only_document(out, &parser, err);
  yaml_parser_delete(&parser);
  return status;
}

cloth_status cloth_yaml_open(const char *path, cloth_yaml *out, cloth_error *err)
{
  *out = (cloth_yaml){.path = cloth_string_copy(path)};
  if (out->path == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: no memory to read it", path);
  CLOTH_TRY(cloth_text_read(path, &out->text, err));
  blank_comments(path, out->text.data, out->text.size);
  return parse_text(out, err);
}

cloth_status cloth_yaml_open_text(const char *name, const char *text, cloth_yaml *out,
                                  cloth_error *err)
{
  *out = (cloth_yaml){.path = cloth_string_copy(name)};
  out->text = (cloth_text){cloth_string_copy(text), strlen(text)};
  if (out->path == NULL || out->text.data == NULL)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: no memory to read it", name);
  return parse_text(out, err);
}

void cloth_yaml_close(cloth_yaml *file)
{
  yaml_document_delete(&file->document);
  free(file->text.data);
  free(file->path);
  *file = (cloth_yaml){0};
}

cloth_value cloth_yaml_root(cloth_yaml *file)
{
  return (cloth_value){file, yaml_document_get_root_node(&file->document), NULL};
}

// ---- messages -----------------------------------------------------------------------------------

cloth_status cloth_yaml_fail(cloth_error *err, const char *file, int line, cloth_value at,
                             const char *format, ...)
{
  char text[400];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  size_t where = at.node->start_mark.line + 1;
  if (at.key == NULL)
    return cloth_fail(err, CLOTH_BAD_SCENE, file, line, "%s:%zu: %s", at.file->path, where, text);
  return cloth_fail(err, CLOTH_BAD_SCENE, file, line, "%s:%zu: key '%s': %s", at.file->path, where,
                    at.key, text);
}

cloth_status cloth_yaml_blame(cloth_error *err, cloth_value at, cloth_status status,
                              const cloth_error *cause)
{
  if (status == CLOTH_OK) return CLOTH_OK;
  if (status < CLOTH_OK)
    return cloth_fail(err, status, cause->file, cause->line, "%s", cause->text);
  return cloth_yaml_fail(err, cause->file, cause->line, at, "%s", cause->text);
}

static const char *scalar_text(const yaml_node_t *node)
{
  return (const char *)node->data.scalar.value;
}

// what a value is, for "expected ..., found ..."
static void describe(cloth_value at, char *out, size_t size)
{
  if (at.node->type == YAML_MAPPING_NODE)
    snprintf(out, size, "a mapping");
  else if (at.node->type == YAML_SEQUENCE_NODE)
    snprintf(out, size, "a list of %d", cloth_yaml_count(at));
  else if (at.node->type == YAML_SCALAR_NODE && at.node->data.scalar.length == 0)
    snprintf(out, size, "nothing");
  else if (at.node->type == YAML_SCALAR_NODE)
    snprintf(out, size, "'%.60s'", scalar_text(at.node));
  else
    snprintf(out, size, "nothing");
}

// ---- shapes -------------------------------------------------------------------------------------

bool cloth_yaml_is_word(cloth_value at, const char *word)
{
  return at.node->type == YAML_SCALAR_NODE && strcmp(scalar_text(at.node), word) == 0;
}

bool cloth_yaml_is_mapping(cloth_value at) { return at.node->type == YAML_MAPPING_NODE; }

bool cloth_yaml_is_list(cloth_value at) { return at.node->type == YAML_SEQUENCE_NODE; }

int cloth_yaml_count(cloth_value at)
{
  if (cloth_yaml_is_mapping(at))
    return (int)(at.node->data.mapping.pairs.top - at.node->data.mapping.pairs.start);
  if (cloth_yaml_is_list(at))
    return (int)(at.node->data.sequence.items.top - at.node->data.sequence.items.start);
  return 0;
}

cloth_value cloth_yaml_item(cloth_value list, int i)
{
  int index = list.node->data.sequence.items.start[i];
  return (cloth_value){list.file, yaml_document_get_node(&list.file->document, index), list.key};
}

static yaml_node_t *key_node(cloth_value mapping, int i)
{
  return yaml_document_get_node(&mapping.file->document,
                                mapping.node->data.mapping.pairs.start[i].key);
}

cloth_value cloth_yaml_pair(cloth_value mapping, int i)
{
  int index = mapping.node->data.mapping.pairs.start[i].value;
  return (cloth_value){mapping.file, yaml_document_get_node(&mapping.file->document, index),
                       scalar_text(key_node(mapping, i))};
}

static cloth_status check_known(cloth_value at, const char *const *known, cloth_error *err)
{
  const char *best = NULL;
  for (; *known; known++) {
    if (strcmp(*known, at.key) == 0) return CLOTH_OK;
    cloth_nearest(at.key, *known, &best);
  }
  CLOTH_YAML_FAIL(err, at, "unknown key; the nearest is '%s'", best);
}

cloth_status cloth_yaml_mapping(cloth_value at, const char *const *known, cloth_error *err)
{
  char found[80];
  describe(at, found, sizeof found);
  if (!cloth_yaml_is_mapping(at))
    CLOTH_YAML_FAIL(err, at, "expected keys with values, found %s", found);
  int n = cloth_yaml_count(at);
  for (int i = 0; i < n; i++) {
    yaml_node_t *key = key_node(at, i);
    cloth_value value = {at.file, key, at.key};
    if (key->type != YAML_SCALAR_NODE || key->data.scalar.length == 0)
      CLOTH_YAML_FAIL(err, value, "a key must be a word");
    value.key = scalar_text(key);
    if (strlen(value.key) != key->data.scalar.length)
      CLOTH_YAML_FAIL(err, value, "a key with a NUL character");
    if (known) CLOTH_TRY(check_known(value, known, err));
    for (int j = 0; j < i; j++)
      if (strcmp(scalar_text(key_node(at, j)), value.key) == 0)
        CLOTH_YAML_FAIL(err, value, "is there twice; first on line %zu",
                        key_node(at, j)->start_mark.line + 1);
  }
  return CLOTH_OK;
}

cloth_status cloth_yaml_list(cloth_value at, int least, int most, cloth_error *err)
{
  char found[80];
  describe(at, found, sizeof found);
  int n = cloth_yaml_count(at);
  if (cloth_yaml_is_list(at) && n >= least && (most < 0 || n <= most)) return CLOTH_OK;
  if (most == least) CLOTH_YAML_FAIL(err, at, "expected a list of %d, found %s", least, found);
  if (most < 0) CLOTH_YAML_FAIL(err, at, "expected a list of at least %d, found %s", least, found);
  CLOTH_YAML_FAIL(err, at, "expected a list of %d to %d, found %s", least, most, found);
}

bool cloth_yaml_find(cloth_value mapping, const char *key, cloth_value *out)
{
  int n = cloth_yaml_is_mapping(mapping) ? cloth_yaml_count(mapping) : 0;
  for (int i = 0; i < n; i++) {
    *out = cloth_yaml_pair(mapping, i);
    if (strcmp(out->key, key) == 0) return true;
  }
  return false;
}

cloth_status cloth_yaml_need(cloth_value mapping, const char *key, cloth_value *out,
                             cloth_error *err)
{
  if (cloth_yaml_find(mapping, key, out)) return CLOTH_OK;
  CLOTH_YAML_FAIL(err, mapping, "'%s' is missing", key);
}

// ---- scalars ------------------------------------------------------------------------------------

cloth_status cloth_yaml_text(cloth_value at, const char **out, cloth_error *err)
{
  char found[80];
  describe(at, found, sizeof found);
  if (at.node->type != YAML_SCALAR_NODE || at.node->data.scalar.length == 0 ||
      strlen(scalar_text(at.node)) != at.node->data.scalar.length)
    CLOTH_YAML_FAIL(err, at, "expected text, found %s", found);
  *out = scalar_text(at.node);
  return CLOTH_OK;
}

static bool is_number(cloth_value at, double *out)
{
  return at.node->type == YAML_SCALAR_NODE && cloth_number_parse(scalar_text(at.node), out);
}

cloth_status cloth_yaml_number(cloth_value at, const char *unit, double least, double most,
                               double *out, cloth_error *err)
{
  char found[80];
  double value;
  describe(at, found, sizeof found);
  if (!is_number(at, &value))
    CLOTH_YAML_FAIL(err, at, "expected a number [%s] in [%g, %g], found %s", unit, least, most,
                    found);
  if (!(value >= least && value <= most))
    CLOTH_YAML_FAIL(err, at, "%g [%s] is not in [%g, %g]", value, unit, least, most);
  *out = value;
  return CLOTH_OK;
}

cloth_status cloth_yaml_int(cloth_value at, const char *unit, int least, int most, int *out,
                            cloth_error *err)
{
  char found[80];
  int value;
  double number;
  describe(at, found, sizeof found);
  if (is_number(at, &number) && !(number >= least && number <= most))
    CLOTH_YAML_FAIL(err, at, "%g [%s] is not in [%d, %d]", number, unit, least, most);
  if (at.node->type != YAML_SCALAR_NODE || !cloth_integer_parse(scalar_text(at.node), &value))
    CLOTH_YAML_FAIL(err, at, "expected a whole number [%s] in [%d, %d], found %s", unit, least,
                    most, found);
  *out = value;
  return CLOTH_OK;
}

cloth_status cloth_yaml_numbers(cloth_value at, int count, const char *unit, double most,
                                double *out, cloth_error *err)
{
  char found[80];
  describe(at, found, sizeof found);
  if (!cloth_yaml_is_list(at) || cloth_yaml_count(at) != count)
    CLOTH_YAML_FAIL(err, at, "expected a list of %d numbers [%s], found %s", count, unit, found);
  for (int i = 0; i < count; i++)
    CLOTH_TRY(cloth_yaml_number(cloth_yaml_item(at, i), unit, -most, most, &out[i], err));
  return CLOTH_OK;
}

cloth_status cloth_yaml_choice(cloth_value at, const char *const *words, int *out, cloth_error *err)
{
  char found[80], list[160] = "";
  const char *best = NULL;
  describe(at, found, sizeof found);
  bool is_text = at.node->type == YAML_SCALAR_NODE;
  for (int i = 0; words[i]; i++) {
    if (is_text && strcmp(words[i], scalar_text(at.node)) == 0) {
      *out = i;
      return CLOTH_OK;
    }
    if (is_text) cloth_nearest(scalar_text(at.node), words[i], &best);
    size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", words[i]);
  }
  if (best == NULL) CLOTH_YAML_FAIL(err, at, "expected one of %s, found %s", list, found);
  CLOTH_YAML_FAIL(err, at, "expected one of %s, found %s; the nearest is '%s'", list, found, best);
}
