// validate [--short] [--out FILE.csv] [TEST...]: the engine against known answers;
// doc/validation.md. Exit code 0: all within reach; 1: some missed; 2: usage.
#include "validate/cases.h"
#include "validate/strip.h"

static int quick;

static void cantilevers(void)
{
  static const double all[] = {0.1, 1, 10, 100, 1000}, few[] = {1, 100};
  for (int mesh = 0; mesh < STRIP_MESHES; mesh++)
    for (int i = 0; i < (quick ? 2 : 5); i++)
      case_cantilever(mesh, quick ? few[i] : all[i], "shape", quick ? 30 : 0);
}

static void tip_loads(void)
{
  static const double all[] = {0.5, 2, 10};
  for (int mesh = 0; mesh < STRIP_MESHES; mesh++)
    for (int i = quick ? 1 : 0; i < (quick ? 2 : 3); i++) case_tip_load(mesh, all[i], "shape");
}

static void end_moments(void)
{
  for (int mesh = 0; mesh < (quick ? 1 : STRIP_MESHES); mesh++) case_end_moment(mesh, "shape");
}

static void heart_loops(void)
{
  static const double all[] = {1, 30, 1000};
  for (int mesh = 0; mesh < (quick ? 1 : STRIP_MESHES); mesh++)
    for (int i = quick ? 1 : 0; i < (quick ? 2 : 3); i++) case_heart_loop(mesh, all[i], "shape");
}

static const struct {
  const char *name;
  void (*run)(void);
} tests[] = {{"cantilever", cantilevers},
             {"tip_load", tip_loads},
             {"end_moment", end_moments},
             {"heart_loop", heart_loops}};

int main(int argc, char **argv)
{
  int n = (int)(sizeof tests / sizeof *tests), chosen = 0;
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--short") == 0)
      quick = 1;
    else if (strcmp(argv[i], "--out") == 0 && i + 1 < argc) {
      if (!results_open(argv[++i])) return fprintf(stderr, "cannot write %s\n", argv[i]), 2;
    } else
      chosen++;
  }
  for (int t = 0; t < n; t++) {
    int wanted = chosen == 0;
    for (int i = 1; i < argc; i++) wanted |= strcmp(argv[i], tests[t].name) == 0;
    if (wanted) tests[t].run();
  }
  printf("%d missed\n", results_missed());
  return results_missed() > 0;
}
