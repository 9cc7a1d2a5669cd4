// PLY (Turk 1994): ascii, binary little and big endian; any element and property types. Taken are
// x, y, z of `vertex`, its (s, t), (u, v) or (texture_u, texture_v) as material coordinates in
// metres, and the list vertex_indices or vertex_index of `face`.
#include "scene/mesh_file.h"
#include "scene/number.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef enum encoding { ASCII, LITTLE, BIG } encoding;

typedef enum number_type {
  NO_TYPE,
  INT8,
  UINT8,
  INT16,
  UINT16,
  INT32,
  UINT32,
  FLOAT32,
  FLOAT64
} number_type;

enum { PROPERTIES_MAX = 256, ELEMENTS_MAX = 32 };

typedef enum meaning { IGNORED, X, Y, Z, WARP, WEFT, CORNERS } meaning;

typedef struct property {
  number_type type, count_type; // count_type: NO_TYPE unless it is a list
  meaning meaning;
} property;

typedef struct element {
  char name[32];
  long long count;
  int property_count;
  property property[PROPERTIES_MAX];
} element;

typedef struct reader {
  const char *path, *start, *at, *end;
  int line;
  encoding encoding;
  bool has_format;
  int element_count;
  element *element;    // [ELEMENTS_MAX]
  cloth_doubles v, vt; // 3, 2 per vertex
  cloth_ints triangle; // 3 each
  cloth_ints polygon;  // of the face that is being read
  bool has_axis[3], has_material[2];
} reader;

// where in the file: a line of text, or a byte of a binary part
#define PLY_FAIL(r, err, ...)                                                                      \
  do {                                                                                             \
    char text_[256];                                                                               \
    snprintf(text_, sizeof text_, __VA_ARGS__);                                                    \
    if ((r)->line > 0) CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s:%d: %s", (r)->path, (r)->line, text_); \
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: byte %td: %s", (r)->path, (r)->at - (r)->start, text_);  \
  } while (0)

#define PUSH(r, err, call)                                                                         \
  do {                                                                                             \
    if (!(call)) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: no memory", (r)->path);                     \
  } while (0)

// ---- header -------------------------------------------------------------------------------------

// The next header line without its end; false behind the last one.
static bool next_line(reader *r, char *out, size_t size)
{
  if (r->at == r->end) return false;
  const char *stop = memchr(r->at, '\n', (size_t)(r->end - r->at));
  const char *next = stop ? stop + 1 : r->end;
  if (stop == NULL) stop = r->end;
  if (stop > r->at && stop[-1] == '\r') stop--;
  size_t n = (size_t)(stop - r->at);
  if (n >= size) n = size - 1;
  memcpy(out, r->at, n);
  out[n] = '\0';
  r->at = next;
  r->line++;
  return true;
}

static number_type type_of(const char *word)
{
  static const struct {
    const char *name;
    number_type type;
  } types[] = {{"char", INT8},     {"int8", INT8},       {"uchar", UINT8},    {"uint8", UINT8},
               {"short", INT16},   {"int16", INT16},     {"ushort", UINT16},  {"uint16", UINT16},
               {"int", INT32},     {"int32", INT32},     {"uint", UINT32},    {"uint32", UINT32},
               {"float", FLOAT32}, {"float32", FLOAT32}, {"double", FLOAT64}, {"float64", FLOAT64}};
  for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
    if (strcmp(word, types[i].name) == 0) return types[i].type;
  return NO_TYPE;
}

static meaning meaning_of(const char *element_name, const char *name, bool list)
{
  static const struct {
    const char *name;
    meaning meaning;
  } known[] = {{"x", X},           {"y", Y},    {"z", Z},    {"s", WARP},
               {"t", WEFT},        {"u", WARP}, {"v", WEFT}, {"texture_u", WARP},
               {"texture_v", WEFT}};
  if (strcmp(element_name, "face") == 0)
    return list && (strcmp(name, "vertex_indices") == 0 || strcmp(name, "vertex_index") == 0)
               ? CORNERS
               : IGNORED;
  if (list || strcmp(element_name, "vertex") != 0) return IGNORED;
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
    if (strcmp(name, known[i].name) == 0) return known[i].meaning;
  return IGNORED;
}

static cloth_status read_format(reader *r, const char *line, cloth_error *err)
{
  char kind[32], version[16];
  if (sscanf(line, "format %31s %15s", kind, version) != 2 || strcmp(version, "1.0") != 0)
    PLY_FAIL(r, err, "'%.60s' is not 'format KIND 1.0'", line);
  if (strcmp(kind, "ascii") == 0)
    r->encoding = ASCII;
  else if (strcmp(kind, "binary_little_endian") == 0)
    r->encoding = LITTLE;
  else if (strcmp(kind, "binary_big_endian") == 0)
    r->encoding = BIG;
  else
    PLY_FAIL(r, err, "format '%s' is not one of ascii, binary_little_endian, binary_big_endian",
             kind);
  r->has_format = true;
  return CLOTH_OK;
}

static cloth_status read_element(reader *r, const char *line, cloth_error *err)
{
  char count[32];
  int length = 0;
  double number;
  if (r->element_count == ELEMENTS_MAX)
    PLY_FAIL(r, err, "more than %d elements", (int)ELEMENTS_MAX);
  element *e = &r->element[r->element_count];
  *e = (element){0};
  if (sscanf(line, "element %31s %31s %n", e->name, count, &length) != 2 || line[length] != '\0' ||
      !cloth_number_parse(count, &number) || !(number >= 0 && number <= 1e15))
    PLY_FAIL(r, err, "'%.60s' is not 'element NAME COUNT'", line);
  e->count = (long long)number;
  bool ours = strcmp(e->name, "vertex") == 0 || strcmp(e->name, "face") == 0;
  if (ours && e->count > CLOTH_MESH_FILE_MAX)
    PLY_FAIL(r, err, "%s: more than 100 million", e->name);
  for (int i = 0; i < r->element_count; i++)
    if (strcmp(r->element[i].name, e->name) == 0)
      PLY_FAIL(r, err, "element %s is there twice", e->name);
  r->element_count++;
  return CLOTH_OK;
}

static cloth_status read_property(reader *r, const char *line, cloth_error *err)
{
  char type[16], count[16] = "", name[64];
  if (r->element_count == 0) PLY_FAIL(r, err, "a property before the first element");
  element *e = &r->element[r->element_count - 1];
  if (e->property_count == PROPERTIES_MAX)
    PLY_FAIL(r, err, "element %s has more than %d properties", e->name, (int)PROPERTIES_MAX);
  property *p = &e->property[e->property_count];
  bool list = sscanf(line, "property list %15s %15s %63s", count, type, name) == 3;
  if (!list && sscanf(line, "property %15s %63s", type, name) != 2)
    PLY_FAIL(r, err, "'%.60s' is neither 'property TYPE NAME' nor 'property list TYPE TYPE NAME'",
             line);
  *p = (property){type_of(type), list ? type_of(count) : NO_TYPE, meaning_of(e->name, name, list)};
  if (p->type == NO_TYPE) PLY_FAIL(r, err, "'%s' is not a PLY type", type);
  if (list && (p->count_type == NO_TYPE || p->count_type >= FLOAT32))
    PLY_FAIL(r, err, "'%s' is not a whole PLY type", count);
  for (int i = 0; i < e->property_count && p->meaning != IGNORED; i++) {
    if (e->property[i].meaning != p->meaning) continue;
    if (p->meaning != WARP && p->meaning != WEFT)
      PLY_FAIL(r, err, "'%.60s' repeats what an earlier property gives", line);
    p->meaning = IGNORED; // a second set of texture coordinates
  }
  if (p->meaning >= X && p->meaning <= Z) r->has_axis[p->meaning - X] = true;
  if (p->meaning == WARP || p->meaning == WEFT) r->has_material[p->meaning - WARP] = true;
  e->property_count++;
  return CLOTH_OK;
}

static bool starts_with(const char *line, const char *word)
{
  size_t n = strlen(word);
  return strncmp(line, word, n) == 0 && (line[n] == ' ' || line[n] == '\t' || line[n] == '\0');
}

static cloth_status read_header(reader *r, cloth_error *err)
{
  char line[1024];
  if (!next_line(r, line, sizeof line) || strcmp(line, "ply") != 0)
    CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s:1: the first line is not 'ply'", r->path);
  for (;;) {
    if (!next_line(r, line, sizeof line)) PLY_FAIL(r, err, "the header ends without 'end_header'");
    if (starts_with(line, "end_header")) break;
    if (starts_with(line, "format"))
      CLOTH_TRY(read_format(r, line, err));
    else if (starts_with(line, "element"))
      CLOTH_TRY(read_element(r, line, err));
    else if (starts_with(line, "property"))
      CLOTH_TRY(read_property(r, line, err));
    else if (!starts_with(line, "comment") && !starts_with(line, "obj_info") && line[0] != '\0')
      PLY_FAIL(r, err, "'%.60s' does not belong in a PLY header", line);
  }
  if (!r->has_format) PLY_FAIL(r, err, "the header has no 'format' line");
  for (int i = 0; i < 3; i++)
    if (!r->has_axis[i]) PLY_FAIL(r, err, "element vertex has no property %c", "xyz"[i]);
  return CLOTH_OK;
}

// ---- numbers ------------------------------------------------------------------------------------

static cloth_status read_ascii(reader *r, double *out, cloth_error *err)
{
  while (r->at < r->end && (*r->at == ' ' || *r->at == '\t' || *r->at == '\r' || *r->at == '\n'))
    r->line += *r->at++ == '\n';
  if (r->at == r->end) PLY_FAIL(r, err, "the file ends too early");
  const char *stop = cloth_number_read(r->at, out);
  if (stop == NULL || (stop < r->end && strchr(" \t\r\n", *stop) == NULL) || *r->at == '\0')
    PLY_FAIL(r, err, "'%.*s' is not a number", (int)strcspn(r->at, " \t\r\n") % 40, r->at);
  r->at = stop;
  return CLOTH_OK;
}

static cloth_status read_binary(reader *r, number_type type, double *out, cloth_error *err)
{
  static const unsigned char size_of[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  size_t size = size_of[type];
  if ((size_t)(r->end - r->at) < size) PLY_FAIL(r, err, "the file ends too early");
  uint64_t bits = 0;
  for (size_t i = 0; i < size; i++) {
    uint64_t byte = (unsigned char)r->at[i];
    bits |= byte << 8 * (r->encoding == LITTLE ? i : size - 1 - i);
  }
  r->at += size;
  uint32_t half = (uint32_t)bits;
  float single;
  switch (type) {
  case NO_TYPE:
    break;
  case INT8:
    *out = (int8_t)bits;
    break;
  case INT16:
    *out = (int16_t)bits;
    break;
  case INT32:
    *out = (int32_t)bits;
    break;
  case UINT8:
  case UINT16:
  case UINT32:
    *out = half;
    break;
  case FLOAT32:
    memcpy(&single, &half, sizeof single), *out = (double)single;
    break;
  case FLOAT64:
    memcpy(out, &bits, sizeof *out);
    break;
  }
  return CLOTH_OK;
}

static cloth_status read_number(reader *r, number_type type, double *out, cloth_error *err)
{
  if (r->encoding == ASCII) return read_ascii(r, out, err);
  return read_binary(r, type, out, err);
}

// ---- elements -----------------------------------------------------------------------------------

static cloth_status add_polygon(reader *r, long long face, cloth_error *err)
{
  const cloth_ints *p = &r->polygon;
  if (p->count < 3) PLY_FAIL(r, err, "face %lld has %zu corners; it needs 3", face, p->count);
  if (r->triangle.count / 3 + p->count > CLOTH_MESH_FILE_MAX)
    PLY_FAIL(r, err, "more than 100 million triangles");
  for (size_t i = 1; i + 1 < p->count; i++) {
    PUSH(r, err, cloth_ints_push(&r->triangle, p->data[0]));
    PUSH(r, err, cloth_ints_push(&r->triangle, p->data[i]));
    PUSH(r, err, cloth_ints_push(&r->triangle, p->data[i + 1]));
  }
  return CLOTH_OK;
}

static cloth_status read_list(reader *r, const property *p, long long row, cloth_error *err)
{
  double count, value;
  CLOTH_TRY(read_number(r, p->count_type, &count, err));
  if (!(count >= 0 && count <= (double)(r->end - r->at) && count == floor(count)))
    PLY_FAIL(r, err, "%g is not the length of a list that still fits the file", count);
  r->polygon.count = 0;
  for (double i = 0; i < count; i++) {
    CLOTH_TRY(read_number(r, p->type, &value, err));
    if (p->meaning != CORNERS) continue;
    if (!(value >= 0 && value < CLOTH_MESH_FILE_MAX && value == floor(value)))
      PLY_FAIL(r, err, "face %lld: %g is not the index of a vertex", row, value);
    PUSH(r, err, cloth_ints_push(&r->polygon, (int)value));
  }
  return p->meaning == CORNERS ? add_polygon(r, row, err) : CLOTH_OK;
}

static cloth_status read_row(reader *r, const element *e, long long row, cloth_error *err)
{
  double x[3] = {0}, u[2] = {0};
  for (int i = 0; i < e->property_count; i++) {
    const property *p = &e->property[i];
    if (p->count_type != NO_TYPE) {
      CLOTH_TRY(read_list(r, p, row, err));
      continue;
    }
    double value;
    CLOTH_TRY(read_number(r, p->type, &value, err));
    if (p->meaning != IGNORED && !isfinite(value))
      PLY_FAIL(r, err, "vertex %lld: %g is not a finite number", row, value);
    if (p->meaning >= X && p->meaning <= Z) x[p->meaning - X] = value;
    if (p->meaning == WARP || p->meaning == WEFT) u[p->meaning - WARP] = value;
  }
  if (strcmp(e->name, "vertex") != 0) return CLOTH_OK;
  for (int i = 0; i < 3; i++) PUSH(r, err, cloth_doubles_push(&r->v, x[i]));
  for (int i = 0; i < 2; i++) PUSH(r, err, cloth_doubles_push(&r->vt, u[i]));
  return CLOTH_OK;
}

static cloth_status read_elements(reader *r, cloth_error *err)
{
  r->line = r->encoding == ASCII ? r->line + 1 : 0; // the numbers begin on the next line
  for (int i = 0; i < r->element_count; i++)
    for (long long row = 0; row < r->element[i].count && r->element[i].property_count > 0; row++)
      CLOTH_TRY(read_row(r, &r->element[i], row, err));
  for (; r->at < r->end; r->at++) {
    if (strchr(" \t\r\n", *r->at) == NULL || *r->at == '\0')
      PLY_FAIL(r, err, "%td bytes follow the last element: the header counts too few",
               r->end - r->at);
    if (r->line > 0) r->line += *r->at == '\n';
  }
  return CLOTH_OK;
}

static cloth_status hand_over(reader *r, cloth_mesh *out, cloth_error *err)
{
  bool with_material = r->has_material[0] && r->has_material[1];
  int vertices = (int)(r->v.count / 3), triangles = (int)(r->triangle.count / 3);
  for (size_t i = 0; i < r->triangle.count; i++)
    if (r->triangle.data[i] >= vertices)
      CLOTH_FAIL(err, CLOTH_BAD_SCENE, "%s: a face names vertex %d; indices are in [0, %d]",
                 r->path, r->triangle.data[i], vertices - 1);
  CLOTH_TRY(cloth_mesh_new(vertices, triangles, with_material, out, err));
  if (vertices) memcpy(out->position, r->v.data, sizeof(double) * r->v.count);
  if (triangles) memcpy(out->triangle, r->triangle.data, sizeof(int) * r->triangle.count);
  for (size_t i = 0; with_material && i < r->triangle.count; i++)
    memcpy(out->material + 2 * i, r->vt.data + 2 * (size_t)r->triangle.data[i], 2 * sizeof(double));
  return CLOTH_OK;
}

cloth_status cloth_ply_parse(const char *path, const cloth_text *text, cloth_mesh_file *out,
                             cloth_error *err)
{
  reader r = {.path = path, .start = text->data, .at = text->data, .end = text->data + text->size};
  r.element = calloc(ELEMENTS_MAX, sizeof *r.element);
  if (r.element == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "%s: no memory", path);
  cloth_status status = read_header(&r, err);
  if (status == CLOTH_OK) status = read_elements(&r, err);
  if (status == CLOTH_OK) status = hand_over(&r, &out->mesh, err);
  free(r.element);
  free(r.v.data), free(r.vt.data), free(r.triangle.data), free(r.polygon.data);
  return status;
}
