// Tests of src/geometry/predicates.c. Oracle: the same determinants in 64-bit whole numbers, with
// coordinates small enough that nothing overflows. Multiplied by a power of two the sign stays,
// also down among the denormals and up where a product of two overflows.
#include "check.h"
#include "geometry/exact_integer.h"
#include "geometry/predicates.h"

#include <float.h>
#include <limits.h>
#include <stdint.h>

static uint64_t state = 88172645463325252u;

// whole, in [-most, most]
static int64_t whole(int64_t most)
{
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return (int64_t)(state % (uint64_t)(2 * most + 1)) - most;
}

static int sign_of(int64_t x) { return (x > 0) - (x < 0); }

// d is often in the plane of the others, on the line of two of them, or one of them
static void four_points(int64_t most, int64_t x[4][3])
{
  int64_t s = whole(3), t = whole(3), how = whole(2);
  for (int p = 0; p < 3; p++)
    for (int k = 0; k < 3; k++) x[p][k] = whole(most);
  for (int k = 0; k < 3; k++) {
    int64_t u = x[1][k] - x[0][k], v = x[2][k] - x[0][k];
    x[3][k] = x[0][k] + s * u + (how > 0 ? t * v : 0) + (how < 0 ? whole(1) : 0);
  }
}

static void to_doubles(int64_t x[4][3], int exponent, double y[4][3])
{
  for (int p = 0; p < 4; p++)
    for (int k = 0; k < 3; k++) y[p][k] = ldexp((double)x[p][k], exponent);
}

static int exact_3d(int64_t x[4][3])
{
  int64_t e[3][3];
  for (int p = 0; p < 3; p++)
    for (int k = 0; k < 3; k++) e[p][k] = x[p + 1][k] - x[0][k];
  int64_t det = 0;
  for (int k = 0; k < 3; k++) {
    int p = (k + 1) % 3, q = (k + 2) % 3;
    det += e[2][k] * (e[0][p] * e[1][q] - e[0][q] * e[1][p]);
  }
  return sign_of(det);
}

static int exact_2d(int64_t x[4][3], int axis)
{
  int p = (axis + 1) % 3, q = (axis + 2) % 3;
  return sign_of((x[1][p] - x[0][p]) * (x[2][q] - x[0][q]) -
                 (x[1][q] - x[0][q]) * (x[2][p] - x[0][p]));
}

static int signs_are_those_of_whole_numbers(void)
{
  const int exponent[] = {0, -20, -1074, -500, 600, 1000};
  int zeros = 0, others = 0;
  for (int n = 0; n < 60000; n++) {
    int64_t x[4][3];
    double y[4][3];
    four_points(n % 3 ? 4 : 1 << 16, x);
    to_doubles(x, exponent[n % 6], y);
    int sign = exact_3d(x);
    sign ? others++ : zeros++;
    CHECK(cloth_orient3d(y[0], y[1], y[2], y[3]) == sign);
    CHECK(cloth_orient3d(y[1], y[0], y[2], y[3]) == -sign);
    CHECK(cloth_orient3d(y[3], y[2], y[1], y[0]) == sign);
    for (int axis = 0; axis < 3; axis++) {
      CHECK(cloth_orient2d(y[0], y[1], y[2], axis) == exact_2d(x, axis));
      CHECK(cloth_orient2d(y[1], y[0], y[2], axis) == -exact_2d(x, axis));
    }
  }
  CHECK(zeros > 5000 && others > 5000);
  return 0;
}

static int one_last_digit_decides(void)
{
  // on the plane x + y + z = 3 at one; a last digit up or down is off it
  double a[3] = {3, 0, 0}, b[3] = {0, 3, 0}, c[3] = {0, 0, 3}, d[3] = {0.5, 0.25, 2.25};
  CHECK(cloth_orient3d(a, b, c, d) == 0);
  d[0] = nextafter(0.5, 1);
  CHECK(cloth_orient3d(a, b, c, d) == 1);
  d[0] = nextafter(0.5, 0);
  CHECK(cloth_orient3d(a, b, c, d) == -1);
  // along a line: 0.1 + 0.2 is not 0.3 in doubles
  double p[3] = {0, 0, 0}, q[3] = {0.1, 0.3, 0}, r[3] = {0.2, 0.6, 0};
  CHECK(cloth_orient2d(p, q, r, 2) == 0);
  r[1] = 0.1 + 0.5;
  CHECK(cloth_orient2d(p, q, r, 2) == sign_of((int64_t)((r[1] - 0.6) * 1e18)));
  return 0;
}

static int the_whole_range_of_double_is_exact(void)
{
  double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0}, d[3] = {0.2, 0.2, 5e-324};
  CHECK(cloth_orient3d(a, b, c, d) == 1);
  b[0] = c[1] = 1e-200; // the volume is 5e-724
  CHECK(cloth_orient3d(a, b, c, d) == 1);
  b[0] = c[1] = DBL_MAX;
  CHECK(cloth_orient3d(a, b, c, d) == 1);
  a[0] = a[1] = -DBL_MAX, d[2] = -DBL_MAX; // differences overflow
  CHECK(cloth_orient3d(a, b, c, d) == -1);
  CHECK(cloth_orient2d(a, b, c, 2) == 1);
  d[2] = 0;
  CHECK(cloth_orient3d(a, b, c, d) == 0);
  return 0;
}

static int whole_numbers_add_and_multiply(void)
{
  // (2^1000 + 2^-1000) (2^1000 - 2^-1000) = 2^2000 - 2^-2000
  cloth_exact p, q, sum, difference, product, expected;
  int low = cloth_exact_low(0x1p-1000);
  CHECK(low == -1052 && cloth_exact_low(1.5) == -52 && cloth_exact_low(0x1p-1040) == -1074);
  CHECK(cloth_exact_low(0) == INT_MAX && cloth_exact_low(5e-324) == -1074);
  cloth_exact_set(0x1p1000, low, &p);
  cloth_exact_set(0x1p-1000, low, &q);
  cloth_exact_add(&p, &q, 1, &sum);
  cloth_exact_add(&p, &q, -1, &difference);
  cloth_exact_mul(&sum, &difference, &product);
  // in units of 2^-2104: 2^4104 - 2^104, ones from bit 104 to 4103
  CHECK(product.sign == 1 && product.count == 129);
  for (int bit = 0; bit < 129 * 32; bit++)
    CHECK((product.limb[bit / 32] >> bit % 32 & 1) == (bit >= 104 && bit < 4104));
  cloth_exact_add(&q, &p, -1, &expected);
  cloth_exact_add(&expected, &difference, 1, &sum);
  CHECK(expected.sign == -1 && sum.sign == 0 && sum.count == 0);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(signs_are_those_of_whole_numbers);
  RUN(one_last_digit_decides);
  RUN(the_whole_range_of_double_is_exact);
  RUN(whole_numbers_add_and_multiply);
  return failures != 0;
}
