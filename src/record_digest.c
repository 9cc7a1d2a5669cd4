#include "record_digest.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// FNV-1a (Fowler, Noll, Vo), 64 bits
static uint64_t hash_bytes(uint64_t hash, const void *data, size_t size)
{
  const unsigned char *byte = data;
  for (size_t i = 0; i < size; i++) hash = (hash ^ byte[i]) * UINT64_C(0x100000001b3);
  return hash;
}

static const uint64_t start = UINT64_C(0xcbf29ce484222325);

static uint64_t hash_mesh(const double *position, int vertex_count, const int *triangle,
                          int triangle_count)
{
  uint64_t hash = start;
  hash = hash_bytes(hash, position, 3 * sizeof *position * (size_t)vertex_count);
  return hash_bytes(hash, triangle, 3 * sizeof *triangle * (size_t)triangle_count);
}

int cloth_record_line_count(const cloth_record_subject *subject)
{
  return cloth_count(subject->scene) + cloth_body_count(subject->scene);
}

void cloth_record_line(const cloth_record_subject *subject, int i, char out[CLOTH_RECORD_LINE_SIZE])
{
  const cloth_scene *scene = subject->scene;
  bool is_body = i >= cloth_count(scene);
  const char *name;
  int index = i, vertex_count, triangle_count;
  uint64_t hash;
  if (is_body) {
    index = i - cloth_count(scene);
    cloth_mesh_view mesh = cloth_body_mesh(scene, index);
    name = cloth_body_name(scene, index);
    vertex_count = mesh.vertex_count;
    triangle_count = mesh.triangle_count;
    hash = hash_mesh(mesh.position, vertex_count, mesh.triangle, triangle_count);
  } else {
    name = cloth_name(scene, index);
    vertex_count = cloth_vertex_count(scene, index);
    triangle_count = cloth_triangle_count(scene, index);
    hash = hash_mesh(cloth_rest_positions(scene, index), vertex_count,
                     cloth_triangles(scene, index), triangle_count);
  }
  snprintf(out, CLOTH_RECORD_LINE_SIZE, "%s %d %d %d %016" PRIx64 " %s", is_body ? "body" : "cloth",
           index, vertex_count, triangle_count, hash, name);
  for (char *p = out; *p; p++)
    if (*p == '\n' || *p == '\r') *p = ' '; // a name must not end the line
}

bool cloth_record_param_counts(const cloth_param_info *p)
{
  return strcmp(p->name, "threads") != 0;
}

int cloth_record_param(const cloth_params *params, const cloth_param_info *p, double out[3])
{
  const char *at = (const char *)params + p->offset;
  int whole;
  switch (p->kind) {
  case CLOTH_IS_VECTOR:
    memcpy(out, at, 3 * sizeof *out);
    return 3;
  case CLOTH_IS_DOUBLE:
    memcpy(out, at, sizeof *out);
    return 1;
  case CLOTH_IS_INT:
  case CLOTH_IS_CHOICE:
    memcpy(&whole, at, sizeof whole);
    out[0] = whole;
    return 1;
  }
  return 0;
}

static uint64_t hash_params(uint64_t hash, const cloth_params *values, const cloth_param_info *p)
{
  for (; p->name; p++) {
    double value[3];
    if (!cloth_record_param_counts(p)) continue;
    hash = hash_bytes(hash, value, sizeof *value * (size_t)cloth_record_param(values, p, value));
  }
  return hash;
}

uint64_t cloth_record_digest(const cloth_record_subject *subject, const cloth_def *def)
{
  uint64_t hash = hash_bytes(start, subject->precision, strlen(subject->precision));
  for (int i = 0; i < cloth_record_line_count(subject); i++) {
    char line[CLOTH_RECORD_LINE_SIZE];
    cloth_record_line(subject, i, line);
    hash = hash_bytes(hash, line, strlen(line));
  }
  hash = hash_params(hash, subject->params, cloth_param_table());
  for (int i = 0; i < def->effect_count; i++) {
    hash = hash_bytes(hash, def->effect[i].name, strlen(def->effect[i].name));
    hash = hash_bytes(hash, &def->effect[i].wish, sizeof def->effect[i].wish);
  }
  for (int c = 0; c < def->cloth_count; c++) // all its members are double
    hash = hash_bytes(hash, &def->cloth[c].material, sizeof def->cloth[c].material);
  return hash;
}
