// The independent checker against cases built by hand.
#include "check_meshes.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>

using check_meshes::Mesh;
using check_meshes::Result;

namespace {

Mesh mesh(std::vector<double> position, std::vector<int> triangle)
{
  return {"mesh", std::move(position), std::move(triangle)};
}

size_t self_hits(const Mesh &m) { return check_meshes::intersections({m}, {}).cloth_cloth.size(); }

size_t body_hits(const Mesh &cloth, const Mesh &body)
{
  return check_meshes::intersections({cloth}, {body}).cloth_body.size();
}

// n x n quads in [0, 1]^2 at height(x, y)
template <typename Height> Mesh sheet(int n, Height height)
{
  Mesh m;
  for (int j = 0; j <= n; j++)
    for (int i = 0; i <= n; i++) {
      double x = double(i) / n, y = double(j) / n;
      m.position.insert(m.position.end(), {x, y, height(x, y)});
    }
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      int v = j * (n + 1) + i;
      m.triangle.insert(m.triangle.end(), {v, v + 1, v + n + 2, v, v + n + 2, v + n + 1});
    }
  return m;
}

// an axis-aligned box, outward normals
Mesh box(double x0, double y0, double z0, double x1, double y1, double z1)
{
  Mesh m;
  for (int i = 0; i < 8; i++)
    m.position.insert(m.position.end(), {i & 1 ? x1 : x0, i & 2 ? y1 : y0, i & 4 ? z1 : z0});
  m.triangle = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return m;
}

} // namespace

TEST(check_meshes, crossing_triangles_are_found)
{
  EXPECT_EQ(1u, self_hits(mesh({0, 0, 0, 1, 0, 0, 0, 1, 0, .2, .2, -1, .3, .2, 1, .2, .3, 1},
                               {0, 1, 2, 3, 4, 5})));
}

TEST(check_meshes, separate_triangles_are_not)
{
  // boxes overlap, triangles miss each other by 1e-9
  EXPECT_EQ(0u, self_hits(mesh({0, 0, 0, 1, 0, 0, 0, 1, 0, .5 + 1e-9, .5, -1, 1, .5, 1, .5, 1, 1},
                               {0, 1, 2, 3, 4, 5})));
}

TEST(check_meshes, touching_counts_and_a_gap_of_one_rounding_does_not)
{
  std::vector<double> x = {0, 0, 0, 1, 0, 0, 0, 1, 0, .2, .2, 0, .3, .2, 1, .2, .3, 1};
  EXPECT_EQ(1u, self_hits(mesh(x, {0, 1, 2, 3, 4, 5})));
  x[11] = 5e-324; // the least number above 0: exact predicates see it
  EXPECT_EQ(0u, self_hits(mesh(x, {0, 1, 2, 3, 4, 5})));
}

TEST(check_meshes, neighbours_of_a_flat_or_wavy_sheet_do_not_intersect)
{
  EXPECT_EQ(0u, self_hits(sheet(20, [](double, double) { return 0.0; })));
  EXPECT_EQ(0u,
            self_hits(sheet(20, [](double x, double y) { return .1 * std::sin(9 * x + 5 * y); })));
}

TEST(check_meshes, triangles_with_a_common_corner_that_cross_away_from_it_are_found)
{
  // both start at the origin; the second pierces the first's opposite edge
  EXPECT_EQ(1u,
            self_hits(mesh({0, 0, 0, 1, -1, 0, 1, 1, 0, 2, 0, -.5, 2, 0, .5}, {0, 1, 2, 0, 3, 4})));
  // the second is smaller: its own opposite edge pierces the first
  EXPECT_EQ(
      1u, self_hits(mesh({0, 0, 0, 1, -1, 0, 1, 1, 0, .5, 0, -.1, .5, 0, .1}, {0, 1, 2, 0, 3, 4})));
  // they meet in the corner alone
  EXPECT_EQ(
      0u, self_hits(mesh({0, 0, 0, 1, -1, 0, 1, 1, 0, -1, 0, -.5, -1, 0, .5}, {0, 1, 2, 0, 3, 4})));
}

TEST(check_meshes, an_edge_folded_flat_is_found_and_one_folded_nearly_flat_is_not)
{
  std::vector<double> x = {0, 0, 0, 1, 0, 0, .5, 1, 0, .5, .8, 0};
  EXPECT_EQ(1u, self_hits(mesh(x, {0, 1, 2, 1, 0, 3})));
  x[11] = 1e-12;
  EXPECT_EQ(0u, self_hits(mesh(x, {0, 1, 2, 1, 0, 3})));
  x[11] = 0, x[10] = -1; // unfolded
  EXPECT_EQ(0u, self_hits(mesh(x, {0, 1, 2, 1, 0, 3})));
}

TEST(check_meshes, a_triangle_that_is_there_twice_is_found)
{
  EXPECT_EQ(1u, self_hits(mesh({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2, 1, 2, 0})));
}

TEST(check_meshes, a_triangle_without_area_is_a_segment)
{
  Mesh sheet = mesh({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2});
  EXPECT_EQ(1u, body_hits(sheet, mesh({.2, .2, -1, .2, .2, 1, .2, .2, 0}, {0, 1, 2})));
  EXPECT_EQ(0u, body_hits(sheet, mesh({.2, .2, .1, .2, .2, 1, .2, .2, .5}, {0, 1, 2})));
}

TEST(check_meshes, two_cloths_are_checked_against_each_other)
{
  Mesh a = sheet(4, [](double, double) { return 0.0; });
  Mesh b = sheet(4, [](double x, double) { return x - .4; });
  Result r = check_meshes::intersections({a, b}, {});
  ASSERT_FALSE(r.cloth_cloth.empty());
  for (const auto &hit : r.cloth_cloth) EXPECT_NE(hit.mesh0, hit.mesh1);
}

TEST(check_meshes, the_count_is_that_of_every_pair_tested)
{
  // brute force has no boxes: two sheets at an angle, each pair of triangles alone
  Mesh a = sheet(6, [](double x, double y) { return .3 * std::sin(7 * x + y); });
  Mesh b = sheet(6, [](double x, double y) { return .2 * std::cos(5 * y - x); });
  size_t alone = 0;
  for (size_t i = 0; i < a.triangle.size(); i += 3)
    for (size_t j = 0; j < b.triangle.size(); j += 3) {
      Mesh one = mesh(a.position, {a.triangle.begin() + long(i), a.triangle.begin() + long(i) + 3});
      Mesh two = mesh(b.position, {b.triangle.begin() + long(j), b.triangle.begin() + long(j) + 3});
      alone += body_hits(one, two);
    }
  EXPECT_GT(alone, 0u);
  EXPECT_EQ(alone, body_hits(a, b));
}

TEST(check_meshes, cloth_on_a_table_is_free_and_cloth_in_it_is_found)
{
  Mesh table = box(-1, -1, -.1, 2, 2, 0);
  EXPECT_EQ(0u, body_hits(sheet(5, [](double, double) { return 1e-6; }), table));
  EXPECT_GT(body_hits(sheet(5, [](double x, double) { return x - .5; }), table), 0u);
}

TEST(check_meshes, cloth_wholly_inside_a_body_is_found)
{
  Mesh body = box(-1, -1, -1, 2, 2, 2);
  Result r = check_meshes::intersections({sheet(3, [](double, double) { return 0.0; })}, {body});
  EXPECT_TRUE(r.cloth_body.empty());
  ASSERT_EQ(1u, r.cloth_in_body.size());
  r = check_meshes::intersections({sheet(3, [](double, double) { return 2.5; })}, {body});
  EXPECT_TRUE(r.cloth_in_body.empty());
}

TEST(check_meshes, an_obj_file_is_read_and_a_broken_one_is_refused_with_its_line)
{
  std::string path = testing::TempDir() + "check_meshes_test.obj";
  std::ofstream(path) << "# cloth a step 0\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1/1 2/2 3 4\n";
  Mesh m = check_meshes::read_obj(path);
  EXPECT_EQ(12u, m.position.size());
  EXPECT_EQ((std::vector<int>{0, 1, 2, 0, 2, 3}), m.triangle);

  for (const char *bad : {"v 0 0 0\nf 1 2 3\n", "v 0 0\n", "v 0 0 0\nf 1 1\n", "v 0 0 nan\n"}) {
    std::ofstream(path) << bad;
    try {
      check_meshes::read_obj(path);
      ADD_FAILURE() << "accepted: " << bad;
    } catch (const std::runtime_error &e) {
      EXPECT_NE(std::string::npos, std::string(e.what()).find(path + ":")) << e.what();
    }
  }
  std::remove(path.c_str());
}
