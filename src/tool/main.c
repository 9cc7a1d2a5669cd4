// cloth: the command. The table of subcommands; to add one, write its file and name it here.
#include "nearest.h"
#include "tool.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const tool_command *const commands[] = {
    &tool_run, &tool_info,     &tool_replay, &tool_bench,    &tool_params, &tool_check,
    &tool_ccd, &tool_ccd_mesh, &tool_links,  &tool_accuracy, NULL,
};

static void print_usage(FILE *out)
{
  fprintf(out, "cloth: cloth for robots\n\nusage: cloth COMMAND ...\n\n");
  for (int i = 0; commands[i]; i++)
    fprintf(out, "  %-8s %s\n", commands[i]->name, commands[i]->meaning);
  fprintf(
      out,
      "\n  cloth COMMAND --help   what a command takes\n"
      "  cloth --version        version\n\n"
      "exit codes: 0 done, 1 simulation failed, replay differs or a check found something, 2 bad "
      "input\n");
}

static void print_options(const tool_option *option)
{
  for (; option->name; option++) {
    char left[64];
    snprintf(left, sizeof left, "--%s %s", option->name, option->value ? option->value : "");
    printf("  %-24s %s\n", left, option->meaning);
  }
}

static void print_help(const tool_command *c)
{
  printf("cloth %s: %s\n\nusage: cloth %s %s [options]\n\n", c->name, c->meaning, c->name,
         c->operands);
  print_options(c->option);
  if (c->takes_scene) print_options(tool_scene_options);
  printf("  %-24s %s\n", "--help", "this text");
}

static const tool_command *command_find(const char *name)
{
  for (int i = 0; commands[i]; i++)
    if (strcmp(commands[i]->name, name) == 0) return commands[i];

  const char *nearest = NULL;
  for (int i = 0; commands[i]; i++) cloth_nearest(name, commands[i]->name, &nearest);
  fprintf(stderr, "cloth: unknown command '%s'", name);
  if (tool_is_near(name, nearest)) fprintf(stderr, "; did you mean '%s'?", nearest);
  fprintf(stderr, " (cloth --help lists them)\n");
  return NULL;
}

// main() for a subcommand that exists
static int run_command(const tool_command *command, int argc, char **argv)
{
  cloth_error err = {0};
  tool_arguments args = {0};
  int code;
  cloth_status status = tool_parse(command, argc, argv, &args, &err);
  if (!args.help) { // before anything can be refused that all processes would say
    cloth_status joined = tool_processes_join(&args, NULL, &err);
    if (status == CLOTH_OK) status = joined;
  }
  if (status != CLOTH_OK) {
    code = tool_exit_code(status);
  } else if (args.help) {
    print_help(command);
    code = TOOL_DONE;
  } else {
    code = command->run(&args, &err);
  }

  // output that did not arrive (a full disk behind a redirection) is a failure too
  if (fflush(stdout) != 0 && err.status == CLOTH_OK) {
    code = TOOL_FAILED;
    cloth_fail(&err, CLOTH_IO, __FILE__, __LINE__, "cannot write to the standard output");
  }
  char message[640] = "";
  if (err.status != CLOTH_OK)
    snprintf(message, sizeof message, "cloth %s: %s", command->name, err.text);
  if (err.status != CLOTH_OK) fprintf(stderr, "%s\n", message);
  if (err.status == CLOTH_INTERNAL) fprintf(stderr, "  at %s:%d\n", err.file, err.line);
  tool_arguments_free(&args);
  return tool_processes_leave(code, message);
}

// OpenMP's threads spin for milliseconds while they wait, unless the environment says otherwise
// before the program starts. On a core that somebody else needs too, that makes a step ten times
// slower; to sleep at once makes it 1.4 times slower everywhere. So: look 2000 times (20 to 100
// us), then sleep; and start over with that said.
static void wait_briefly(char **argv)
{
  if (getenv("OMP_WAIT_POLICY") != NULL || getenv("GOMP_SPINCOUNT") != NULL) return;
  if (setenv("OMP_WAIT_POLICY", "passive", 1) != 0 || setenv("GOMP_SPINCOUNT", "2000", 1) != 0)
    return;
  execv("/proc/self/exe", argv); // returns only where there is no /proc: then it spins
}

int main(int argc, char **argv)
{
  wait_briefly(argv);
  if (argc < 2) {
    print_usage(stderr);
    return TOOL_BAD_INPUT;
  }
  if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0) {
    print_usage(stdout);
    return TOOL_DONE;
  }
  if (strcmp(argv[1], "--version") == 0) {
    printf("cloth %s\n", CLOTH_VERSION);
    return TOOL_DONE;
  }
  const tool_command *command = command_find(argv[1]);
  return command ? run_command(command, argc - 2, argv + 2) : TOOL_BAD_INPUT;
}
