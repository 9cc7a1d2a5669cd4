// A deep copy of a description.
#include "front.h"

#include <stdlib.h>
#include <string.h>

// a copy of n bytes; NULL for NULL; *ok becomes false when memory is out
static void *copy(const void *from, size_t n, bool *ok)
{
  if (from == NULL) return NULL;
  void *to = malloc(n ? n : 1);
  if (to == NULL)
    *ok = false;
  else if (n > 0)
    memcpy(to, from, n);
  return to;
}

static char *copy_text(const char *from, bool *ok)
{
  return from ? copy(from, strlen(from) + 1, ok) : NULL;
}

static void copy_mesh(cloth_mesh *m, bool *ok)
{
  size_t v = (size_t)m->vertex_count, t = (size_t)m->triangle_count;
  m->position = copy(m->position, sizeof(double) * 3 * v, ok);
  m->triangle = copy(m->triangle, sizeof(int) * 3 * t, ok);
  m->material = copy(m->material, sizeof(double) * 6 * t, ok);
}

static void copy_motion(cloth_motion *m, bool *ok)
{
  m->time = copy(m->time, sizeof(double) * (size_t)m->key_count, ok);
  m->pose = copy(m->pose, sizeof(cloth_pose) * (size_t)m->key_count, ok);
}

static void copy_cloth(cloth_cloth_def *c, bool *ok)
{
  c->name = copy_text(c->name, ok);
  c->material_name = copy_text(c->material_name, ok);
  copy_mesh(&c->mesh, ok);
  c->group = copy(c->group, sizeof *c->group * (size_t)c->group_count, ok);
  for (int g = 0; c->group != NULL && g < c->group_count; g++) {
    c->group[g].name = copy_text(c->group[g].name, ok);
    c->group[g].vertex = copy(c->group[g].vertex, sizeof(int) * (size_t)c->group[g].count, ok);
  }
}

cloth_status cloth_def_clone(const cloth_def *def, cloth_def **out, cloth_error *err)
{
  bool ok = true;
  cloth_def *d = copy(def, sizeof *def, &ok);
  if (d == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "scene description");
  d->path = copy_text(def->path, &ok);
  d->cloth = copy(def->cloth, sizeof *d->cloth * (size_t)d->cloth_count, &ok);
  d->body = copy(def->body, sizeof *d->body * (size_t)d->body_count, &ok);
  d->pin = copy(def->pin, sizeof *d->pin * (size_t)d->pin_count, &ok);
  if (d->cloth == NULL) d->cloth_count = 0;
  if (d->body == NULL) d->body_count = 0;
  if (d->pin == NULL) d->pin_count = 0;
  for (int i = 0; i < d->cloth_count; i++) copy_cloth(&d->cloth[i], &ok);
  for (int i = 0; i < d->body_count; i++) {
    d->body[i].name = copy_text(d->body[i].name, &ok);
    copy_mesh(&d->body[i].mesh, &ok);
    copy_motion(&d->body[i].motion, &ok);
  }
  for (int i = 0; i < d->pin_count; i++) copy_motion(&d->pin[i].motion, &ok);
  if (!ok) {
    cloth_def_free(d);
    CLOTH_FAIL(err, CLOTH_NO_MEMORY, "scene description");
  }
  *out = d;
  return CLOTH_OK;
}
