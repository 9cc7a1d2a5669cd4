#include "params.h"

#include "nearest.h"
#include "scene/number.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

cloth_params cloth_params_default(void)
{
  return (cloth_params){
#define CLOTH_PARAM(type, name, value, unit, least, most, meaning) .name = value,
#define CLOTH_VECTOR(name, x, y, z, unit, most, meaning)           .name = {x, y, z},
#define CLOTH_CHOICE(name, value, choices, meaning)                .name = value,
#include "params.inl"
  };
}

cloth_material cloth_material_default(void)
{
  return (cloth_material){
#define CLOTH_MATERIAL(name, value, unit, least, most, meaning) .name = value,
#include "material.inl"
  };
}

const cloth_param_info *cloth_param_table(void)
{
// clang-format off
#define KIND_double CLOTH_IS_DOUBLE
#define KIND_int    CLOTH_IS_INT
  static const cloth_param_info table[] = {
#define CLOTH_PARAM(type, name, value, unit, least, most, meaning)                                 \
  {#name, unit, meaning, NULL, KIND_##type, least, most, {value, 0, 0}, offsetof(cloth_params, name)},
#define CLOTH_VECTOR(name, x, y, z, unit, most, meaning)                                           \
  {#name, unit, meaning, NULL, CLOTH_IS_VECTOR, -(most), most, {x, y, z}, offsetof(cloth_params, name)},
#define CLOTH_CHOICE(name, value, choices, meaning)                                                \
  {#name, "1", meaning, choices, CLOTH_IS_CHOICE, 0, 0, {value, 0, 0}, offsetof(cloth_params, name)},
  // clang-format on
#include "params.inl"
      {NULL, NULL, NULL, NULL, CLOTH_IS_DOUBLE, 0, 0, {0, 0, 0}, 0}};
  return table;
}

const cloth_param_info *cloth_material_table(void)
{
  static const cloth_param_info table[] = {
#define CLOTH_MATERIAL(name, value, unit, least, most, meaning)                                    \
  {#name,                                                                                          \
   unit,                                                                                           \
   meaning,                                                                                        \
   NULL,                                                                                           \
   CLOTH_IS_DOUBLE,                                                                                \
   least,                                                                                          \
   most,                                                                                           \
   {value, 0, 0},                                                                                  \
   offsetof(cloth_material, name)},
#include "material.inl"
      {NULL, NULL, NULL, NULL, CLOTH_IS_DOUBLE, 0, 0, {0, 0, 0}, 0}};
  return table;
}

static int choice_count(const char *choices)
{
  int n = 1;
  for (; *choices; choices++) n += *choices == '|';
  return n;
}

const char *cloth_param_choice(const cloth_param_info *info, int index, int *length)
{
  const char *word = info->choices;
  for (; index > 0 && strchr(word, '|'); index--) word = strchr(word, '|') + 1;
  *length = (int)strcspn(word, "|");
  return word;
}

// index of a word in "a|b|c", or -1
static int choice_find(const char *choices, const char *word)
{
  size_t length = strlen(word);
  for (int i = 0;; i++) {
    size_t n = strcspn(choices, "|");
    if (n == length && memcmp(choices, word, n) == 0) return i;
    if (choices[n] == '\0') return -1;
    choices += n + 1;
  }
}

static cloth_status check_range(const cloth_param_info *p, const double *value, cloth_error *err)
{
  if (p->kind != CLOTH_IS_VECTOR) {
    if (!(value[0] >= p->least && value[0] <= p->most))
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s = %g [%s] is not in [%g, %g]", p->name, value[0],
                 p->unit, p->least, p->most);
    return CLOTH_OK;
  }
  for (int c = 0; c < 3; c++)
    if (!(value[c] >= p->least && value[c] <= p->most))
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s = (%g, %g, %g) [%s]: %c is not in [%g, %g]", p->name,
                 value[0], value[1], value[2], p->unit, "xyz"[c], p -> least, p -> most);
  return CLOTH_OK;
}

static cloth_status check_entry(const cloth_param_info *p, const void *base, cloth_error *err)
{
  const char *field = (const char *)base + p->offset;
  double value[3] = {0};
  int whole;
  switch (p->kind) {
  case CLOTH_IS_DOUBLE:
    memcpy(value, field, sizeof *value);
    break;
  case CLOTH_IS_VECTOR:
    memcpy(value, field, sizeof value);
    break;
  case CLOTH_IS_INT:
    memcpy(&whole, field, sizeof whole);
    value[0] = whole;
    break;
  case CLOTH_IS_CHOICE:
    memcpy(&whole, field, sizeof whole);
    if (whole < 0 || whole >= choice_count(p->choices))
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s = %d is not one of %s", p->name, whole, p->choices);
    return CLOTH_OK;
  }
  return check_range(p, value, err);
}

cloth_status cloth_params_check(const cloth_params *params, cloth_error *err)
{
  for (const cloth_param_info *p = cloth_param_table(); p->name; p++)
    CLOTH_TRY(check_entry(p, params, err));
  return CLOTH_OK;
}

cloth_status cloth_material_check(const cloth_material *m, cloth_error *err)
{
  for (const cloth_param_info *p = cloth_material_table(); p->name; p++)
    CLOTH_TRY(check_entry(p, m, err));

  // the stiffness matrix of an orthotropic membrane is positive definite only then
  if (m->poisson > 0 && m->stretch_weft > 0 &&
      !(m->poisson * m->poisson * m->stretch_weft < m->stretch_warp))
    CLOTH_FAIL(
        err, CLOTH_BAD_ARGUMENT,
        "poisson = %g [1] is not in [0, %g): its square times stretch_weft = %g [N/m] must be "
        "below stretch_warp = %g [N/m]",
        m->poisson, m->stretch_warp > 0 ? sqrt(m->stretch_warp / m->stretch_weft) : 0.0,
        m->stretch_weft, m->stretch_warp);
  return CLOTH_OK;
}

static const cloth_param_info *find(const cloth_param_info *table, const char *name)
{
  for (; table->name; table++)
    if (strcmp(table->name, name) == 0) return table;
  return NULL;
}

// three numbers separated by blanks or commas
static bool parse_vector(const char *text, double out[3])
{
  for (int c = 0; c < 3; c++) {
    while (*text == ' ' || *text == '\t' || (c > 0 && *text == ',')) text++;
    text = cloth_number_read(text, &out[c]);
    if (text == NULL) return false;
    if (*text != '\0' && strchr(" \t,\r\n", *text) == NULL) return false;
  }
  return text[strspn(text, " \t\r\n")] == '\0';
}

static cloth_status set_choice(const cloth_param_info *p, char *field, const char *value,
                               cloth_error *err)
{
  int index = choice_find(p->choices, value);
  if (index < 0)
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s = '%s' is not one of %s", p->name, value, p->choices);
  memcpy(field, &index, sizeof index);
  return CLOTH_OK;
}

static cloth_status set_int(const cloth_param_info *p, char *field, const char *value,
                            cloth_error *err)
{
  int whole;
  double number;
  if (!cloth_integer_parse(value, &whole)) {
    // a number that no int can hold is out of range, not a misspelling
    if (cloth_number_parse(value, &number)) CLOTH_TRY(check_range(p, &number, err));
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s = '%s' is not a whole number in [%g, %g]", p->name,
               value, p->least, p->most);
  }
  number = whole;
  CLOTH_TRY(check_range(p, &number, err));
  memcpy(field, &whole, sizeof whole);
  return CLOTH_OK;
}

// a number, or a word or a spelling that only this parameter has: real_time; 1 %
static bool parse_double(const cloth_param_info *p, const char *value, double *out)
{
  if (strcmp(p->name, "time_budget") == 0 && strcmp(value, "real_time") == 0)
    return *out = -1, true;
  const char *percent = strcmp(p->name, "accuracy") == 0 ? strchr(value, '%') : NULL;
  if (percent == NULL) return cloth_number_parse(value, out);
  char number[64];
  if (percent - value >= (int)sizeof number || percent[1 + strspn(percent + 1, " \t\r\n")] != '\0')
    return false;
  memcpy(number, value, (size_t)(percent - value));
  number[percent - value] = '\0';
  if (!cloth_number_parse(number, out)) return false;
  *out /= 100;
  return true;
}

cloth_status cloth_param_set(const cloth_param_info *table, void *base, const char *name,
                             const char *value, cloth_error *err)
{
  const cloth_param_info *p = find(table, name);
  if (p == NULL) {
    const char *best = NULL;
    for (const cloth_param_info *q = table; q->name; q++) cloth_nearest(name, q->name, &best);
    CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "unknown name '%s'; the nearest is '%s'", name, best);
  }
  char *field = (char *)base + p->offset;
  double number[3] = {0};
  switch (p->kind) {
  case CLOTH_IS_CHOICE:
    return set_choice(p, field, value, err);
  case CLOTH_IS_INT:
    return set_int(p, field, value, err);
  case CLOTH_IS_DOUBLE:
    if (!parse_double(p, value, number))
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT, "%s = '%s' is not a number%s; [%s] in [%g, %g]", p->name,
                 value, strcmp(name, "accuracy") == 0 ? " such as 0.01 or 1 %" : "", p->unit,
                 p->least, p->most);
    CLOTH_TRY(check_range(p, number, err));
    memcpy(field, number, sizeof *number);
    return CLOTH_OK;
  case CLOTH_IS_VECTOR:
    if (!parse_vector(value, number))
      CLOTH_FAIL(err, CLOTH_BAD_ARGUMENT,
                 "%s = '%s' is not three numbers such as \"%g %g %g\"; [%s], each in [%g, %g]",
                 p->name, value, p->value[0], p->value[1], p->value[2], p->unit, p->least, p->most);
    CLOTH_TRY(check_range(p, number, err));
    memcpy(field, number, sizeof number);
    return CLOTH_OK;
  }
  CLOTH_FAIL(err, CLOTH_INTERNAL, "%s: unknown kind %d", p->name, (int)p->kind);
}
