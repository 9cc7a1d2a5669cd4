// Tests of src/scene/obj.c, obj_write.c, ply.c and mesh_file.c.
#include "check.h"
#include "folder.h"
#include "scene/mesh.h"

#include <stdint.h>

// a bent sheet whose numbers have no short decimal form
static cloth_mesh sample(void)
{
  const double size[2] = {1, 1};
  const int resolution[2] = {5, 6};
  cloth_mesh m;
  cloth_error err = {0};
  if (cloth_mesh_grid(size, resolution, CLOTH_GRID_UNSTRUCTURED, &m, &err) != CLOTH_OK) exit(1);
  for (int v = 0; v < m.vertex_count; v++) m.position[3 * v + 2] = sin(7.0 * v) / 3;
  return m;
}

static bool same_shape(const cloth_mesh *a, const cloth_mesh *b)
{
  return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
         memcmp(a->position, b->position, sizeof(double) * 3 * (size_t)a->vertex_count) == 0 &&
         memcmp(a->triangle, b->triangle, sizeof(int) * 3 * (size_t)a->triangle_count) == 0;
}

// ---- a PLY writer, for the tests alone ----------------------------------------------------------

typedef enum ply_kind { PLY_ASCII, PLY_LITTLE, PLY_BIG } ply_kind;

static size_t put(char *out, size_t at, const void *value, size_t size, ply_kind kind)
{
  const uint16_t probe = 1;
  bool machine_is_little = *(const char *)&probe == 1;
  for (size_t i = 0; i < size; i++)
    out[at + i] =
        ((const char *)value)[(kind == PLY_LITTLE) == machine_is_little ? i : size - 1 - i];
  return at + size;
}

// vertices as double with a stray short before and a list between; faces with ushort counts and
// ints
static size_t write_ply(const cloth_mesh *m, ply_kind kind, const char *newline, char *out,
                        size_t room)
{
  static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  const char *n = newline;
  size_t at = (size_t)snprintf(
      out, room,
      "ply%sformat %s 1.0%scomment made by a test%selement vertex %d%sproperty short "
      "flag%sproperty "
      "double x%sproperty float64 y%sproperty list uchar float stray%sproperty double z%sproperty "
      "double s%sproperty double t%selement edge 1%sproperty int a%sproperty uint b%selement face "
      "%d%sproperty uchar red%sproperty list ushort int vertex_indices%send_header%s",
      n, names[kind], n, n, m->vertex_count, n, n, n, n, n, n, n, n, n, n, n, m->triangle_count, n,
      n, n, n);
  double uv[64][2];
  for (int i = 0; i < 3 * m->triangle_count; i++)
    memcpy(uv[m->triangle[i]], m->material + 2 * i, sizeof uv[0]);
  for (int v = 0; v < m->vertex_count; v++) {
    const double *x = m->position + 3 * v;
    int16_t flag = (int16_t)(-v);
    uint8_t two = 2;
    float stray[2] = {1.5f, -2};
    if (kind == PLY_ASCII) {
      at += (size_t)snprintf(out + at, room - at, "%d %.17g %.17g 2 1.5 -2 %.17g %.17g %.17g%s",
                             flag, x[0], x[1], x[2], uv[v][0], uv[v][1], n);
      continue;
    }
    at = put(out, at, &flag, 2, kind), at = put(out, at, &x[0], 8, kind);
    at = put(out, at, &x[1], 8, kind), at = put(out, at, &two, 1, kind);
    at = put(out, at, &stray[0], 4, kind), at = put(out, at, &stray[1], 4, kind);
    at = put(out, at, &x[2], 8, kind), at = put(out, at, &uv[v][0], 8, kind);
    at = put(out, at, &uv[v][1], 8, kind);
  }
  int32_t a = -5;
  uint32_t b = 4000000000u;
  if (kind == PLY_ASCII) at += (size_t)snprintf(out + at, room - at, "%d %u%s", a, b, n);
  if (kind != PLY_ASCII) at = put(out, at, &a, 4, kind), at = put(out, at, &b, 4, kind);
  for (int t = 0; t < m->triangle_count; t++) {
    const int *v = m->triangle + 3 * t;
    uint8_t red = 200;
    uint16_t three = 3;
    if (kind == PLY_ASCII) {
      at += (size_t)snprintf(out + at, room - at, "200 3 %d %d %d%s", v[0], v[1], v[2], n);
      continue;
    }
    at = put(out, at, &red, 1, kind), at = put(out, at, &three, 2, kind);
    for (int k = 0; k < 3; k++) at = put(out, at, &v[k], 4, kind);
  }
  return at;
}

// ---- round trips --------------------------------------------------------------------------------

static int every_encoding_gives_the_same_mesh(void)
{
  folder f = folder_make();
  cloth_mesh m = sample();
  cloth_error err = {0};
  cloth_mesh_file back;
  char *bytes = malloc(1 << 20);
  const char *path = folder_path(&f, "a.obj");
  CHECK_OK(cloth_obj_write(path, m.vertex_count, m.position, m.triangle_count, m.triangle, &err),
           err);
  CHECK_OK(cloth_mesh_file_read(path, &back, &err), err);
  CHECK(same_shape(&m, &back.mesh) && back.mesh.material == NULL);
  cloth_mesh_file_free(&back);
  static const char *const newlines[] = {"\n", "\r\n"};
  for (int i = 0; i < 6; i++) {
    size_t n = write_ply(&m, (ply_kind)(i % 3), newlines[i / 3], bytes, 1 << 20);
    path = folder_write_bytes(&f, "b.PLY", bytes, n);
    CHECK_OK(cloth_mesh_file_read(path, &back, &err), err);
    CHECK(same_shape(&m, &back.mesh));
    CHECK(back.mesh.material != NULL);
    CHECK(memcmp(m.material, back.mesh.material, sizeof(double) * 6 * (size_t)m.triangle_count) ==
          0);
    cloth_mesh_file_free(&back);
  }
  free(bytes);
  cloth_mesh_free(&m);
  folder_remove(&f);
  return 0;
}

// a binary file cut at any byte is refused; nothing is read behind its end (address sanitizer)
static int truncated_files_are_refused(void)
{
  folder f = folder_make();
  cloth_mesh m = sample();
  char *bytes = malloc(1 << 20);
  for (int kind = 0; kind < 3; kind++) {
    size_t n = write_ply(&m, (ply_kind)kind, "\n", bytes, 1 << 20);
    for (size_t cut = 0; cut + 2 < n; cut += n / 97) {
      cloth_mesh_file back;
      cloth_error err = {0};
      const char *path = folder_write_bytes(&f, "cut.ply", bytes, cut);
      CHECK(cloth_mesh_file_read(path, &back, &err) == CLOTH_BAD_SCENE);
      CHECK(strstr(err.text, "cut.ply") != NULL);
    }
  }
  free(bytes);
  cloth_mesh_free(&m);
  folder_remove(&f);
  return 0;
}

static int small_types_are_read(void)
{
  // char x, uchar y, ushort z and an unsigned char list of chars
  static const char head[] =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty char x\n"
      "property uint8 y\nproperty uint16 z\nelement face 1\n"
      "property list uint8 int8 vertex_index\nend_header\n";
  static const unsigned char body[] = {0xff, 200, 1, 2, 0, 0, 0, 0, 127, 1, 0xff, 0xff, 3, 0, 1, 2};
  char bytes[512];
  memcpy(bytes, head, sizeof head - 1);
  memcpy(bytes + sizeof head - 1, body, sizeof body);
  folder f = folder_make();
  cloth_mesh_file back;
  cloth_error err = {0};
  const char *path = folder_write_bytes(&f, "a.ply", bytes, sizeof head - 1 + sizeof body);
  CHECK_OK(cloth_mesh_file_read(path, &back, &err), err);
  const double expected[9] = {-1, 200, 258, 0, 0, 0, 127, 1, 65535};
  CHECK(memcmp(back.mesh.position, expected, sizeof expected) == 0);
  cloth_mesh_file_free(&back);
  folder_remove(&f);
  return 0;
}

// some exporters write the same coordinates under several names
static int the_first_texture_coordinates_of_a_ply_count(void)
{
  folder f = folder_make();
  cloth_mesh_file m;
  cloth_error err = {0};
  const char *path = folder_write(
      &f, "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float s\nproperty float t\nproperty float u\nproperty float v\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 1 2 7 7\n1 0 0 3 4 7 7\n0 1 0 5 6 7 7\n3 0 1 2\n");
  CHECK_OK(cloth_mesh_file_read(path, &m, &err), err);
  CHECK(m.mesh.material != NULL);
  for (int k = 0; k < 6; k++) CHECK(m.mesh.material[k] == k + 1);
  cloth_mesh_file_free(&m);
  folder_remove(&f);
  return 0;
}

// ---- OBJ ----------------------------------------------------------------------------------------

static cloth_status read_obj(const char *text, cloth_mesh_file *out, cloth_error *err)
{
  folder f = folder_make();
  cloth_status status = cloth_mesh_file_read(folder_write(&f, "m.obj", text), out, err);
  folder_remove(&f);
  return status;
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static int polygons_become_fans(void)
{
  cloth_mesh_file m;
  cloth_error err = {0};
  CHECK_OK(read_obj(SQUARE "v -1 0.5 0\nf 1 2 3 4 5\n", &m, &err), err);
  const int fan[9] = {0, 1, 2, 0, 2, 3, 0, 3, 4};
  CHECK(m.mesh.triangle_count == 3 && memcmp(m.mesh.triangle, fan, sizeof fan) == 0);
  cloth_mesh_file_free(&m);
  return 0;
}

static int every_way_to_write_a_face(void)
{
  static const char *const faces[] = {"f 1 2 3",
                                      "f -4 -3 -2",
                                      "f 1/1 2/2 3/3",
                                      "f 1//1 2//1 3//1",
                                      "f 1/1/1 2/2/1 3/3/1",
                                      "f 1/ 2/ 3/",
                                      "f 1// 2// 3//",
                                      "f -4/-3/-1 -3/-2/-1 -2/-1/-1",
                                      "  f\t1   2 \\\n 3  # comment",
                                      "f 1 2 3\r",
                                      "f 1 2 3 \r\n\r\n"};
  for (size_t i = 0; i < sizeof faces / sizeof faces[0]; i++) {
    char text[512];
    snprintf(text, sizeof text, "# c\nmtllib x.mtl\n%svt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n%s", SQUARE,
             faces[i]);
    cloth_mesh_file m;
    cloth_error err = {0};
    const int expected[3] = {0, 1, 2};
    CHECK_OK(read_obj(text, &m, &err), err);
    CHECK(m.mesh.vertex_count == 4 && m.mesh.triangle_count == 1);
    CHECK(memcmp(m.mesh.triangle, expected, sizeof expected) == 0);
    bool has_vt = strchr(faces[i], '/') && !strstr(faces[i], "//") && !strstr(faces[i], "/ ");
    CHECK((m.mesh.material != NULL) == has_vt);
    if (has_vt)
      CHECK(m.mesh.material[2] == 1 && m.mesh.material[3] == 0 && m.mesh.material[5] == 1);
    cloth_mesh_file_free(&m);
  }
  return 0;
}

static int groups_hold_the_vertices_of_their_faces(void)
{
  cloth_mesh_file m;
  cloth_error err = {0};
  CHECK_OK(read_obj(SQUARE "v 2 0 0\nv 2 1 0\no shirt\nf 1 2 3\ng left hem\nf 1 3 4\ng right\n"
                           "f 2 5 6\ng\nf 2 6 3\ng empty\n",
                    &m, &err),
           err);
  static const struct {
    const char *name;
    int count, vertex[6];
  } expected[] = {{"shirt", 6, {0, 1, 2, 3, 4, 5}},
                  {"left", 3, {0, 2, 3}},
                  {"hem", 3, {0, 2, 3}},
                  {"right", 3, {1, 4, 5}}};
  CHECK(m.group_count == 4);
  for (int i = 0; i < 4; i++) {
    CHECK(strcmp(m.group[i].name, expected[i].name) == 0);
    CHECK(m.group[i].count == expected[i].count);
    for (int k = 0; k < m.group[i].count; k++) CHECK(m.group[i].vertex[k] == expected[i].vertex[k]);
  }
  cloth_mesh_file_free(&m);
  return 0;
}

static int long_lines_are_lines(void)
{
  size_t n = 200000;
  char *text = malloc(n + 200);
  int at = sprintf(text, "%s# ", SQUARE);
  memset(text + at, 'x', n);
  strcpy(text + (size_t)at + n, "\nv 0.5 0.5 1 0.1 0.2 0.3\nf 1 2 5\n");
  cloth_mesh_file m;
  cloth_error err = {0};
  CHECK_OK(read_obj(text, &m, &err), err);
  CHECK(m.mesh.vertex_count == 5 && m.mesh.position[14] == 1);
  cloth_mesh_file_free(&m);
  free(text);
  return 0;
}

static int partial_texture_coordinates_are_noticed(void)
{
  cloth_mesh_file m;
  cloth_error err = {0};
  CHECK_OK(read_obj(SQUARE "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1 3 4\n", &m, &err), err);
  CHECK(m.mesh.material == NULL && m.material_missing == 9);
  cloth_mesh_file_free(&m);
  return 0;
}

static int bad_files_name_their_line(void)
{
  static const struct {
    const char *name, *text, *expected;
  } rows[] = {
      {"a.obj", SQUARE "f 1 2 9\n", "a.obj:5: f: vertex 9 is not there; 4 precede this line"},
      {"a.obj", SQUARE "f 1 2 0\n", "a.obj:5: f: vertex 0 is not there"},
      {"a.obj", SQUARE "f 1 2 -5\n", "a.obj:5: f: vertex -5 is not there"},
      {"a.obj", SQUARE "f 1 2 99999999999999999999\n", "a.obj:5: f: "},
      {"a.obj", SQUARE "f 1 2\n", "a.obj:5: f has 2 corners; it needs 3"},
      {"a.obj", SQUARE "f 1/7 2/7 3/7\n", "a.obj:5: f: vt 7 is not there"},
      {"a.obj", SQUARE "f 1/1/1/1 2 3\n", "a.obj:5: f: "},
      {"a.obj", SQUARE "f a b c\n", "a.obj:5: f: 'a' is not v, v/vt, v//vn or v/vt/vn"},
      {"a.obj", SQUARE "f 1.5 2 3\n", "a.obj:5: f: '1.5' is not"},
      {"a.obj", "v 0 0\n", "a.obj:1: v has 2 numbers; it needs 3"},
      {"a.obj", "\n\nv 0 0 nan\n", "a.obj:3: v: 'nan' is not a finite number"},
      {"a.obj", "v 0 1e999 0\n", "a.obj:1: v: '1e999' is not a finite number"},
      {"a.obj", "v 0 0,5 0\n", "a.obj:1: v: '0,5' is not a finite number"},
      {"a.obj", "v 0 0 0\\\n x\n", "a.obj:2: v: 'x' is not a finite number"},
      {"a.obj", "hello world\n", "a.obj:1: 'hello' is not an OBJ statement"},
      {"a.obj",
       "\x7f"
       "ELF\x02\x01\x01",
       "a.obj:1: "},
      {"a.obj", SQUARE, "a.obj: the mesh has 4 vertices and 0 triangles"},
      {"a.obj", "", "a.obj: the mesh has 0 vertices and 0 triangles"},
      {"a.stl", "solid x\n", "a.stl: the name ends neither with .obj nor with .ply"},
      {"a.ply", "", "a.ply:1: the first line is not 'ply'"},
      {"a.ply", "ply\n", "a.ply:1: the header ends without 'end_header'"},
      {"a.ply", "ply\nformat ascii 2.0\n", "a.ply:2: 'format ascii 2.0' is not 'format KIND 1.0'"},
      {"a.ply", "ply\nformat text 1.0\n", "a.ply:2: format 'text' is not one of"},
      {"a.ply", "ply\nend_header\n", "a.ply:2: the header has no 'format' line"},
      {"a.ply", "ply\nformat ascii 1.0\nend_header\n", "element vertex has no property x"},
      {"a.ply", "ply\nformat ascii 1.0\nproperty int x\n",
       "a.ply:3: a property before the first element"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex many\n", "a.ply:3: "},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex -3\n", "a.ply:3: "},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 9000000000000\n",
       "a.ply:3: vertex: more than 100 million"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty quad x\n",
       "a.ply:4: 'quad' is not a PLY type"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float x\n",
       "a.ply:5: "},
      {"a.ply", "ply\nformat ascii 1.0\nwhat\n", "a.ply:3: 'what' does not belong in a PLY header"},
#define HEAD                                                                                       \
  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "   \
  "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      {"a.ply", HEAD "0 0 0\n1 0 0\n0 one 0\n3 0 1 2\n", "a.ply:12: 'one' is not a number"},
      {"a.ply", HEAD "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n",
       "a.ply:11: vertex 1: nan is not a finite number"},
      {"a.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
       "a.ply: a face names vertex 7; indices are in [0, 2]"},
      {"a.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
       "a.ply:13: face 0: -1 is not the index of a vertex"},
      {"a.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "a.ply:13: face 0 has 2 corners; it needs 3"},
      {"a.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n200 0 1 2\n",
       "a.ply:13: 200 is not the length of a list"},
      {"a.ply", HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n5\n",
       "a.ply:14: 2 bytes follow the last element"},
      {"a.ply", HEAD "0 0 0\n1 0 0\n", "the file ends too early"},
  };
  folder f = folder_make();
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    cloth_mesh_file m;
    cloth_error err = {0};
    const char *path = folder_write(&f, rows[i].name, rows[i].text);
    cloth_status status = cloth_mesh_file_read(path, &m, &err);
    if (status != CLOTH_BAD_SCENE || strstr(err.text, rows[i].expected) == NULL) {
      printf("row %zu: %s\n  expected %s\n", i, err.text, rows[i].expected);
      return 1;
    }
    CHECK(m.mesh.position == NULL && m.group == NULL);
  }
  folder_remove(&f);
  return 0;
}

static int missing_files_and_folders_are_named(void)
{
  folder f = folder_make();
  cloth_mesh_file m;
  cloth_error err = {0};
  CHECK(cloth_mesh_file_read(folder_path(&f, "none.obj"), &m, &err) == CLOTH_BAD_SCENE);
  CHECK(strstr(err.text, "none.obj: No such file") != NULL);
  folder_remove(&f);
  err = (cloth_error){0};
  CHECK(cloth_mesh_file_read("/dev/null.obj", &m, &err) == CLOTH_BAD_SCENE);
  return 0;
}

// bytes changed at random must be refused or read, never crash (address sanitizer)
static int damaged_bytes_do_no_harm(void)
{
  folder f = folder_make();
  cloth_mesh mesh = sample();
  char *bytes = malloc(1 << 20), *damaged = malloc(1 << 20);
  uint64_t state = 7;
  int refused = 0;
  for (int i = 0; i < 300; i++) {
    size_t n = write_ply(&mesh, (ply_kind)(i % 3), "\n", bytes, 1 << 20);
    memcpy(damaged, bytes, n);
    for (int k = 0; k < 5; k++) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      damaged[(state >> 20) % n] = (char)(state >> 56);
    }
    cloth_mesh_file m;
    cloth_error err = {0};
    cloth_status status =
        cloth_mesh_file_read(folder_write_bytes(&f, "d.ply", damaged, n), &m, &err);
    CHECK(status == CLOTH_OK || status == CLOTH_BAD_SCENE);
    refused += status != CLOTH_OK;
    if (status == CLOTH_OK) cloth_mesh_file_free(&m);
  }
  CHECK(refused > 30);
  free(bytes), free(damaged);
  cloth_mesh_free(&mesh);
  folder_remove(&f);
  return 0;
}

static int a_file_appears_whole_or_not_at_all(void)
{
  folder f = folder_make();
  cloth_mesh m = sample();
  cloth_error err = {0};
  const char *path = folder_path(&f, "out.obj");
  CHECK_OK(cloth_obj_write(path, m.vertex_count, m.position, m.triangle_count, m.triangle, &err),
           err);
  CHECK_OK(cloth_obj_write(path, m.vertex_count, m.position, m.triangle_count, m.triangle, &err),
           err);
  CHECK(folder_count(&f) == 1); // no temporary file stays
  path = folder_path(&f, "no/such/folder.obj");
  CHECK(cloth_obj_write(path, m.vertex_count, m.position, m.triangle_count, m.triangle, &err) ==
        CLOTH_IO);
  CHECK(strstr(err.text, "folder.obj: cannot be written: No such file") != NULL);
  err = (cloth_error){0};
  // a full disk is seen when the file is closed
  if (symlink("/dev/full", folder_path(&f, "full.obj.part")) == 0 &&
      access("/dev/full", W_OK) == 0) {
    path = folder_path(&f, "full.obj");
    CHECK(cloth_obj_write(path, m.vertex_count, m.position, m.triangle_count, m.triangle, &err) ==
          CLOTH_IO);
    CHECK(access(path, F_OK) != 0);
  }
  cloth_mesh_free(&m);
  folder_remove(&f);
  return 0;
}

// meshes written by other programs, where they are
static int meshes_of_others_are_read(void)
{
  const char *data = getenv("CLOTH_SHARED_DATA");
  char folder_name[1024], path[1200];
  snprintf(folder_name, sizeof folder_name, "%s", __FILE__);
  char *end = strstr(folder_name, "test/scene/");
  if (data)
    snprintf(folder_name, sizeof folder_name, "%s", data);
  else if (end)
    snprintf(end, sizeof folder_name - (size_t)(end - folder_name), "../shared/data");
  static const struct {
    const char *name;
    int vertices, triangles;
  } rows[] = {{"square2K.obj", 1939, 3716},
              {"cylinder7K.obj", 7296, 13992},
              {"skirt16x64.obj", 1024, 1920},
              {"tableCloth.obj", 14161, 27848},
              {"dress/stage.obj", 15656, 29456}};
  for (int i = 0; i < 5; i++) {
    snprintf(path, sizeof path, "%.1000s/meshes/%s", folder_name, rows[i].name);
    if (access(path, R_OK) != 0) {
      printf("skip: no %s\n", rows[i].name);
      continue;
    }
    cloth_mesh_file m;
    cloth_error err = {0};
    CHECK_OK(cloth_mesh_file_read(path, &m, &err), err);
    CHECK(m.mesh.vertex_count == rows[i].vertices && m.mesh.triangle_count == rows[i].triangles);
    cloth_mesh_file_free(&m);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(every_encoding_gives_the_same_mesh);
  RUN(truncated_files_are_refused);
  RUN(small_types_are_read);
  RUN(the_first_texture_coordinates_of_a_ply_count);
  RUN(polygons_become_fans);
  RUN(every_way_to_write_a_face);
  RUN(groups_hold_the_vertices_of_their_faces);
  RUN(long_lines_are_lines);
  RUN(partial_texture_coordinates_are_noticed);
  RUN(bad_files_name_their_line);
  RUN(missing_files_and_folders_are_named);
  RUN(damaged_bytes_do_no_harm);
  RUN(a_file_appears_whole_or_not_at_all);
  RUN(meshes_of_others_are_read);
  return failures != 0;
}
