// cloth params: the tables of parameters and of fabric properties, in Markdown, as README.md and
// doc/materials.md show them.
#include "tool.h"

#include <string.h>

static const tool_option options[] = {
    {"material", NULL, "the properties of a fabric instead"},
    {NULL, NULL, NULL},
};

static void print_default(const cloth_param_info *p)
{
  if (p->kind == CLOTH_IS_CHOICE) {
    int length;
    const char *word = cloth_param_choice(p, (int)p->value[0], &length);
    printf("%.*s", length, word);
    return;
  }
  int count = p->kind == CLOTH_IS_VECTOR ? 3 : 1;
  for (int i = 0; i < count; i++) printf(i ? " %.6g" : "%.6g", p->value[i]);
}

static void print_range(const cloth_param_info *p)
{
  if (p->kind != CLOTH_IS_CHOICE) {
    printf("%.6g to %.6g", p->least, p->most);
    return;
  }
  for (const char *word = p->choices; *word;) {
    int length = (int)strcspn(word, "|");
    printf(word == p->choices ? "%.*s" : ", %.*s", length, word);
    word += length;
    if (*word == '|') word++;
  }
}

static int params_main(const tool_arguments *args, cloth_error *err)
{
  (void)err;
  const cloth_param_info *p =
      tool_has(args, "material") ? cloth_material_table() : cloth_param_table();
  printf("| name | default | unit | range | meaning |\n|---|---|---|---|---|\n");
  for (; p->name; p++) {
    printf("| `%s` | ", p->name);
    print_default(p);
    printf(" | %s | ", p->kind == CLOTH_IS_CHOICE ? "" : p->unit);
    print_range(p);
    printf(" | %s |\n", p->meaning);
  }
  return TOOL_DONE;
}

const tool_command tool_params = {
    "params", "", 0, 0, false, options, "the table of parameters, in Markdown", params_main};
