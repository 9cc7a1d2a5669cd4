// `variables:` and `variants:` of a scene file: a plain $NAME anywhere in the file stands for a
// variable's value, as a YAML alias would.
#include "nearest.h"
#include "scene/scene_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_reference(const yaml_node_t *node)
{
  return node->type == YAML_SCALAR_NODE && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE &&
         node->data.scalar.length > 1 && node->data.scalar.value[0] == '$';
}

static int node_index(const cloth_yaml *file, const yaml_node_t *node)
{
  return (int)(node - file->document.nodes.start) + 1;
}

// ---- values -------------------------------------------------------------------------------------

// the place in `variables` where the node of a variable's value is written; NULL: no such variable
static int *slot_of(cloth_value variables, const char *name)
{
  int n = variables.node ? cloth_yaml_count(variables) : 0;
  for (int i = 0; i < n; i++)
    if (strcmp(cloth_yaml_pair(variables, i).key, name) == 0)
      return &variables.node->data.mapping.pairs.start[i].value;
  return NULL;
}

// what may have been meant, for the end of a message
static const char *hint(cloth_value mapping, const char *name, char out[96])
{
  const char *best = NULL;
  int n = mapping.node ? cloth_yaml_count(mapping) : 0;
  for (int i = 0; i < n; i++) cloth_nearest(name, cloth_yaml_pair(mapping, i).key, &best);
  snprintf(out, 96, best ? "the nearest is '%.60s'" : "the file has none", best);
  return out;
}

static cloth_status check_values(cloth_value variables, cloth_error *err)
{
  CLOTH_TRY(cloth_yaml_mapping(variables, NULL, err));
  for (int i = 0; i < cloth_yaml_count(variables); i++) {
    cloth_value value = cloth_yaml_pair(variables, i);
    if (is_reference(value.node))
      CLOTH_YAML_FAIL(err, value, "a variable's value cannot be another variable");
  }
  return CLOTH_OK;
}

// every variant, whether it is asked for or not: does it speak of variables that are there?
static cloth_status check_variants(cloth_value variants, cloth_value variables, cloth_error *err)
{
  char text[96];
  CLOTH_TRY(cloth_yaml_mapping(variants, NULL, err));
  for (int i = 0; i < cloth_yaml_count(variants); i++) {
    cloth_value variant = cloth_yaml_pair(variants, i);
    CLOTH_TRY(check_values(variant, err));
    for (int k = 0; k < cloth_yaml_count(variant); k++) {
      cloth_value value = cloth_yaml_pair(variant, k);
      if (slot_of(variables, value.key) == NULL)
        CLOTH_YAML_FAIL(err, value, "no such variable; %s", hint(variables, value.key, text));
    }
  }
  return CLOTH_OK;
}

// the values that a variant gives become those of the variables
static void apply_variant(cloth_value variant, cloth_value variables)
{
  for (int i = 0; i < cloth_yaml_count(variant); i++) {
    cloth_value value = cloth_yaml_pair(variant, i);
    *slot_of(variables, value.key) = node_index(variant.file, value.node);
  }
}

// NAME=VALUE
static cloth_status apply_value(char *word, cloth_value root, cloth_value variables,
                                cloth_error *err)
{
  char *value = strchr(word, '='), text[96];
  *value++ = '\0';
  int *slot = slot_of(variables, word);
  if (slot == NULL)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: no variable '%s'; %s", root.file->path, word,
               hint(variables, word, text));
  int node = yaml_document_add_scalar(&root.file->document, NULL, (yaml_char_t *)value, -1,
                                      YAML_PLAIN_SCALAR_STYLE);
  if (node == 0) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for variable '%s'", word);
  *slot = node;
  return CLOTH_OK;
}

static cloth_status apply_word(char *word, cloth_value root, cloth_error *err)
{
  cloth_value variables = {.node = NULL}, variants = {.node = NULL}, variant;
  char text[96];
  if (!cloth_yaml_find(root, "variables", &variables)) variables.node = NULL;
  if (!cloth_yaml_find(root, "variants", &variants)) variants.node = NULL;
  if (strchr(word, '=')) return apply_value(word, root, variables, err);
  if (variants.node == NULL || !cloth_yaml_find(variants, word, &variant))
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: no variant '%s'; %s", root.file->path, word,
               hint(variants, word, text));
  apply_variant(variant, variables);
  return CLOTH_OK;
}

// ---- references ---------------------------------------------------------------------------------

// *index: of a node in the document; led on to the variable's value if the node names one
static cloth_status resolve(cloth_value root, cloth_value variables, int *index, cloth_error *err)
{
  yaml_node_t *node = yaml_document_get_node(&root.file->document, *index);
  if (node == NULL || !is_reference(node)) return CLOTH_OK;
  const char *name = (const char *)node->data.scalar.value + 1;
  const int *slot = slot_of(variables, name);
  cloth_value at = {root.file, node, NULL};
  char text[96];
  if (slot == NULL)
    CLOTH_YAML_FAIL(err, at, "'$%s': no such variable; %s", name, hint(variables, name, text));
  *index = *slot;
  return CLOTH_OK;
}

static cloth_status resolve_all(cloth_value root, cloth_error *err)
{
  const yaml_document_t *document = &root.file->document;
  cloth_value variables;
  if (!cloth_yaml_find(root, "variables", &variables)) variables.node = NULL;
  for (yaml_node_t *n = document->nodes.start; n < document->nodes.top; n++) {
    if (n->type == YAML_SEQUENCE_NODE)
      for (int *i = n->data.sequence.items.start; i < n->data.sequence.items.top; i++)
        CLOTH_TRY(resolve(root, variables, i, err));
    if (n->type == YAML_MAPPING_NODE)
      for (yaml_node_pair_t *p = n->data.mapping.pairs.start; p < n->data.mapping.pairs.top; p++)
        CLOTH_TRY(resolve(root, variables, &p->value, err));
  }
  return CLOTH_OK;
}

cloth_status cloth_resolve_variables(cloth_yaml *file, const char *variant, cloth_error *err)
{
  cloth_value root = cloth_yaml_root(file), variables = {.node = NULL}, variants;
  if (!cloth_yaml_find(root, "variables", &variables)) variables.node = NULL;
  if (variables.node) CLOTH_TRY(check_values(variables, err));
  if (cloth_yaml_find(root, "variants", &variants))
    CLOTH_TRY(check_variants(variants, variables, err));
  char *words = cloth_string_copy(variant ? variant : ""), *rest = words;
  if (words == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for variant '%s'", variant);
  cloth_status status = CLOTH_OK;
  while (status == CLOTH_OK && rest && *rest) {
    char *word = rest;
    rest = strchr(rest, ',');
    if (rest) *rest++ = '\0';
    status = apply_word(word, cloth_yaml_root(file), err);
  }
  free(words);
  return status == CLOTH_OK ? resolve_all(cloth_yaml_root(file), err) : status;
}
