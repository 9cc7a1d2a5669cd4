// Tests of src/scene/mesh_check.c, through the calls that add cloths and bodies.
#include "check.h"
#include "shape.h"

// a strip of four triangles over the vertices 0..5: below 0 2 4, above 1 3 5
static const double strip[6][3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0},
                                   {1, 1, 0}, {2, 0, 0}, {2, 1, 0}};
static const int strip_triangle[4][3] = {{0, 2, 1}, {2, 3, 1}, {2, 4, 3}, {4, 5, 3}};

typedef struct fixture {
  double x[12][3], u[12][6];
  int t[12][3], vertex_count, triangle_count;
  bool with_material;
} fixture;

static fixture good(void)
{
  fixture f = {.vertex_count = 6, .triangle_count = 4};
  memcpy(f.x, strip, sizeof strip);
  memcpy(f.t, strip_triangle, sizeof strip_triangle);
  return f;
}

static void give_material(fixture *f)
{
  f->with_material = true;
  for (int t = 0; t < f->triangle_count; t++)
    for (int k = 0; k < 3; k++) memcpy(f->u[t] + 2 * k, f->x[f->t[t][k]], 2 * sizeof(double));
}

static cloth_mesh_view view_of(const fixture *f)
{
  cloth_mesh_view v = {f->vertex_count, f->triangle_count, f->x[0], f->t[0],
                       f->with_material ? f->u[0] : NULL};
  return v;
}

static cloth_status add_cloth(const fixture *f, bool repair, cloth_def **def, cloth_error *err)
{
  CLOTH_TRY(cloth_def_new(def, err));
  cloth_def_params(*def)->mesh_defects = repair;
  cloth_cloth_view v = {.name = "sheet",
                        .mesh = view_of(f),
                        .material = cloth_material_default(),
                        .pose = cloth_pose_identity()};
  return cloth_def_add_cloth(*def, &v, NULL, err);
}

static cloth_status add_body(const fixture *f, cloth_def **def, cloth_error *err)
{
  CLOTH_TRY(cloth_def_new(def, err));
  cloth_body_view v = {
      .name = "link", .mesh = view_of(f), .pose = cloth_pose_identity(), .friction = 0.3};
  return cloth_def_add_body(*def, &v, NULL, err);
}

static bool repairs_are(const cloth_mesh_repairs *r, cloth_mesh_repairs expected)
{
  return memcmp(r, &expected, sizeof expected) == 0;
}

// A defect is refused with `text` and leaves nothing; on repair it is counted and what is left is a
// mesh that passes.
static int check_defect(const fixture *f, const char *text, cloth_mesh_repairs expected,
                        int vertices, int triangles)
{
  cloth_def *def;
  cloth_error err = {0};
  CHECK(add_cloth(f, false, &def, &err) == CLOTH_BAD_SCENE);
  if (strstr(err.text, text) == NULL || strstr(err.text, "'sheet'") == NULL) {
    printf("%s\n", err.text);
    return 1;
  }
  CHECK(def->cloth_count == 0);
  cloth_def_free(def);

  err = (cloth_error){0};
  CHECK_OK(add_cloth(f, true, &def, &err), err);
  const cloth_cloth_def *c = &def->cloth[0];
  CHECK(repairs_are(&c->repairs, expected));
  CHECK(c->mesh.vertex_count == vertices && c->mesh.triangle_count == triangles);
  CHECK(shape_count_edges(&c->mesh).manifold);
  cloth_cloth_view again = {
      .name = "again",
      .mesh = {vertices, triangles, c->mesh.position, c->mesh.triangle, c->mesh.material},
      .material = cloth_material_default(),
      .pose = cloth_pose_identity()};
  cloth_def_params(def)->mesh_defects = 0;
  CHECK_OK(cloth_def_add_cloth(def, &again, NULL, &err), err);
  cloth_def_free(def);
  return 0;
}

static int a_sound_mesh_comes_out_as_it_went_in(void)
{
  fixture f = good();
  give_material(&f);
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(add_cloth(&f, false, &def, &err), err);
  const cloth_mesh *m = &def->cloth[0].mesh;
  CHECK(repairs_are(&def->cloth[0].repairs, (cloth_mesh_repairs){0}));
  CHECK(m->vertex_count == 6 && m->triangle_count == 4);
  CHECK(memcmp(m->position, strip, sizeof strip) == 0);
  CHECK(memcmp(m->triangle, strip_triangle, sizeof strip_triangle) == 0);
  CHECK(memcmp(m->material, f.u, sizeof(double) * 6 * 4) == 0);
  cloth_def_free(def);
  return 0;
}

static int vertices_that_are_not_finite_are_never_taken(void)
{
  const double bad[] = {NAN, INFINITY, -INFINITY};
  for (int i = 0; i < 3; i++) {
    fixture f = good();
    f.x[3][1] = bad[i];
    for (int repair = 0; repair < 2; repair++) {
      cloth_def *def;
      cloth_error err = {0};
      CHECK(add_cloth(&f, repair, &def, &err) == CLOTH_BAD_SCENE);
      CHECK(strstr(err.text, "vertex 3 = (1, ") && strstr(err.text, "[m] is not finite"));
      cloth_def_free(def);
    }
    cloth_def *def;
    cloth_error err = {0};
    CHECK(add_body(&f, &def, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "'link': vertex 3") != NULL);
    CHECK(def->body_count == 0);
    cloth_def_free(def);
  }
  return 0;
}

static int indices_out_of_range_are_never_taken(void)
{
  const int bad[] = {-1, 6, 2147483647, -2147483647};
  for (int i = 0; i < 4; i++) {
    fixture f = good();
    f.t[2][1] = bad[i];
    cloth_def *def;
    cloth_error err = {0}, err2 = {0};
    CHECK(add_cloth(&f, true, &def, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "triangle 2 names vertex ") && strstr(err.text, "in [0, 5]"));
    cloth_def_free(def);
    CHECK(add_body(&f, &def, &err2) == CLOTH_BAD_SCENE);
    cloth_def_free(def);
  }
  return 0;
}

static int empty_meshes_are_never_taken(void)
{
  for (int i = 0; i < 4; i++) {
    fixture f = good();
    cloth_mesh_view v = view_of(&f);
    if (i == 0) v.vertex_count = 0;
    if (i == 1) v.triangle_count = -1;
    if (i == 2) v.position = NULL;
    if (i == 3) v.vertex_count = 2147483647;
    cloth_body_view body = {.name = "b", .mesh = v, .pose = cloth_pose_identity()};
    cloth_def *def;
    cloth_error err = {0};
    CHECK_OK(cloth_def_new(&def, &err), err);
    CHECK(cloth_def_add_body(def, &body, NULL, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "'b': the mesh has") != NULL);
    cloth_def_free(def);
  }
  return 0;
}

static int zero_area_is_dropped(void)
{
  fixture twice = good(), collinear = good(), point = good();
  const int repeated[3] = {4, 4, 5};
  memcpy(twice.t[twice.triangle_count++], repeated, sizeof repeated);
  const double middle[3] = {1.5, 0.5,
                            0}; // on the line from 2 to 5, and used by this triangle alone
  memcpy(collinear.x[collinear.vertex_count++], middle, sizeof middle);
  const int flat[3] = {2, 5, 6};
  memcpy(collinear.t[collinear.triangle_count++], flat, sizeof flat);
  const int same[3] = {6, 7, 8};
  memcpy(point.t[point.triangle_count++], same, sizeof same);
  point.vertex_count = 9; // three vertices at the origin
  CHECK(check_defect(&twice, "triangle 4 (vertices 4, 4, 5) has no area",
                     (cloth_mesh_repairs){.zero_area = 1}, 6, 4) == 0);
  CHECK(check_defect(&collinear, "triangle 4 (vertices 2, 5, 6) has no area",
                     (cloth_mesh_repairs){.zero_area = 1, .unreferenced = 1}, 6, 4) == 0);
  CHECK(check_defect(&point, "triangle 4", (cloth_mesh_repairs){.zero_area = 1, .unreferenced = 3},
                     6, 4) == 0);
  return 0;
}

// small is not the same as flat: a cloth of microns is sound
static int area_is_judged_by_shape_not_by_size(void)
{
  fixture f = good();
  for (int v = 0; v < 6; v++)
    for (int i = 0; i < 3; i++) f.x[v][i] *= 1e-6;
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(add_cloth(&f, false, &def, &err), err);
  cloth_def_free(def);
  return 0;
}

static int duplicates_are_dropped(void)
{
  // as it is, from another corner on, the other way round
  const int copies[3][3] = {{2, 4, 3}, {4, 3, 2}, {4, 2, 3}};
  for (int i = 0; i < 3; i++) {
    fixture f = good();
    memcpy(f.t[f.triangle_count++], copies[i], sizeof copies[i]);
    CHECK(check_defect(&f, "triangles 2 and 4 have the same vertices",
                       (cloth_mesh_repairs){.duplicate = 1}, 6, 4) == 0);
  }
  return 0;
}

static int third_triangles_on_an_edge_are_dropped(void)
{
  fixture f = good();
  const double fin[3] = {1, 0.5, 1};
  const int third[3] = {2, 3, 6}; // the edge 2 3 has triangles 1 and 2
  memcpy(f.x[f.vertex_count++], fin, sizeof fin);
  memcpy(f.t[f.triangle_count++], third, sizeof third);
  return check_defect(&f, "the edge of vertices 2 and 3 has more than two triangles (1, 2, 4)",
                      (cloth_mesh_repairs){.non_manifold = 1, .unreferenced = 1}, 6, 4);
}

static void turn(fixture *f, int t)
{
  int v = f->t[t][1];
  f->t[t][1] = f->t[t][2], f->t[t][2] = v;
}

// the fewer turned ones follow the many, material corners with them
static int turned_triangles_are_turned_back(void)
{
  for (int t = 0; t < 4; t++) {
    fixture f = good();
    turn(&f, t);
    give_material(&f);
    CHECK(check_defect(&f, "are wound against each other", (cloth_mesh_repairs){.flipped = 1}, 6,
                       4) == 0);
    cloth_def *def;
    cloth_error err = {0};
    double least;
    CHECK_OK(add_cloth(&f, true, &def, &err), err);
    const cloth_mesh *m = &def->cloth[0].mesh;
    CHECK(shape_area(m, &least) == 2 && least == 0.5);
    for (int i = 0; i < 12; i++) CHECK(m->material[2 * i] == m->position[3 * m->triangle[i]]);
    cloth_def_free(def);
  }
  return 0;
}

// a strip closed with half a turn
static int one_sided_cloth_is_refused_even_on_repair(void)
{
  fixture f = {.vertex_count = 12, .triangle_count = 0};
  for (int i = 0; i < 6; i++) { // 0 1, 2 3, ... are the ends of six rungs
    double a = i * 1.0471975511965976, half = a / 2;
    for (int end = 0; end < 2; end++) {
      double s = end ? 0.3 : -0.3;
      f.x[2 * i + end][0] = (1 + s * cos(half)) * cos(a);
      f.x[2 * i + end][1] = (1 + s * cos(half)) * sin(a);
      f.x[2 * i + end][2] = s * sin(half);
    }
  }
  for (int i = 0; i < 6; i++) {
    int a = 2 * i, b = a + 1, c = (a + 2) % 12, d = c + 1;
    if (i == 5) c = 1, d = 0; // the half turn
    const int two[2][3] = {{a, c, b}, {c, d, b}};
    memcpy(f.t[f.triangle_count++], two[0], sizeof two[0]);
    memcpy(f.t[f.triangle_count++], two[1], sizeof two[1]);
  }
  for (int repair = 0; repair < 2; repair++) { // nor is the repair recommended
    cloth_def *def;
    cloth_error err = {0};
    CHECK(add_cloth(&f, repair, &def, &err) == CLOTH_BAD_SCENE);
    CHECK(strstr(err.text, "Moebius") != NULL);
    cloth_def_free(def);
  }
  return 0;
}

static int unused_vertices_are_dropped_and_groups_follow(void)
{
  fixture f = good();
  for (int v = 6; v > 2; v--) memcpy(f.x[v], f.x[v - 1], sizeof f.x[v]); // a hole at vertex 2
  f.vertex_count = 7;
  for (int t = 0; t < 4; t++)
    for (int k = 0; k < 3; k++) f.t[t][k] += f.t[t][k] >= 2;
  CHECK(check_defect(&f, "vertex 2 belongs to no triangle", (cloth_mesh_repairs){.unreferenced = 1},
                     6, 4) == 0);

  const int some[] = {6, 2, 3, 0, 3}, only[] = {2};
  const cloth_group_view groups[] = {{"some", 5, some}, {"only", 1, only}};
  cloth_cloth_view v = {.name = "sheet",
                        .mesh = view_of(&f),
                        .material = cloth_material_default(),
                        .pose = cloth_pose_identity(),
                        .group_count = 1,
                        .group = groups};
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(cloth_def_new(&def, &err), err);
  cloth_def_params(def)->mesh_defects = 1;
  CHECK_OK(cloth_def_add_cloth(def, &v, NULL, &err), err);
  const cloth_group_def *g = &def->cloth[0].group[0];
  CHECK(g->count == 3 && g->vertex[0] == 0 && g->vertex[1] == 2 && g->vertex[2] == 5);
  v.name = "other", v.group_count = 2;
  CHECK(cloth_def_add_cloth(def, &v, NULL, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "no vertex of group 'only' is left") != NULL);
  CHECK(def->cloth_count == 1);
  cloth_def_free(def);
  return 0;
}

static int flat_material_is_flattened_from_the_shape(void)
{
  fixture f = good();
  give_material(&f);
  for (int k = 0; k < 3; k++) f.u[1][2 * k] = f.u[1][2 * k + 1] = 0.5;
  CHECK(check_defect(&f, "triangle 1 has no area in material space",
                     (cloth_mesh_repairs){.flattened = 1}, 6, 4) == 0);
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(add_cloth(&f, true, &def, &err), err);
  const double *u = def->cloth[0].mesh.material + 6; // of the corners (1, 0), (1, 1), (0, 1)
  CHECK_NEAR(u[2] - u[0], 0, 1e-15);
  CHECK_NEAR(u[3] - u[1], 1, 1e-15);
  CHECK_NEAR(u[4] - u[0], -1, 1e-15);
  CHECK_NEAR(u[5] - u[1], 1, 1e-15);
  cloth_def_free(def);

  f.u[2][3] = NAN;
  CHECK(add_cloth(&f, true, &def, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "triangle 2, corner 1: material coordinates") != NULL);
  cloth_def_free(def);
  return 0;
}

// a robot's meshes are what they are: only what cannot be collided with goes
static int bodies_may_be_open_and_non_manifold(void)
{
  fixture f = good();
  const double fin[3] = {1, 0.5, 1}, stray[3] = {9, 9, 9};
  const int more[5][3] = {{2, 3, 6}, {1, 2, 0}, {1, 2, 0}, {3, 3, 1}, {4, 2, 3}};
  memcpy(f.x[f.vertex_count++], fin, sizeof fin);
  memcpy(f.x[f.vertex_count++], stray, sizeof stray);
  memcpy(f.t[4], more, sizeof more);
  f.triangle_count = 9;
  cloth_def *def;
  cloth_error err = {0};
  CHECK_OK(add_body(&f, &def, &err), err);
  const cloth_body_def *b = &def->body[0];
  // kept: the strip, the fin, and two backs of a thin wall
  CHECK(b->mesh.triangle_count == 7 && b->mesh.vertex_count == 7);
  CHECK(repairs_are(&b->repairs,
                    (cloth_mesh_repairs){.zero_area = 1, .duplicate = 1, .unreferenced = 1}));
  CHECK(b->mesh.material == NULL);
  cloth_def_free(def);
  return 0;
}

static int nothing_left_is_refused(void)
{
  fixture f = good();
  for (int t = 0; t < 4; t++) f.t[t][2] = f.t[t][0];
  cloth_def *def;
  cloth_error err = {0}, err2 = {0};
  CHECK(add_body(&f, &def, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "no triangle has an area") != NULL);
  cloth_def_free(def);
  CHECK(add_cloth(&f, true, &def, &err2) == CLOTH_BAD_SCENE);
  CHECK(strstr(err2.text, "no triangle has an area") != NULL);
  cloth_def_free(def);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(a_sound_mesh_comes_out_as_it_went_in);
  RUN(vertices_that_are_not_finite_are_never_taken);
  RUN(indices_out_of_range_are_never_taken);
  RUN(empty_meshes_are_never_taken);
  RUN(zero_area_is_dropped);
  RUN(area_is_judged_by_shape_not_by_size);
  RUN(duplicates_are_dropped);
  RUN(third_triangles_on_an_edge_are_dropped);
  RUN(turned_triangles_are_turned_back);
  RUN(one_sided_cloth_is_refused_even_on_repair);
  RUN(unused_vertices_are_dropped_and_groups_follow);
  RUN(flat_material_is_flattened_from_the_shape);
  RUN(bodies_may_be_open_and_non_manifold);
  RUN(nothing_left_is_refused);
  return failures != 0;
}
