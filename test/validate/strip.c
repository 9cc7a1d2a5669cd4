#include "validate/strip.h"

const char *const strip_mesh_name[STRIP_MESHES + 1] = {"grid, one way", "grid, alternating",
                                                       "unstructured", "uneven"};

// ---- meshes -------------------------------------------------------------------------------------

static double noise(unsigned *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return (double)(*seed >> 8) / (1 << 23) - 1;
}

static void put(strip *s, int a, int b, int c)
{
  int *t = s->triangle + 3 * s->triangles++;
  t[0] = a, t[1] = b, t[2] = c;
}

static void vertex(strip *s, double x, double y)
{
  if (s->vertices >= STRIP_MAX) abort();
  double *p = s->x + 3 * s->vertices++;
  p[0] = x, p[1] = y, p[2] = 0;
}

static void grid_cells(strip *s, int across, int alternating)
{
  for (int c = 0; c + 1 < s->columns; c++)
    for (int r = 0; r < across; r++) {
      int a = s->column_first[c] + r, b = s->column_first[c + 1] + r;
      if (alternating && (r + c) % 2)
        put(s, a, b, b + 1), put(s, a, b + 1, a + 1);
      else
        put(s, a, b, a + 1), put(s, b, b + 1, a + 1);
    }
}

// columns of across + 1 and across + 2 vertices in turn, offset by half a cell
static void offset_cells(strip *s, int across)
{
  for (int c = 0; c + 1 < s->columns; c++) {
    int n = across + 1, even = c % 2 == 0;
    int few = s->column_first[even ? c : c + 1], many = s->column_first[even ? c + 1 : c];
    for (int i = 0; i < n; i++) {
      if (even)
        put(s, few + i, many + i, many + i + 1);
      else
        put(s, many + i, few + i, many + i + 1);
      if (i + 1 == n) continue;
      if (even)
        put(s, few + i, many + i + 1, few + i + 1);
      else
        put(s, few + i, few + i + 1, many + i + 1);
    }
  }
}

void strip_make(strip *s, strip_mesh mesh, double length, int cells, int across, int tail)
{
  unsigned seed = 5;
  int free_mesh = mesh == STRIP_UNSTRUCTURED || mesh == STRIP_UNEVEN;
  double jitter = mesh == STRIP_UNEVEN ? 0.3 : 0.15;
  double h = length / cells, dy = free_mesh ? h * 2 / sqrt(3) : h;
  s->vertices = s->triangles = 0;
  s->columns = cells + 2 + tail;
  s->length = length, s->width = across * dy, s->h = h;
  for (int c = 0; c < s->columns; c++) {
    int odd = free_mesh && c % 2, n = across + 1 + odd;
    int straight = c < 2 || c >= cells + 1; // clamps and ends
    s->column_first[c] = s->vertices;
    for (int i = 0; i < n; i++) {
      int side = i == 0 || i == n - 1;
      double y = odd ? (side ? (i ? across : 0) : i - 0.5) * dy : i * dy, x = (c - 1) * h;
      if (free_mesh && !straight && !side)
        x += jitter * h * noise(&seed), y += jitter * dy * noise(&seed);
      vertex(s, x, y - s->width / 2);
    }
  }
  s->column_first[s->columns] = s->vertices;
  if (free_mesh)
    offset_cells(s, across);
  else
    grid_cells(s, across, mesh == STRIP_ALTERNATING);
}

// ---- scenes -------------------------------------------------------------------------------------

cloth_scene *strip_scene(const strip *s, cloth_material material, const char *gravity,
                         const char *model)
{
  cloth_error err = {0};
  cloth_def *def = def_new("double");
  def_set(def, "time_step", "0.05");
  def_set(def, "gravity", gravity);
  def_set(def, "bending_model", model);
  def_set(def, "newton_iterations_max", "10");
  def_set(def, "newton_tolerance", "1e-5");
  def_set(def, "pcg_tolerance", "1e-4");
  def_set(def, "pcg_iterations_max", "5000");
  def_set(def, "effects.self_contact", "off");
  cloth_cloth_view v = {.name = "strip",
                        .mesh = {s->vertices, s->triangles, s->x, s->triangle, NULL},
                        .material = material,
                        .pose = cloth_pose_identity()};
  must(cloth_def_add_cloth(def, &v, NULL, &err), &err);
  return scene_new(def);
}

cloth_grasp_id strip_hold(const strip *s, cloth_scene *scene, int first, int last,
                          const cloth_grasp_view *how)
{
  static int vertex_of[STRIP_MAX];
  cloth_error err = {0};
  cloth_grasp_id id = {0, 0};
  cloth_grasp_view g = *how;
  g.cloth = 0, g.body = -1, g.count = 0, g.vertex = vertex_of;
  for (int v = s->column_first[first]; v < s->column_first[last + 1]; v++) vertex_of[g.count++] = v;
  must(cloth_grasp(scene, &g, &id, &err), &err);
  return id;
}

int strip_settle(cloth_scene *scene, double rest, int most)
{
  enum { CALM = 10 }; // steps: what swings has no speed at its turning points
  cloth_error err = {0};
  for (int n = 1, calm = 0;; n++) {
    cloth_step_report r;
    // short steps at first: a start that is not quite at rest must not be flung about
    must(cloth_step(scene, n < 10 ? 0.005 * n : 0, &r, &err), &err);
    calm = r.energy_kinetic < rest ? calm + 1 : 0;
    if (n >= most || calm >= CALM) return n;
  }
}

double strip_mean(const strip *s, const double *x, int c, int k)
{
  double sum = 0;
  int n = s->column_first[c + 1] - s->column_first[c];
  for (int v = s->column_first[c]; v < s->column_first[c + 1]; v++) sum += x[3 * v + k];
  return sum / n;
}

// ---- results ------------------------------------------------------------------------------------

static FILE *table;
static int missed;

int results_open(const char *path)
{
  table = fopen(path, "w");
  if (table) fprintf(table, "test,mesh,quantity,parameter,measured,expected,error,reach\n");
  return table != NULL;
}

void result(const char *test, const char *mesh, const char *what, double parameter, double measured,
            double expected, double reach)
{
  double error = expected != 0 ? measured / expected - 1 : measured;
  int miss = !(fabs(error) <= reach);
  missed += miss;
  printf("%s %-18s %-18s %-22s %10.4g  measured %-11.6g expected %-11.6g error %+.2f %%\n",
         miss ? "FAIL" : "ok  ", test, mesh, what, parameter, measured, expected, 100 * error);
  fflush(stdout);
  if (!table) return;
  fprintf(table, "%s,\"%s\",%s,%.6g,%.8g,%.8g,%.5f,%g\n", test, mesh, what, parameter, measured,
          expected, error, reach);
  fflush(table);
}

int results_missed(void) { return missed; }
