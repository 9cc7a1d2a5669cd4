// The command line: --name value, --name=value, switches and operands in any order; "--" ends
// options.
#include "nearest.h"
#include "tool.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const tool_option tool_scene_options[] = {
    {"variant", "LIST", "variants of the scene file, and VARIABLE=VALUE, e.g. small,speed=4"},
    {"preset", "NAME",
     "fast, balanced, accurate, reference or a YAML file; what the scene says itself wins"},
    {"resolution", "F", "factor on the cells along each side of every grid and tube"},
    {"backend", "NAME", "auto, cpu, cuda or shuffle"},
    {"devices", "LIST", "one device for each part, e.g. cpu,cpu or 0,0; mpi: one for each process"},
    {"precision", "NAME", "float or double"},
    {"threads", "N", "CPU threads; 0 takes what OpenMP finds"},
    {"set", "NAME=VALUE",
     "any parameter (cloth params), or effects.NAME=auto|on|off; may be repeated"},
    {NULL, NULL, NULL},
};

// ---- parsing -----------------------------------------------------------------------------------

// option i of a subcommand: its own, then those of scenes
static const tool_option *option_at(const tool_command *c, int i)
{
  int own = 0;
  while (c->option[own].name) own++;
  if (i < own) return &c->option[i];
  if (!c->takes_scene || !tool_scene_options[i - own].name) return NULL;
  return &tool_scene_options[i - own];
}

static cloth_status option_find(const tool_command *c, const char *text, size_t length,
                                const tool_option **out, cloth_error *err)
{
  for (int i = 0; (*out = option_at(c, i)) != NULL; i++)
    if (strlen((*out)->name) == length && strncmp((*out)->name, text, length) == 0) return CLOTH_OK;

  char wrong[64];
  const char *nearest = NULL;
  snprintf(wrong, sizeof wrong, "%.*s", (int)(length < 60 ? length : 60), text);
  for (int i = 0; option_at(c, i); i++) cloth_nearest(wrong, option_at(c, i)->name, &nearest);
  if (tool_is_near(wrong, nearest))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "unknown option --%s; did you mean --%s?", wrong, nearest);
  CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "unknown option --%s (cloth %s --help lists them)", wrong,
             c->name);
}

// argv[*i] is an option; moves *i over its value
static cloth_status parse_option(tool_arguments *args, int argc, char **argv, int *i,
                                 cloth_error *err)
{
  const char *text = argv[*i] + 2;
  const char *equals = strchr(text, '=');
  const tool_option *option;
  CLOTH_TRY(option_find(args->command, text, equals ? (size_t)(equals - text) : strlen(text),
                        &option, err));
  tool_given *given = &args->given[args->given_count++];
  given->option = option;
  if (!option->value) {
    if (equals)
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--%s takes no value, got '%s'", option->name,
                 equals + 1);
    return CLOTH_OK;
  }
  if (equals)
    given->value = equals + 1;
  else if (*i + 1 < argc && strncmp(argv[*i + 1], "--", 2) != 0)
    given->value = argv[++*i];
  else
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--%s needs a value: --%s %s", option->name, option->name,
               option->value);
  return CLOTH_OK;
}

cloth_status tool_parse(const tool_command *command, int argc, char **argv, tool_arguments *out,
                        cloth_error *err)
{
  *out = (tool_arguments){.command = command};
  out->operand = calloc((size_t)argc + 1, sizeof *out->operand);
  out->given = calloc((size_t)argc + 1, sizeof *out->given);
  if (!out->operand || !out->given)
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d arguments", argc);

  bool options = true;
  for (int i = 0; i < argc; i++) {
    if (options && strcmp(argv[i], "--") == 0)
      options = false;
    else if (options && (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0))
      out->help = true;
    else if (options && strncmp(argv[i], "--", 2) == 0)
      CLOTH_TRY(parse_option(out, argc, argv, &i, err));
    else if (options && argv[i][0] == '-' && argv[i][1] != '\0')
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "unknown option %s (cloth %s --help lists them)", argv[i],
                 command->name);
    else
      out->operand[out->operand_count++] = argv[i];
  }
  if (out->help) return CLOTH_OK;

  if (out->operand_count < command->operand_least)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "too few arguments; usage: cloth %s %s [options]",
               command->name, command->operands);
  if (out->operand_count > command->operand_most)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
               "too many arguments, '%s' is one; usage: cloth %s %s [options]",
               out->operand[command->operand_most], command->name, command->operands);
  return CLOTH_OK;
}

void tool_arguments_free(tool_arguments *args)
{
  free(args->operand);
  free(args->given);
  *args = (tool_arguments){0};
}

bool tool_is_near(const char *wrong, const char *name)
{
  // more than a third of the letters wrong is another word, not a slip
  return name && cloth_edit_distance(wrong, name) <= 1 + (int)strlen(wrong) / 3;
}

// ---- values ------------------------------------------------------------------------------------

static const tool_given *last_given(const tool_arguments *args, const char *option)
{
  for (int i = args->given_count - 1; i >= 0; i--)
    if (strcmp(args->given[i].option->name, option) == 0) return &args->given[i];
  return NULL;
}

bool tool_has(const tool_arguments *args, const char *option)
{
  return last_given(args, option) != NULL;
}

const char *tool_text(const tool_arguments *args, const char *option)
{
  const tool_given *given = last_given(args, option);
  return given ? given->value : NULL;
}

cloth_status tool_integer(const tool_arguments *args, const char *option, int64_t least,
                          int64_t most, int64_t *out, cloth_error *err)
{
  const char *text = tool_text(args, option);
  if (!text) return CLOTH_OK;
  char *end;
  errno = 0;
  long long value = strtoll(text, &end, 10);
  if (end == text || *end != '\0')
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--%s '%s' is not a whole number in [%lld, %lld]", option,
               text, (long long)least, (long long)most);
  if (errno == ERANGE || value < least || value > most)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--%s %s is out of range [%lld, %lld]", option, text,
               (long long)least, (long long)most);
  *out = value;
  return CLOTH_OK;
}

cloth_status tool_number(const tool_arguments *args, const char *option, const char *unit,
                         double least, double most, double *out, cloth_error *err)
{
  const char *text = tool_text(args, option);
  if (!text) return CLOTH_OK;
  char *end;
  double value = strtod(text, &end);
  if (end == text || *end != '\0')
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--%s '%s' is not a number [%s] in [%g, %g]", option, text,
               unit, least, most);
  if (!(value >= least && value <= most)) // NaN too
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "--%s %s [%s] is not in [%g, %g]", option, text, unit,
               least, most);
  *out = value;
  return CLOTH_OK;
}

int tool_exit_code(cloth_status status)
{
  switch (status) {
  case CLOTH_OK:
    return TOOL_DONE;
  case CLOTH_BAD_ARGUMENT:
  case CLOTH_BAD_SCENE:
  case CLOTH_UNSUPPORTED:
  case CLOTH_BAD_STATE:
  case CLOTH_IO:
    return TOOL_BAD_INPUT;
  case CLOTH_UNSTABLE:
  case CLOTH_NO_MEMORY:
  case CLOTH_DEVICE_LOST:
  case CLOTH_INTERNAL:
    break;
  }
  return TOOL_FAILED;
}
