// validate [--short] [--out FILE.csv] [TEST...]: the engine against known answers;
// doc/validation.md. Exit code 0: all within reach; 1: some missed; 2: usage.
#include "validate/cases.h"
#include "validate/strip.h"

static int quick;

static void cantilevers(void)
{
  static const double all[] = {0.1, 1, 10, 100, 1000}, few[] = {1, 100};
  for (int mesh = 0; mesh <= STRIP_UNEVEN; mesh++)
    for (int i = 0; i < (quick ? 2 : 5); i++)
      case_cantilever(mesh, quick ? few[i] : all[i], "shape", quick ? 30 : 0);
}

static void mesh_orders(void) { case_mesh_order(STRIP_LEFT, 10); }

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

static void hanging_sheets(void)
{
  for (int mode = 1; mode <= (quick ? 1 : 3); mode++)
    for (int mesh = 0; mesh < (quick ? 1 : STRIP_MESHES); mesh++) case_hanging_sheet(mesh, mode);
}

static void catenaries(void)
{
  for (int mesh = 0; mesh < (quick ? 1 : STRIP_MESHES); mesh++) case_catenary(mesh, 0.7);
}

static void stick_slips(void) { case_stick_slips(quick); }

static void capstans(void)
{
  static const double mu[] = {0.25, 0.1, 0.5};
  for (int mesh = 0; mesh < (quick ? 1 : STRIP_MESHES); mesh++)
    for (int i = 0; i < (quick ? 1 : 3); i++) case_capstan(mesh, mu[i]);
}

static void slopes(void)
{
  static const double mu[] = {0.3, 0.45, 0.5};
  for (int mesh = 0; mesh < (quick ? 1 : STRIP_MESHES); mesh++)
    for (int i = 0; i < 3; i++) case_slope(mesh, mu[i]);
}

// bands of the literature: silk Matsudaira and Yang 2003; cotton Gan, Ly and Steven 1991; wool
// worsteds; denim and banners by their class
static void drapes(void)
{
  static const struct {
    const char *fabric;
    double least, most;
  } band[] = {{"cotton", 0.60, 0.76},
              {"silk", 0.20, 0.40},
              {"flag", 0.20, 0.40},
              {"denim", 0.70, 0.90},
              {"wool", 0.40, 0.70}};
  for (int i = 0; i < (quick ? 1 : 5); i++)
    case_drape(band[i].fabric, quick ? 10 : 30, band[i].least, band[i].most);
  for (int rings = 20; rings <= 40 && !quick; rings += 20) // coarser and finer
    case_drape("cotton", rings, 0.60, 0.76);
}

static const struct {
  const char *name;
  void (*run)(void);
} tests[] = {
    {"reference", case_reference},     {"cantilever", cantilevers}, {"order", mesh_orders},
    {"tip_load", tip_loads},           {"end_moment", end_moments}, {"heart_loop", heart_loops},
    {"hanging_sheet", hanging_sheets}, {"catenary", catenaries},    {"drape", drapes},
    {"stick_slip", stick_slips},       {"capstan", capstans},       {"slope", slopes}};

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
    int wanted = chosen == 0 && (!quick || t < 2); // the short run: two of them
    for (int i = 1; i < argc; i++) wanted |= strcmp(argv[i], tests[t].name) == 0;
    if (wanted) tests[t].run();
  }
  printf("%d missed\n", results_missed());
  return results_missed() > 0;
}
