// Wavefront OBJ: v, vt (material coordinates in metres), f (polygons, as fans), g and o (groups).
#include "scene/mesh_file.h"
#include "scene/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct group {
  char *name;
  cloth_ints vertex;
} group;

typedef struct reader {
  const char *path, *at;
  int line;
  cloth_doubles v, vt;      // 3, 2 numbers each
  cloth_ints vertex, vt_of; // 3 per triangle; vt_of is -1 where a corner has none
  cloth_ints polygon;       // (vertex, vt) of the face that is being read
  int with_vt, without_vt;  // line of the first face with, without texture coordinates; 0: none
  group *group;
  size_t group_count, group_room;
  int of_object;        // group of `o`, -1: none
  cloth_ints of_groups; // groups of `g`
} reader;

#define OBJ_FAIL(r, err, ...)                                                                      \
  do {                                                                                             \
    char text_[256];                                                                               \
    snprintf(text_, sizeof text_, __VA_ARGS__);                                                    \
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s:%d: %s", (r)->path, (r)->line, text_);                    \
  } while (0)

#define PUSH(r, err, call)                                                                         \
  do {                                                                                             \
    if (!(call)) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s:%d: no memory", (r)->path, (r)->line);       \
  } while (0)

static bool at_end_of_line(char c) { return c == '\0' || c == '\n' || c == '\r' || c == '#'; }

static bool at_end_of_word(char c)
{
  return c == ' ' || c == '\t' || c == '\\' || at_end_of_line(c);
}

static void skip_newline(reader *r)
{
  if (*r->at == '\0') return;
  r->at += r->at[0] == '\r' && r->at[1] == '\n' ? 2 : 1;
  r->line++;
}

// blanks, and the backslash that joins a line with the next
static void skip_blanks(reader *r)
{
  for (;;) {
    if (*r->at == ' ' || *r->at == '\t') {
      r->at++;
    } else if (*r->at == '\\' && (r->at[1] == '\n' || r->at[1] == '\r')) {
      r->at++;
      skip_newline(r);
    } else {
      return;
    }
  }
}

static size_t word_length(const char *at)
{
  size_t n = 0;
  while (!at_end_of_word(at[n])) n++;
  return n;
}

static int shown(size_t n) { return n < 40 ? (int)n : 40; }

// up to `most` finite numbers until the end of the line; *count is how many there were
static cloth_status read_numbers(reader *r, const char *what, int least, int most, double *out,
                                 cloth_error *err)
{
  int n = 0;
  for (;; n++) {
    skip_blanks(r);
    if (at_end_of_line(*r->at)) break;
    double value;
    const char *end = cloth_number_read(r->at, &value);
    if (end == NULL || !at_end_of_word(*end) || !isfinite(value))
      OBJ_FAIL(r, err, "%s: '%.*s' is not a finite number", what, shown(word_length(r->at)), r->at);
    if (n < most) out[n] = value;
    r->at = end;
  }
  if (n < least) OBJ_FAIL(r, err, "%s has %d numbers; it needs %d", what, n, least);
  return CLOTH_OK;
}

static cloth_status read_vertex(reader *r, cloth_error *err)
{
  double x[3] = {0};
  CLOTH_TRY(read_numbers(r, "v", 3, 3, x, err)); // a weight or a colour may follow
  if (r->v.count / 3 >= CLOTH_MESH_FILE_MAX) OBJ_FAIL(r, err, "more than 100 million vertices");
  for (int i = 0; i < 3; i++) PUSH(r, err, cloth_doubles_push(&r->v, x[i]));
  return CLOTH_OK;
}

static cloth_status read_texture(reader *r, cloth_error *err)
{
  double u[2] = {0};
  CLOTH_TRY(read_numbers(r, "vt", 1, 2, u, err));
  if (r->vt.count / 2 >= CLOTH_MESH_FILE_MAX) OBJ_FAIL(r, err, "more than 100 million vt");
  for (int i = 0; i < 2; i++) PUSH(r, err, cloth_doubles_push(&r->vt, u[i]));
  return CLOTH_OK;
}

// One index of a face, from 1 on, or from the end when negative; *at moves behind it.
static cloth_status read_index(reader *r, const char *what, size_t count, int *out,
                               cloth_error *err)
{
  const char *start = r->at, *digit = start + (*start == '-');
  long long value = 0;
  for (; *digit >= '0' && *digit <= '9' && value < (1LL << 40); digit++)
    value = 10 * value + (*digit - '0');
  bool is_number = digit > start + (*start == '-') && (at_end_of_word(*digit) || *digit == '/');
  if (!is_number)
    OBJ_FAIL(r, err, "f: '%.*s' is not v, v/vt, v//vn or v/vt/vn", shown(word_length(start)),
             start);
  if (*start == '-') value = -value;
  long long index = value < 0 ? (long long)count + value : value - 1;
  if (value == 0 || index < 0 || index >= (long long)count)
    OBJ_FAIL(r, err, "f: %s %lld is not there; %zu precede this line", what, value, count);
  r->at = digit;
  *out = (int)index;
  return CLOTH_OK;
}

static cloth_status read_corner(reader *r, int *vertex, int *texture, cloth_error *err)
{
  int normal;
  *texture = -1;
  CLOTH_TRY(read_index(r, "vertex", r->v.count / 3, vertex, err));
  if (*r->at != '/') return CLOTH_OK;
  r->at++;
  // some exporters leave what they do not have empty: 1/ and 1//
  if (*r->at != '/' && !at_end_of_word(*r->at))
    CLOTH_TRY(read_index(r, "vt", r->vt.count / 2, texture, err));
  if (*r->at != '/') return CLOTH_OK;
  r->at++;
  if (at_end_of_word(*r->at)) return CLOTH_OK;
  // normals are not kept, so how many there are was not counted
  if (*r->at == '-')
    while (!at_end_of_word(*r->at)) r->at++;
  else
    CLOTH_TRY(read_index(r, "vn", (size_t)1 << 31, &normal, err));
  if (!at_end_of_word(*r->at)) OBJ_FAIL(r, err, "f: more than v/vt/vn in a corner");
  return CLOTH_OK;
}

static cloth_status join_groups(reader *r, int vertex, cloth_error *err)
{
  if (r->of_object >= 0) PUSH(r, err, cloth_ints_push(&r->group[r->of_object].vertex, vertex));
  for (size_t i = 0; i < r->of_groups.count; i++)
    if (r->of_groups.data[i] != r->of_object)
      PUSH(r, err, cloth_ints_push(&r->group[r->of_groups.data[i]].vertex, vertex));
  return CLOTH_OK;
}

static cloth_status read_face(reader *r, cloth_error *err)
{
  bool all_have_vt = true;
  r->polygon.count = 0;
  for (;;) {
    skip_blanks(r);
    if (at_end_of_line(*r->at)) break;
    int vertex, texture;
    CLOTH_TRY(read_corner(r, &vertex, &texture, err));
    all_have_vt = all_have_vt && texture >= 0;
    PUSH(r, err, cloth_ints_push(&r->polygon, vertex));
    PUSH(r, err, cloth_ints_push(&r->polygon, texture));
    CLOTH_TRY(join_groups(r, vertex, err));
  }
  const int *p = r->polygon.data;
  size_t corners = r->polygon.count / 2;
  if (corners < 3) OBJ_FAIL(r, err, "f has %zu corners; it needs 3", corners);
  if (r->vertex.count / 3 + corners > CLOTH_MESH_FILE_MAX)
    OBJ_FAIL(r, err, "more than 100 million triangles");
  int *first = all_have_vt ? &r->with_vt : &r->without_vt;
  if (*first == 0) *first = r->line;
  for (size_t i = 1; i + 1 < corners; i++) {
    const size_t fan[3] = {0, i, i + 1};
    for (int k = 0; k < 3; k++) {
      PUSH(r, err, cloth_ints_push(&r->vertex, p[2 * fan[k]]));
      PUSH(r, err, cloth_ints_push(&r->vt_of, p[2 * fan[k] + 1]));
    }
  }
  return CLOTH_OK;
}

static cloth_status find_group(reader *r, const char *name, size_t length, int *out,
                               cloth_error *err)
{
  for (size_t i = 0; i < r->group_count; i++)
    if (strlen(r->group[i].name) == length && memcmp(r->group[i].name, name, length) == 0) {
      *out = (int)i;
      return CLOTH_OK;
    }
  group *grown = cloth_list_grow(r->group, r->group_count, &r->group_room, sizeof *grown);
  PUSH(r, err, grown != NULL);
  r->group = grown;
  char *copy = malloc(length + 1);
  PUSH(r, err, copy != NULL);
  memcpy(copy, name, length);
  copy[length] = '\0';
  *out = (int)r->group_count;
  r->group[r->group_count++] = (group){.name = copy};
  return CLOTH_OK;
}

static cloth_status read_group(reader *r, bool object, cloth_error *err)
{
  if (object)
    r->of_object = -1;
  else
    r->of_groups.count = 0;
  for (;;) {
    skip_blanks(r);
    if (at_end_of_line(*r->at)) return CLOTH_OK;
    size_t n = word_length(r->at);
    int index = 0;
    if (n == 0) n = 1; // a lone backslash
    CLOTH_TRY(find_group(r, r->at, n, &index, err));
    r->at += n;
    if (!object)
      PUSH(r, err, cloth_ints_push(&r->of_groups, index));
    else if (r->of_object < 0)
      r->of_object = index;
  }
}

static cloth_status read_statement(reader *r, cloth_error *err)
{
  // legal, but nothing that a cloth or a body needs
  static const char *const ignored[] = {
      "vn",     "vp",       "p",        "l",      "s",     "usemtl",    "mtllib",
      "usemap", "maplib",   "bevel",    "mg",     "bmat",  "deg",       "lod",
      "cstype", "c_interp", "d_interp", "curv",   "curv2", "surf",      "parm",
      "trim",   "end",      "hole",     "scrv",   "sp",    "con",       "step",
      "ctech",  "stech",    "call",     "csh",    "res",   "bzp",       "bsp",
      "cdc",    "cdp",      "off",      "stitch", "seam",  "trace_obj", "shadow_obj"};
  size_t n = word_length(r->at);
  const char *word = r->at;
  r->at += n;
  if (n == 1 && *word == 'v') return read_vertex(r, err);
  if (n == 1 && *word == 'f') return read_face(r, err);
  if (n == 1 && (*word == 'g' || *word == 'o')) return read_group(r, *word == 'o', err);
  if (n == 2 && memcmp(word, "vt", 2) == 0) return read_texture(r, err);
  for (size_t i = 0; i < sizeof ignored / sizeof ignored[0]; i++) {
    if (strlen(ignored[i]) != n || memcmp(word, ignored[i], n) != 0) continue;
    for (;;) {
      while (*r->at != '\0' && *r->at != '\n' && *r->at != '\r' && *r->at != '\\') r->at++;
      const char *stop = r->at;
      skip_blanks(r);
      if (r->at != stop) continue; // joined with the next line
      if (*r->at != '\\') return CLOTH_OK;
      r->at++;
    }
  }
  OBJ_FAIL(r, err, "'%.*s' is not an OBJ statement", shown(n ? n : 1), word);
}

static cloth_status read_all(reader *r, const cloth_text *text, cloth_error *err)
{
  if (text->size >= 3 && memcmp(text->data, "\xef\xbb\xbf", 3) == 0) r->at += 3; // byte order mark
  for (;;) {
    skip_blanks(r);
    if (*r->at == '#')
      while (*r->at != '\0' && *r->at != '\n' && *r->at != '\r') r->at++;
    if (*r->at == '\0') break;
    if (*r->at == '\n' || *r->at == '\r')
      skip_newline(r);
    else
      CLOTH_TRY(read_statement(r, err));
  }
  if (r->at != text->data + text->size) OBJ_FAIL(r, err, "a NUL byte; this is no OBJ file");
  return CLOTH_OK;
}

static int compare_ints(const void *a, const void *b)
{
  int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

// groups without a face are left out
static cloth_status hand_over_groups(reader *r, cloth_mesh_file *out, cloth_error *err)
{
  if (r->group_count == 0) return CLOTH_OK;
  out->group = calloc(r->group_count, sizeof *out->group);
  PUSH(r, err, out->group != NULL);
  for (size_t i = 0; i < r->group_count; i++) {
    cloth_ints *v = &r->group[i].vertex;
    if (v->count == 0) continue;
    qsort(v->data, v->count, sizeof *v->data, compare_ints);
    size_t n = 0;
    for (size_t k = 0; k < v->count; k++)
      if (k == 0 || v->data[k] != v->data[n - 1]) v->data[n++] = v->data[k];
    out->group[out->group_count++] =
        (cloth_group_def){.name = r->group[i].name, .count = (int)n, .vertex = v->data};
    r->group[i] = (group){0};
  }
  return CLOTH_OK;
}

static cloth_status hand_over(reader *r, cloth_mesh_file *out, cloth_error *err)
{
  bool with_material = r->with_vt > 0 && r->without_vt == 0;
  int triangles = (int)(r->vertex.count / 3);
  CLOTH_TRY(cloth_mesh_new((int)(r->v.count / 3), triangles, with_material, &out->mesh, err));
  if (r->v.count) memcpy(out->mesh.position, r->v.data, sizeof(double) * r->v.count);
  if (r->vertex.count) memcpy(out->mesh.triangle, r->vertex.data, sizeof(int) * r->vertex.count);
  for (size_t i = 0; with_material && i < r->vt_of.count; i++)
    memcpy(out->mesh.material + 2 * i, r->vt.data + 2 * (size_t)r->vt_of.data[i],
           2 * sizeof(double));
  if (r->with_vt && r->without_vt) out->material_missing = r->without_vt;
  return hand_over_groups(r, out, err);
}

cloth_status cloth_obj_parse(const char *path, const cloth_text *text, cloth_mesh_file *out,
                             cloth_error *err)
{
  reader r = {.path = path, .at = text->data, .line = 1, .of_object = -1};
  cloth_status status = read_all(&r, text, err);
  if (status == CLOTH_OK) status = hand_over(&r, out, err);
  for (size_t i = 0; i < r.group_count; i++) {
    free(r.group[i].name);
    free(r.group[i].vertex.data);
  }
  free(r.group);
  free(r.v.data), free(r.vt.data), free(r.vertex.data), free(r.vt_of.data);
  free(r.polygon.data), free(r.of_groups.data);
  return status;
}
