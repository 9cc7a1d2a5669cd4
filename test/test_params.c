// Tests of src/params.c and src/nearest.c.
#include "check.h"
#include "nearest.h"
#include "params.h"

static int defaults_are_legal(void)
{
  cloth_params p = cloth_params_default();
  cloth_material m = cloth_material_default();
  cloth_error err = {0};
  CHECK_OK(cloth_params_check(&p, &err), err);
  CHECK_OK(cloth_material_check(&m, &err), err);
  return 0;
}

static int message_names_parameter_unit_and_range(void)
{
  cloth_params p = cloth_params_default();
  cloth_error err = {0};
  p.thickness = NAN;
  CHECK(cloth_params_check(&p, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strcmp(err.text, "thickness = nan [m] is not in [1e-05, 0.05]") == 0);

  p = cloth_params_default();
  err = (cloth_error){0};
  p.gravity[1] = -INFINITY;
  CHECK(cloth_params_check(&p, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strcmp(err.text, "gravity = (0, -inf, -9.81) [m/s^2]: y is not in [-1000, 1000]") == 0);
  return 0;
}

// what a field of the struct holds, by another route than the table's reader
static double field(const cloth_param_info *p, const void *base, int component)
{
  const char *at = (const char *)base + p->offset;
  if (p->kind == CLOTH_IS_INT || p->kind == CLOTH_IS_CHOICE) return *(const int *)at;
  return ((const double *)at)[component];
}

static int check_limits(const cloth_param_info *table, void *base)
{
  for (const cloth_param_info *p = table; p->name; p++) {
    if (p->kind == CLOTH_IS_CHOICE) continue;
    const double inside[2] = {p->least, p->most};
    double outside[2] = {p->least - 1, p->most + 1};
    if (p->kind == CLOTH_IS_DOUBLE || p->kind == CLOTH_IS_VECTOR)
      outside[0] = nextafter(p->least, -INFINITY), outside[1] = nextafter(p->most, INFINITY);
    for (int i = 0; i < 2; i++) {
      char text[200];
      cloth_error err = {0};
      const char *format = p->kind == CLOTH_IS_VECTOR ? "%.17g 0 %.17g" : "%.17g";
      snprintf(text, sizeof text, format, inside[i], inside[i]);
      CHECK_OK(cloth_param_set(table, base, p->name, text, &err), err);
      CHECK(field(p, base, 0) == inside[i]);
      snprintf(text, sizeof text, format, outside[i], inside[i]);
      CHECK(cloth_param_set(table, base, p->name, text, &err) == CLOTH_BAD_ARGUMENT);
      CHECK(strstr(err.text, p->name) != NULL);
      CHECK(strstr(err.text, p->unit) != NULL);
      CHECK(field(p, base, 0) == inside[i]); // a refusal changes nothing
    }
  }
  return 0;
}

static int both_ends_of_every_range_are_in_it(void)
{
  cloth_params p = cloth_params_default();
  cloth_material m = cloth_material_default();
  return check_limits(cloth_param_table(), &p) || check_limits(cloth_material_table(), &m);
}

static int tables_hold_the_defaults_of_the_structs(void)
{
  cloth_params params = cloth_params_default();
  int count = 0;
  for (const cloth_param_info *p = cloth_param_table(); p->name; p++, count++)
    for (int c = 0; c < (p->kind == CLOTH_IS_VECTOR ? 3 : 1); c++)
      CHECK(field(p, &params, c) == p->value[c]);
  CHECK(count > 20);
  CHECK(params.gravity[2] == -9.81 && params.newton_iterations_max == 3 &&
        params.thickness == 3e-3);
  return 0;
}

static int a_material_must_be_positive_definite(void)
{
  cloth_material m = cloth_material_default();
  cloth_error err = {0};
  m.poisson = 0.6, m.stretch_warp = 100, m.stretch_weft = 277; // 0.6^2 * 277 < 100
  CHECK_OK(cloth_material_check(&m, &err), err);
  m.stretch_weft = 278;
  CHECK(cloth_material_check(&m, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strstr(err.text, "poisson = 0.6") != NULL);
  m.stretch_warp = m.stretch_weft = m.shear = 0; // no membrane at all
  err = (cloth_error){0};
  CHECK_OK(cloth_material_check(&m, &err), err);
  return 0;
}

static int an_accuracy_is_a_share_or_so_many_per_cent(void)
{
  static const char *const good[] = {"0.01", "1 %", "1%", " 1.0 % ", "1e0\t%"};
  static const char *const bad[] = {"1 %%", "% 1", "%", "1 % m", "one %", "1 m", "", "0x1p-7 %"};
  static const char *const outside[] = {"0.6", "1", "51 %", "-1 %", "nan %"};
  cloth_params p = cloth_params_default();
  cloth_error err = {0};
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    p.accuracy = 0;
    CHECK_OK(cloth_param_set(cloth_param_table(), &p, "accuracy", good[i], &err), err);
    CHECK_NEAR(p.accuracy, 0.01, 1e-16);
  }
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    err = (cloth_error){0};
    CHECK(cloth_param_set(cloth_param_table(), &p, "accuracy", bad[i], &err) == CLOTH_BAD_ARGUMENT);
    CHECK(strstr(err.text, "0.01 or 1 %") != NULL && strstr(err.text, "[0, 0.5]") != NULL);
  }
  for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
    err = (cloth_error){0};
    CHECK(cloth_param_set(cloth_param_table(), &p, "accuracy", outside[i], &err) ==
          CLOTH_BAD_ARGUMENT);
    CHECK(strstr(err.text, "[0, 0.5]") != NULL);
  }
  CHECK_NEAR(p.accuracy, 0.01, 1e-16);
  // a share of what it does not say stays a misspelling
  CHECK(cloth_param_set(cloth_param_table(), &p, "friction", "30 %", &err) == CLOTH_BAD_ARGUMENT);
  return 0;
}

static int unknown_names_get_the_nearest(void)
{
  static const char *const pairs[][2] = {{"thicknes", "thickness"},
                                         {"timestep", "time_step"},
                                         {"Gravity", "gravity"},
                                         {"pcg_tolerence", "pcg_tolerance"},
                                         {"sub_steps", "substeps"}};
  cloth_params p = cloth_params_default();
  for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
    cloth_error err = {0};
    char expected[100];
    CHECK(cloth_param_set(cloth_param_table(), &p, pairs[i][0], "1", &err) == CLOTH_BAD_ARGUMENT);
    snprintf(expected, sizeof expected, "'%s'; the nearest is '%s'", pairs[i][0], pairs[i][1]);
    CHECK(strstr(err.text, expected) != NULL);
  }
  return 0;
}

static int wrong_types_say_what_was_expected(void)
{
  static const char *const rows[][3] = {
      {"thickness", "thick", "is not a number"},
      {"thickness", "", "is not a number"},
      {"thickness", "1e-3 m", "is not a number"},
      {"thickness", "0x1p-8", "is not a number"},
      {"thickness", "nan", "thickness = nan [m] is not in"},
      {"threads", "2.5", "is not a whole number in [0, 1024]"},
      {"threads", "99999999999999999999", "threads = 1e+20 [1] is not in [0, 1024]"},
      {"threads", "-1", "threads = -1 [1] is not in [0, 1024]"},
      {"gravity", "0 0", "is not three numbers such as \"0 0 -9.81\""},
      {"gravity", "0 0 0 0", "is not three numbers"},
      {"gravity", "1 2 x", "is not three numbers"},
      {"gravity", "0 nan 0", "y is not in [-1000, 1000]"},
      {"mesh_defects", "fix", "is not one of refuse|repair"},
      {"mesh_defects", "", "is not one of refuse|repair"},
      {"mesh_defects", "refuse|repair", "is not one of refuse|repair"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    cloth_params p = cloth_params_default(), before = p;
    cloth_error err = {0};
    CHECK(cloth_param_set(cloth_param_table(), &p, rows[i][0], rows[i][1], &err) ==
          CLOTH_BAD_ARGUMENT);
    if (strstr(err.text, rows[i][2]) == NULL) {
      printf("%s = %s: %s\n", rows[i][0], rows[i][1], err.text);
      return 1;
    }
    CHECK(memcmp(&p, &before, sizeof p) == 0);
  }
  return 0;
}

static int text_sets_every_kind(void)
{
  cloth_params p = cloth_params_default();
  cloth_error err = {0};
  CHECK_OK(cloth_param_set(cloth_param_table(), &p, "thickness", " 2.5e-3 ", &err), err);
  CHECK_OK(cloth_param_set(cloth_param_table(), &p, "threads", "4", &err), err);
  CHECK_OK(cloth_param_set(cloth_param_table(), &p, "gravity", "0, 1.5 -2", &err), err);
  CHECK_OK(cloth_param_set(cloth_param_table(), &p, "mesh_defects", "repair", &err), err);
  CHECK(p.thickness == 2.5e-3 && p.threads == 4 && p.mesh_defects == 1);
  CHECK(p.gravity[0] == 0 && p.gravity[1] == 1.5 && p.gravity[2] == -2);
  p.mesh_defects = 2;
  CHECK(cloth_params_check(&p, &err) == CLOTH_BAD_ARGUMENT);
  CHECK(strstr(err.text, "mesh_defects = 2 is not one of refuse|repair") != NULL);
  return 0;
}

static int edit_distance_counts_letters(void)
{
  CHECK(cloth_edit_distance("", "") == 0);
  CHECK(cloth_edit_distance("", "abc") == 3);
  CHECK(cloth_edit_distance("abc", "") == 3);
  CHECK(cloth_edit_distance("kitten", "sitting") == 3); // Levenshtein's example
  CHECK(cloth_edit_distance("form", "from") == 1);      // two letters swapped
  CHECK(cloth_edit_distance("ABC", "abc") == 0);
  char longer[200];
  memset(longer, 'x', sizeof longer - 1);
  longer[sizeof longer - 1] = '\0';
  CHECK(cloth_edit_distance(longer, longer) == 0);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(defaults_are_legal);
  RUN(message_names_parameter_unit_and_range);
  RUN(both_ends_of_every_range_are_in_it);
  RUN(tables_hold_the_defaults_of_the_structs);
  RUN(a_material_must_be_positive_definite);
  RUN(an_accuracy_is_a_share_or_so_many_per_cent);
  RUN(unknown_names_get_the_nearest);
  RUN(wrong_types_say_what_was_expected);
  RUN(text_sets_every_kind);
  RUN(edit_distance_counts_letters);
  return failures != 0;
}
