// Tests of src/scene/number.c.
#include "check.h"
#include "scene/number.h"

#include <limits.h>
#include <stdint.h>

static int same_bits_as_the_c_library(void)
{
  static const char *const texts[] = {"0",
                                      "-0",
                                      "1",
                                      "0.1",
                                      "-2.5e-3",
                                      ".5",
                                      "5.",
                                      "1e22",
                                      "1e23",
                                      "123456789012345",
                                      "1234567890123456",
                                      "9007199254740993",
                                      "4.9e-324",
                                      "2.2250738585072011e-308",
                                      "1.7976931348623157e308",
                                      "0.000000000000000000000000000001",
                                      "1e-22",
                                      "100000000000000000000000000000000",
                                      "3.14159265358979323846",
                                      "+7",
                                      "007.25",
                                      "1E+2",
                                      "0.30000000000000004",
                                      "1e400",
                                      "1e-400"};
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
    double ours, theirs = strtod(texts[i], NULL);
    CHECK(cloth_number_parse(texts[i], &ours));
    CHECK(memcmp(&ours, &theirs, sizeof ours) == 0);
  }
  return 0;
}

static int printing_and_reading_gives_the_same_bits(void)
{
  uint64_t state = 1;
  for (int i = 0; i < 20000; i++) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    double mantissa = (double)(int64_t)state / 9223372036854775808.0, back;
    double value = ldexp(mantissa, (int)(state >> 56) - 128);
    char text[64];
    snprintf(text, sizeof text, "%.17g", value);
    CHECK(cloth_number_parse(text, &back));
    CHECK(back == value);
    snprintf(text, sizeof text, "%.6f", mantissa); // short ones take another path
    CHECK(cloth_number_parse(text, &back));
    CHECK(back == strtod(text, NULL));
  }
  return 0;
}

static int words_for_infinity_and_nan(void)
{
  double x;
  CHECK(cloth_number_parse("nan", &x) && isnan(x));
  CHECK(cloth_number_parse(".NaN", &x) && isnan(x));
  CHECK(cloth_number_parse("inf", &x) && x == INFINITY);
  CHECK(cloth_number_parse("-.inf", &x) && x == -INFINITY);
  CHECK(cloth_number_parse("Infinity", &x) && x == INFINITY);
  return 0;
}

static int garbage_is_no_number(void)
{
  static const char *const texts[] = {"",    " ",     ".",   "-",    "+",    "e5",  "1e",
                                      "1e+", "1.2.3", "1,5", "0x10", "1 2",  "--1", "abc",
                                      "1f",  "nanx",  ".e1", "\xff", "1e5e5"};
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
    double x = 42;
    int n = 42;
    if (cloth_number_parse(texts[i], &x)) printf("'%s' was read as %g\n", texts[i], x);
    CHECK(x == 42);
    CHECK(!cloth_integer_parse(texts[i], &n) && n == 42);
  }
  return 0;
}

static int whole_numbers_fit_or_are_refused(void)
{
  int n;
  CHECK(cloth_integer_parse(" 12 ", &n) && n == 12);
  CHECK(cloth_integer_parse("2147483647", &n) && n == INT_MAX);
  CHECK(cloth_integer_parse("-2147483648", &n) && n == INT_MIN);
  CHECK(!cloth_integer_parse("2147483648", &n));
  CHECK(!cloth_integer_parse("-2147483649", &n));
  CHECK(!cloth_integer_parse("99999999999999999999999", &n));
  CHECK(!cloth_integer_parse("1.0", &n));
  return 0;
}

static int a_number_ends_where_it_ends(void)
{
  double x;
  const char *text = "1.5/2";
  CHECK(cloth_number_read(text, &x) == text + 3 && x == 1.5);
  text = "3e";
  CHECK(cloth_number_read(text, &x) == text + 1 && x == 3);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(same_bits_as_the_c_library);
  RUN(printing_and_reading_gives_the_same_bits);
  RUN(words_for_infinity_and_nan);
  RUN(garbage_is_no_number);
  RUN(whole_numbers_fit_or_are_refused);
  RUN(a_number_ends_where_it_ends);
  return failures != 0;
}
