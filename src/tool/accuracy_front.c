// What is read off a table: how far the references are from their limit, the Pareto front, and the
// cheapest setting for an error.
#include "accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct candidate {
  const accuracy_row *row;
  double cost;
} candidate;

static int compare_candidates(const void *a, const void *b)
{
  const candidate *x = a, *y = b;
  if (x->cost != y->cost) return x->cost < y->cost ? -1 : 1;
  double e = x->row->error_rms, f = y->row->error_rms;
  return (e > f) - (e < f);
}

static double cost_of(const accuracy_row *row, accuracy_cost cost)
{
  if (cost == ACCURACY_WALL) return row->wall_per_second;
  return cost == ACCURACY_CPU ? row->cpu_per_second : row->work;
}

static bool is_reference(const accuracy_row *row) { return strcmp(row->varied, "reference") == 0; }

// runs of a scene that ended well, the cheapest first
static int candidates_of(const accuracy_table *t, const char *scene, accuracy_cost cost,
                         candidate *out)
{
  int n = 0;
  for (int i = 0; i < t->count; i++) {
    const accuracy_row *row = &t->row[i];
    bool counts = strcmp(row->scene, scene) == 0 && strcmp(row->status, "ok") == 0 &&
                  !is_reference(row) &&
                  row->error_rms < 1; // nor NaN, nor what is a cloth's size away
    if (counts) out[n++] = (candidate){row, cost_of(row, cost)};
  }
  qsort(out, (size_t)n, sizeof *out, compare_candidates);
  return n;
}

static void print_candidate(const candidate *c, accuracy_cost cost)
{
  static const char *const unit[] = {"s / s", "s / s", "iterations x vertices / s"};
  printf("    %9.3g %%  %10.4g %s  %s: %s\n", 100 * c->row->error_rms, c->cost, unit[cost],
         c->row->varied, c->row->setting);
}

static void print_references(const accuracy_table *t, const char *scene)
{
  printf("  references, and how far they are from their limit:\n");
  for (int i = 0; i < t->count; i++) {
    const accuracy_row *row = &t->row[i];
    if (strcmp(row->scene, scene) != 0 || !is_reference(row)) continue;
    printf("    %-22s %9.3g %% from the finest, %9.3g %% from that on the mesh of the file\n",
           row->setting, 100 * row->error_rms, 100 * row->error_rms_same_mesh);
  }
}

// What the reference is sure of: the error of what is next to it, on the finest mesh that was
// tried. With order one in the step that is the reference's own.
static double sure_to(const accuracy_table *t, const char *scene)
{
  double resolution = 0, error = 0;
  for (int i = 0; i < t->count; i++) {
    const accuracy_row *row = &t->row[i];
    if (strcmp(row->scene, scene) != 0 || !is_reference(row) || !(row->error_rms > 0)) continue;
    if (row->resolution > resolution) resolution = row->resolution, error = 0;
    if (row->resolution == resolution) error = fmax(error, row->error_rms);
  }
  return error;
}

// cheaper than none that is as good
static void print_front(const candidate *c, int n, accuracy_cost cost)
{
  double best = INFINITY;
  printf("  Pareto front:\n");
  for (int i = 0; i < n; i++) {
    if (!(c[i].row->error_rms < best)) continue;
    best = c[i].row->error_rms;
    print_candidate(&c[i], cost);
  }
}

static void print_cheapest(const candidate *c, int n, double sure, accuracy_cost cost)
{
  static const double wanted[] = {0.1, 0.01, 0.001};
  for (int w = 0; w < 3; w++) {
    int i = 0;
    while (i < n && !(c[i].row->error_rms <= wanted[w])) i++;
    printf("  cheapest for %g %%:", 100 * wanted[w]);
    if (i == n)
      printf(" none reached it\n");
    else
      printf("\n"), print_candidate(&c[i], cost);
    if (wanted[w] < sure)
      printf("    but the reference itself is sure to %.2g %% only\n", 100 * sure);
  }
}

cloth_status accuracy_print(const accuracy_table *t, accuracy_cost cost, cloth_error *err)
{
  candidate *c = calloc((size_t)t->count + 1, sizeof *c);
  if (!c) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "no memory for %d rows", t->count);
  for (int i = 0; i < t->count; i++) {
    const char *scene = t->row[i].scene;
    bool first = true;
    for (int j = 0; j < i; j++) first = first && strcmp(t->row[j].scene, scene) != 0;
    if (!first) continue;
    int n = candidates_of(t, scene, cost, c);
    printf("%s: %d runs\n", scene, n);
    print_references(t, scene);
    print_front(c, n, cost);
    print_cheapest(c, n, sure_to(t, scene), cost);
  }
  free(c);
  return CLOTH_OK;
}
