// Settings by name and text: what a command line, a ROS parameter and a scene file share.
#include "nearest.h"
#include "scene/def.h"
#include "scene/number.h"

#include <stdio.h>
#include <string.h>

static cloth_status set_word(char *out, size_t size, const char *name, const char *value,
                             const char *const *choices, const char *list, cloth_error *err)
{
  const char *best = NULL;
  for (; *choices; choices++) {
    if (strcmp(*choices, value) == 0) {
      snprintf(out, size, "%s", value);
      return CLOTH_OK;
    }
    cloth_nearest(value, *choices, &best);
  }
  CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s = '%s' is not one of %s; the nearest is '%s'", name,
             value, list, best);
}

// "cpu,cpu,cpu" are the devices 0, 1, 2 of the CPU backend; "0,0,1" names them; "mpi" is one for
// each process
static cloth_status set_devices(cloth_def *def, const char *value, cloth_error *err)
{
  int device[CLOTH_DEVICES_MAX], count = 0, cpus = 0;
  bool processes = strcmp(value, "mpi") == 0;
  if (processes) value = "0";
  for (const char *at = value;; at++) {
    char word[16];
    at += strspn(at, " \t");
    size_t n = strcspn(at, ","), length = n;
    while (length > 0 && (at[length - 1] == ' ' || at[length - 1] == '\t')) length--;
    snprintf(word, sizeof word, "%.*s", (int)(length < 15 ? length : 15), at);
    if (count == CLOTH_DEVICES_MAX)
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "devices = '%.60s...' has more than %d parts", value,
                 (int)CLOTH_DEVICES_MAX);
    if (strcmp(word, "cpu") == 0)
      device[count] = cpus++;
    else if (!cloth_integer_parse(word, &device[count]) || device[count] < 0 ||
             device[count] > 1023)
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
                 "devices = '%.60s': '%s' is neither 'cpu' nor a device index in [0, 1023]; mpi "
                 "stands alone",
                 value, word);
    count++;
    at += n;
    if (*at == '\0') break;
  }
  memcpy(def->device, device, sizeof device[0] * (size_t)count);
  def->device_count = count;
  def->devices_are_cpu = cpus > 0;
  def->devices_are_processes = processes;
  return CLOTH_OK;
}

enum {
#define CLOTH_EFFECT(name) COUNT_##name,
#include "effect/effects.inl"
  EFFECT_COUNT
};
_Static_assert((int)EFFECT_COUNT <= (int)CLOTH_EFFECTS_MAX, "each effect has room for a wish");

static bool is_one_of(const char *value, const char *const *words)
{
  for (; *words; words++)
    if (strcmp(value, *words) == 0) return true;
  return false;
}

static cloth_status set_effect(cloth_def *def, const char *name, const char *value,
                               cloth_error *err)
{
  static const char *const on[] = {"on", "true", "yes", NULL}, *const off[] = {"off", "false", "no",
                                                                               NULL};
  cloth_effect_wish wish = CLOTH_EFFECT_AUTO;
  if (is_one_of(value, on))
    wish = CLOTH_EFFECT_ON;
  else if (is_one_of(value, off))
    wish = CLOTH_EFFECT_OFF;
  else if (strcmp(value, "auto") != 0)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "effects.%s = '%s' is not one of auto, on, off", name,
               value);

  static const char *const known[] = {
#define CLOTH_EFFECT(name) #name,
#include "effect/effects.inl"
      NULL};
  const char *best = NULL;
  for (const char *const *effect = known; *effect; effect++) cloth_nearest(name, *effect, &best);
  if (strcmp(best, name) != 0)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "effects.%s: unknown effect; the nearest is '%s'", name,
               best);
  int i = 0;
  while (i < def->effect_count && strcmp(def->effect[i].name, name) != 0) i++;
  if (i == def->effect_count) def->effect_count++;
  snprintf(def->effect[i].name, sizeof def->effect[i].name, "%s", name);
  def->effect[i].wish = wish;
  return CLOTH_OK;
}

static cloth_status set_duration(cloth_def *def, const char *value, cloth_error *err)
{
  double number;
  if (!cloth_number_parse(value, &number))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "duration = '%s' is not a number; [s] in [0, 1e+06]",
               value);
  if (!(number >= 0 && number <= 1e6))
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "duration = %g [s] is not in [0, 1e+06]", number);
  def->duration = number;
  return CLOTH_OK;
}

cloth_status cloth_def_set(cloth_def *def, const char *name, const char *value, cloth_error *err)
{
  static const char *const backends[] = {"auto", "cpu", "cuda", "shuffle", NULL};
  static const char *const precisions[] = {"float", "double", NULL};
  if (name == NULL || value == NULL)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "a setting needs a name and a value");
  if (strcmp(name, "backend") == 0)
    return set_word(def->backend, sizeof def->backend, name, value, backends,
                    "auto, cpu, cuda, shuffle", err);
  if (strcmp(name, "precision") == 0)
    return set_word(def->precision, sizeof def->precision, name, value, precisions, "float, double",
                    err);
  if (strcmp(name, "devices") == 0) return set_devices(def, value, err);
  if (strcmp(name, "duration") == 0) return set_duration(def, value, err);
  if (strncmp(name, "effects.", 8) == 0) return set_effect(def, name + 8, value, err);

  const char *best = NULL;
  cloth_nearest(name, "backend", &best);
  cloth_nearest(name, "precision", &best);
  cloth_nearest(name, "devices", &best);
  cloth_nearest(name, "duration", &best);
  for (const cloth_param_info *p = cloth_param_table(); p->name; p++) {
    if (strcmp(p->name, name) == 0)
      return cloth_param_set(cloth_param_table(), &def->params, name, value, err);
    cloth_nearest(name, p->name, &best);
  }
  CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "unknown name '%s'; the nearest is '%s'", name, best);
}
