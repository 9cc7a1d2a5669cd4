// Particles and closed shapes: what comes out of cloth_shape_resolve() is held against distances
// worked out here by clamping to the solid, on random ways through and beside each shape.
#include "check.h"
#include "shape_contact.h"

#ifdef CLOTH_SINGLE_PRECISION
#define DIGITS 2e-6
#else
#define DIGITS 1e-13
#endif

enum { TRIES = 200000 };

static uint32_t seed;

static double roll(void)
{
  seed = seed * 1664525u + 1013904223u;
  return (double)(seed >> 8) / (1 << 23) - 1;
}

static cloth_v3 somewhere(double size)
{
  double x = size * roll(), y = size * roll();
  return cloth_v3_make((cloth_real)x, (cloth_real)y, (cloth_real)(size * roll()));
}

static double clamp(double a, double most) { return a < -most ? -most : a > most ? most : a; }

// distance from the solid, 0 inside
static double distance(int kind, const cloth_real *size, cloth_v3 p)
{
  double x = (double)p.x, y = (double)p.y, z = (double)p.z, r = sqrt(x * x + y * y);
  double a = (double)size[0], b = (double)size[1], c = (double)size[2];
  if (kind == CLOTH_SHAPE_KIND_HALF_SPACE) return z > 0 ? z : 0;
  if (kind == CLOTH_SHAPE_KIND_SPHERE) {
    double d = sqrt(r * r + z * z) - a;
    return d > 0 ? d : 0;
  }
  if (kind == CLOTH_SHAPE_KIND_BOX) {
    double dx = x - clamp(x, a), dy = y - clamp(y, b), dz = z - clamp(z, c);
    return sqrt(dx * dx + dy * dy + dz * dz);
  }
  double dr = r - clamp(r, a), dz = z - clamp(z, b);
  return sqrt(dr * dr + dz * dz);
}

static const cloth_real size_of[4][3] = {{0, 0, 0},
                                         {(cloth_real)0.3, 0, 0},
                                         {(cloth_real)0.2, (cloth_real)0.3, (cloth_real)0.1},
                                         {(cloth_real)0.25, (cloth_real)0.15, 0}};

static int stays_outside(void)
{
  const double gap = 0.02;
  seed = 1;
  for (int kind = 0; kind < 4; kind++)
    for (int i = 0, moved = 0; i < TRIES; i++) {
      cloth_v3 from = somewhere(0.6), to = cloth_v3_add(from, somewhere(0.1)), p = to, n;
      double before = distance(kind, size_of[kind], to);
      if (!cloth_shape_resolve(kind, size_of[kind], (cloth_real)gap, from, &p, &n)) {
        CHECK(before >= gap - DIGITS);
        continue;
      }
      moved++;
      CHECK_NEAR((double)cloth_v3_length(n), 1, DIGITS);
      CHECK(distance(kind, size_of[kind], p) >= gap - DIGITS);
      // who crossed the corner of a box is put before the face, which may be beside it
      if (kind == CLOTH_SHAPE_KIND_BOX && !(before < gap)) continue;
      if (kind == CLOTH_SHAPE_KIND_BOX && distance(kind, size_of[kind], p) > gap + DIGITS) continue;
      if (before > 0 && before < 1e-4) continue; // too little of it has a direction
      // the shape is where the normal comes from
      cloth_v3 inside = cloth_v3_add_scaled(p, (cloth_real)(-gap - 1e-3), n);
      CHECK(distance(kind, size_of[kind], inside) < gap / 2);
      if (i == TRIES - 1) CHECK(moved > TRIES / 100);
    }
  return 0;
}

// nothing is farther pushed than to the nearest point of the grown surface, where it came from
// outside
static int goes_the_nearest_way(void)
{
  const double gap = 0.02;
  seed = 2;
  for (int kind = 0; kind < 4; kind++)
    for (int i = 0; i < TRIES; i++) {
      cloth_v3 to = somewhere(0.6), p = to, n;
      double depth = gap - distance(kind, size_of[kind], to);
      if (!(depth < gap))
        continue; // the centre is inside: what is nearest is not told by distance()
      if (!cloth_shape_resolve(kind, size_of[kind], (cloth_real)gap, to, &p, &n)) continue;
      CHECK_NEAR((double)cloth_v3_length(cloth_v3_sub(p, to)), depth, DIGITS);
    }
  return 0;
}

// a thin plate is not crossed, however fast
static int box_is_not_crossed(void)
{
  const cloth_real plate[3] = {1, 1, (cloth_real)0.002};
  const double gap = 0.001;
  seed = 3;
  for (int i = 0; i < TRIES; i++) {
    double up = roll() < 0 ? -1 : 1;
    cloth_v3 from = somewhere(0.5), to = somewhere(0.5), n;
    from.z = (cloth_real)(up * (0.0031 + 0.5 * fabs(roll())));
    to.z = (cloth_real)(-up * 0.5 * fabs(roll()));
    CHECK(cloth_shape_resolve(CLOTH_SHAPE_KIND_BOX, plate, (cloth_real)gap, from, &to, &n));
    CHECK_NEAR((double)to.z, up * 0.003, DIGITS);
    CHECK((double)n.z == up);
  }
  return 0;
}

// ---- velocities ---------------------------------------------------------------------------------

static const cloth_real still[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

static cloth_shapes floor_of(cloth_real friction, const cloth_real *t1, int *kind, cloth_real *mu)
{
  *kind = CLOTH_SHAPE_KIND_HALF_SPACE, *mu = friction;
  cloth_shapes s = {1, kind, size_of[0], mu, still, t1, (cloth_real)0.01};
  return s;
}

// Coulomb: a blow of speed u on the floor takes at most mu u from the slip, and never turns it
static int friction_is_that_of_coulomb(void)
{
  const double h = 1e-3;
  seed = 4;
  for (int i = 0; i < TRIES; i++) {
    int kind, touch = 0;
    cloth_real mu;
    double friction = fabs(roll()), down = 2 * fabs(roll()) + 0.01, slip = 3 * roll();
    cloth_shapes s = floor_of((cloth_real)friction, still, &kind, &mu);
    cloth_v3 x = cloth_v3_make(0, 0, (cloth_real)0.01);
    cloth_v3 v = cloth_v3_make((cloth_real)slip, 0, (cloth_real)-down);
    cloth_v3 end = cloth_shapes_move(&s, (cloth_real)h, x, &v, &touch);
    double left = fabs(slip) - friction * down;
    CHECK(touch == 1);
    CHECK_NEAR((double)v.z, 0, 10 * DIGITS);
    CHECK_NEAR((double)v.x, left > 0 ? copysign(left, slip) : 0, 10 * DIGITS);
    CHECK_NEAR((double)end.z, 0.01, DIGITS);
    CHECK_NEAR((double)end.x, h * (double)v.x, DIGITS);
  }
  return 0;
}

// a floor that rises takes along what lies on it, and no faster
static int a_body_that_moves_gives_its_velocity(void)
{
  const double h = 1e-3, rise = 0.7, along = 0.4;
  cloth_real moved[12];
  int kind, touch = 0;
  cloth_real mu;
  memcpy(moved, still, sizeof moved);
  moved[9] = (cloth_real)(h * along), moved[11] = (cloth_real)(h * rise);
  cloth_shapes s = floor_of(10, moved, &kind, &mu);
  cloth_v3 x = cloth_v3_make(0, 0, (cloth_real)0.01), v = cloth_v3_make(0, 0, 0);
  cloth_v3 end = cloth_shapes_move(&s, (cloth_real)h, x, &v, &touch);
  CHECK_NEAR((double)v.z, rise, 1e4 * DIGITS);
  CHECK_NEAR((double)v.x, along, 1e4 * DIGITS); // sticks
  CHECK_NEAR((double)end.z, 0.01 + h * rise, DIGITS);
  return 0;
}

// what starts too deep is put outside, but gets no speed from it
static int a_start_inside_adds_no_energy(void)
{
  int kind, touch = 0;
  cloth_real mu;
  cloth_shapes s = floor_of(0, still, &kind, &mu);
  cloth_v3 x = cloth_v3_make(0, 0, (cloth_real)-0.05), v = cloth_v3_make(0, 0, 0);
  cloth_v3 end = cloth_shapes_move(&s, (cloth_real)1e-3, x, &v, &touch);
  CHECK_NEAR((double)end.z, 0.01, DIGITS);
  CHECK_NEAR((double)v.z, 0, DIGITS);
  return 0;
}

int main(int argc, char **argv)
{
  int failures = 0;
  RUN(stays_outside);
  RUN(goes_the_nearest_way);
  RUN(box_is_not_crossed);
  RUN(friction_is_that_of_coulomb);
  RUN(a_body_that_moves_gives_its_velocity);
  RUN(a_start_inside_adds_no_energy);
  return failures > 0;
}
