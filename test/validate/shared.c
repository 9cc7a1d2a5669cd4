// The references of this folder against the curves of others, where those are there.
#include "validate/cases.h"
#include "validate/reference.h"
#include "validate/strip.h"

// rows of a CSV file with `columns` numbers each, after its title; how many, or -1
static int read_rows(const char *name, int columns, double *out, int most)
{
  char path[1024], line[512];
  const char *folder = getenv("CLOTH_SHARED_DATA");
  snprintf(path, sizeof path, "%s/master_curves/%s", folder ? folder : CLOTH_SHARED, name);
  FILE *f = fopen(path, "r");
  int n = 0;
  if (f == NULL) return printf("skip reference: no %s\n", path), -1;
  while (n < most && fgets(line, sizeof line, f)) {
    char *at = line, *end;
    int c = 0;
    for (; c < columns; c++, at = end + 1) {
      out[columns * n + c] = strtod(at, &end);
      if (end == at) break;
    }
    n += c == columns;
  }
  fclose(f);
  return n;
}

void case_stick_slips(int quick)
{
  static const double mu[] = {0.3, 0.2, 0.25};
  static double curve[6 * 800];
  int n = read_rows("stick_slip_clamped_hinged_elastica.csv", 6, curve, 800);
  for (int mesh = 0; mesh < (quick ? 1 : STRIP_MESHES) && n > 0; mesh++)
    for (int i = 0; i < (quick ? 1 : 3); i++) case_stick_slip(mesh, mu[i], curve, n);
}

void case_reference(void)
{
  static double row[6 * 400];
  double worst = 0, a, b, c;
  int n = read_rows("cantilever.csv", 6, row, 400);
  // far beyond 1e4 the angle at the free end is below what a double holds
  for (int i = 0; i < n && row[6 * i] < 2e4; i += 8) {
    reference_cantilever(row[6 * i], 0, &a, &b);
    worst = fmax(worst, fabs(a / b / row[6 * i + 3] - 1));
  }
  if (n > 0) result("reference", "-", "cantilever.csv", n, worst, 0, 1e-6);
  n = read_rows("cantilever_tip_load.csv", 4, row, 400);
  worst = 0;
  for (int i = 0; i < n; i += 8) {
    reference_cantilever(0, row[4 * i], &a, &b);
    worst = fmax(worst, fabs(a / row[4 * i + 1] - 1));
  }
  if (n > 0) result("reference", "-", "tip_load.csv", n, worst, 0, 1e-6);
  n = read_rows("heart_loop.csv", 5, row, 400);
  worst = 0;
  for (int i = 0; i < n && row[5 * i] < 2000; i += 10) {
    reference_heart_loop(row[5 * i], &a, &b, &c, 0, NULL, NULL);
    worst = fmax(worst, fabs(a / row[5 * i + 1] - 1));
  }
  if (n > 0) result("reference", "-", "heart_loop.csv", n, worst, 0, 1e-5);
}
