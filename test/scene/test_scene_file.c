// Tests of src/scene/scene_*.c: what good files mean. Bad ones: test_scene_file_bad.c.
#include "check.h"
#include "folder.h"
#include "shape.h"

// the top of the source tree, from this file's own path
static void source_path(const char *name, char *out, size_t size)
{
  const char *end = strstr(__FILE__, "test/scene/");
  snprintf(out, size, "%.*s%s", end ? (int)(end - __FILE__) : 0, __FILE__, name);
}

static char *read_text(const char *path)
{
  FILE *f = fopen(path, "rb");
  if (f == NULL) return NULL;
  char *text = calloc(1, 1 << 20);
  size_t n = text ? fread(text, 1, (1 << 20) - 1, f) : 0;
  fclose(f);
  if (text) text[n] = '\0';
  return text;
}

static cloth_status load(const char *text, cloth_def **def, cloth_error *err)
{
  folder f = folder_make();
  cloth_status status = cloth_def_load(folder_write(&f, "scene.yaml", text), def, err);
  folder_remove(&f);
  return status;
}

// ---- the documentation --------------------------------------------------------------------------

// the complete example of doc/scene_file.md, with the files it names
static cloth_status load_example(folder *f, cloth_def **def, cloth_error *err)
{
  char path[1024];
  source_path("doc/scene_file.md", path, sizeof path);
  char *page = read_text(path);
  char *start = page ? strstr(page, "```yaml\n") : NULL,
       *end = start ? strstr(start + 8, "```") : NULL;
  if (end == NULL) CLOTH_FAIL(err, CLOTH_IO, "no example in %s", path);
  *end = '\0';
  folder_write(f, "example.yaml", start + 8);
  free(page);

  source_path("config/materials/towel.yaml", path, sizeof path);
  char *towel = read_text(path);
  if (towel == NULL) CLOTH_FAIL(err, CLOTH_IO, "no %s", path);
  folder_write(f, "towel.yaml", towel);
  free(towel);
  folder_write(f, "banner.obj",
               "v 0 0 0\nv 800 0 0\nv 0 0 500\nv 800 0 500\nvt 0 0\nvt 1 0\nvt 0 1\n"
               "vt 1 1\no flag\nf 1/1 2/2 4/4 3/3\n");
  folder_write(f, "gripper.ply",
               "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
               "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  return cloth_def_load(folder_path(f, "example.yaml"), def, err);
}

static int the_documented_example_means_what_it_says(void)
{
  folder f = folder_make();
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(load_example(&f, &def, &err), err);
  folder_remove(&f);
  CHECK(strcmp(def->name, "example") == 0 && def->duration == 4 && def->device_count == 2);
  CHECK(def->params.wind[0] == 1 && def->params.mesh_defects == 1 &&
        def->params.time_step == 0.0166667);
  CHECK(def->effect_count == 2 && def->effect[0].wish == CLOTH_EFFECT_ON);

  const cloth_cloth_def *towel = &def->cloth[0], *banner = &def->cloth[1];
  CHECK(def->cloth_count == 2 && strcmp(towel->material_name, "towel") == 0);
  CHECK(towel->material.density == 0.35 && towel->material.bend_warp == 5e-5); // override, file
  CHECK(banner->material.density == 0.1 && banner->material.shear == 400);     // inline, default
  CHECK(towel->mesh.vertex_count == 26 * 36 && towel->group_count == 4);
  CHECK(towel->pose.position[2] == 0.85);
  CHECK_NEAR(towel->pose.rotation[2], sin(0.15), 1e-15);
  CHECK(towel->group[0].count == 2 && towel->group[0].vertex[0] == 0 &&
        towel->group[0].vertex[1] == 25);
  CHECK(towel->group[1].count == 26 && towel->group[1].vertex[0] == 35 * 26);
  CHECK(banner->mesh.material == NULL && banner->mesh.position[3] == 0.8);
  CHECK(strcmp(banner->group[0].name, "flag") == 0 && banner->group[0].count == 4);

  CHECK(def->pin_count == 2);
  CHECK(def->pin[0].group == 0 && def->pin[0].body == -1 && def->pin[0].motion.key_count == 2);
  CHECK(def->pin[0].end == 3 && def->pin[0].stiffness == 0);
  CHECK(def->pin[1].body == cloth_def_find_body(def, "rod") && def->pin[1].end == INFINITY);
  CHECK(def->pin[1].stiffness == 500 && def->pin[1].break_force == 20);

  CHECK(def->body_count == 5);
  CHECK(def->body[0].friction == 0.5 && def->body[1].friction == 0.3);
  CHECK(!def->body[0].plane && def->body[1].plane);
  CHECK(def->body[2].motion.velocity[2] == 0.1 && def->body[2].motion.end == 2);
  CHECK(def->body[3].motion.key_count == 2 && def->body[3].pose.position[0] == 1);
  CHECK(shape_volume(&def->body[4].mesh) > 0); // mirrored and turned over: still outward
  cloth_def_free(def);
  return 0;
}

// tables are kept as they are, and the numbers beside them are those near zero strain and curvature
static int a_measured_fabric_is_read_with_its_tables(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(
      load("materials: {m: {density: 0.2, stretching: [[100, 10, 50, 20], [1, 0, 1, -1], [2, 0, 1, "
           "1], "
           "[3, 0, 1, 1], [4, 0, 1, 1], [5, 0, 6, 7]], bending: [[8e-5, 2e-5, 3e-5, 4e-5, 5e-5], "
           "[1e-5, 2e-5, 3e-5, 4e-5, 5e-5], [4e-5, 2e-5, 3e-5, 4e-5, 6e-5]]}}\n"
           "cloths: [{name: a, grid: {size: [1, 1], resolution: [2, 2]}, material: m}]\n",
           &def, &err),
      err);
  const cloth_material *m = &def->cloth[0].material;
  CHECK(m->measured_stretching[1] == 10 && m->measured_stretching[23] == 7);
  CHECK(m->measured_bending[0] == 8e-5 && m->measured_bending[14] == 6e-5);
  CHECK_NEAR(m->stretch_warp, 2 * (100 - 10 * 10 / 50.0), 1e-12);
  CHECK_NEAR(m->stretch_weft, 2 * (50 - 10 * 10 / 100.0), 1e-12);
  CHECK_NEAR(m->shear, 40, 1e-12);
  CHECK_NEAR(m->bend_weft, 2e-5, 1e-15); // an edge along the warp curves the weft
  CHECK_NEAR(m->bend_warp, 1e-5, 1e-15);
  cloth_def_free(def);
  return 0;
}

static int an_isotropic_sheet_has_the_stiffness_of_a_plate(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(
      load("materials: {m: {isotropic: {young: 2e6, poisson: 0.25, thickness: 5e-4}, shear: 7}}\n"
           "cloths: [{name: a, grid: {size: [1, 1], resolution: [2, 2]}, material: m}]\n",
           &def, &err),
      err);
  const cloth_material *m = &def->cloth[0].material;
  CHECK_NEAR(m->stretch_warp, 1000, 1e-9);
  CHECK_NEAR(m->bend_warp / (2e6 * 1.25e-10 / (12 * (1 - 0.0625))), 1, 1e-12);
  CHECK(m->poisson == 0.25 && m->shear == 7); // what stands beside wins
  cloth_def_free(def);
  return 0;
}

// doc/materials.md shows the numbers of the files and of src/material.inl
static int every_fabric_loads_and_is_documented(void)
{
  static const char *const fabrics[] = {"towel",     "cotton", "denim",   "silk",
                                        "wool",      "flag",   "leather", "soft_cotton",
                                        "interlock", "ponte",  "rib_knit"};
  enum { COUNT = sizeof fabrics / sizeof *fabrics };
  char path[1024], text[2048], row[512];
  source_path("doc/materials.md", path, sizeof path);
  char *page = read_text(path);
  CHECK(page != NULL);
  cloth_def *def[COUNT];
  for (int i = 0; i < COUNT; i++) {
    cloth_error err = {0};
    source_path("config/materials", path, sizeof path);
    snprintf(
        text, sizeof text,
        "materials: {m: {file: '%s/%s.yaml'}}\ncloths: [{name: a, grid: {size: [1, 1], resolution: "
        "[2, 2]}, material: m}]\n",
        path, fabrics[i]);
    CHECK_OK(load(text, &def[i], &err), err);
  }
  for (const cloth_param_info *p = cloth_material_table(); p->name; p++) {
    int n = snprintf(row, sizeof row, "| `%s` | %s |", p->name, p->unit);
    for (int i = 0; i < COUNT; i++)
      n += snprintf(row + n, sizeof row - (size_t)n, " %g |",
                    *(const double *)((const char *)&def[i]->cloth[0].material + p->offset));
    if (strstr(page, row) == NULL) printf("doc/materials.md has no row %s\n", row);
    CHECK(strstr(page, row) != NULL);
    snprintf(row, sizeof row, "| `%s` | %s | [%g, %g] | %g |", p->name, p->unit, p->least, p->most,
             p->value[0]);
    if (strstr(page, row) == NULL) printf("doc/materials.md has no row %s\n", row);
    CHECK(strstr(page, row) != NULL);
  }
  for (int i = 0; i < COUNT; i++) cloth_def_free(def[i]);
  free(page);
  return 0;
}

static int the_scenes_of_the_package_load(void)
{
  char path[1024], file[2048];
  source_path("config/scenes", path, sizeof path);
  DIR *dir = opendir(path);
  CHECK(dir != NULL);
  int n = 0;
  for (struct dirent *e; (e = readdir(dir)) != NULL;) {
    size_t length = strlen(e->d_name);
    if (length < 6 || strcmp(e->d_name + length - 5, ".yaml") != 0) continue;
    cloth_def *def;
    cloth_error err = {0};
    snprintf(file, sizeof file, "%s/%s", path, e->d_name);
    CHECK_OK(cloth_def_load(file, &def, &err), err);
    cloth_def_free(def);
    n++;
  }
  closedir(dir);
  printf("     %d scenes\n", n);
  return 0;
}

// ---- groups -------------------------------------------------------------------------------------

static int groups_select_what_they_say(void)
{
  // 3 x 3 vertices at -1, 0, 1
  static const struct {
    const char *how;
    int count, vertex[9];
  } rows[] = {{"{vertices: [8, 0, 8]}", 2, {0, 8}},
              {"{box: [[0, -1, 0], [1, 0, 0]]}", 4, {1, 2, 4, 5}},
              {"{nearest: [0.9, 2, 5]}", 1, {8}},
              {"{nearest: [[-1, -1, 0], [1, -1, 0]]}", 2, {0, 2}},
              {"{radius: {center: [0, 0, 0], r: 1}}", 5, {1, 3, 4, 5, 7}},
              {"{side: left}", 3, {0, 3, 6}},
              {"{side: right}", 3, {2, 5, 8}},
              {"{side: bottom}", 3, {0, 1, 2}},
              {"{side: top}", 3, {6, 7, 8}},
              {"[{side: top}, {vertices: [0]}, {side: left}]", 5, {0, 3, 6, 7, 8}}};
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    char text[512];
    cloth_def *def;
    cloth_error err = {0};
    snprintf(text, sizeof text,
             "cloths: [{name: a, grid: {size: [2, 2], resolution: [3, 3]}, groups: {g: %s}}]\n",
             rows[i].how);
    CHECK_OK(load(text, &def, &err), err);
    const cloth_group_def *g = &def->cloth[0].group[0];
    CHECK(g->count == rows[i].count);
    for (int k = 0; k < g->count; k++) CHECK(g->vertex[k] == rows[i].vertex[k]);
    cloth_def_free(def);
  }
  return 0;
}

static int sides_of_an_unstructured_grid_are_whole(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(
      load(
          "cloths: [{name: a, grid: {size: [0.3, 0.7], resolution: [7, 8], pattern: unstructured}, "
          "groups: {l: {side: left}, r: {side: right}, b: {side: bottom}, t: {side: top}}}]\n",
          &def, &err),
      err);
  const int counts[4] = {8, 8, 7, 8}; // row 7 is odd: one vertex more
  for (int i = 0; i < 4; i++) CHECK(def->cloth[0].group[i].count == counts[i]);
  cloth_def_free(def);
  return 0;
}

// ---- poses and motions --------------------------------------------------------------------------

static void turned(const double q[4], const double v[3], double out[3])
{
  // the rotation matrix of a quaternion, written out
  double x = q[0], y = q[1], z = q[2], w = q[3];
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                          {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                          {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
  for (int i = 0; i < 3; i++) out[i] = r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2];
}

// Rz(yaw) Ry(pitch) Rx(roll)
static int rpy_turns_about_fixed_axes(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(
      load(
          "bodies: [{name: b, box: {size: [1, 1, 1]}, pose: {position: [1, 2, 3], rpy: [0.3, -0.5, "
          "1.1]}}]\n",
          &def, &err),
      err);
  const double in[3] = {0.2, -0.7, 0.4}, a[3] = {0.3, -0.5, 1.1};
  double v[3] = {in[0], in[1], in[2]}, out[3], n[3];
  n[0] = v[0], n[1] = cos(a[0]) * v[1] - sin(a[0]) * v[2],
  n[2] = sin(a[0]) * v[1] + cos(a[0]) * v[2];
  v[0] = cos(a[1]) * n[0] + sin(a[1]) * n[2], v[1] = n[1],
  v[2] = -sin(a[1]) * n[0] + cos(a[1]) * n[2];
  n[0] = cos(a[2]) * v[0] - sin(a[2]) * v[1], n[1] = sin(a[2]) * v[0] + cos(a[2]) * v[1],
  n[2] = v[2];
  turned(def->body[0].pose.rotation, in, out);
  for (int i = 0; i < 3; i++) CHECK_NEAR(out[i], n[i], 1e-15);
  cloth_def_free(def);
  return 0;
}

// the solid side of a plane is below it, whatever its normal, and `pose` moves the whole
static int planes_stand_where_their_normal_says(void)
{
  static const double normals[][3] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -2, 0}, {1, 2, -3}};
  for (int i = 0; i < 5; i++) {
    const double *n = normals[i];
    double norm = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), up[3];
    const double z[3] = {0, 0, 1};
    char text[512];
    cloth_def *def;
    cloth_error err = {0};
    snprintf(text, sizeof text,
             "bodies: [{name: p, plane: {normal: [%g, %g, %g], offset: 0.5}, pose: {position: [1, "
             "1, 1]}}]\n",
             n[0], n[1], n[2]);
    CHECK_OK(load(text, &def, &err), err);
    turned(def->body[0].pose.rotation, z, up);
    for (int k = 0; k < 3; k++) {
      CHECK_NEAR(up[k], n[k] / norm, 1e-15);
      CHECK_NEAR(def->body[0].pose.position[k], 1 + 0.5 * n[k] / norm, 1e-15);
    }
    cloth_def_free(def);
  }
  return 0;
}

// what a key leaves out is as in the key before, in the first as in the pose
static int keys_carry_on_what_they_leave_out(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(load("bodies:\n- name: b\n  box: {size: [1, 1, 1]}\n  pose: {position: [1, 2, 3], rpy: "
                "[0, 0, 1]}\n"
                "  motion:\n    keys:\n    - {time: 1}\n    - {time: 2, position: [4, 5, 6]}\n"
                "    - {time: 3, rpy: [0, 0, 2]}\n",
                &def, &err),
           err);
  const cloth_motion *m = &def->body[0].motion;
  const double x[3] = {1, 4, 4}, angle[3] = {1, 1, 2};
  for (int i = 0; i < 3; i++) {
    CHECK(m->time[i] == i + 1 && m->pose[i].position[0] == x[i]);
    CHECK_NEAR(2 * atan2(m->pose[i].rotation[2], m->pose[i].rotation[3]), angle[i], 1e-15);
  }
  cloth_def_free(def);
  return 0;
}

static int a_body_starts_where_its_keys_have_it_at_time_0(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(load("bodies:\n- name: b\n  sphere: {radius: 1}\n  motion: {keys: [{time: 2, position: "
                "[7, 0, 0]}, "
                "{time: 3, position: [8, 0, 0]}]}\n",
                &def, &err),
           err);
  CHECK(def->body[0].pose.position[0] == 7);
  cloth_def_free(def);
  return 0;
}

// ---- meshes -------------------------------------------------------------------------------------

static int texture_coordinates_are_metres_of_material(void)
{
  static const char *const obj =
      "v 0 0 0\nv 2 0 0\nv 0 2 0\nvt 0 0\nvt 3 0\nvt 0 4\nf 1/1 2/2 3/3\n";
  static const struct {
    const char *keys;
    double u, x; // warp of the second corner, 0 if it is flattened; x of the second vertex
  } rows[] = {{"", 3, 2},
              {", scale: 0.5", 3, 1},
              {", material_scale: 0.1", 0.3, 2},
              {", material_coordinates: flatten", 0, 2},
              {", material_coordinates: file, scale: [2, 1, 1]", 3, 4}};
  for (int i = 0; i < 5; i++) {
    folder f = folder_make();
    char text[512];
    cloth_def *def;
    cloth_error err = {0};
    folder_write(&f, "m.obj", obj);
    snprintf(text, sizeof text, "cloths: [{name: a, mesh: m.obj%s}]\n", rows[i].keys);
    CHECK_OK(cloth_def_load(folder_write(&f, "s.yaml", text), &def, &err), err);
    const cloth_mesh *m = &def->cloth[0].mesh;
    CHECK((m->material == NULL) == (rows[i].u == 0));
    if (m->material) CHECK_NEAR(m->material[2], rows[i].u, 1e-15);
    CHECK(m->position[3] == rows[i].x);
    cloth_def_free(def);
    folder_remove(&f);
  }
  return 0;
}

// the front of a mirrored cloth shows to the other side, and its corners keep their material
static int mirrored_meshes_are_turned_over(void)
{
  folder f = folder_make();
  cloth_def *def;
  cloth_error err = {0};
  double least;
  folder_write(&f, "m.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nvt 0 0\nvt 2 0\nvt 0 2\nf 1/1 2/2 3/3\n");
  const char *path =
      folder_write(&f, "s.yaml", "cloths: [{name: a, mesh: m.obj, scale: [-1, 1, 1]}]\n");
  CHECK_OK(cloth_def_load(path, &def, &err), err);
  const cloth_mesh *m = &def->cloth[0].mesh;
  CHECK(shape_area(m, &least) == 2);
  for (int k = 0; k < 3; k++) {
    CHECK(m->material[2 * k] == -m->position[3 * m->triangle[k]]);
    CHECK(m->material[2 * k + 1] == m->position[3 * m->triangle[k] + 1]);
  }
  cloth_def_free(def);
  folder_remove(&f);
  return 0;
}

static int repairs_of_files_are_counted(void)
{
  folder f = folder_make();
  cloth_def *def;
  cloth_error err = {0};
  folder_write(&f, "m.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\nf 2 3 3\nf 4 2 3\n");
  const char *path =
      folder_write(&f, "s.yaml",
                   "params: {mesh_defects: repair}\ncloths: [{name: a, mesh: m.obj}]\n"
                   "bodies: [{name: b, mesh: m.obj}]\n");
  CHECK_OK(cloth_def_load(path, &def, &err), err);
  const cloth_mesh_repairs *a = &def->cloth[0].repairs, *b = &def->body[0].repairs;
  CHECK(a->zero_area == 1 && a->duplicate == 1 && a->unreferenced == 1 && a->flipped == 0);
  CHECK(memcmp(a, b, sizeof *a) == 0);
  cloth_def_free(def);
  folder_remove(&f);
  return 0;
}

// ---- YAML ---------------------------------------------------------------------------------------

static int every_way_to_write_yaml(void)
{
  static const char *const texts[] = {
      "name: x\nduration: 2.5\n",
      "{name: x, duration: 2.5}",
      "{\"name\": \"x\", \"duration\": 2.5}",
      "---\nname: x\nduration: 2.5\n...\n",
      "# comment\nduration: 2.5 # comment\nname: 'x'\n",
      "name: x\r\nduration: 2.5\r\n",
      "\xef\xbb\xbfname: x\nduration: 2.5\n",
      "name: &n x\nduration: 25.0e-1\n",
  };
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
    cloth_def *def;
    cloth_error err = {0};
    CHECK_OK(load(texts[i], &def, &err), err);
    CHECK(strcmp(def->name, "x") == 0 && def->duration == 2.5);
    cloth_def_free(def);
  }
  return 0;
}

static int aliases_stand_for_what_they_name(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(
      load("bodies:\n- {name: a, box: &b {size: [1, 2, 3]}}\n- {name: c, box: *b}\n", &def, &err),
      err);
  CHECK(shape_volume(&def->body[1].mesh) == 6);
  cloth_def_free(def);
  return 0;
}

static int variables_stand_wherever_a_value_may(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(load("variables: {n: 3, size: [1, 2, 4], word: '$t', t: 2.5}\n"
                "name: '$t'\nduration: $t\n"
                "cloths: [{name: a, grid: {size: [1, $t], resolution: [$n, $n]}}]\n"
                "bodies: [{name: $word, box: {size: $size}}, {name: b, box: {size: [1, 1, $t]}}]\n",
                &def, &err),
           err);
  CHECK(def->duration == 2.5 && def->cloth[0].mesh.vertex_count == 9);
  CHECK(strcmp(def->name, "$t") == 0 && strcmp(def->body[0].name, "$t") == 0); // quoted: text
  CHECK(shape_volume(&def->body[0].mesh) == 8 && shape_volume(&def->body[1].mesh) == 2.5);
  cloth_def_free(def);
  return 0;
}

static int variants_are_applied_in_their_order(void)
{
  static const char *const text =
      "variables: {t: 1, n: 2}\nvariants: {small: {t: 3}, fine: {t: 4, n: 5}}\nduration: $t\n"
      "cloths: [{name: a, grid: {size: [1, 1], resolution: [$n, 2]}}]\n";
  static const struct {
    const char *variant;
    double t;
    int n;
  } good[] = {{NULL, 1, 2},           {"", 1, 2},           {"small", 3, 2},
              {"small,fine", 4, 5},   {"fine,small", 3, 5}, {"fine,t=9", 9, 5},
              {"t=9,n=4,small", 3, 4}};
  static const struct {
    const char *variant, *expected;
  } bad[] = {{"smal", "no variant 'smal'; the nearest is 'small'"},
             {"small,,fine", "no variant ''"},
             {"nn=3", "no variable 'nn'; the nearest is 'n'"},
             {"n=few", "key 'resolution': expected a whole number"},
             {"n=", "key 'resolution': expected a whole number"}};
  folder f = folder_make();
  const char *path = folder_write(&f, "s.yaml", text);
  cloth_def *def;
  for (int i = 0; i < 7; i++) {
    cloth_error err = {0};
    CHECK_OK(
        cloth_def_load_with(path, &(cloth_load_options){.variant = good[i].variant}, &def, &err),
        err);
    CHECK(def->duration == good[i].t && def->cloth[0].mesh.vertex_count == 2 * good[i].n);
    cloth_def_free(def);
  }
  for (int i = 0; i < 5; i++) {
    cloth_error err = {0};
    CHECK(cloth_def_load_with(path, &(cloth_load_options){.variant = bad[i].variant}, &def, &err) ==
          CLOTH_BAD_SCENE);
    CHECK(def == NULL && strstr(err.text, bad[i].expected) != NULL);
  }
  path = folder_write(&f, "s.yaml", "variables: {t: 1}\nvariants: {a: {u: 1}}\nduration: $t\n");
  cloth_error err = {0};
  CHECK(cloth_def_load_with(path, &(cloth_load_options){.variant = "a"}, &def, &err) ==
        CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, ":2: key 'u': no such variable; the nearest is 't'") != NULL);
  folder_remove(&f);
  return 0;
}

// every variant of every scene of the package; the scenes say which by their `variants:`
static int the_small_scenes_of_the_package_load(void)
{
  static const char *const scenes[] = {
      "twisted_cylinder", "five_turns",   "rotating_sphere",        "funnel",
      "tablecloth_pull",  "needles",      "mat_on_knives",          "sphere_sheets",
      "flag_two_corners", "towel_rolled", "hand_on_crumpled_towel", "towel_whipped",
      "link_sweep",       "pinched",      "towel_on_towel",         "towels_clash"};
  for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
    char name[256], path[1024];
    cloth_def *def;
    cloth_error err = {0};
    snprintf(name, sizeof name, "config/scenes/%s.yaml", scenes[i]);
    source_path(name, path, sizeof path);
    CHECK_OK(cloth_def_load_with(path, &(cloth_load_options){.variant = "small"}, &def, &err), err);
    int vertices = 0;
    for (int c = 0; c < def->cloth_count; c++) vertices += def->cloth[c].mesh.vertex_count;
    CHECK(vertices < 2000 && def->duration > 0);
    cloth_def_free(def);
  }
  return 0;
}

static int a_scene_without_a_name_is_called_like_its_file(void)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(load("duration: 1\n", &def, &err), err);
  CHECK(strcmp(def->name, "scene") == 0);
  CHECK(def->cloth_count == 0);
  cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(the_documented_example_means_what_it_says);
  RUN(a_measured_fabric_is_read_with_its_tables);
  RUN(an_isotropic_sheet_has_the_stiffness_of_a_plate);
  RUN(every_fabric_loads_and_is_documented);
  RUN(the_scenes_of_the_package_load);
  RUN(groups_select_what_they_say);
  RUN(sides_of_an_unstructured_grid_are_whole);
  RUN(rpy_turns_about_fixed_axes);
  RUN(planes_stand_where_their_normal_says);
  RUN(keys_carry_on_what_they_leave_out);
  RUN(a_body_starts_where_its_keys_have_it_at_time_0);
  RUN(texture_coordinates_are_metres_of_material);
  RUN(mirrored_meshes_are_turned_over);
  RUN(repairs_of_files_are_counted);
  RUN(every_way_to_write_yaml);
  RUN(aliases_stand_for_what_they_name);
  RUN(variables_stand_wherever_a_value_may);
  RUN(variants_are_applied_in_their_order);
  RUN(the_small_scenes_of_the_package_load);
  RUN(a_scene_without_a_name_is_called_like_its_file);
  return failures != 0;
}
