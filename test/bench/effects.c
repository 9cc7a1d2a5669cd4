// What each effect of a scene costs: the scene runs warm, its state is saved, and from that state a
// few steps are timed as it is and without each of its effects. All scenes take turns in every
// round and minima are kept, so that what else runs on the machine disturbs all alike. And the bare
// pass: what a loop over the vertices costs that does no more than read and write the state.
//
//   effects_price WARM STEPS ROUNDS SCENE.yaml [KEY=VALUE...]   CSV: what was removed, whose time
//   and
//                                                               memory, ms a step, bytes
//   effects_price bare VERTICES ROUNDS                           ms of a pass, double, one thread
#include "cloth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { EFFECTS_MAX = 32, VARIANTS_MAX = EFFECTS_MAX + 1 };

// the scene without one effect
typedef struct variant {
  const char *removed; // "" for the scene as it is
  cloth_scene *scene;
  double step_ms, effect_ms[EFFECTS_MAX]; // least over the rounds
  cloth_step_report last;
} variant;

static int fail(const char *what, const cloth_error *err)
{
  fprintf(stderr, "effects_price: %s: %s\n", what, err->text);
  return 1;
}

// of this program on a CPU, which others disturb little; else of the wall
static double now_ms(bool cpu)
{
  struct timespec t;
  clock_gettime(cpu ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int make(variant *v, const char *path, char **set, int sets, const char *removed)
{
  cloth_error err = {0};
  cloth_def *def = NULL;
  char key[128];
  memset(v, 0, sizeof *v);
  v->removed = removed;
  v->step_ms = INFINITY;
  for (int e = 0; e < EFFECTS_MAX; e++) v->effect_ms[e] = INFINITY;
  if (cloth_def_load(path, &def, &err)) return fail(path, &err);
  for (int i = 0; i < sets; i++) {
    const char *value = strchr(set[i], '=');
    if (value == NULL || value - set[i] >= (int)sizeof key) return fail(set[i], &err);
    snprintf(key, sizeof key, "%.*s", (int)(value - set[i]), set[i]);
    if (cloth_def_set(def, key, value + 1, &err)) return fail(set[i], &err);
  }
  snprintf(key, sizeof key, "effects.%s", removed);
  if (removed[0] && cloth_def_set(def, key, "off", &err)) return fail(key, &err);
  cloth_status status = cloth_scene_new(def, &v->scene, &err);
  cloth_def_free(def);
  return status ? fail(path, &err) : 0;
}

static int effects_of(const variant *v, cloth_effect_info *out)
{
  cloth_error err = {0};
  for (int e = 0; e < cloth_effect_count(); e++)
    if (cloth_effect_describe(v->scene, e, &out[e], &err)) return fail("effect", &err);
  return 0;
}

// `steps` steps from the saved state; what is least so far is kept
static int round_of(variant *v, const char *state, int steps)
{
  cloth_error err = {0};
  cloth_effect_info before[EFFECTS_MAX], after[EFFECTS_MAX];
  if (cloth_state_load(v->scene, state, &err)) return fail("load", &err);
  if (effects_of(v, before)) return 1;
  bool cpu = strcmp(cloth_backend_of(v->scene), "cpu") == 0;
  double start = now_ms(cpu);
  for (int i = 0; i < steps; i++)
    if (cloth_step(v->scene, 0, &v->last, &err)) return fail("step", &err);
  v->step_ms = fmin(v->step_ms, (now_ms(cpu) - start) / steps);
  if (effects_of(v, after)) return 1;
  for (int e = 0; e < cloth_effect_count(); e++)
    v->effect_ms[e] = fmin(v->effect_ms[e], (after[e].ms - before[e].ms) / steps);
  return 0;
}

static int print(const variant *v)
{
  cloth_effect_info info[EFFECTS_MAX];
  if (effects_of(v, info)) return 1;
  const char *removed = v->removed[0] ? v->removed : "-";
  printf("%s,step,%.5f,%llu,%d\n", removed, v->step_ms, (unsigned long long)v->last.memory_bytes,
         v->last.vertices);
  for (int e = 0; e < cloth_effect_count(); e++)
    if (info[e].active)
      printf("%s,%s,%.5f,%llu,%d\n", removed, info[e].name, v->effect_ms[e],
             (unsigned long long)info[e].memory_bytes, v->last.vertices);
  return 0;
}

// the state after `warm` steps, into a file that mkstemp() names
static int warm_up(int warm, const char *path, char **set, int sets, char *state,
                   cloth_effect_info *info)
{
  variant v;
  cloth_error err = {0};
  int code = make(&v, path, set, sets, "");
  if (code) return code;
  int file = mkstemp(state);
  for (int i = 0; i < warm && !code; i++)
    if (cloth_step(v.scene, 0, NULL, &err)) code = fail("step", &err);
  if (file < 0) code = fail(state, &err);
  if (!code && cloth_state_save(v.scene, state, &err)) code = fail(state, &err);
  if (!code) code = effects_of(&v, info);
  cloth_scene_free(v.scene);
  if (file >= 0) close(file);
  return code;
}

static int price(int warm, int steps, int rounds, const char *path, char **set, int sets)
{
  static variant v[VARIANTS_MAX];
  char state[] = "/tmp/effects-price-XXXXXX";
  cloth_effect_info info[EFFECTS_MAX];
  int count = 0, code = warm_up(warm, path, set, sets, state, info);
  if (!code) code = make(&v[count++], path, set, sets, ""); // as new as the others: same buffers
  for (int e = 0; e < cloth_effect_count() && !code; e++)
    if (info[e].active) code = make(&v[count++], path, set, sets, info[e].name);
  for (int r = 0; r < rounds; r++)
    for (int i = 0; i < count && !code; i++) code = round_of(&v[i], state, steps);
  if (!code) printf("removed,of,ms,bytes,vertices\n");
  for (int i = 0; i < count && !code; i++) code = print(&v[i]);
  for (int i = 0; i < count; i++) cloth_scene_free(v[i].scene);
  remove(state);
  return code;
}

// symplectic Euler: v += h g where it is free, x += h v
static void pass(int n, double h, const double g[3], const double *free_, double *x, double *v)
{
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      double next = free_[i] * (v[3 * i + k] + h * g[k]);
      v[3 * i + k] = next;
      x[3 * i + k] += h * next;
    }
}

static int bare(int n, int rounds)
{
  const double g[3] = {0, 0, -9.81};
  double *x = calloc((size_t)n, 3 * sizeof *x), *v = calloc((size_t)n, 3 * sizeof *v);
  double *is_free = calloc((size_t)n, sizeof *is_free), least = INFINITY;
  for (int i = 0; is_free && i < n; i++) is_free[i] = i > 1;
  for (int r = 0; r < rounds && x && v && is_free; r++) {
    double start = now_ms(true);
    pass(n, 1.0 / 60, g, is_free, x, v);
    least = fmin(least, now_ms(true) - start);
  }
  printf("bare,%.5f,%g\n", least, x && n > 2 ? x[8] : 0); // the result is used
  free(x), free(v), free(is_free);
  return 0;
}

int main(int argc, char **argv)
{
  if (argc == 4 && strcmp(argv[1], "bare") == 0) return bare(atoi(argv[2]), atoi(argv[3]));
  if (argc < 5) {
    fprintf(stderr, "usage: effects_price WARM STEPS ROUNDS SCENE.yaml [KEY=VALUE...]\n"
                    "       effects_price bare VERTICES ROUNDS\n");
    return 2;
  }
  return price(atoi(argv[1]), atoi(argv[2]), atoi(argv[3]), argv[4], argv + 5, argc - 5);
}
