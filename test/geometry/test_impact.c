// Tests of src/geometry/impact.c: one-sided, against contacts that are there by construction.
#include "check.h"
#include "geometry/impact.h"

#include <stdint.h>

static uint64_t state = 88172645463325252u;

// whole, in [-most, most]
static int whole(int most)
{
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return (int)(state % (uint64_t)(2 * most + 1)) - most;
}

// Points with whole coordinates that touch exactly: the foot of a vertex in a face, or the common
// point of two edges, at weights of eighths, often 0 or 1; without area or length now and then.
static void touch(cloth_impact_kind kind, double c[4][3])
{
  int a = (whole(4) + 4), b = (whole(4) + 4);
  if (kind == CLOTH_IMPACT_VERTEX_FACE && a + b > 8) a = 8 - a, b = 8 - b;
  int flat = whole(3) == 0;
  for (int k = 0; k < 3; k++) {
    int p = 8 * whole(2), q = 8 * whole(2), r = 8 * whole(2);
    if (flat && k == 2) p = q = r = 0;
    if (kind == CLOTH_IMPACT_VERTEX_FACE) {
      c[1][k] = p, c[2][k] = q, c[3][k] = r;
      c[0][k] = p + (a * (q - p) + b * (r - p)) / 8.0;
    } else { // p + a / 8 (q - p) = the point at b / 8 of the other edge, both ends of which are
             // moved
      double at = p + a * (q - p) / 8.0;
      c[0][k] = p, c[1][k] = q;
      c[2][k] = at - b * r / 8.0, c[3][k] = at + (8 - b) * r / 8.0;
    }
  }
}

// What touches at an eighth of the step, moving from and to places that are exact in double, is
// neither missed nor met late, in any precision; also where float cannot hold the places, and where
// all moves along in one plane, or nothing moves at all.
static int constructed_contacts_are_neither_missed_nor_late(void)
{
  const int sizes[] = {0, 0, -40, 37, -400, 400, -1000};
  for (int n = 0; n < 24000; n++) {
    cloth_impact_kind kind = n % 2 ? CLOTH_IMPACT_VERTEX_FACE : CLOTH_IMPACT_EDGE_EDGE;
    int when = whole(4) + 4, size = sizes[n % 7], speed = n % 11 ? whole(3) + 3 : 0;
    double c[4][3], x[8][3], far = n % 5 ? 0 : ldexp(1 + 2 * whole(1 << 20), n % 3 ? -20 : 9);
    touch(kind, c);
    for (int p = 0; p < 4; p++)
      for (int k = 0; k < 3; k++) {
        int v = n % 13 && !(n % 17 == 0 && k == 2) ? whole(speed) : 0;
        x[p][k] = ldexp(far + c[p][k] - when * v, size);
        x[4 + p][k] = ldexp(far + c[p][k] + (8 - when) * v, size);
      }
    for (int precision = 0; precision < 3; precision++) {
      cloth_impact_result r =
          cloth_impact_test(kind, (cloth_impact_precision)precision, (const double(*)[3])x);
      CHECK(r.hit);
      CHECK(r.toi >= 0 && r.toi <= when / 8.0);
    }
  }
  return 0;
}

// a vertex falls on a face at half time; scaled, and moved by what float cannot hold
static int an_impact_is_found_at_any_size_and_place(void)
{
  const double fall[8][3] = {{.2, .2, 1},  {0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                             {.2, .2, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const double size[] = {1, 1e-30, 1e-150, 1e-300, 1e30, 1e150, 1e300};
  for (int n = 0; n < 7; n++)
    for (int precision = 0; precision < 3; precision++)
      for (int aside = 0; aside < 2; aside++) {
        double x[8][3];
        for (int k = 0; k < 24; k++) x[k / 3][k % 3] = size[n] * fall[k / 3][k % 3];
        if (aside) x[0][0] = x[4][0] = -0.01 * size[n]; // beside the face
        for (int k = 0; k < 8; k++) x[k][1] += n == 0 ? 1e6 : 0;
        cloth_impact_result r = cloth_impact_test(
            CLOTH_IMPACT_VERTEX_FACE, (cloth_impact_precision)precision, (const double(*)[3])x);
        CHECK(r.hit == !aside);
        if (r.hit) CHECK(r.toi <= 0.5 && r.toi > 0.4999);
      }
  return 0;
}

// A vertex falls on a face, or beside it by a hundredth, in other units along each axis, one of
// them so small that its squares are 0.
static int an_impact_is_found_in_other_units_along_each_axis(void)
{
  const double fall[8][3] = {{.2, .2, 1},  {0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                             {.2, .2, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int n = 0; n < 18; n++)
    for (int precision = 0; precision < 3; precision++) {
      double x[8][3];
      for (int k = 0; k < 24; k++) x[k / 3][k % 3] = fall[k / 3][k % 3];
      int aside = n % 2;
      if (aside) x[0][0] = x[4][0] = -0.01;
      for (int p = 0; p < 8; p++) {
        x[p][n % 3] = ldexp(x[p][n % 3], n < 6 ? -600 : n < 12 ? -960 : 700);
        if (n >= 6) x[p][(n + 1) % 3] = ldexp(x[p][(n + 1) % 3], -300);
      }
      cloth_impact_result r = cloth_impact_test(
          CLOTH_IMPACT_VERTEX_FACE, (cloth_impact_precision)precision, (const double(*)[3])x);
      CHECK(r.hit == !aside);
      if (r.hit) CHECK(r.toi <= 0.5 && r.toi > 0.4999);
    }
  return 0;
}

// apart by less than float tells: float alone says contact, and double decides
static int float_asks_again_where_it_cannot_tell(void)
{
  double x[8][3] = {{-1, .2, 1e-9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                    {2, .3, 1e-9},  {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int above = 1; above >= -1; above -= 2) {
    x[0][2] = above * 1e-9;
    cloth_impact_result r =
        cloth_impact_test(CLOTH_IMPACT_VERTEX_FACE, CLOTH_IMPACT_FLOAT, (const double(*)[3])x);
    CHECK(r.asked_again && r.hit == (above < 0));
    r = cloth_impact_test(CLOTH_IMPACT_VERTEX_FACE, CLOTH_IMPACT_FLOAT_ALONE,
                          (const double(*)[3])x);
    CHECK(r.hit && !r.asked_again);
  }
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(constructed_contacts_are_neither_missed_nor_late);
  RUN(an_impact_is_found_at_any_size_and_place);
  RUN(an_impact_is_found_in_other_units_along_each_axis);
  RUN(float_asks_again_where_it_cannot_tell);
  return failures != 0;
}
