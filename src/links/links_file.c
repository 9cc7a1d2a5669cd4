#include "links/links_file.h"

#include "scene/yaml.h"

#include <math.h>
#include <string.h>

// ---- the tree -----------------------------------------------------------------------------------

typedef struct reader {
  cloth_links *links;
  bool seen[CLOTH_LINKS_PARTS_MAX];
} reader;

// a list of parts and of lists: a switch; its node
static cloth_status read_branch(reader *r, cloth_value at, int *node, cloth_error *err)
{
  cloth_links *l = r->links;
  if (!cloth_yaml_is_list(at)) {
    CLOTH_TRY(cloth_yaml_int(at, "part", 0, l->parts - 1, node, err));
    if (r->seen[*node]) CLOTH_YAML_FAIL(err, at, "part %d is there twice", *node);
    r->seen[*node] = true;
    return CLOTH_OK;
  }
  CLOTH_TRY(cloth_yaml_list(at, 1, CLOTH_LINKS_PARTS_MAX, err));
  if (l->nodes == CLOTH_LINKS_NODES_MAX)
    CLOTH_YAML_FAIL(err, at, "more than %d switches", CLOTH_LINKS_NODES_MAX - l->parts);
  int top = l->nodes++;
  for (int i = 0; i < cloth_yaml_count(at); i++) {
    int child;
    CLOTH_TRY(read_branch(r, cloth_yaml_item(at, i), &child, err));
    l->parent[child] = top;
  }
  l->parent[top] = -1;
  *node = top;
  return CLOTH_OK;
}

static cloth_status read_tree(cloth_value at, cloth_links *l, cloth_error *err)
{
  reader r = {.links = l};
  int root;
  l->flat = false, l->nodes = l->parts;
  for (int i = 0; i < l->parts; i++) l->parent[i] = -1;
  CLOTH_TRY(read_branch(&r, at, &root, err));
  for (int i = 0; i < l->parts; i++)
    if (!r.seen[i]) CLOTH_YAML_FAIL(err, at, "part %d of %d is not in the tree", i, l->parts);
  return CLOTH_OK;
}

// one number for all links, or a list: of the links of the parts, then level by level up
static cloth_status read_levels(cloth_value at, const char *unit, double most, const cloth_links *l,
                                double *out, cloth_error *err)
{
  double level[16];
  int count = 1;
  if (cloth_yaml_is_list(at)) {
    CLOTH_TRY(cloth_yaml_list(at, 1, 16, err));
    count = cloth_yaml_count(at);
    for (int i = 0; i < count; i++)
      CLOTH_TRY(cloth_yaml_number(cloth_yaml_item(at, i), unit, 0, most, &level[i], err));
  } else {
    CLOTH_TRY(cloth_yaml_number(at, unit, 0, most, &level[0], err));
  }
  for (int n = 0; n < l->nodes; n++) {
    int height = 0; // longest way down to a part
    for (int p = 0; p < l->parts; p++) {
      int up = 0, k = p;
      while (k >= 0 && k != n) k = l->parent[k], up++;
      if (k == n && up > height) height = up;
    }
    out[n] = level[height < count ? height : count - 1];
  }
  return CLOTH_OK;
}

static cloth_status read_links(cloth_value at, cloth_links *l, cloth_error *err)
{
  static const char *const known[] = {"flat", "tree", "bandwidth", "latency", NULL};
  cloth_value v;
  CLOTH_TRY(cloth_yaml_mapping(at, known, err));
  bool has_tree = cloth_yaml_find(at, "tree", &v);
  *l = cloth_links_flat(l->parts, 0, 0);
  if (has_tree) {
    if (cloth_yaml_is_list(v)) {
      CLOTH_TRY(read_tree(v, l, err));
    } else {
      static const char *const words[] = {"binary", NULL};
      int which;
      CLOTH_TRY(cloth_yaml_choice(v, words, &which, err));
      *l = cloth_links_binary(l->parts, 0, 0);
    }
  }
  CLOTH_TRY(cloth_yaml_need(at, "bandwidth", &v, err));
  CLOTH_TRY(read_levels(v, "B/s", 1e15, l, l->bandwidth, err));
  for (int n = 0; n < l->nodes; n++)
    if (!(l->bandwidth[n] > 0)) CLOTH_YAML_FAIL(err, v, "0 B/s: must be above 0");
  CLOTH_TRY(cloth_yaml_need(at, "latency", &v, err));
  return read_levels(v, "s", 1, l, l->latency, err);
}

static cloth_status number_or(cloth_value at, const char *key, const char *unit, double least,
                              double most, double *out, cloth_error *err)
{
  cloth_value v;
  if (!cloth_yaml_find(at, key, &v)) return CLOTH_OK;
  return cloth_yaml_number(v, unit, least, most, out, err);
}

static cloth_status read_model(cloth_value root, cloth_links_model *m, cloth_error *err)
{
  static const char *const known[] = {"name", "parts", "links", "product", NULL};
  static const char *const known_product[] = {
      "rows", "blocks", "memory_bandwidth", "own", "halo", "precision", NULL};
  static const char *const precisions[] = {"float", "double", NULL};
  cloth_value v, p;
  const char *name = "";
  int precision = 0;
  CLOTH_TRY(cloth_yaml_mapping(root, known, err));
  if (cloth_yaml_find(root, "name", &v)) CLOTH_TRY(cloth_yaml_text(v, &name, err));
  snprintf(m->name, sizeof m->name, "%s", name);
  CLOTH_TRY(cloth_yaml_need(root, "parts", &v, err));
  CLOTH_TRY(cloth_yaml_int(v, "1", 1, CLOTH_LINKS_PARTS_MAX, &m->links.parts, err));
  CLOTH_TRY(cloth_yaml_need(root, "links", &v, err));
  CLOTH_TRY(read_links(v, &m->links, err));
  CLOTH_TRY(cloth_yaml_need(root, "product", &p, err));
  CLOTH_TRY(cloth_yaml_mapping(p, known_product, err));
  CLOTH_TRY(cloth_yaml_need(p, "rows", &v, err));
  CLOTH_TRY(cloth_yaml_number(v, "1", 1, 1e12, &m->rows, err));
  CLOTH_TRY(cloth_yaml_need(p, "memory_bandwidth", &v, err));
  CLOTH_TRY(cloth_yaml_number(v, "B/s", 1, 1e15, &m->memory_bandwidth, err));
  m->blocks = 7, m->own = 0.95, m->halo = 1;
  CLOTH_TRY(number_or(p, "blocks", "1", 1, 1000, &m->blocks, err));
  CLOTH_TRY(number_or(p, "own", "1", 0, 1, &m->own, err));
  CLOTH_TRY(number_or(p, "halo", "1", 0, 1, &m->halo, err));
  if (cloth_yaml_find(p, "precision", &v))
    CLOTH_TRY(cloth_yaml_choice(v, precisions, &precision, err));
  m->real_bytes = precision == 0 ? 4 : 8;
  return CLOTH_OK;
}

cloth_status cloth_links_load(const char *path, cloth_links_model *out, cloth_error *err)
{
  cloth_yaml file = {0};
  memset(out, 0, sizeof *out);
  cloth_status status = cloth_yaml_open(path, &file, err);
  if (status == CLOTH_OK) status = read_model(cloth_yaml_root(&file), out, err);
  cloth_yaml_close(&file);
  return status;
}

// ---- the forecast -------------------------------------------------------------------------------

void cloth_links_predict(const cloth_links_model *m, cloth_links_forecast *f)
{
  const cloth_links *l = &m->links;
  int n = l->parts;
  memset(f, 0, sizeof *f);
  // a block: nine numbers and its column; a row: its place, x and y
  double row = m->blocks * (9 * m->real_bytes + 4) + 6 * m->real_bytes + 4;
  f->single = m->rows * row / m->memory_bandwidth;
  f->own = n > 1 ? m->own * f->single / n : f->single;
  f->other = n > 1 ? (1 - m->own) * f->single / n / (n - 1) : 0;
  f->count = n * (n - 1);
  f->stages = cloth_transfer_order(l, f->order);
  cloth_transfer_times(l, f->count, f->order, m->halo * 3 * m->real_bytes * m->rows / n, f->time);
  for (int p = 0; p < n; p++) f->end[p] = f->own;
  for (int i = 0; i < f->count; i++) { // arrivals of a part are in order
    double *end = &f->end[f->order[i].to];
    *end = fmax(*end, f->time[2 * i + 1]) + f->other;
    f->exchange = fmax(f->exchange, f->time[2 * i + 1]);
  }
  for (int p = 0; p < n; p++) f->pipelined = fmax(f->pipelined, f->end[p]);
  f->straight = f->exchange + f->own + (n - 1) * f->other;
}
