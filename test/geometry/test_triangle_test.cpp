// Tests of src/geometry/triangle_test.c and intersections.c. Oracle: CGAL in exact rational
// numbers. It constructs what two triangles have in common and looks whether that is more than the
// vertices they share.
#include "check_meshes.h"

extern "C" {
#include "geometry/intersections.h"
#include "geometry/predicates.h"
#include "geometry/triangle_test.h"
}

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Triangle = Kernel::Triangle_3;

uint64_t state = 88172645463325252u;

int below(int n)
{
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return static_cast<int>(state % static_cast<uint64_t>(n));
}

// the set that three points span, as its extreme points
struct Set {
  std::vector<Point> x; // 1, 2 or 3
};

Set set_of(const Point &a, const Point &b, const Point &c)
{
  if (!CGAL::collinear(a, b, c)) return {{a, b, c}};
  std::vector<Point> x = {a, b, c};
  std::sort(x.begin(), x.end());
  if (x[0] == x[2]) return {{x[0]}};
  return {{x[0], x[2]}};
}

// extreme points of what two sets have in common
std::vector<Point> common(const Set &a, const Set &b)
{
  if (a.x.size() < b.x.size()) return common(b, a);
  std::vector<Point> out;
  if (b.x.size() == 1) {
    bool in = a.x.size() == 3   ? Triangle(a.x[0], a.x[1], a.x[2]).has_on(b.x[0])
              : a.x.size() == 2 ? Segment(a.x[0], a.x[1]).has_on(b.x[0])
                                : a.x[0] == b.x[0];
    if (in) out.push_back(b.x[0]);
    return out;
  }
  auto keep = [&](const auto &result) {
    if (!result) return;
    if (const Point *p = boost::get<Point>(&*result)) out.push_back(*p);
    if (const Segment *s = boost::get<Segment>(&*result)) out = {s->source(), s->target()};
  };
  if (a.x.size() == 2) {
    keep(CGAL::intersection(Segment(a.x[0], a.x[1]), Segment(b.x[0], b.x[1])));
  } else if (b.x.size() == 2) {
    keep(CGAL::intersection(Triangle(a.x[0], a.x[1], a.x[2]), Segment(b.x[0], b.x[1])));
  } else {
    auto result =
        CGAL::intersection(Triangle(a.x[0], a.x[1], a.x[2]), Triangle(b.x[0], b.x[1], b.x[2]));
    keep(result);
    if (result)
      if (const Triangle *t = boost::get<Triangle>(&*result)) out = {(*t)[0], (*t)[1], (*t)[2]};
    if (result)
      if (const auto *many = boost::get<std::vector<Point>>(&*result)) out = *many;
  }
  return out;
}

struct Pair {
  double x[6][3];
  int a[3], b[3];
};

bool oracle(const Pair &p)
{
  std::vector<Point> point;
  for (const auto &x : p.x) point.emplace_back(x[0], x[1], x[2]);
  std::vector<int> shared;
  for (int v = 0; v < 6; v++)
    if (std::count(p.a, p.a + 3, v) && std::count(p.b, p.b + 3, v)) shared.push_back(v);
  if (shared.size() == 3) return true;
  std::vector<Point> both = common(set_of(point[p.a[0]], point[p.a[1]], point[p.a[2]]),
                                   set_of(point[p.b[0]], point[p.b[1]], point[p.b[2]]));
  if (shared.empty()) return !both.empty();
  const Point &u = point[shared[0]], &v = point[shared.back()];
  for (const Point &x : both) // all extreme points on a point or segment: nothing beyond it
    if (u == v ? x != u : !Segment(u, v).has_on(x)) return true;
  return false;
}

bool ours(const Pair &p, int turn)
{
  cloth_corners a, b;
  for (int k = 0; k < 3; k++) {
    a.vertex[k] = p.a[(k + turn) % 3], b.vertex[k] = p.b[(3 - k + turn) % 3];
    a.x[k] = p.x[a.vertex[k]], b.x[k] = p.x[b.vertex[k]];
  }
  return turn % 2 ? cloth_triangles_intersect(&b, &a, true)
                  : cloth_triangles_intersect(&a, &b, true);
}

// Corners on a grid of few points, so that most triangles touch, lie in one plane or have no
// area; `share` vertices in common, and now and then a vertex twice in a triangle.
Pair random_pair(int range, int flat, int share, double unit)
{
  Pair p;
  for (auto &x : p.x)
    for (int k = 0; k < 3; k++) x[k] = (k == 2 && flat ? 0 : below(range)) * unit;
  for (int k = 0; k < 3; k++) p.a[k] = k, p.b[k] = k < share ? k : 3 + k;
  if (below(20) == 0) p.a[below(3)] = p.a[below(3)];
  if (below(20) == 0) p.b[below(3)] = p.b[below(3)];
  return p;
}

void compare(const Pair &p)
{
  bool expected = oracle(p);
  for (int turn = 0; turn < 2; turn++) {
    if (ours(p, turn) == expected) continue;
    for (int k = 0; k < 3; k++) {
      const double *x = p.x[p.a[k]], *y = p.x[p.b[k]];
      std::printf("a %d (%.17g %.17g %.17g)  b %d (%.17g %.17g %.17g)\n", p.a[k], x[0], x[1], x[2],
                  p.b[k], y[0], y[1], y[2]);
    }
    FAIL() << "CGAL: " << expected;
  }
}

} // namespace

TEST(triangle_test, degenerate_pairs_are_what_exact_construction_says)
{
  for (int n = 0; n < 24000 && !HasFailure(); n++)
    compare(random_pair(2 + n % 4, n % 5 == 0, n / 5 % 4, 1));
}

TEST(triangle_test, the_least_doubles_are_told_apart)
{
  for (int n = 0; n < 2000 && !HasFailure(); n++)
    compare(random_pair(2 + n % 3, n % 5 == 0, n / 5 % 3, 5e-324));
  for (int n = 0; n < 6000 && !HasFailure(); n++) { // one last digit off a degenerate place
    Pair p = random_pair(2 + n % 3, n % 5 == 0, n / 5 % 3, n % 2 ? 1 : 0.1);
    double &c = p.x[below(6)][below(3)];
    c = std::nextafter(c, below(2) ? 10 : -10);
    compare(p);
  }
}

TEST(triangle_test, predicates_are_those_of_cgal)
{
  for (int n = 0; n < 20000; n++) {
    double x[4][3];
    Point p[4];
    for (int v = 0; v < 4; v++) {
      for (double &c : x[v]) {
        c = below(4) * 0.1;
        if (below(4) == 0) c = std::nextafter(c, 1);
        if (below(50) == 0) c = std::ldexp(c, below(600) - 300);
      }
      p[v] = Point(x[v][0], x[v][1], x[v][2]);
    }
    ASSERT_EQ(static_cast<int>(CGAL::orientation(p[0], p[1], p[2], p[3])),
              cloth_orient3d(x[0], x[1], x[2], x[3]));
  }
}

// whole meshes, against the checker that uses CGAL alone
TEST(triangle_test, meshes_intersect_where_check_meshes_says)
{
  for (int n = 0; n < 6; n++) {
    std::vector<check_meshes::Mesh> meshes(2);
    std::vector<cloth_mesh_view> views;
    for (int m = 0; m < 2; m++) {
      int size =
          12 +
          2 * m; // even: no triangle lies on the fold, where check_meshes counts neighbours too
      for (int j = 0; j <= size; j++)
        for (int i = 0; i <= size; i++) {
          double x = double(i) / size, y = double(j) / size;
          // wavy, flat, or folded over at x = 1/2 onto itself
          double z = n < 3 ? (0.1 + 0.2 * n) * std::sin(9 * x + (4 + n) * y + m) : 0;
          if (n == 3 && x > 0.5) x = 1 - x;
          meshes[m].position.insert(meshes[m].position.end(), {x, y, z + (n == 5 ? 0.01 * m : 0)});
        }
      for (int j = 0; j < size; j++)
        for (int i = 0; i < size; i++) {
          int v = j * (size + 1) + i;
          meshes[m].triangle.insert(meshes[m].triangle.end(),
                                    {v, v + 1, v + size + 2, v, v + size + 2, v + size + 1});
        }
      views.push_back({static_cast<int>(meshes[m].position.size() / 3),
                       static_cast<int>(meshes[m].triangle.size() / 3), meshes[m].position.data(),
                       meshes[m].triangle.data(), nullptr});
    }
    cloth_triangle_pair *pair = nullptr;
    int64_t count = 0;
    cloth_error err = {};
    ASSERT_EQ(CLOTH_OK, cloth_intersections_find(2, views.data(), &pair, &count, &err));
    check_meshes::Result expected = check_meshes::intersections(meshes, {});
    EXPECT_EQ(expected.cloth_cloth.size(), static_cast<size_t>(count)) << n;
    auto key = [](int a, int b, int c, int d) { return std::array<int, 4>{a, b, c, d}; };
    std::vector<std::array<int, 4>> theirs, mine;
    for (const auto &h : expected.cloth_cloth)
      theirs.push_back(std::make_pair(h.mesh0, h.triangle0) < std::make_pair(h.mesh1, h.triangle1)
                           ? key(h.mesh0, h.triangle0, h.mesh1, h.triangle1)
                           : key(h.mesh1, h.triangle1, h.mesh0, h.triangle0));
    for (int64_t i = 0; i < count; i++)
      mine.push_back(
          key(pair[i].mesh[0], pair[i].triangle[0], pair[i].mesh[1], pair[i].triangle[1]));
    std::sort(theirs.begin(), theirs.end());
    std::sort(mine.begin(), mine.end());
    EXPECT_EQ(theirs, mine) << n;
    std::free(pair);
  }
}
