// Saving, loading and hashing the state. The file: a header, positions and velocities as the engine
// holds them, bodies, holds, what friction remembers, and a checksum over all of it. A run
// continued from it gives the same bits.
#include "contact/friction.h"
#include "effect/effect.h"
#include "state/state.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char MAGIC[8] = "CLOTHST6";

typedef struct file_header {
  char magic[8];
  uint64_t mesh; // digest of vertices and triangles
  double time;
  int64_t step;
  int32_t real_bytes, vertices, bodies, holds, cloths, mean_known, pins, friction;
  int32_t tangles, substeps; // tangles: 1: known to be free of them, 2: settling
  int32_t history, parts;    // of bdf2: 1: is there; of accuracy
  uint64_t body_bytes;       // bytes after the vectors
} file_header;

typedef struct file_body {
  cloth_pose now, target;
  int32_t commanded, pad;
} file_body;

typedef struct file_hold {
  cloth_pose now, target;
  double stiffness, break_force, force[3], torque[3];
  int32_t alive, rigid, cloth, count, body, pin;
  uint32_t generation, pad;
} file_hold;

// FNV-1a, 64 bits (Fowler, Noll, Vo)
static uint64_t digest(uint64_t h, const void *data, size_t n)
{
  const unsigned char *p = data;
  for (size_t i = 0; i < n; i++) h = (h ^ p[i]) * 1099511628211u;
  return h;
}

static const uint64_t DIGEST_START = 14695981039346656037u;

static uint64_t mesh_digest(const cloth_sim *sim)
{
  uint64_t h = digest(DIGEST_START, sim->triangle, sizeof(int) * 3 * (size_t)sim->triangle_count);
  return digest(h, sim->rest, sizeof(double) * 3 * (size_t)sim->vertex_count);
}

// positions and velocities, and of bdf2 those before, if they are known
static cloth_status read_state(cloth_sim *sim, cloth_real **x, cloth_error *err)
{
  size_t n = 3 * (size_t)sim->vertex_count;
  const cloth_part *p = cloth_rescue_part(sim);
  const cloth_real *vector[] = {p->x_t0, p->v, p->x_last, p->v_last};
  int count = sim->bdf2.known ? 4 : 2;
  CLOTH_TRY(cloth_staging(sim, (size_t)count * n, err));
  *x = sim->host;
  for (int i = 0; i < count; i++)
    CLOTH_TRY(sim->backend->read(p->device, sim->host + (size_t)i * n, vector[i],
                                 sizeof(cloth_real) * n, err));
  return CLOTH_OK;
}

cloth_status cloth_sim_hash(void *data, uint64_t *out, cloth_error *err)
{
  cloth_sim *sim = data;
  cloth_real *x;
  CLOTH_TRY(read_state(sim, &x, err));
  uint64_t h = digest(DIGEST_START, &sim->time, sizeof sim->time);
  if (sim->bdf2.known) h = digest(h, &sim->bdf2.h_last, sizeof sim->bdf2.h_last);
  *out = digest(h, x, sizeof(cloth_real) * (sim->bdf2.known ? 12 : 6) * (size_t)sim->vertex_count);
  return CLOTH_OK;
}

// ---- writing ------------------------------------------------------------------------------------

typedef struct writer {
  FILE *file;
  uint64_t sum;
  bool failed;
} writer;

static void put(writer *w, const void *data, size_t n)
{
  w->sum = digest(w->sum, data, n);
  if (n > 0 && fwrite(data, 1, n, w->file) != n) w->failed = true;
}

static void put_hold(writer *w, const cloth_sim *sim, const cloth_hold_state *h)
{
  file_hold f;
  memset(&f, 0, sizeof f); // padding too: the checksum covers it
  f.now = h->now, f.target = h->target;
  f.stiffness = h->stiffness, f.break_force = h->break_force;
  memcpy(f.force, h->force, sizeof f.force), memcpy(f.torque, h->torque, sizeof f.torque);
  f.alive = h->alive, f.rigid = h->rigid, f.cloth = h->cloth, f.count = h->alive ? h->count : 0;
  f.body = h->body, f.pin = h->pin, f.generation = h->generation;
  put(w, &f, sizeof f);
  if (!h->alive) return;
  put(w, h->vertex, sizeof(int) * (size_t)h->count);
  put(w, h->local, sizeof(double) * 3 * (size_t)h->count);
  put(w, h->ignore, (size_t)sim->def->body_count);
}

static void put_all(writer *w, cloth_sim *sim, const cloth_real *x,
                    const cloth_friction_entry *friction, int friction_count)
{
  file_header head;
  memset(&head, 0, sizeof head);
  memcpy(head.magic, MAGIC, sizeof MAGIC);
  head.mesh = mesh_digest(sim), head.time = sim->time, head.step = sim->step;
  head.real_bytes = sizeof(cloth_real), head.vertices = sim->vertex_count;
  head.bodies = sim->def->body_count, head.holds = sim->hold_count;
  head.cloths = sim->def->cloth_count, head.mean_known = sim->mean_known;
  head.pins = sim->def->pin_count, head.friction = friction_count;
  head.history = sim->bdf2.known;
  head.tangles = (sim->tangles.known_free ? 1 : 0) + (sim->tangles.settling ? 2 : 0);
  head.substeps = sim->substeps_crowded, head.parts = sim->control.parts;
  put(w, &head, sizeof head);
  put(w, x, sizeof(cloth_real) * 6 * (size_t)sim->vertex_count);
  put(w, sim->pin_broken, (size_t)sim->def->pin_count);
  put(w, sim->mean_velocity, sizeof(double) * 3 * (size_t)sim->def->cloth_count);
  put(w, sim->acceleration, sizeof(double) * 3 * (size_t)sim->def->cloth_count);
  for (int b = 0; b < sim->def->body_count; b++) {
    file_body f;
    memset(&f, 0, sizeof f);
    f.now = sim->body[b].now, f.target = sim->body[b].target, f.commanded = sim->body[b].commanded;
    put(w, &f, sizeof f);
  }
  for (int h = 0; h < sim->hold_count; h++) put_hold(w, sim, &sim->hold[h]);
  put(w, friction, sizeof *friction * (size_t)friction_count);
  if (sim->bdf2.known) {
    put(w, &sim->bdf2.h_last, sizeof sim->bdf2.h_last);
    put(w, x + 6 * (size_t)sim->vertex_count, sizeof(cloth_real) * 6 * (size_t)sim->vertex_count);
  }
  uint64_t sum = w->sum;
  put(w, &sum, sizeof sum);
}

cloth_status cloth_sim_save(void *data, const char *path, cloth_error *err)
{
  cloth_sim *sim = data;
  cloth_real *x;
  char beside[4096] = "";
  if (path && snprintf(beside, sizeof beside, "%s.part", path) >= (int)sizeof beside)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "state file: the path is longer than %zu characters",
               sizeof beside);
  cloth_friction_entry *friction;
  int friction_count;
  CLOTH_TRY(cloth_friction_read(sim, &friction, &friction_count, err));
  cloth_status status = read_state(sim, &x, err);
  if (path == NULL) {
    free(friction);
    return status;
  }
  writer w = {status == CLOTH_OK ? fopen(beside, "wb") : NULL, DIGEST_START, false};
  if (w.file == NULL) {
    int cause = errno;
    free(friction);
    CLOTH_TRY(status);
    CLOTH_FAIL(err, CLOTH_IO, "cannot write state file %s: %s", path, strerror(cause));
  }
  put_all(&w, sim, x, friction, friction_count);
  free(friction);
  if (fclose(w.file) != 0) w.failed = true;
  if (w.failed || rename(beside, path) != 0) {
    int cause = errno;
    remove(beside);
    CLOTH_FAIL(err, CLOTH_IO, "cannot write state file %s: %s", path, strerror(cause));
  }
  return CLOTH_OK;
}

// ---- reading ------------------------------------------------------------------------------------

typedef struct reader {
  const unsigned char *at, *end;
} reader;

// the next n bytes, or NULL if the file is too short
static const void *take(reader *r, size_t n)
{
  if ((size_t)(r->end - r->at) < n) return NULL;
  const void *p = r->at;
  r->at += n;
  return p;
}

static cloth_status read_file(const char *path, unsigned char **data, size_t *size,
                              cloth_error *err)
{
  FILE *f = fopen(path, "rb");
  if (f == NULL) CLOTH_FAIL(err, CLOTH_IO, "cannot read state file %s: %s", path, strerror(errno));
  long end = fseek(f, 0, SEEK_END) == 0 ? ftell(f) : -1;
  *data = end >= 0 && end < (1L << 40) ? malloc((size_t)end + 1) : NULL;
  bool good =
      *data != NULL && fseek(f, 0, SEEK_SET) == 0 && fread(*data, 1, (size_t)end, f) == (size_t)end;
  fclose(f);
  if (!good) {
    free(*data);
    *data = NULL;
    CLOTH_FAIL(err, CLOTH_IO, "cannot read state file %s", path);
  }
  *size = (size_t)end;
  return CLOTH_OK;
}

static cloth_status check_header(const cloth_sim *sim, const char *path, const unsigned char *data,
                                 size_t size, cloth_error *err)
{
  file_header h;
  uint64_t sum;
  if (size < sizeof h + sizeof sum || memcmp(data, MAGIC, sizeof MAGIC) != 0)
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "%s is not a state file of this version (%zu bytes)", path,
               size);
  memcpy(&h, data, sizeof h);
  if (h.real_bytes != (int)sizeof(cloth_real))
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "%s is of precision %s, the scene is %s", path,
               h.real_bytes == 4 ? "float" : "double",
               sizeof(cloth_real) == 4 ? "float" : "double");
  if (h.vertices != sim->vertex_count || h.mesh != mesh_digest(sim) ||
      h.bodies != sim->def->body_count || h.cloths != sim->def->cloth_count ||
      h.pins != sim->def->pin_count)
    CLOTH_FAIL(err, CLOTH_BAD_STATE,
               "%s is of another scene: %d vertices and %d bodies, this has %d and %d%s", path,
               h.vertices, h.bodies, sim->vertex_count, sim->def->body_count,
               h.vertices == sim->vertex_count && h.bodies == sim->def->body_count
                   ? " (another mesh)"
                   : "");
  memcpy(&sum, data + size - sizeof sum, sizeof sum);
  if (sum != digest(DIGEST_START, data, size - sizeof sum))
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "%s is truncated or damaged: its checksum does not fit", path);
  return CLOTH_OK;
}

// after the checksum has been found right, sizes inside can be trusted only as far as the file
// reaches
static cloth_status load_hold(cloth_sim *sim, reader *r, int index, int *held, cloth_error *err)
{
  const void *p = take(r, sizeof(file_hold));
  if (p == NULL) CLOTH_FAIL(err, CLOTH_BAD_STATE, "the state file ends inside a grasp");
  file_hold f;
  memcpy(&f, p, sizeof f);
  size_t n = (size_t)f.count, bodies = (size_t)sim->def->body_count;
  const void *vertex = take(r, sizeof(int) * n), *local = take(r, sizeof(double) * 3 * n);
  const void *ignore = f.alive ? take(r, bodies) : NULL;
  if (vertex == NULL || local == NULL || (f.alive && ignore == NULL) || f.count < 0 ||
      f.count > sim->vertex_count)
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "the state file ends inside a grasp");
  CLOTH_TRY(cloth_holds_reserve(sim, index + 1, *held + f.count, err));
  cloth_hold_state *h = &sim->hold[index];
  if (f.alive) {
    h->vertex = realloc(h->vertex, sizeof(int) * n + 1);
    h->local = realloc(h->local, sizeof(double) * 3 * n + 1);
    h->ignore = realloc(h->ignore, bodies + 1);
    if (!h->vertex || !h->local || !h->ignore)
      CLOTH_FAIL(err, CLOTH_NO_MEMORY, "grasp of %zu vertices", n);
    memcpy(h->vertex, vertex, sizeof(int) * n);
    memcpy(h->local, local, sizeof(double) * 3 * n);
    if (bodies > 0) memcpy(h->ignore, ignore, bodies);
    cloth_effect_activate(sim, CLOTH_EFFECT_pins, "vertices are grasped");
  }
  h->now = f.now, h->target = f.target, h->stiffness = f.stiffness, h->break_force = f.break_force;
  memcpy(h->force, f.force, sizeof f.force), memcpy(h->torque, f.torque, sizeof f.torque);
  h->alive = f.alive, h->rigid = f.rigid, h->cloth = f.cloth, h->count = f.count;
  h->body = f.body, h->pin = f.pin, h->generation = f.generation;
  *held += f.count;
  return CLOTH_OK;
}

// are both features of this scene?
static bool pair_exists(const cloth_sim *sim, uint64_t key)
{
  cloth_pair p = cloth_pair_unpack(sim->format, key);
  if (p.type == CLOTH_EDGE_EDGE) return p.a < sim->all_edges && p.b < sim->all_edges;
  return p.a < sim->all_vertices && p.b < sim->all_triangles;
}

static cloth_status load_friction(cloth_sim *sim, reader *r, int count, cloth_error *err)
{
  size_t bytes = sizeof(cloth_friction_entry) * (size_t)(count > 0 ? count : 0);
  const void *data = count >= 0 ? take(r, bytes) : NULL;
  if (data == NULL) CLOTH_FAIL(err, CLOTH_BAD_STATE, "the state file ends inside its contacts");
  cloth_friction_entry *entry = malloc(bytes + 1); // aligned
  if (entry == NULL) CLOTH_FAIL(err, CLOTH_NO_MEMORY, "friction: %d contacts", count);
  memcpy(entry, data, bytes);
  cloth_status status = CLOTH_OK;
  for (int i = 0; i < count && status == CLOTH_OK; i++)
    if (!pair_exists(sim, entry[i].key) || (i > 0 && entry[i].key <= entry[i - 1].key))
      status = cloth_fail(err, CLOTH_BAD_STATE, __FILE__, __LINE__,
                          "the state file has a contact that cannot be");
  if (status == CLOTH_OK) status = cloth_friction_write(sim, entry, count, err);
  free(entry);
  return status;
}

static cloth_status load_all(cloth_sim *sim, const unsigned char *data, size_t size,
                             cloth_error *err)
{
  reader r = {data, data + size - sizeof(uint64_t)};
  file_header head;
  memcpy(&head, take(&r, sizeof head), sizeof head);
  size_t n = 3 * (size_t)sim->vertex_count, bytes = sizeof(cloth_real) * n;
  const unsigned char *x = take(&r, 2 * bytes);
  const void *broken = take(&r, (size_t)head.pins);
  size_t means = sizeof(double) * 3 * (size_t)sim->def->cloth_count;
  const void *mean = take(&r, means), *acceleration = take(&r, means);
  const void *body = take(&r, sizeof(file_body) * (size_t)head.bodies);
  if (x == NULL || broken == NULL || mean == NULL || acceleration == NULL ||
      (body == NULL && head.bodies > 0))
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "the state file is too short");

  int held = 0;
  for (int h = 0; h < sim->hold_count; h++) sim->hold[h].alive = false;
  for (int h = 0; h < head.holds; h++) CLOTH_TRY(load_hold(sim, &r, h, &held, err));
  sim->hold_count = head.holds > sim->hold_count ? head.holds : sim->hold_count;
  CLOTH_TRY(load_friction(sim, &r, head.friction, err));
  const void *h_last = head.history ? take(&r, sizeof(double)) : NULL;
  const unsigned char *history = head.history ? take(&r, 2 * bytes) : NULL;
  if (head.history && (h_last == NULL || history == NULL))
    CLOTH_FAIL(err, CLOTH_BAD_STATE, "the state file ends inside the history of bdf2");
  bool known = history != NULL && sim->params.integrator == CLOTH_BDF2;
  for (int p = 0; p < sim->part_count; p++) {
    cloth_part *part = &sim->part[p];
    CLOTH_TRY(sim->backend->write(part->device, part->x_t0, x, bytes, err));
    CLOTH_TRY(sim->backend->write(part->device, part->v, x + bytes, bytes, err));
    if (!known) continue;
    CLOTH_TRY(sim->backend->write(part->device, part->x_last, history, bytes, err));
    CLOTH_TRY(sim->backend->write(part->device, part->v_last, history + bytes, bytes, err));
  }
  for (int b = 0; b < head.bodies; b++) {
    file_body f;
    memcpy(&f, (const char *)body + sizeof f * (size_t)b, sizeof f);
    sim->body[b].now = f.now, sim->body[b].target = f.target, sim->body[b].commanded = f.commanded;
  }
  memcpy(sim->pin_broken, broken, (size_t)head.pins);
  memcpy(sim->mean_velocity, mean, means), memcpy(sim->acceleration, acceleration, means);
  sim->mean_known = head.mean_known, sim->substeps_crowded = head.substeps;
  sim->control.parts = head.parts;
  sim->time = head.time, sim->step = head.step;
  sim->pairs_valid = false;
  CLOTH_TRY(cloth_holds_refresh(sim, err));
  sim->bdf2.known = known;
  if (known) memcpy(&sim->bdf2.h_last, h_last, sizeof(double));
  sim->tangles.known_free = head.tangles & 1, sim->tangles.settling = head.tangles & 2;
  cloth_blocking_clear(sim);
  return CLOTH_OK;
}

cloth_status cloth_sim_load(void *data, const char *path, cloth_error *err)
{
  cloth_sim *sim = data;
  unsigned char *file = NULL;
  size_t size = 0;
  CLOTH_TRY(read_file(path, &file, &size, err));
  cloth_status status = check_header(sim, path, file, size, err);
  if (status == CLOTH_OK) status = load_all(sim, file, size, err);
  free(file);
  return status;
}
