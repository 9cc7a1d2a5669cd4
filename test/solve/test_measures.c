// What a step reads of large cloth is reduced on the device in several passes: the box of all ways
// and the largest stretch are those of every vertex and triangle, on one part and on several.
#include "membrane_stretch.h"
#include "solve/sim.h"

enum { SHEETS = 12, N = 41 }; // 316 chunks of vertices, 600 of triangles: more than are read

static sheet cloth;

static cloth_sim *sim_of(cloth_def **def, const char *devices)
{
  sheet_make(&cloth, 0.2, 0.2, N, N);
  *def = def_new(PRECISION);
  def_set(*def, "devices", devices);
  def_set(*def, "threads", "2");
  for (int i = 0; i < SHEETS; i++) {
    char name[16];
    snprintf(name, sizeof name, "sheet_%d", i);
    def_cloth(*def, name, &cloth, cloth_material_default(), pose_at(0, 0, 0.01 * i));
  }
  return sim_new(*def);
}

// the same noise on every part, and one vertex that is far out in one direction
static void shake(cloth_sim *sim, int far, int axis)
{
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    uint32_t seed = 3;
    for (int i = 0; i < 3 * sim->vertex_count; i++) {
      part->x_t0[i] = (cloth_real)(sim->rest[i] + 0.001 * roll_real(&seed));
      part->x[i] = part->x_t0[i] + (cloth_real)(0.001 * roll_real(&seed));
      part->v[i] = (cloth_real)(0.1 * roll_real(&seed));
    }
    part->x_t0[3 * far + axis] += (cloth_real)0.4;
  }
}

static cloth_box box_by_hand(const cloth_sim *sim, cloth_real h)
{
  const cloth_part *p = &sim->part[0];
  cloth_box all = {{0, 0, 0}, {0, 0, 0}};
  for (int v = 0; v < sim->vertex_count; v++) {
    cloth_v3 x = cloth_v3_load(p->x_t0, v), fly = cloth_v3_add_scaled(x, h, cloth_v3_load(p->v, v));
    cloth_box way = cloth_box_union(cloth_box_swept(x, cloth_v3_load(p->x, v), 0),
                                    cloth_box_swept(fly, fly, 0));
    all = v ? cloth_box_union(all, way) : way;
  }
  return all;
}

static double stretch_by_hand(const cloth_sim *sim)
{
  double worst = 0;
  for (int p = 0; p < sim->part_count; p++) {
    const cloth_part *part = &sim->part[p];
    cloth_real stretch;
    for (int t = 0; t < part->membrane.count; t++) {
      cloth_membrane_stretch_args a = {part->membrane.vertex + 3 * t, part->membrane_rest + 5 * t,
                                       part->x_t0, &stretch};
      cloth_membrane_stretch(0, &a);
      worst = (double)stretch > worst ? (double)stretch : worst;
    }
  }
  return worst;
}

static int measures_are_those_of_every_vertex_and_triangle(void)
{
  static const char *const devices[] = {"cpu", "cpu, cpu, cpu"};
  cloth_error err = {0};
  for (int d = 0; d < 2; d++) {
    cloth_def *def;
    cloth_sim *sim = sim_of(&def, devices[d]);
    cloth_step_report report = {0};
    sim->report = &report;
    for (int i = 0; i < 12; i++) {
      shake(sim, sim->vertex_count * i / 11 - (i == 11), i % 3);
      CHECK_OK(cloth_box_update(sim, 0.01, &err), err);
      cloth_box all = box_by_hand(sim, (cloth_real)0.01);
      CHECK(memcmp(&all, &sim->cloth_box, sizeof all) == 0);
      CHECK_OK(cloth_stretch_measure(sim, &err), err);
      CHECK(report.stretch_max == stretch_by_hand(sim) && report.stretch_max > 10);
    }
    cloth_sim_free(sim), cloth_def_free(def);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(measures_are_those_of_every_vertex_and_triangle);
  return failures > 0;
}
