// FCL's opinion is only worth something if FCL is asked the right way. The oracle here is brute
// force over all pairs with distances and intersections written out in the plainest way.
#include "node/fcl_check.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <set>
#include <tuple>

using namespace robot_cloth;
using Eigen::Vector3d;

namespace {

struct Soup {
  std::vector<double> x;
  std::vector<int> t;

  cloth_mesh_view view() const
  {
    cloth_mesh_view v = {};
    v.vertex_count = static_cast<int>(x.size() / 3);
    v.triangle_count = static_cast<int>(t.size() / 3);
    v.position = x.data();
    v.triangle = t.data();
    return v;
  }
  int count() const { return static_cast<int>(t.size() / 3); }
  Vector3d corner(int triangle, int k) const
  {
    const double *p = &x[3 * static_cast<size_t>(t[static_cast<size_t>(3 * triangle + k)])];
    return {p[0], p[1], p[2]};
  }
  void add(const Vector3d &a, const Vector3d &b, const Vector3d &c)
  {
    for (const Vector3d &v : {a, b, c}) {
      t.push_back(static_cast<int>(x.size() / 3));
      x.insert(x.end(), v.data(), v.data() + 3);
    }
  }
};

std::mt19937 random_bits(1);

Vector3d randomIn(double half)
{
  std::uniform_real_distribution<double> u(-half, half);
  return {u(random_bits), u(random_bits), u(random_bits)};
}

// Triangles of about `edge` m whose first corners lie in a cube of half width `half`.
Soup randomSoup(int count, double half, double edge)
{
  Soup s;
  for (int i = 0; i < count; i++) {
    const Vector3d a = randomIn(half);
    s.add(a, a + randomIn(edge), a + randomIn(edge));
  }
  return s;
}

// A wavy sheet of n x n vertices in [0, 1]^2.
Soup sheet(int n, double wave)
{
  Soup s;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      const double u = double(i) / (n - 1), v = double(j) / (n - 1);
      s.x.insert(s.x.end(), {u, v, wave * std::sin(20 * u) * std::cos(17 * v)});
    }
  for (int i = 0; i + 1 < n; i++)
    for (int j = 0; j + 1 < n; j++) {
      const int a = i * n + j;
      s.t.insert(s.t.end(), {a, a + n, a + 1, a + n, a + n + 1, a + 1});
    }
  return s;
}

Soup moved(const Soup &s, const Eigen::Isometry3d &pose)
{
  Soup out = s;
  for (size_t i = 0; i < s.x.size(); i += 3) {
    const Vector3d p = pose * Vector3d(s.x[i], s.x[i + 1], s.x[i + 2]);
    std::copy(p.data(), p.data() + 3, &out.x[i]);
  }
  return out;
}

Eigen::Isometry3d somePose(double turn)
{
  Eigen::Isometry3d p = Eigen::Isometry3d::Identity();
  p.translate(Vector3d(.1, -.05, .02))
      .rotate(Eigen::AngleAxisd(turn, Vector3d(1, 2, 3).normalized()));
  return p;
}

// ---- the oracle ----

double pointSegment(const Vector3d &p, const Vector3d &a, const Vector3d &b)
{
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0., 1.);
  return (p - a - t * (b - a)).norm();
}

// Inside the prism over the triangle: the plane's distance. Otherwise its edges are nearer.
double pointTriangle(const Vector3d &p, const Vector3d (&t)[3])
{
  const Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]);
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; k++) {
    const Vector3d &a = t[k], &b = t[(k + 1) % 3];
    inside = inside && n.cross(b - a).dot(p - a) >= 0;
    nearest = std::min(nearest, pointSegment(p, a, b));
  }
  return inside ? std::abs(n.dot(p - t[0])) / n.norm() : nearest;
}

// Ends against the other segment, and the interior minimum where there is one.
double segmentSegment(const Vector3d &a, const Vector3d &b, const Vector3d &c, const Vector3d &d)
{
  double nearest = std::min(
      {pointSegment(a, c, d), pointSegment(b, c, d), pointSegment(c, a, b), pointSegment(d, a, b)});
  const Vector3d u = b - a, v = d - c, w = c - a, n = u.cross(v);
  if (!(n.squaredNorm() > 0)) return nearest;
  const double s = w.cross(v).dot(n) / n.squaredNorm(), t = w.cross(u).dot(n) / n.squaredNorm();
  if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
    nearest = std::min(nearest, std::abs(w.dot(n)) / n.norm());
  return nearest;
}

double volume(const Vector3d &a, const Vector3d &b, const Vector3d &c, const Vector3d &d)
{
  return (b - a).cross(c - a).dot(d - a);
}

bool segmentCrosses(const Vector3d &p, const Vector3d &q, const Vector3d (&t)[3])
{
  if (volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) > 0) return false;
  const double x = volume(p, q, t[0], t[1]), y = volume(p, q, t[1], t[2]),
               z = volume(p, q, t[2], t[0]);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

bool intersects(const Vector3d (&a)[3], const Vector3d (&b)[3])
{
  for (int k = 0; k < 3; k++)
    if (segmentCrosses(a[k], a[(k + 1) % 3], b) || segmentCrosses(b[k], b[(k + 1) % 3], a))
      return true;
  return false;
}

double triangleTriangle(const Vector3d (&a)[3], const Vector3d (&b)[3])
{
  if (intersects(a, b)) return 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; i++) {
    nearest = std::min({nearest, pointTriangle(a[i], b), pointTriangle(b[i], a)});
    for (int j = 0; j < 3; j++)
      nearest = std::min(nearest, segmentSegment(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return nearest;
}

double distance(const Soup &a, int i, const Soup &b, int j)
{
  const Vector3d s[3] = {a.corner(i, 0), a.corner(i, 1), a.corner(i, 2)};
  const Vector3d t[3] = {b.corner(j, 0), b.corner(j, 1), b.corner(j, 2)};
  return triangleTriangle(s, t);
}

using Pair = std::pair<int, int>; // body triangle, cloth triangle

std::set<Pair> closePairs(const Soup &body, const Soup &cloth, double margin)
{
  std::set<Pair> out;
  for (int i = 0; i < body.count(); i++)
    for (int j = 0; j < cloth.count(); j++)
      if (distance(body, i, cloth, j) < margin) out.insert({i, j});
  return out;
}

std::vector<cloth_body_pair> candidates(const std::set<Pair> &pairs)
{
  std::vector<cloth_body_pair> out;
  for (const Pair &p : pairs) out.push_back({0, p.first, 0, p.second});
  return out;
}

// With nothing offered, everything is missed: FCL's truth laid open.
std::set<Pair> fclPairs(const FclCheck &check, double margin)
{
  const PairComparison c = check.compare(margin, 0, nullptr, 0, std::numeric_limits<int>::max());
  std::set<Pair> out;
  for (const MissedPair &m : c.missed) out.insert({m.pair.body_triangle, m.pair.cloth_triangle});
  EXPECT_EQ(static_cast<int64_t>(out.size()), c.truth);
  return out;
}

// Rounding moves a distance by some 1e-15 of the coordinates; random distances never come that
// close to the margin, so the sets are equal.
void expectTruth(const FclCheck &check, const Soup &body, const Soup &cloth, double margin)
{
  const std::set<Pair> expected = closePairs(body, cloth, margin), found = fclPairs(check, margin);
  EXPECT_GT(expected.size(), 0u);
  EXPECT_EQ(found, expected);
}

} // namespace

// ---- pairs within a margin ----

TEST(truth, is_what_brute_force_finds_on_random_triangles_of_every_size)
{
  // Half width of the cube, edge of body and of cloth triangles, margin: m.
  const double rows[][4] = {
      {.5, .3, .05, .02},     {.5, 2, .02, .01},        {.01, .01, .0002, .0005},
      {.1, .5, .0001, .0005}, {.002, .001, .001, 1e-4}, {1e-4, 5e-5, 5e-5, 1e-5},
      {5, 1, 1, .1}};
  for (const auto &row : rows) {
    SCOPED_TRACE(row[1]);
    const Soup body = randomSoup(80, row[0], row[1]), cloth = randomSoup(80, row[0], row[2]);
    const Eigen::Isometry3d pose = somePose(.8);
    FclCheck check;
    check.addBody(moved(body, pose.inverse()).view(), pose);
    check.addCloth(cloth.view());
    expectTruth(check, body, cloth, row[3]);
  }
}

TEST(truth, is_what_brute_force_finds_on_slivers)
{
  Soup body, cloth;
  for (int i = 0; i < 80; i++) {
    const Vector3d a = randomIn(.1), along = randomIn(.1), b = randomIn(.1);
    body.add(a, a + along, a + .5 * along + randomIn(1e-5));
    cloth.add(b, b + randomIn(.02), b + randomIn(.02));
  }
  FclCheck check;
  check.addBody(body.view(), Eigen::Isometry3d::Identity());
  check.addCloth(cloth.view());
  expectTruth(check, body, cloth, .01);
}

TEST(truth, follows_bodies_that_move_and_cloth_that_deforms)
{
  const Soup body = randomSoup(40, .3, .3), flat = sheet(12, 0);
  FclCheck check;
  check.addBody(body.view(), Eigen::Isometry3d::Identity());
  check.addCloth(flat.view());
  for (int step = 1; step <= 4; step++) {
    // Far from the first shape: the tree of the flat sheet is refitted to a crumpled and moved one.
    const Soup cloth = moved(sheet(12, .1 * step), somePose(step));
    const Eigen::Isometry3d pose = somePose(-.5 * step);
    check.moveBody(0, pose);
    check.moveCloth(0, cloth.x.data(), cloth.view().vertex_count);
    expectTruth(check, moved(body, pose), cloth, .03);
  }
}

// ---- comparing ----

TEST(comparison, more_than_the_truth_passes_and_one_pair_less_is_named)
{
  const Soup body = randomSoup(60, .3, .2), cloth = randomSoup(60, .3, .2);
  FclCheck check;
  check.addBody(body.view(), Eigen::Isometry3d::Identity());
  check.addCloth(cloth.view());
  const double margin = .01;
  const std::set<Pair> truth = closePairs(body, cloth, margin);
  std::vector<cloth_body_pair> offer = candidates(closePairs(body, cloth, .05));
  offer.insert(offer.end(), offer.begin(), offer.begin() + 5); // told twice
  PairComparison c = check.compare(margin, 0, offer.data(), static_cast<int>(offer.size()));
  EXPECT_TRUE(c.contained());
  EXPECT_EQ(c.truth, static_cast<int64_t>(truth.size()));
  EXPECT_EQ(c.candidates, static_cast<int64_t>(offer.size()) - 5);
  EXPECT_DOUBLE_EQ(c.ratio, double(c.candidates) / double(c.truth));

  offer = candidates(truth);
  const cloth_body_pair gone = offer[truth.size() / 2];
  offer.erase(offer.begin() + static_cast<long>(truth.size() / 2));
  c = check.compare(margin, 0, offer.data(), static_cast<int>(offer.size()));
  EXPECT_FALSE(c.contained());
  ASSERT_EQ(c.missed.size(), 1u);
  EXPECT_EQ(c.missed[0].pair.body_triangle, gone.body_triangle);
  EXPECT_EQ(c.missed[0].pair.cloth_triangle, gone.cloth_triangle);
  EXPECT_NEAR(c.missed[0].distance, distance(body, gone.body_triangle, cloth, gone.cloth_triangle),
              1e-14);
}

TEST(comparison, a_pair_in_the_epsilon_band_may_be_missing)
{
  Soup body, cloth;
  body.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  cloth.add({.2, .2, .01}, {.3, .2, .01}, {.2, .3, .01}); // 10 mm above
  FclCheck check;
  check.addBody(body.view(), Eigen::Isometry3d::Identity());
  check.addCloth(cloth.view());
  EXPECT_EQ(check.compare(.009, 0, nullptr, 0).truth, 0);
  EXPECT_EQ(check.compare(.011, 0, nullptr, 0).missed_count, 1);
  const PairComparison inside = check.compare(.011, .002, nullptr, 0);
  EXPECT_EQ(inside.truth, 1);
  EXPECT_EQ(inside.missed_count, 0);
}

TEST(comparison, counts_all_missed_pairs_and_keeps_the_closest)
{
  const Soup body = randomSoup(40, .2, .2), cloth = randomSoup(40, .2, .2);
  FclCheck check;
  check.addBody(body.view(), Eigen::Isometry3d::Identity());
  check.addCloth(cloth.view());
  const PairComparison all = check.compare(.05, 0, nullptr, 0, 1 << 20),
                       few = check.compare(.05, 0, nullptr, 0, 3);
  EXPECT_EQ(few.missed_count, all.truth);
  ASSERT_EQ(few.missed.size(), 3u);
  for (size_t i = 0; i < 3; i++) EXPECT_EQ(few.missed[i].distance, all.missed[i].distance);
}

TEST(comparison, keeps_bodies_and_cloths_apart)
{
  Soup low, high;
  low.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  high.add({0, 0, 1}, {1, 0, 1}, {0, 1, 1});
  FclCheck check;
  check.addBody(high.view(), Eigen::Isometry3d::Identity());
  check.addBody({}, Eigen::Isometry3d::Identity()); // a link without collision geometry
  check.addBody(low.view(), Eigen::Isometry3d::Identity());
  check.addCloth(low.view());
  check.addCloth(high.view());
  const PairComparison c = check.compare(.01, 0, nullptr, 0);
  ASSERT_EQ(c.missed_count, 2);
  EXPECT_EQ(c.missed[0].pair.body, 0);
  EXPECT_EQ(c.missed[0].pair.cloth, 1);
  EXPECT_EQ(c.missed[1].pair.body, 2);
  EXPECT_EQ(c.missed[1].pair.cloth, 0);
}

TEST(comparison, triangles_without_area_are_counted_and_not_judged)
{
  Soup body, cloth;
  body.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  cloth.add({0, 0, 0}, {1, 1, 0}, {2, 2, 0});
  FclCheck check;
  check.addBody(body.view(), Eigen::Isometry3d::Identity());
  check.addCloth(cloth.view());
  const PairComparison c = check.compare(.01, 0, nullptr, 0);
  EXPECT_EQ(c.degenerate, 1);
  EXPECT_EQ(c.truth, 0);
}

TEST(comparison, bad_input_is_refused_and_nothing_changes)
{
  Soup body = randomSoup(3, .1, .1), cloth = randomSoup(3, .1, .1);
  FclCheck check;
  check.addBody(body.view(), Eigen::Isometry3d::Identity());
  check.addCloth(cloth.view());
  const int64_t before = check.compare(.1, 0, nullptr, 0).truth;
  const cloth_body_pair bad[] = {{1, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, -1}};
  for (const cloth_body_pair &p : bad)
    EXPECT_THROW(check.compare(.01, 0, &p, 1), std::invalid_argument);
  EXPECT_THROW(check.compare(-1, 0, nullptr, 0), std::invalid_argument);
  EXPECT_THROW(check.compare(NAN, 0, nullptr, 0), std::invalid_argument);
  EXPECT_THROW(check.compare(.01, NAN, nullptr, 0), std::invalid_argument);
  std::vector<double> nan = cloth.x;
  nan[4] = NAN;
  EXPECT_THROW(check.moveCloth(0, nan.data(), 9), std::invalid_argument);
  EXPECT_THROW(check.moveCloth(0, cloth.x.data(), 8), std::invalid_argument);
  EXPECT_THROW(check.moveCloth(1, cloth.x.data(), 9), std::invalid_argument);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().x() = INFINITY;
  EXPECT_THROW(check.moveBody(0, pose), std::invalid_argument);
  Soup index = cloth;
  index.t[2] = 99;
  EXPECT_THROW(check.addCloth(index.view()), std::invalid_argument);
  EXPECT_EQ(check.clothCount(), 1);
  EXPECT_EQ(check.compare(.1, 0, nullptr, 0).truth, before);
}

// ---- intersections ----

TEST(intersections, of_cloth_with_bodies_are_what_brute_force_finds)
{
  for (double edge : {.3, .01, .0003}) {
    const Soup body = randomSoup(70, edge, edge), cloth = randomSoup(70, edge, edge);
    const Eigen::Isometry3d pose = somePose(1.3);
    FclCheck check;
    check.addBody(moved(body, pose.inverse()).view(), pose);
    check.addCloth(cloth.view());
    int64_t expected = 0;
    for (int i = 0; i < body.count(); i++)
      for (int j = 0; j < cloth.count(); j++) expected += distance(body, i, cloth, j) == 0;
    EXPECT_GT(expected, 20);
    const Intersections found = check.intersections(1 << 20);
    EXPECT_EQ(found.cloth_body, expected) << edge;
    for (const IntersectingPair &p : found.pairs) {
      if (p.body < 0) continue;
      EXPECT_EQ(distance(cloth, p.triangle_a, body, p.triangle_b), 0);
    }
  }
}

TEST(intersections, of_cloth_with_itself_are_what_brute_force_finds)
{
  const Soup cloth = randomSoup(120, .3, .2);
  FclCheck check;
  check.addCloth(cloth.view());
  int64_t expected = 0;
  for (int i = 0; i < cloth.count(); i++)
    for (int j = i + 1; j < cloth.count(); j++) expected += distance(cloth, i, cloth, j) == 0;
  EXPECT_GT(expected, 20);
  const Intersections found = check.intersections(2);
  EXPECT_EQ(found.cloth_cloth, expected);
  EXPECT_EQ(found.cloth_body, 0);
  EXPECT_EQ(found.pairs.size(), 2u); // counted all, kept two
}

TEST(intersections, neighbours_in_a_mesh_do_not_count)
{
  FclCheck check;
  check.addCloth(sheet(20, .05).view());
  EXPECT_EQ(check.intersections().cloth_cloth, 0);
}

// The tree refitted to its children, FCL's default, fails here: see Mesh::refit().
TEST(intersections, of_two_cloths_are_counted_once_and_a_refit_sees_them_come_and_go)
{
  const Soup a = sheet(10, 0);
  Soup b = moved(sheet(10, 0), Eigen::Isometry3d(Eigen::Translation3d(0, 0, .01)));
  FclCheck check;
  check.addCloth(a.view());
  check.addCloth(b.view());
  EXPECT_EQ(check.intersections().cloth_cloth, 0);
  b.x[2] = -.01; // one corner, in one triangle, dips through the sheet below
  check.moveCloth(1, b.x.data(), b.view().vertex_count);
  const Intersections through = check.intersections(1 << 20);
  EXPECT_GT(through.cloth_cloth, 0);
  for (const IntersectingPair &p : through.pairs) {
    EXPECT_EQ(p.cloth_a, 0);
    EXPECT_EQ(p.cloth_b, 1);
    EXPECT_EQ(distance(a, p.triangle_a, b, p.triangle_b), 0);
  }
  b.x[2] = .01;
  check.moveCloth(1, b.x.data(), b.view().vertex_count);
  EXPECT_EQ(check.intersections().cloth_cloth, 0);
}
